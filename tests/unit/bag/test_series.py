"""The files of a recording."""

import os
from datetime import datetime
from pathlib import Path

from fixtures.says import assert_says, raises_saying

from lcmtools.bag.recorder import Progress
from lcmtools.bag.series import LogSeries
from lcmtools.cli.bag.recording import summary
from lcmtools.errors import LcmtoolsError
from lcmtools.observe.reading.log_file import index_path


def _names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_files_of_a_split_recording_are_numbered_and_the_oldest_go(tmp_path: Path) -> None:
    series = LogSeries(str(tmp_path / "ride.lcmlog"), numbered=True, most=2)
    for _ in range(4):
        series.next().close()
    wanted = [tmp_path / "ride_2.lcmlog", tmp_path / "ride_3.lcmlog"]
    assert list(series.paths) == wanted
    assert _names(tmp_path) == sorted(
        [p.name for p in wanted] + [index_path(p).name for p in wanted]
    )
    line = summary(Progress(40, 3000, 4, {}), series)
    assert_says(line, "40 messages (3.00 KB)", f"{wanted[0]} to ride_3.lcmlog", "no losses")


def test_a_name_has_the_date_and_a_folder_takes_the_usual_name(tmp_path: Path) -> None:
    LogSeries(str(tmp_path / "%Y-x.lcmlog")).next().close()
    year = datetime.now().astimezone().year
    assert _names(tmp_path) == [f"{year}-x.lcmlog", f"{year}-x.lcmlog.index"]
    with LogSeries(str(tmp_path)).next() as writer:
        assert writer.path.parent == tmp_path
        assert writer.path.name.startswith(f"{year}-")


def test_a_name_that_is_no_utf_8_is_a_name(tmp_path: Path) -> None:
    name = os.fsdecode(b"\xe4%Y\xe5.lcmlog")
    LogSeries(str(tmp_path / name)).next().close()
    year = str(datetime.now().astimezone().year)
    assert (tmp_path / name.replace("%Y", year)).exists()


def test_snapshots_within_a_second_have_names_of_their_own(tmp_path: Path) -> None:
    series = LogSeries(str(tmp_path / "a.lcmlog"))
    series.next().close()
    series.next().close()
    assert [path.name for path in series.paths] == ["a.lcmlog", "a_1.lcmlog"]


def test_a_file_that_exists_is_refused(tmp_path: Path) -> None:
    (tmp_path / "ride_0.lcmlog").touch()
    with raises_saying(LcmtoolsError, "ride_0.lcmlog exists; "):
        LogSeries(str(tmp_path / "ride.lcmlog"), numbered=True).next()
