"""plot: fields over time, of a bus and of a log."""

import pytest
from fixtures.build import write_log
from fixtures.says import assert_line


@pytest.fixture
def log(tmp_path):
    """The path of a log with a Twist on /cmd each second."""
    drive = ((n, "/cmd", "geometry_msgs/Twist", {"linear": {"x": n / 4}}) for n in range(20))
    return write_log(tmp_path / "a.log", *drive)


def test_a_log_is_drawn_as_text(log, cli):
    result = cli("bag", "plot", log, "/cmd/linear.x")
    assert (result.code, result.err) == (0, "")
    assert "/cmd/linear.x" in result.out
    assert "4.75" in result.out  # its greatest value, and its last time
    assert "19.0" in result.out


def test_a_log_is_drawn_as_a_picture(log, tmp_path, cli):
    picture = tmp_path / "a.svg"
    result = cli("bag", "plot", log, "/cmd/linear", "-o", str(picture))
    assert (result.code, result.out) == (0, "")
    assert result.err == f"{picture}: /cmd/linear.x, /cmd/linear.y, /cmd/linear.z\n"
    assert "<svg" in picture.read_text()


@pytest.mark.parametrize(
    ("field", "said", "code"),
    [
        ("/cmd/linear.q", "no field 'q' (fields: x, y, z)", 2),
        ("/cmt/linear.x", "there is nothing on /cmt/linear.x in the log; it has /cmd", 1),
    ],
)
def test_what_is_not_in_the_log_is_named(field, said, code, log, cli):
    result = cli("bag", "plot", log, field)
    assert said in result.err
    assert result.code == code


@pytest.fixture
def _driven(bus_url, start, lcmtools_path, monkeypatch):
    """A Twist on /cmd at 50 Hz."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    start(lcmtools_path, "pub", "-r", "50", "/cmd", "geometry_msgs/Twist", "{linear: {x: 2}}")


@pytest.mark.usefixtures("_driven")
def test_a_picture_of_a_bus_is_of_the_time_given(tmp_path, cli):
    picture = tmp_path / "a.png"
    result = cli("plot", "/cmd/linear.x", "--duration", "0.5s", "-o", str(picture))
    assert (result.code, result.out) == (0, ""), result.err
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.usefixtures("_driven")
def test_curves_are_drawn_on_a_terminal_again_and_again(on_terminal):
    text = on_terminal("plot", "/cmd/linear.x", "--duration", "5s")
    assert text.count("/cmd/linear.x") > 1
    assert text.count("\x1b[2J") > 1
    assert "time [s]" in text


def test_what_is_no_terminal_needs_a_file(cli):
    result = cli("plot", "/cmd/linear.x")
    assert_line(result.err, "lcmtools plot: ", "terminal", "-o FILE.png\n")
    assert result.code == 2
