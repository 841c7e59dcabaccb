"""The agreement of a picture's colours with the depths that it shows. Pure numbers.

Nothing is said about which colour means what: grey, inverted grey and any colour map are as good.
What counts is that pixels of the same depth look the same. The measure is the correlation ratio
(eta squared; K. Pearson, 1905): the part of the colours' variance that is explained by the depth.
A picture of something else, one upside down or one that is all black explains little or nothing.
"""

from collections.abc import Sequence

GOOD = 0.9
"""From here on a picture counts as right."""
_CLASSES = 64


def explained(depths: Sequence[int], colors: Sequence[Sequence[float]]) -> float:
    """The part of the variance of the colours that the depths explain, from 0 to 1.

    Args:
        depths: Per pixel, in any unit; 0 means that there is no reading.
        colors: Of the same pixels in the picture; each has one number, or three.
    """
    total = _scatter(colors)
    if total <= 0.0:
        return 0.0
    within = sum(_scatter(piece) for piece in _by_depth(depths, colors))
    return 1.0 - within / total


def _by_depth(
    depths: Sequence[int], colors: Sequence[Sequence[float]]
) -> list[list[Sequence[float]]]:
    """The colours in classes of about equal depth, each with as many pixels."""
    order = sorted(range(len(depths)), key=depths.__getitem__)
    size = max(1, -(-len(order) // _CLASSES))
    pieces = [order[start : start + size] for start in range(0, len(order), size)]
    return [[colors[pixel] for pixel in piece] for piece in pieces]


def _scatter(colors: Sequence[Sequence[float]]) -> float:
    """Sum of squared distances from the mean."""
    return sum(_scatter_of_channel(channel) for channel in zip(*colors, strict=True))


def _scatter_of_channel(values: Sequence[float]) -> float:
    mean = sum(values) / len(values)
    return sum((value - mean) ** 2 for value in values)
