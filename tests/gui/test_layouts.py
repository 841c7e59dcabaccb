"""Layouts: with a name, in a shared address, and undone."""

import json
from urllib.parse import quote

import pytest

from tests.gui.conftest import forget_layouts

OWN = {"split": "row", "parts": [{"panel": "topics"}, {"panel": "log"}], "sizes": [1, 1]}


def with_layout(address, layout):
    return f"{address}#{quote(json.dumps(layout, separators=(',', ':')))}"


@pytest.fixture(scope="module")
def address(module_start, lcmtools_path):
    """The address of a window that the tests share."""
    server = module_start(lcmtools_path, "gui", "--port", "0", "--no-open")
    return server.wait_for("http://").split()[-1]


@pytest.fixture
def own(page, address):
    """A page with the person's own layout, topics beside the log, and no others stored."""
    forget_layouts(page, address)
    page.goto(with_layout(address, OWN))
    shows(page, "Topics", "Log")
    page.wait_for_function("() => localStorage.length > 0")
    return page


def shows(page, *titles):
    """Wait until these panels are shown, in this order."""
    page.wait_for_function(
        """titles => {
          const found = [...document.querySelectorAll('.panel h2')].map((one) => one.textContent);
          return JSON.stringify(found) === JSON.stringify(titles);
        }""",
        arg=list(titles),
    )


def kept(page):
    """Wait until the page has kept its layout, so that what follows is another change."""
    page.wait_for_function(
        """() => {
          const { dataset } = document.body;
          const before = dataset.hash;
          dataset.hash = location.hash;
          return location.hash !== before;
        }"""
    )


def press(page, item):
    page.get_by_role("button", name="Layouts").click()
    page.get_by_role("menuitem", name=item, exact=True).click()


def save_as(page, name):
    press(page, "Save as …")
    page.get_by_label("Name of the layout").fill(name)
    page.keyboard.press("Enter")


def close(page, panel):
    page.locator(f"[data-panel={panel}]").get_by_role("button", name="Close", exact=True).click()


def test_a_layout_is_saved_with_a_name_shown_again_and_deleted(own):
    own.get_by_label("Filter topics").fill("chat")
    save_as(own, "driving <b>")
    close(own, "topics")
    shows(own, "Log")
    save_as(own, "log")
    own.reload()
    shows(own, "Log")
    press(own, "driving <b>")
    shows(own, "Topics", "Log")
    assert own.get_by_label("Filter topics").input_value() == "chat"
    press(own, "Delete …")
    own.get_by_role("menuitem", name="Delete driving <b>").click()
    own.get_by_role("button", name="Layouts").click()
    items = own.get_by_role("menuitem").all_inner_texts()
    assert items == ["log", "Save as …", "Delete …", "Reset layout"]


def test_another_layout_is_replaced_only_after_a_question(own):
    save_as(own, "mine")
    close(own, "log")
    for answer, panels in (("Cancel", ["Topics", "Log"]), ("Replace", ["Topics"])):
        save_as(own, "mine")
        own.get_by_text("Replace the layout mine?").wait_for()
        own.get_by_role("button", name=answer).click()
        press(own, "mine")
        shows(own, *panels)
        if answer == "Cancel":
            own.keyboard.press("Control+z")
            shows(own, "Topics")


@pytest.mark.parametrize(
    ("answer", "now", "later"),
    [
        ("Use this one", ["Graph"], ["Graph"]),
        ("Back to mine", ["Topics", "Log"], ["Topics", "Log"]),
        ("", ["Graph"], ["Topics", "Log"]),
    ],
)
def test_a_shared_address_replaces_the_own_layout_only_if_the_person_says_so(
    own, address, answer, now, later
):
    own.goto("about:blank")
    own.goto(with_layout(address, {"panel": "graph"}))
    own.get_by_text("This layout is from the address. Yours is kept.").wait_for()
    shows(own, "Graph")
    if answer:
        own.get_by_role("button", name=answer).click()
        own.get_by_text("This layout is from the address").wait_for(state="hidden")
    shows(own, *now)
    own.goto("about:blank")
    own.goto(address)
    shows(own, *later)
    assert own.get_by_text("This layout is from the address").is_hidden()


def test_the_own_layout_in_the_address_asks_nothing(own):
    own.wait_for_function("() => location.hash.includes('topics')")
    own.reload()
    shows(own, "Topics", "Log")
    assert own.get_by_text("This layout is from the address").is_hidden()


def test_a_reload_before_the_browser_has_the_new_address_shows_the_own_layout(own):
    own.evaluate(
        """() => {
          history.replaceState(null, "", location.hash);
          history.replaceState = () => {};
        }"""
    )
    close(own, "topics")
    shows(own, "Log")
    own.reload()
    shows(own, "Log")
    assert own.get_by_text("This layout is from the address").is_hidden()


def test_a_layout_that_is_put_into_the_address_bar_asks_too(own):
    own.evaluate("hash => { location.hash = hash; }", quote('{"panel":"graph"}'))
    own.get_by_text("This layout is from the address. Yours is kept.").wait_for()
    shows(own, "Graph")


def test_changes_are_undone_one_after_the_other_and_other_panels_stay(own):
    own.evaluate("() => { document.body.dataset.hash = location.hash; }")
    own.get_by_label("Filter topics").fill("chat")
    own.locator("[data-panel=log]").evaluate("one => { one.dataset.mark = 'stays'; }")
    kept(own)
    divider = own.get_by_role("separator")
    width = own.locator("[data-panel=log]").bounding_box()["width"]
    divider.focus()
    own.keyboard.press("ArrowLeft")
    assert own.locator("[data-panel=log]").bounding_box()["width"] > width
    kept(own)
    close(own, "topics")
    shows(own, "Log")
    kept(own)
    own.get_by_role("button", name="Add panel").click()
    own.get_by_role("menuitem", name="Frames").click()
    shows(own, "Log", "Frames")
    own.keyboard.press("Control+z")
    shows(own, "Log")
    own.get_by_role("button", name="Undo the last change").click()
    shows(own, "Topics", "Log")
    assert own.get_by_label("Filter topics").input_value() == "chat"
    own.keyboard.press("Control+z")
    assert own.locator("[data-panel=log]").bounding_box()["width"] == pytest.approx(width, abs=1)
    assert own.locator("[data-panel=log]").get_attribute("data-mark") == "stays"
    own.keyboard.press("Control+z")
    assert own.locator(".spoken").inner_text() == "there is no change to undo"


def test_a_reset_layout_is_undone_and_typing_undoes_nothing(own):
    press(own, "Reset layout")
    shows(own, "Topics", "Log", "World")
    field = own.get_by_label("Filter topics")
    field.fill("x")
    field.press("Control+z")
    shows(own, "Topics", "Log", "World")
    own.get_by_role("button", name="Undo the last change").click()
    shows(own, "Topics", "Log")
