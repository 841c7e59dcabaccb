"""Fuzzers: seeded and short; longer by LCMTOOLS_FUZZ, the factor of their number of inputs.

LCMTOOLS_FUZZ=1000 LCMTOOLS_SEED=7 pytest tests/endure
"""

import os
import random

import pytest
from fixtures.limits import cpu_limit


@pytest.fixture
def rounds():
    """Random numbers for each input, by a loop over the number of these.

    An input that takes very long fails. The last seed that is printed is that of the failure.
    """
    factor = float(os.environ.get("LCMTOOLS_FUZZ", "1"))
    first = int(os.environ.get("LCMTOOLS_SEED", "0"))

    def make(count):
        for seed in range(first, first + max(1, int(count * factor))):
            print(f"LCMTOOLS_SEED={seed}")  # noqa: T201 - shown if the test fails
            with cpu_limit():
                yield random.Random(seed)  # noqa: S311 - no secret

    return make
