"""Words for what a recording has so far."""

from collections.abc import Mapping

from lcmtools.bag.recorder import Progress
from lcmtools.bag.series import LogSeries
from lcmtools.observe.reading.losses import Loss
from lcmtools.observe.reports.describe import size_text
from lcmtools.text_table import plural

_MOST_NAMED = 20  # senders with losses


def summary(progress: Progress, series: LogSeries) -> str:
    """Return a sentence with what was recorded and what is known to be lost."""
    paths = series.paths
    where = (
        f"{paths[0]} to {paths[-1].name}" if len(paths) > 1 else paths[0] if paths else "no file"
    )
    among = ", the last ones" if series.count > len(paths) else ""
    what = f"{plural(progress.messages, 'message')} ({size_text(progress.bytes)}){among} in {where}"
    if not progress.losses_are_known:
        return f"{what}; losses are not known on this bus"
    return f"{what}; {losses_text(progress.losses, progress.overflows)}"


def losses_text(losses: Mapping[str, Loss], overflows: int = 0) -> str:
    """Return the losses of all senders as text, and the datagrams that full buffers dropped."""
    by_size = sorted(losses.items(), key=lambda item: -item[1].lost)
    named = [f"{loss} of {name}" for name, loss in by_size[:_MOST_NAMED]]
    if others := by_size[_MOST_NAMED:]:
        named.append(f"{sum(loss.lost for _, loss in others)} of {len(others)} others")
    text = f"lost {', '.join(named)}" if named else "no losses"
    if not overflows:
        return text
    seen = "" if named else " by the senders' numbers"
    return f"{text}{seen}; up to {plural(overflows, 'datagram')} came while its buffers were full"
