"""The graph in a browser: the lab's nodes, a planted fault at its node, and walking by keys."""

import pytest

from tests.gui.conftest import press_rare

CONTROLLER = 'g[data-key="node:/simple_controller"]'


@pytest.fixture(scope="module", autouse=True)
def _lab(module_start, lcmtools_path):
    """The Husky, and a controller that lacks its namespace."""
    module_start(lcmtools_path, "run", "sim", "husky").wait_for("simulating")
    module_start(lcmtools_path, "run", "simple_controller")


@pytest.fixture
def graph(page, serve):
    """The panel with the graph in it."""
    _, address = serve("graph")
    page.goto(address)
    page.wait_for_selector(CONTROLLER)
    return page


def test_a_fault_is_marked_at_its_node_and_shows_its_remedy(graph):
    graph.wait_for_selector('g[data-key="node:/morse"]')
    graph.wait_for_selector("text=/^[1-9][0-9.]* Hz$/ >> nth=0")
    graph.wait_for_selector(f"{CONTROLLER} .sign.is-warning")
    graph.click(".graph-findings >> text=subscriptions are unconnected")
    assert "__ns:=/husky0" in graph.inner_text(".graph-about .remedy >> nth=0")
    assert graph.get_attribute(CONTROLLER, "class").split() == ["vertex", "is-node"]
    assert "is-dimmed" in graph.get_attribute('g[data-key="topic:/husky0/imu"]', "class")
    graph.keyboard.press("Escape")
    graph.wait_for_selector(".graph-about", state="hidden")


def test_keys_walk_along_the_edges(graph):
    graph.focus('g[data-key="topic:/desired_velocity"]')
    graph.keyboard.press("ArrowRight")
    focused = "document.activeElement.dataset.key"
    assert graph.evaluate(focused) == "node:/simple_controller"
    graph.keyboard.press("Enter")
    assert "publishes /controlled_velocity" in graph.inner_text(".graph-about")
    graph.keyboard.press("ArrowRight")
    assert graph.evaluate(focused) == "topic:/controlled_velocity"


def test_the_graph_is_text_for_screen_readers(graph):
    text = graph.locator(".graph-outline").text_content()
    assert "/simple_controller" in text
    assert "subscribes to /desired_velocity" in text
    press_rare(graph, "Text")
    assert graph.is_visible(".graph-outline")
    assert graph.is_hidden(".graph-drawing")


def test_choices_change_what_is_drawn(graph):
    press_rare(graph, "Groups")
    graph.wait_for_selector('.band-name:text-is("/husky0")')
    press_rare(graph, "Topics")
    graph.wait_for_selector('g[data-key="topic:/desired_velocity"]', state="detached")


def test_the_drawing_is_saved_with_its_colours(graph, tmp_path):
    with graph.expect_download() as download:
        press_rare(graph, "Save as SVG")
    path = tmp_path / "graph.svg"
    download.value.save_as(path)
    text = path.read_text()
    assert "/simple_controller" in text
    assert 'fill="rgb(' in text
