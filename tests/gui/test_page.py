"""The page itself, in a real browser: topics, messages, the form, the log, and the arrangement."""

import json
import signal
import socket
from urllib.parse import quote

import pytest

from lcmtools.errors import NothingReceived
from lcmtools.observe.reading.received import messages
from tests.gui.conftest import forget_layouts

POSE = "{header: {frame_id: map}, pose: {position: {x: 1.5, y: -2.0}}}"


@pytest.fixture(scope="module", autouse=True)
def _nodes(module_start, lcmtools_path):
    module_start(lcmtools_path, "run", "talker").wait_for("hello")
    module_start(
        lcmtools_path, *("pub", "-r", "10", "/pose", "geometry_msgs/PoseStamped", POSE, "-v")
    ).wait_for("#1")


@pytest.fixture(scope="module")
def address(module_start, lcmtools_path):
    """The address of a window with all panels that the tests share."""
    server = module_start(lcmtools_path, "gui", "--port", "0", "--no-open")
    return server.wait_for("http://").split()[-1]


@pytest.fixture
def topics(page, address):
    """A page that shows the topics above the log."""
    parts = [{"panel": "topics"}, {"panel": "log"}]
    tree = {"split": "column", "parts": parts, "sizes": [3, 1]}
    forget_layouts(page, address)
    page.goto(f"{address}#{quote(json.dumps(tree))}")
    page.get_by_role("cell", name="/chatter", exact=True).wait_for()
    return page


def row(page, topic):
    return page.locator("tbody tr", has=page.get_by_role("cell", name=topic, exact=True))


def panels(page):
    return [str(name) for name in page.locator(".panel h2").all_inner_texts()]


def test_topics_have_their_types_and_rates(topics):
    chatter = row(topics, "/chatter")
    assert "std_msgs/String" in chatter.inner_text()
    chatter.get_by_text("10.0 Hz").wait_for()
    assert "/talker" in chatter.inner_text()


def test_the_filter_leaves_the_topics_with_its_text(topics):
    topics.get_by_label("Filter topics").fill("PoseStamped")
    row(topics, "/chatter").wait_for(state="detached")
    assert row(topics, "/pose").count() == 1
    assert topics.get_by_text("1 of ").count() == 1


def test_columns_sort_both_ways(topics):
    def order():
        return [str(one) for one in topics.locator("tbody td[data-column=topic]").all_inner_texts()]

    by_name = order()
    assert by_name == sorted(by_name)
    topics.get_by_role("button", name="Topic").click()
    assert order() == sorted(by_name, reverse=True)
    assert topics.locator("th[data-column=topic]").get_attribute("aria-sort") == "descending"


def test_a_message_unfolds_with_its_units_and_comments(topics):
    row(topics, "/pose").click()
    tree = topics.get_by_role("tree", name="Message of /pose")
    x = tree.locator("[data-path='pose.position.x']")
    x.get_by_text("1.5", exact=True).wait_for()
    x.locator(".tree-unit", has_text="m").wait_for()
    position = tree.locator("[data-path='pose.position']")
    assert position.get_attribute("aria-expanded") == "true"
    position.click()
    x.wait_for(state="detached")
    assert position.get_attribute("aria-expanded") == "false"
    assert "position" in position.locator(".tree-comment").inner_text()


def test_the_form_publishes_once_and_at_a_rate(topics, module_bus_url):
    arrivals = messages("/speed", url=module_bus_url, wall_time=True, timeout=40.0)
    topics.get_by_role("button", name="Publish …").click()
    form = topics.get_by_role("form", name="Publish")
    form.get_by_label("Topic").fill("/speed")
    form.get_by_label("Type").fill("geometry_msgs/Twist")
    form.get_by_label("Type").press("Enter")  # chooses the type, and sends nothing
    x = form.locator("fieldset", has_text="linear").locator("input").first
    x.fill("fast")
    form.get_by_role("button", name="Publish once").click()
    form.get_by_text("linear.x").wait_for()  # the error names the field
    x.fill("0.25")
    form.get_by_role("button", name="Repeat").click()
    found = next(arrivals).message
    assert found.linear.x == 0.25  # the first one: Enter has sent none of zeros
    form.get_by_text("published 3").wait_for()
    form.get_by_role("button", name="Stop").click()
    assert form.get_by_role("button", name="Repeat").get_attribute("aria-pressed") == "false"
    x.fill("0.75")
    x.press("Control+Enter")
    form.get_by_text("published at").wait_for()
    arrivals.close()


def test_the_type_and_the_slash_of_a_known_topic_are_filled_in(topics):
    topics.get_by_role("button", name="Publish …").click()
    form = topics.get_by_role("form", name="Publish")
    form.get_by_label("Topic").fill("pose")
    form.get_by_label("Topic").press("Tab")
    form.get_by_text("position").first.wait_for()
    assert form.get_by_label("Topic").input_value() == "/pose"


