"""The check of a class: several submissions at a time, each program in its own process.

Each process runs ``lcmtools lab check`` in a folder with a copy of the submission, and its report
is read here. However the check ends, these processes are terminated and can clean up.
"""

import json
import os
import select
import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from lcmtools.labs.catalogue import Lab
from lcmtools.labs.checks.check_report import read_json
from lcmtools.labs.checks.checked_programs import own_command
from lcmtools.labs.checks.choice import choose
from lcmtools.labs.checks.log_check import can_play
from lcmtools.labs.checks.results import CheckResult, Report
from lcmtools.labs.checks.submissions import copy_submission, programs_of, submissions_in
from lcmtools.processes.child import ChildProcess, Start, StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard

_PAUSE = 0.2  # [s] between two looks at whether the check has been broken off


@dataclass(frozen=True, slots=True)
class _Job:
    """A program of a submission."""

    submission: Path
    option: str
    command: str


class ClassCheck:
    """Checks the submissions in a folder, ``jobs`` programs at a time.

    ``commands`` contain {program}, see ``programs_of``; ``arguments`` are passed to ``lab check``.
    The names of submission and program are added to the path ``plot``.
    """

    def __init__(
        self,
        lab: Lab,
        commands: Mapping[str, str],
        arguments: Sequence[str],
        plot: Path | None,
        jobs: int,
    ) -> None:
        self._lab, self._commands, self._arguments = lab, commands, arguments
        self._plot, self.jobs = plot, jobs
        self.is_played = "--bag" in arguments  # a recorded drive is played, nothing simulated
        self._is_over = threading.Event()

    def run(self, folder: Path, show: Callable[[str, Report], object]) -> dict[str, list[Report]]:
        """Check each file or folder; return the reports by the submissions' names.

        ``show`` is called with the name of a submission and each report of its programs.

        Raises:
            UsageError: The folder has no submissions, or a command line is wrong.
        """
        if self._commands:
            choose(self._lab, self._commands)  # what is wrong with them is reported once
        submissions = submissions_in(folder)
        found = {path.name: self._jobs_of(path) for path in submissions}
        reports = {name: dict[str, Report]() for name in found}
        with ProcessGuard() as guard, ThreadPoolExecutor(self.jobs) as pool:
            running = {
                pool.submit(self._check, job, guard): (name, job.option)
                for name, jobs in found.items()
                for job in jobs
            }
            try:
                for future in as_completed(running):
                    name, option = running[future]
                    reports[name][option] = future.result()
                    show(name, reports[name][option])
            finally:
                self._is_over.set()
                pool.shutdown(wait=False, cancel_futures=True)
        names = " or ".join(program.node for program in self._lab.programs)
        none = _failed("", f"it does not contain a program of this lab: {names}")
        return {
            name: [reports[name][job.option] for job in jobs] or [none]
            for name, jobs in found.items()
        }

    def _jobs_of(self, submission: Path) -> list[_Job]:
        with tempfile.TemporaryDirectory(prefix="lcmtools-class-") as own:
            copy_submission(submission, Path(own))
            programs = programs_of(self._lab, Path(own), self._commands)
        known = [one.option for one in self._lab.programs if can_play(one) or not self.is_played]
        return [_Job(submission, *one) for one in programs.items() if one[0] in known]

    def _check(self, job: _Job, guard: ProcessGuard) -> Report:
        words = [*own_command(), "lab", "check", self._lab.name, "--json"]
        words += [f"--{job.option}", job.command, *self._arguments]
        if self._plot:
            name = f"{self._plot.stem}_{job.submission.stem}_{job.option}{self._plot.suffix}"
            words += ["--plot", str(self._plot.absolute().with_name(name))]
        with tempfile.TemporaryDirectory(prefix="lcmtools-class-") as own:
            copy_submission(job.submission, Path(own))
            start = Start(words, dict(os.environ), own)
            with ChildProcess(start, guard, StopTimeouts()) as child:
                output, errors = self._lines(child)
        try:
            return read_json(json.loads("\n".join(output)))[0]
        except ValueError:  # nothing, or a part of it: the check was ended
            return _failed(job.option, _reason(errors))

    def _lines(self, child: ChildProcess) -> tuple[list[str], list[str]]:
        """Return the lines of output and errors, until the process or the whole check ends."""
        output: list[str] = []
        errors: list[str] = []
        while child.streams and not self._is_over.is_set():
            for stream in select.select(child.streams, [], [], _PAUSE)[0]:
                for is_error, line in child.read(stream):
                    (errors if is_error else output).append(line)
        return output, errors


def _reason(errors: Sequence[str]) -> str:
    """Return the error of a check without a report: its last line."""
    last = errors[-1] if errors else "its check was ended"
    try:
        error = json.loads(last)
        return "; ".join(filter(None, (error["error"], error["hint"])))
    except ValueError:  # wrong usage is reported in words
        return last.partition("lcmtools lab check: ")[2] or last


def _failed(program: str, reason: str) -> Report:
    result = CheckResult("can be run", "a program", "none", is_ok=False, hint=reason)
    return Report(program, (), [result])
