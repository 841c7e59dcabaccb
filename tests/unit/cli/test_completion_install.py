"""Where a shell's script goes, and that the second time nothing changes."""

from pathlib import Path

import pytest

from lcmtools.cli.completion.install import install, plan, script, shell_named, uninstall
from lcmtools.errors import LcmtoolsError, UsageError


@pytest.fixture
def home(tmp_path):
    return tmp_path / "home of me"


@pytest.mark.parametrize(
    ("shell", "target", "settings"),
    [
        ("bash", ".local/share/bash-completion/completions/lcmtools", ".bashrc"),
        ("zsh", ".local/share/zsh/site-functions/_lcmtools", ".zshrc"),
        ("fish", ".config/fish/completions/lcmtools.fish", None),
    ],
)
def test_the_script_goes_where_the_shell_looks(shell, target, settings, home, tmp_path):
    wanted = plan(shell, {"HOME": str(home)}, root=tmp_path)
    assert wanted.script == home / target
    assert wanted.settings == (home / settings if settings else None)
    told = list(install(shell, wanted))
    assert told[0] == f"wrote {wanted.script}"
    assert wanted.script.read_text() == script(shell)


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_second_installation_changes_nothing(shell, home, tmp_path):
    home.mkdir()
    (home / ".bashrc").write_text("alias a=b")  # no newline at its end
    wanted = plan(shell, {"HOME": str(home)}, root=tmp_path)
    list(install(shell, wanted))
    before = {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in _files(home)}
    told = list(install(shell, wanted))
    assert all("already" in line for line in told)
    assert before == {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in _files(home)}


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_uninstall_leaves_what_was_there_before(shell, home, tmp_path):
    home.mkdir()
    for name in (".bashrc", ".zshrc"):
        (home / name).write_text("alias a=b\n")
    wanted = plan(shell, {"HOME": str(home)}, root=tmp_path)
    list(install(shell, wanted))
    list(uninstall(wanted))
    assert [path.name for path in _files(home)] == [".bashrc", ".zshrc"]
    assert {path.read_text() for path in _files(home)} == {"alias a=b\n"}
    assert list(uninstall(wanted)) == [f"{wanted.script} is not there"]


def test_no_line_is_needed_where_bash_completion_is_loaded(home, tmp_path):
    (tmp_path / "usr/share/bash-completion").mkdir(parents=True)
    (tmp_path / "usr/share/bash-completion/bash_completion").touch()
    home.mkdir()
    (home / ".bashrc").write_text("# . /usr/share/bash-completion/bash_completion\n")
    assert plan("bash", {"HOME": str(home)}, root=tmp_path).settings is not None
    (home / ".bashrc").write_text(". /usr/share/bash-completion/bash_completion\n")
    assert plan("bash", {"HOME": str(home)}, root=tmp_path).settings is None


def test_settings_that_are_a_link_stay_one(home, tmp_path):
    home.mkdir()
    (tmp_path / "dotfiles").write_text("alias a=b\n")
    (home / ".bashrc").symlink_to(tmp_path / "dotfiles")
    list(install("bash", plan("bash", {"HOME": str(home)}, root=tmp_path)))
    assert (home / ".bashrc").is_symlink()
    assert (tmp_path / "dotfiles").read_text().startswith("alias a=b\n[ -r '")


def test_the_xdg_folders_and_zdotdir_are_heeded(tmp_path):
    said = {
        "HOME": "/home/me",
        "XDG_DATA_HOME": "/data",
        "XDG_CONFIG_HOME": "/config",
        "ZDOTDIR": "/zsh",
    }
    assert str(plan("bash", said, root=tmp_path).script).startswith("/data/bash-completion/")
    assert str(plan("fish", said, root=tmp_path).script).startswith("/config/fish/")
    assert plan("zsh", said, root=tmp_path).settings == Path("/zsh/.zshrc")


def test_the_shell_is_the_one_named_else_the_users_own():
    assert shell_named("zsh", {"SHELL": "/bin/bash"}) == "zsh"
    assert shell_named(None, {"SHELL": "/usr/bin/fish"}) == "fish"
    with pytest.raises(UsageError, match="no completion for tcsh"):
        shell_named(None, {"SHELL": "/bin/tcsh"})
    with pytest.raises(UsageError, match="SHELL does not name a shell"):
        shell_named(None, {})


def test_a_home_that_is_not_there_or_a_file_in_the_way_is_said(home, tmp_path):
    with pytest.raises(LcmtoolsError, match="HOME is not set"):
        plan("bash", {})
    home.write_text("a file")
    with pytest.raises(LcmtoolsError, match="cannot write"):
        list(install("fish", plan("fish", {"HOME": str(home)}, root=tmp_path)))


def _files(folder):
    return sorted(path for path in folder.rglob("*") if path.is_file())
