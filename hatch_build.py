"""Writes the man pages when a wheel is built, from the commands' own help."""

import subprocess
import sys
from tempfile import TemporaryDirectory
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class ManPages(BuildHookInterface):  # type: ignore[type-arg]
    """Puts the man pages where man looks for those of a command on the PATH."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Write the pages and have them packed."""
        del version
        self._folder = TemporaryDirectory(prefix="lcmtools-man-")
        # -m, and no PYTHONPATH: pip takes a folder that is installed editably out of that
        command = [sys.executable, "-m", "docs.man_pages", self._folder.name]
        subprocess.run(command, cwd=self.root, check=True)  # noqa: S603 - our own module
        build_data["shared_data"][self._folder.name] = "share/man/man1"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Remove the pages that have been packed."""
        del version, build_data, artifact_path
        self._folder.cleanup()
