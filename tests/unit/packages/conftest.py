"""Fixtures of the tests of users' packages: folders to make, and a cache of the test's own."""

import pytest

from lcmtools.packages.user_types import UserTypes
from lcmtools.types.fingerprints import FINGERPRINTS


@pytest.fixture
def write(tmp_path):
    """``write({"a/B.lcm": "text"})``: makes files; gives the folder that they are in."""

    def make(files):
        for name, text in files.items():
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return tmp_path

    return make


@pytest.fixture
def cache_folder(tmp_path_factory):
    """An empty cache folder."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def types_of(cache_folder):
    """``types_of(folder, ...)``: the types of a LCMTOOLS_TYPE_PATH of these folders."""

    def make(*folders):
        environment = {
            "LCMTOOLS_TYPE_PATH": ":".join(map(str, folders)),
            "XDG_CACHE_HOME": str(cache_folder),
        }
        time = iter(range(0, 10**6, 100))  # every look is a new one
        return UserTypes(environment, [], FINGERPRINTS, lambda: float(next(time)))

    return make