def test_nobody_publishes_from_a_page_that_may_only_watch(serve, page):
    _, address = serve("topics", "--read-only")
    page.goto(address)
    page.get_by_text("watching only").wait_for()
    row(page, "/pose").click()
    page.get_by_role("button", name="Publish", exact=True).click()
    page.get_by_text("this page may only watch, not command").wait_for()
    assert page.get_by_role("button", name="Publish once").is_disabled()
    assert page.get_by_role("button", name="Repeat").is_disabled()


def test_the_log_shows_lines_by_level_node_and_text(topics):
    log = topics.locator("[data-panel=log]")
    log.get_by_text("hello world").first.wait_for()
    log.get_by_label("Search the lines").fill("nobody says this")
    assert log.locator("tbody tr").count() == 0
    log.get_by_label("Search the lines").fill("HELLO")
    log.get_by_text("hello world").first.wait_for()
    log.get_by_label("Lowest level").select_option("WARN")
    assert log.locator("tbody tr").count() == 0
    log.get_by_label("Lowest level").select_option("DEBUG")
    log.get_by_label("Node").select_option("/talker")
    log.get_by_text("hello world").first.wait_for()


def repeat(page, topic):
    """Let the form publish again and again."""
    page.get_by_role("button", name="Publish …").click()
    form = page.get_by_role("form", name="Publish")
    form.get_by_label("Topic").fill(topic)
    form.get_by_label("Type").fill("geometry_msgs/Twist")
    form.get_by_label("Type").press("Tab")
    form.locator("fieldset").first.wait_for()
    form.get_by_role("button", name="Repeat").click()
    form.get_by_text("published 3").wait_for()


def test_it_comes_back_by_itself_but_what_was_sent_does_not(
    page, module_start, lcmtools_path, module_bus_url
):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    command = (lcmtools_path, "gui", "topics", "--no-open", "--port", port)
    server = module_start(*command)
    page.goto(server.wait_for("http://").split()[-1])
    row(page, "/chatter").wait_for()
    repeat(page, "/asked_for")
    server.send_signal(signal.SIGINT)
    server.wait()
    page.get_by_text("The connection to lcmtools gui is lost").wait_for()
    page.get_by_text("stopped: the connection").wait_for()
    again = module_start(*command)
    again.wait_for("http://")
    page.get_by_text("connected", exact=True).wait_for()
    page.get_by_text("The connection to lcmtools gui is lost").wait_for(state="hidden")
    assert page.get_by_role("button", name="Repeat").get_attribute("aria-pressed") == "false"
    before = row(page, "/chatter").inner_text()
    page.wait_for_function(
        "before => [...document.querySelectorAll('tr')].every(row => row.innerText !== before)",
        arg=before,
    )
    with pytest.raises(NothingReceived):  # nobody has asked for more
        next(messages("/asked_for", url=module_bus_url, wall_time=True, timeout=1.0))
    again.send_signal(signal.SIGINT)


def test_the_arrangement_is_kept_in_the_browser_and_in_the_address(topics, address, browser):
    assert panels(topics) == ["Topics", "Log"]
    topics.get_by_label("Filter topics").fill("chat")
    topics.locator("[data-panel=log]").get_by_role("button", name="Close").click()
    topics.get_by_role("button", name="Add panel").click()
    topics.get_by_role("menuitem", name="Graph").click()
    assert panels(topics) == ["Topics", "Graph"]
    topics.wait_for_function("() => location.hash.includes('graph')")
    shared = topics.url
    topics.reload()
    topics.locator("[data-panel=graph]").wait_for()
    assert topics.get_by_label("Filter topics").input_value() == "chat"
    topics.goto("about:blank")
    topics.goto(address)  # without what is behind #
    topics.locator("[data-panel=graph]").wait_for()
    topics.get_by_role("button", name="Layouts").click()
    topics.get_by_role("menuitem", name="Reset layout").click()
    topics.locator("[data-panel=graph]").wait_for(state="detached")
    assert panels(topics) == ["Topics", "Log", "World"]
    other = browser.new_page()
    other.goto(shared)
    other.locator("[data-panel=graph]").wait_for()
    other.close()


@pytest.mark.parametrize("cut_off", ["%7B%22panel", "%E0%A4%A", "%7B%22panel%22%3A%22none%22%7D"])
def test_an_address_that_was_cut_off_shows_panels_all_the_same(page, address, cut_off):
    page.goto(f"{address}#{cut_off}")
    page.locator(".layout > *").first.wait_for()
    page.get_by_text("connected", exact=True).wait_for()


