"""The room of the panels on a small screen, 1280 by 800, three panels beside each other."""

import json
from urllib.parse import quote

import pytest

from tests.gui.conftest import forget_layouts, open_more

PANELS = ("topics", "plot", "world", "graph", "image", "steer", "frames", "log")
ROOM = """(panel) => {
  const body = document.querySelector(`[data-panel=${panel}] .panel-body`);
  const tools = [...body.querySelectorAll(".tools")];
  const used = tools.reduce((sum, one) => sum + one.offsetHeight, 0);
  const [left, right] = [body.getBoundingClientRect().left, body.getBoundingClientRect().right];
  const cut = [...body.querySelectorAll("th, .tools > *")].filter((one) => {
    const box = one.getBoundingClientRect();
    return box.width > 0 && (box.right > right + 1 || box.left < left - 1);
  });
  return [used, body.offsetHeight, cut.map((one) => one.innerText)];
}"""


@pytest.fixture(scope="module")
def address(module_start, lcmtools_path):
    module_start(lcmtools_path, "run", "sim", "husky").wait_for("simulating")
    server = module_start(lcmtools_path, "gui", "--port", "0", "--no-open")
    return server.wait_for("http://").split()[-1]


def shown(page, address, tree):
    page.set_viewport_size({"width": 1280, "height": 800})
    forget_layouts(page, address)
    page.goto(f"{address}#{quote(json.dumps(tree))}")


@pytest.mark.parametrize("panel", PANELS)
def test_the_tools_of_a_panel_are_one_row_and_no_column_is_cut(page, address, panel):
    parts = [{"panel": "record"}, {"panel": panel}, {"panel": "record"}]
    shown(page, address, {"split": "row", "parts": parts, "sizes": [1, 1, 1]})
    page.locator(f"[data-panel={panel}] .panel-body > *").first.wait_for()
    if panel in ("topics", "frames"):
        page.locator(f"[data-panel={panel}] tbody tr").nth(3).wait_for()
    used, whole, cut = page.evaluate(ROOM, panel)
    assert 0 < used + (panel == "frames") <= 40
    assert used < 0.2 * whole
    assert cut == []


def test_rarely_used_tools_are_in_a_menu_that_escape_closes(page, address):
    shown(page, address, {"panel": "plot"})
    tool = page.get_by_role("button", name="Save as CSV")
    open_more(page)
    tool.wait_for()
    page.keyboard.press("Escape")
    tool.wait_for(state="hidden")
    page.get_by_role("button", name="More …", expanded=False).wait_for()  # told a moment later


def test_a_plot_opens_below_the_widest_panel(page, address):
    parts = [{"panel": "topics", "settings": {"topic": "/husky0/odometry"}}, {"panel": "log"}]
    shown(page, address, {"split": "row", "parts": parts, "sizes": [3, 2]})
    number = page.locator(".tree-row", has=page.locator(".icon-button")).first
    number.hover()
    number.locator(".icon-button").click()
    plot, topics = (page.locator(f"[data-panel={one}]") for one in ("plot", "topics"))
    plot.wait_for()
    assert plot.bounding_box()["width"] == topics.bounding_box()["width"]
    assert plot.bounding_box()["y"] > topics.bounding_box()["y"]


def test_the_only_node_with_parameters_is_chosen(page, address):
    shown(page, address, {"panel": "parameters"})
    page.get_by_label("use_sim_time").wait_for()
    assert page.get_by_label("Node").input_value() == "/morse"
