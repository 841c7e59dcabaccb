"""The files of a recording."""

import os
from datetime import datetime

import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools.bag.recorder import Progress
from lcmtools.bag.recording_words import losses_text, summary
from lcmtools.bag.series import LogSeries
from lcmtools.bag.surgery import write_log
from lcmtools.errors import LcmtoolsError
from lcmtools.observe.reading.log_file import LogFile, index_path
from lcmtools.observe.reading.losses import Loss
from lcmtools.wire.log_compression import compression_of
from lcmtools.wire.packet import Packet


def _names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_files_of_a_split_recording_are_numbered_and_the_oldest_go(tmp_path):
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
    unknown = summary(Progress(40, 3000, 4, {}, losses_are_known=False), series)
    assert unknown.endswith("; losses are not known on this bus")


def test_a_name_has_the_date_and_a_folder_takes_the_usual_name(tmp_path):
    LogSeries(str(tmp_path / "%Y-x.lcmlog")).next().close()
    year = datetime.now().astimezone().year
    assert _names(tmp_path) == [f"{year}-x.lcmlog", f"{year}-x.lcmlog.index"]
    with LogSeries(str(tmp_path)).next() as writer:
        assert writer.path.parent == tmp_path
        assert writer.path.name.startswith(f"{year}-")


def test_a_name_that_is_no_utf_8_is_a_name(tmp_path):
    name = os.fsdecode(b"\xe4%Y\xe5.lcmlog")
    LogSeries(str(tmp_path / name)).next().close()
    year = str(datetime.now().astimezone().year)
    assert (tmp_path / name.replace("%Y", year)).exists()


def test_snapshots_within_a_second_have_names_of_their_own(tmp_path):
    series = LogSeries(str(tmp_path / "a.lcmlog"))
    series.next().close()
    series.next().close()
    assert [path.name for path in series.paths] == ["a.lcmlog", "a_1.lcmlog"]


def test_a_file_that_exists_is_refused(tmp_path):
    (tmp_path / "ride_0.lcmlog").touch()
    with raises_saying(LcmtoolsError, "ride_0.lcmlog exists; "):
        LogSeries(str(tmp_path / "ride.lcmlog"), numbered=True).next()


@pytest.mark.parametrize(
    ("losses", "overflows", "parts"),
    [
        ({}, 0, ["no losses"]),
        ({}, 7, ["no losses by the senders' numbers", "up to 7 datagrams"]),
        ({"a": Loss(2, 10)}, 7, ["lost 2 of 10 (20.0 %) of a;", "up to 7 datagrams"]),
        ({str(n): Loss(n, 100) for n in range(1, 31)}, 0, ["lost 30 of 100", "55 of 10 others"]),
    ],
)
def test_losses_are_told_with_what_full_buffers_dropped(losses, overflows, parts):
    assert_says(losses_text(losses, overflows), *parts)


@pytest.mark.parametrize(("suffix", "kind"), [(".zst", "zstd"), (".lz4", "lz4"), ("", None)])
def test_a_name_that_ends_so_is_compressed(tmp_path, suffix, kind):
    recorded, sorted_ = tmp_path / f"a.lcmlog{suffix}", tmp_path / f"b.lcmlog{suffix}"
    with LogSeries(str(recorded)).next() as writer:
        writer.add(Packet("A", bytes(100), 1), -1)
    with LogFile(recorded) as log:
        write_log(sorted_, log.packets(), [log])
    assert [compression_of(path.read_bytes()) for path in (recorded, sorted_)] == [kind, kind]
    with LogFile(sorted_) as log:
        assert [packet.payload for packet in log.packets()] == [bytes(100)]
