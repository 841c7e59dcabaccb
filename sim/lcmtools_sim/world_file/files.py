"""Files that a world names: found beside it, and read as text."""

import os
from collections.abc import Sequence
from pathlib import Path

from lcmtools.errors import InvalidFile

_LARGEST_BYTES = 20_000_000
_SCHEME = "model://"
_PATHS = ("GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH")


def read_file(path: Path) -> str:
    """A file's text.

    Raises:
        InvalidFile: It cannot be read, is no text, or is too large for a description.
    """
    try:
        if path.is_file() and path.stat().st_size > _LARGEST_BYTES:
            raise InvalidFile(f"{path}: is larger than {_LARGEST_BYTES // 1_000_000} MB")
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise InvalidFile(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise InvalidFile(f"{path}: is not UTF-8 text (byte {error.start})") from None


def beside(source: str, path: str) -> Path:
    """The file that ``source`` calls ``path``."""
    return Path(source).parent / Path(path).expanduser()


def find_model(uri: str, source: str) -> Path | None:
    """The SDF file that an include in ``source`` means; None where there is none.

    model://NAME is looked up beside the file, in its folder "models", beside its folder, and
    where Gazebo looks for models; nothing is fetched from the network.
    """
    if uri.startswith(_SCHEME):
        name = uri.removeprefix(_SCHEME)
        places = [folder / name for folder in _folders(Path(source).parent)]
    elif "://" in uri and not uri.startswith("file://"):
        return None
    else:
        places = [beside(source, uri.removeprefix("file://"))]
    return next((file for place in places if (file := _model_file(place))), None)


def _folders(here: Path) -> Sequence[Path]:
    said = [os.environ.get(name, "") for name in _PATHS]
    paths = [Path(path) for text in said for path in text.split(":") if path]
    return [here, here / "models", here.parent, here.parent / "models", *paths]


def _model_file(place: Path) -> Path | None:
    """The file itself, or the SDF file of a model's folder: the newest, if there are several."""
    if place.is_file():
        return place
    plain = place / "model.sdf"
    if plain.is_file():
        return plain
    return max(place.glob("*.sdf"), default=None) if place.is_dir() else None
