"""The interactive side of ``bag record``: keys, services, progress line, closing summary."""

import shutil
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from lcmtools.bag.recorder import BagRecorder, Progress
from lcmtools.bag.recording_words import summary
from lcmtools.bag.series import LogSeries
from lcmtools.cli.bus import notify
from lcmtools.cli.output import results_beside, write_document
from lcmtools.cli.status_line import StatusLine
from lcmtools.errors import LcmtoolsError
from lcmtools.node.node import Node
from lcmtools.node.spinning import spin_once
from lcmtools.observe.reports.describe import size_text
from lcmtools.terminal import Terminal, TerminalKeys, is_terminal
from lcmtools.text_table import plural

_TURN = 0.1  # [s] between looks at keys and requests
_PAUSE, _SAVE, _END = " ", "s", "q"


def run_recording(recorder: BagRecorder, series: LogSeries, node: Node | None) -> None:
    """Show the progress of a recording, and handle keys and requests, until it ends."""
    with ExitStack() as stack:
        line = stack.enter_context(StatusLine("lcmtools bag record"))
        trouble = recorder.progress().trouble
        keys = None
        if line.shows and is_terminal(sys.stdin):
            keys = TerminalKeys(stack.enter_context(Terminal(keys=True)))
        while not recorder.wait(0.0 if keys or node else _TURN):
            if node is not None:
                spin_once(node, 0.0 if keys else _TURN)
            for key in keys.read(_TURN) if keys else ():
                if key == _END:
                    return
                _press(key, recorder)
            _write_notes(line, recorder.silence())
            progress = recorder.progress()
            if progress.trouble != trouble:
                trouble = progress.trouble
                line.write_note(trouble or "the bus is back")
            if rates := line.rates(progress.messages, progress.bytes):
                line.write(_status(progress, rates, series))
        _write_notes(line, recorder.silence())


def _write_notes(line: StatusLine, sentences: Sequence[str]) -> None:
    for sentence in sentences:
        line.write_note(sentence)


@contextmanager
def recording(recorder: BagRecorder, series: LogSeries, *, as_json: bool) -> Iterator[None]:
    """Record, and report what was recorded in one line at the end, even after an error."""
    try:
        with recorder:
            yield
    except LcmtoolsError as error:
        if recorder.has_ended and not error.hint and series.paths and series.paths[-1].is_file():
            kept = size_text(series.paths[-1].stat().st_size)
            hint = f"{series.paths[-1]} has {kept} of complete messages"
            raise LcmtoolsError(error.what, hint) from error
        raise
    finally:
        if recorder.has_ended and as_json:
            with results_beside(series.paths[-1] if series.paths else None):
                write_document(_to_json(recorder.progress(), series))
        elif recorder.has_ended and not isinstance(sys.exc_info()[1], LcmtoolsError):
            notify(summary(recorder.progress(), series))


def _to_json(progress: Progress, series: LogSeries) -> dict[str, object]:
    return {
        "files": [*map(str, series.paths)],
        "messages": progress.messages,
        "bytes": progress.bytes,
        "losses": [
            {"sender": name, "lost": loss.lost, "of": loss.sent}
            for name, loss in progress.losses.items()
        ],
        "buffer_overflows": progress.overflows,
    }


def _status(progress: Progress, rates: Sequence[float], series: LogSeries) -> str:
    parts = [
        f"{plural(progress.messages, 'message')}, {rates[0]:.0f}/s",
        f"{size_text(progress.bytes)}, {size_text(rates[1])}/s",
    ]
    if not progress.is_writing:
        kept = f"{plural(progress.kept_messages, 'message')}, {size_text(progress.kept_bytes)}"
        parts = [f"keeping {kept} (s saves)", *([parts[0]] if progress.messages else [])]
    if progress.is_paused:
        parts.insert(0, "paused (space resumes)")
    folder = series.paths[-1].parent if series.paths else Path()
    with suppress(OSError):
        parts.append(f"{size_text(shutil.disk_usage(folder).free)} free")
    lost = sum(loss.lost for loss in progress.losses.values())
    if progress.losses_are_known:
        parts.append(f"{lost} lost" if lost else "none lost")
    return "; ".join(parts)


def _press(key: str, recorder: BagRecorder) -> None:
    if key == _PAUSE:
        recorder.is_paused = not recorder.is_paused
    elif key == _SAVE and recorder.is_of_snapshots:
        recorder.save()
