"""The lines of the log panel: their order, earlier ones, long ones, and those of any language."""

import signal
import socket

import pytest

from lcmtools import Node


@pytest.fixture
def run(serve, page):
    """``run("...")``: the rows after ``receive("a b")``, a second a line, and calls of ``log``."""
    page.goto(serve("topics")[1])

    def evaluate(body):
        found = page.evaluate(
            """async () => {
              const { default: Log } = await import("/panels/log.js");
              const log = new Log({ open: () => {}, changed: () => {} }, {});
              let time = 100;
              const receive = (texts, isFirst = false, start = time) => {
                const line = (text, index) => [start + index, 2, "/n", text, ""];
                const lines = texts.split(" ").map(line);
                time = start + lines.length;
                log.receive({ lines, leftOut: 0, isFirst });
              };
              const text = ({ cells }) =>
                cells[3].innerText + cells[4].innerText.replace("\\u00d7 ", "*");
              const rows = () => [...log.body.rows].map(text);
            """
            f"{body}; return rows(); }}"
        )
        return [str(one) for one in found]

    return evaluate


CASES = [
    ("receive('a b c')", ["a", "b", "c"]),
    ("receive('a b a')", ["b", "a*2"]),
    ("receive('a b'); receive('a c'); receive('b')", ["a*2", "c", "b*2"]),
    ("receive('a b c'); log.setPaused(true); receive('a')", ["a", "b", "c"]),
    (
        "receive('a b c'); log.setPaused(true); receive('a d'); log.setPaused(false)",
        ["b", "c", "a*2", "d"],
    ),
    ("receive('a b'); receive('b c', true, 101)", ["a", "b", "c"]),  # the connection was lost
    ("receive('a b'); receive('c', true, 900)", ["a", "b", "c"]),  # another server
    ("receive('a b'); receive('c', false, 5)", ["c"]),  # a played log goes back
    ("receive('a b a c'); log.search.value = 'a'; log.changed()", ["a*2"]),
    ("receive('a b'); log.changed(); receive('a')", ["b", "a*2"]),
    ("receive('a c'); receive('b', false, 100.5)", ["a", "b", "c"]),  # it took longer to come
]


def test_lines_are_in_the_order_of_their_latest_times(run):
    for body, rows in CASES:
        assert run(body) == rows, body


def test_lines_of_before_are_there_whatever_their_length_and_language_and_stay(
    module_start_node, module_start, lcmtools_path, page
):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    command = (lcmtools_path, "gui", "log", "--no-open", "--port", port)
    server = module_start(*command)
    address = server.wait_for("http://").split()[-1]
    node = module_start_node(lambda: Node("speaker")).node
    texts = ["first", "Grüße, 日本語 🤖 שלום", "long " + "y" * 100_000, "<b>last</b>"]
    page.goto(address)
    page.locator(".log").wait_for()
    for text in texts:
        node.get_logger().info(text)
    page.get_by_text("<b>last</b>", exact=True).wait_for()
    late = page.context.new_page()
    late.goto(address)
    late.get_by_text("<b>last</b>", exact=True).wait_for()
    for one in (page, late):
        assert one.locator("td.text").all_inner_texts() == texts
    late.close()
    server.send_signal(signal.SIGINT)
    server.wait()
    page.get_by_text("The connection to lcmtools gui is lost").wait_for()
    module_start(*command).wait_for("http://")
    page.get_by_text("connected", exact=True).wait_for()
    node.get_logger().info("after")
    page.get_by_text("after", exact=True).wait_for()
    assert page.locator("td.text").all_inner_texts() == [*texts, "after"]
