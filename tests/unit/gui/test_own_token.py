"""The token of a user's own windows, and the file with its secret."""

import re

import pytest

from lcmtools.gui.browser import own_token


def _token(home, right="command"):
    return own_token(right, {"HOME": str(home)})


def _file(home):
    return home / ".local/state/lcmtools/window_secret"


def test_it_is_kept_where_only_the_user_reads_it(tmp_path):
    token = _token(tmp_path)
    assert re.fullmatch(r"[\w-]{22}", token)
    assert _token(tmp_path) == token
    assert _file(tmp_path).stat().st_mode & 0o777 == 0o600
    assert token not in _file(tmp_path).read_text()


def test_who_may_watch_cannot_command_other_windows(tmp_path):
    assert _token(tmp_path, "watch") != _token(tmp_path)


@pytest.mark.parametrize("content", ["", "short\n", "\udcff"])
def test_a_damaged_file_is_replaced(tmp_path, content):
    before = _token(tmp_path)
    _file(tmp_path).write_text(content, errors="surrogateescape")
    after = _token(tmp_path)
    assert after != before
    assert _token(tmp_path) == after


def test_a_file_that_others_can_read_is_replaced(tmp_path):
    before = _token(tmp_path)
    _file(tmp_path).chmod(0o644)
    assert _token(tmp_path) != before
    assert _file(tmp_path).stat().st_mode & 0o777 == 0o600


def test_without_a_file_it_is_another_one_each_time(tmp_path):
    (tmp_path / ".local").write_text("in the way")
    assert _token(tmp_path) != _token(tmp_path)
    assert own_token("watch", {}) != own_token("watch", {})
