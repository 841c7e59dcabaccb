"""The page's files, each compressed once for browsers that accept it.

Must not know the server.
"""

import gzip
import mimetypes
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

_TYPES = {".js": "text/javascript", ".css": "text/css", ".html": "text/html"}


@dataclass(frozen=True, slots=True)
class FileContent:
    """The content of a file as a browser gets it."""

    kind: str  # MIME type
    tag: str  # HTTP's entity tag, different for each content and encoding
    body: bytes
    encoding: str = ""  # "gzip", or "" for the file's own bytes


class StaticFiles:
    """The files of a folder, by the path in an address; "/" is index.html."""

    def __init__(self, folder: Path) -> None:
        files = (path for path in folder.rglob("*") if path.is_file())
        self._paths = {f"/{path.relative_to(folder).as_posix()}": path for path in files}
        self._paths["/"] = folder / "index.html"
        self._contents: dict[tuple[Path, bool], FileContent] = {}

    def get(self, address: str, accepted: str) -> FileContent | None:
        """Return the file at an address, for a header Accept-Encoding; None if there is none."""
        path = self._paths.get(address)
        if path is None:
            return None
        about, is_small = path.stat(), accepts_gzip(accepted)
        tag = f'"{about.st_mtime_ns:x}-{about.st_size:x}{"-gzip" if is_small else ""}"'
        known = self._contents.get((path, is_small))
        if known is None or known.tag != tag:
            known = self._contents[path, is_small] = _read(path, tag, is_small=is_small)
        return known


def accepts_gzip(header: str) -> bool:
    """Return whether a header Accept-Encoding allows gzip (RFC 9110, section 12.5.3)."""
    weights: Mapping[str, str] = {
        name.strip().casefold(): weight.strip()
        for name, _, weight in (part.partition(";") for part in header.split(","))
    }
    weight = weights.get("gzip", weights.get("*", "q=0"))
    return weight.replace(" ", "").casefold() not in ("q=0", "q=0.0", "q=0.00", "q=0.000")


def _read(path: Path, tag: str, *, is_small: bool) -> FileContent:
    kind = _TYPES.get(path.suffix) or mimetypes.guess_type(path.name)[0] or "text/plain"
    body = path.read_bytes()
    if is_small:
        return FileContent(kind, tag, gzip.compress(body), "gzip")
    return FileContent(kind, tag, body)
