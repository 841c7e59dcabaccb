"""The stream of wtf's findings.

A separate process looks every few seconds: it reads all messages for a moment, which delays pages.
"""

import json
import subprocess
import sys
import threading
from collections.abc import Mapping
from typing import Any

from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source
from lcmtools.gui.streams.base import PageStream, Update

_PAUSE = 8.0  # [s] between two looks
_LISTEN = "1s"
_LONGEST = 60.0  # [s] of a look
_KEPT = ("rule", "severity", "text", "items", "remedies", "subjects")


class DoctorFindings(PageStream):
    """The findings of wtf; for a log, only once."""

    period = 0.5
    is_shared = True

    def __init__(self, source: Source) -> None:
        super().__init__(source)
        where = ["--bag", source.name] if source.kind == "log" else ["--lcm-url", source.name]
        self._command = [sys.executable, "-m", "lcmtools", "wtf", "--json", *where]
        if source.kind == "bus":
            self._command += ["--wait", _LISTEN]
        self._latest: Update | None = None
        self._fault = ""
        self._process: subprocess.Popen[bytes] | None = None
        self._ends_soon = threading.Event()
        self._starting = threading.Lock()  # closing meanwhile must find the process to end
        self.until_closed(self._end)
        threading.Thread(target=self._run, name="findings", daemon=True).start()

    def update(self) -> Update | None:
        """Return the findings of the last look."""
        return self._latest

    def problem(self) -> str:
        """Return the reason if wtf could not look, else ""."""
        return self._fault

    def _end(self) -> None:
        self._ends_soon.set()
        with self._starting:
            if self._process is not None:
                self._process.kill()

    def _run(self) -> None:
        while not self._ends_soon.is_set():
            found = self._diagnose()
            if found is not None:
                self._latest, self._fault = Update({"findings": found}), ""
            if self.source.kind == "log" or self._ends_soon.wait(_PAUSE):
                return

    def _diagnose(self) -> list[Json] | None:
        """Return what wtf finds now; None if it was ended or cannot look."""
        silent = subprocess.DEVNULL
        with self._starting:
            if self._ends_soon.is_set():
                return None
            self._process = subprocess.Popen(  # noqa: S603 - lcmtools' own command
                self._command, stdin=silent, stdout=subprocess.PIPE, stderr=silent
            )
        with self._process as process:
            try:
                output, _ = process.communicate(timeout=_LONGEST)
                records: list[Mapping[str, Any]] = json.loads(output)
            except (subprocess.TimeoutExpired, ValueError):
                process.kill()
                self._fault = "" if self._ends_soon.is_set() else "wtf could not look"
                return None
        checked = [record for record in records if record["severity"] != "unchecked"]
        return [{key: record[key] for key in _KEPT} for record in checked]