def test_dividers_and_panels_are_moved_by_pointer(topics):
    log = topics.locator("[data-panel=log]")
    before = log.bounding_box()
    divider = topics.get_by_role("separator").bounding_box()
    topics.mouse.move(divider["x"] + 100, divider["y"] + 3)
    topics.mouse.down()
    topics.mouse.move(divider["x"] + 100, divider["y"] - 97, steps=3)
    topics.mouse.up()
    assert log.bounding_box()["height"] == pytest.approx(before["height"] + 100, abs=3)
    header = log.locator("header").first.bounding_box()
    target = topics.locator("[data-panel=topics]").bounding_box()
    topics.mouse.move(header["x"] + 60, header["y"] + 10)
    topics.mouse.down()
    topics.mouse.move(target["x"] + 20, target["y"] + target["height"] / 2, steps=4)
    topics.mouse.up()
    assert panels(topics) == ["Log", "Topics"]
    left, right = (
        topics.locator(f"[data-panel={one}]").bounding_box() for one in ("log", "topics")
    )
    assert left["x"] + left["width"] <= right["x"]


def reach(page, label):
    """Press Tab until what has this label has the focus."""
    label_of = "() => { const one = document.activeElement; return one.ariaLabel || one.innerText }"
    for _ in range(80):
        if page.evaluate(label_of) == label:
            return
        page.keyboard.press("Tab")
    pytest.fail(f"'{label}' is not reached")


def press(page, *keys):
    for key in keys:
        page.keyboard.press(key)


def test_a_topic_is_chosen_and_its_message_unfolded_by_the_keyboard(topics):
    topics.evaluate("() => document.activeElement.blur()")
    reach(topics, "Filter topics")
    topics.keyboard.type("pose")
    row(topics, "/chatter").wait_for(state="detached")
    reach(topics, "Listeners")  # the last column
    press(topics, "Tab", "Enter")  # the row behind the heading
    tree = topics.get_by_role("tree", name="Message of /pose")
    tree.get_by_role("treeitem").first.wait_for()
    count = tree.get_by_role("treeitem").count()
    reach(topics, "Close the message")
    press(topics, "Tab", "ArrowLeft")  # folds the header
    topics.wait_for_function(
        "count => document.querySelectorAll('[role=treeitem]').length < count", arg=count
    )
    press(topics, "ArrowDown")
    assert topics.evaluate("() => document.activeElement.dataset.path") == "pose"


def test_panels_are_added_moved_sized_and_closed_by_the_keyboard(topics):
    log = topics.locator("[data-panel=log]")
    height = log.bounding_box()["height"]
    reach(topics, "Divider")
    press(topics, "ArrowUp")
    assert log.bounding_box()["height"] > height
    log.get_by_role("button", name="Arrange").focus()
    press(topics, "Enter", "ArrowDown", "ArrowDown", "Enter")  # Move up
    assert panels(topics) == ["Log", "Topics"]
    assert topics.locator(".spoken").inner_text() == "Log moved up"
    topics.get_by_role("button", name="Add panel").focus()
    press(topics, "Enter", "Escape", "Enter", "End", "Enter")
    assert len(panels(topics)) == 3
    log.get_by_role("button", name="Close").focus()
    press(topics, "Enter")
    assert "Log" not in panels(topics)


def test_light_and_dark_are_chosen_and_kept(topics):
    def background():
        return str(topics.evaluate("() => getComputedStyle(document.body).backgroundColor"))

    before = background()
    topics.get_by_role("button", name="Light or dark").click()
    after = background()
    assert after != before
    topics.reload()
    topics.get_by_role("cell", name="/chatter", exact=True).wait_for()
    assert background() == after
    topics.get_by_role("button", name="Light or dark").click()
    assert background() == before


def test_a_narrow_screen_has_the_panels_below_each_other(topics):
    topics.set_viewport_size({"width": 360, "height": 780})
    row(topics, "/pose").click()
    topics.get_by_role("tree", name="Message of /pose").get_by_text("1.5").wait_for()
    boxes = [one.bounding_box() for one in topics.locator(".panel").all()]
    assert [round(box["x"]) for box in boxes] == [8, 8]
    assert boxes[0]["y"] + boxes[0]["height"] <= boxes[1]["y"]
    assert topics.evaluate("() => document.documentElement.scrollWidth") <= 360


def test_a_panel_is_shown_when_its_styles_are_there(serve, page):
    held = []

    def hold(route):
        held.append(route)

    page.route("**/steer.css", hold)
    with page.expect_request("**/steer.css"):
        page.goto(serve("steer", "/v")[1])
    page.wait_for_function("() => document.querySelector('.panel-body')")
    assert page.locator(".pad").count() == 0  # it would move under the pointer
    held[0].continue_()
    page.locator(".pad").wait_for()
