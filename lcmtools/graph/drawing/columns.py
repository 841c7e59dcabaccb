"""Vertices in columns: in what order they stand in each, and how high, so that few lines cross.

Lines go from each column to the next one only; what goes farther has a vertex in each column on
its way. Vertices of one lane stay together: no vertex of another stands between them. Pure
arithmetic on names and numbers, always with the same result. Crossings are reduced as K. Sugiyama,
S. Tagawa and M. Toda do it (Methods for visual understanding of hierarchical system structures,
1981).
"""

from bisect import bisect_right, insort
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

_ROUNDS = 12
_SETTLING = 10
_MOST_LINES = 3000  # beyond that, a good order would take seconds


@dataclass(frozen=True, slots=True)
class Cell:
    """A vertex in its column.

    Attributes:
        column: Which.
        height: How high it is.
        lane: What it stays together with; lanes are sorted from above.
        is_bend: A line passes here, and nothing is drawn.
    """

    column: int
    height: float
    lane: int = 0
    is_bend: bool = False


class Columns:
    """Cells and the lines between them.

    Args:
        cells: By name.
        lines: Pairs of names: from a column to the next one.
        gap: What stays free between two cells, one above the other.
    """

    def __init__(
        self, cells: Mapping[str, Cell], lines: Iterable[tuple[str, str]], gap: float
    ) -> None:
        self._cells = cells
        self._gap = gap
        self._left: dict[str, list[str]] = {name: [] for name in cells}
        self._right: dict[str, list[str]] = {name: [] for name in cells}
        self._size = 0
        for left, right in lines:
            self._right[left].append(right)
            self._left[right].append(left)
            self._size += 1
        count = 1 + max((cell.column for cell in cells.values()), default=-1)
        self._columns: list[list[str]] = [[] for _ in range(count)]
        for name in sorted(cells, key=lambda name: cells[name].lane):
            self._columns[cells[name].column].append(name)

    def order(self) -> None:
        """Put each column into an order that makes few lines cross."""
        best, fewest = self._copy(), self.crossings()
        rounds = _ROUNDS if self._size <= _MOST_LINES else 2
        for number in range(rounds):
            if not fewest:
                break
            self._sweep(rightwards=number % 2 == 0)
            if self._size <= _MOST_LINES:
                self._swap_neighbours()
            crossings = self.crossings()
            if crossings < fewest:
                best, fewest = self._copy(), crossings
        self._columns = best

    def crossings(self) -> int:
        """How many pairs of lines cross."""
        count = 0
        for left, right in pairwise(self._columns):
            place = self._places(right)
            count += _inversions(
                end for name in left for end in sorted(place[v] for v in self._right[name])
            )
        return count

    def heights(self) -> dict[str, float]:
        """Where each cell's middle is, from above; the first lane begins at 0."""
        place: dict[str, float] = {}
        top = 0.0
        for lane in sorted({cell.lane for cell in self._cells.values()}):
            columns = [[v for v in c if self._cells[v].lane == lane] for c in self._columns]
            found = self._settle([column for column in columns if column])
            highest = min(y - self._cells[v].height / 2 for v, y in found.items())
            place.update({v: y - highest + top for v, y in found.items()})
            top = max(place[v] + self._cells[v].height / 2 for v in found)
        return place

    def _copy(self) -> list[list[str]]:
        return [list(column) for column in self._columns]

    def _places(self, column: Sequence[str]) -> dict[str, int]:
        return {name: number for number, name in enumerate(column)}

    def _sweep(self, *, rightwards: bool) -> None:
        """Sort each column by where the neighbours in the one before stand, on average."""
        pairs = list(pairwise(self._columns))
        if not rightwards:
            pairs = [(right, left) for left, right in reversed(pairs)]
        for fixed, column in pairs:
            place = self._places(fixed)
            own = self._places(column)
            near = self._left if rightwards else self._right
            middle = {
                name: sum(place[v] for v in near[name]) / len(near[name])
                if near[name]
                else own[name]
                for name in column
            }
            order = {name: (self._cells[name].lane, middle[name], own[name]) for name in column}
            column.sort(key=order.__getitem__)

    def _swap_neighbours(self) -> None:
        """Exchange cells that stand one above the other where fewer lines cross then."""
        for number, column in enumerate(self._columns):
            sides = []
            if number:
                sides.append((self._left, self._places(self._columns[number - 1])))
            if number + 1 < len(self._columns):
                sides.append((self._right, self._places(self._columns[number + 1])))
            for place in range(len(column) - 1):
                upper, lower = column[place : place + 2]
                if self._cells[upper].lane != self._cells[lower].lane:
                    continue
                gain = 0
                for near, where in sides:
                    above = sorted(where[v] for v in near[upper])
                    below = sorted(where[v] for v in near[lower])
                    gain += _crossed(above, below) - _crossed(below, above)
                if gain > 0:
                    column[place : place + 2] = [lower, upper]

    def _settle(self, columns: list[list[str]]) -> dict[str, float]:
        """Heights for columns of one lane: near their neighbours, in order, and apart."""
        place: dict[str, float] = {}
        for column in columns:
            place.update(self._spread(column, dict.fromkeys(column, (0.0, 1.0))))
        inside = place.keys()
        for number in range(_SETTLING):
            is_last = number >= _SETTLING - 2
            for column in columns if number % 2 == 0 else reversed(columns):
                wanted = {}
                for name in column:
                    near = [*self._left[name], *self._right[name]]
                    if not is_last:
                        near = (self._left if number % 2 == 0 else self._right)[name] or near
                    pulls = [(place[v], self._pull(name, v)) for v in near if v in inside]
                    weight = sum(pull for _, pull in pulls)
                    middle = sum(y * pull for y, pull in pulls) / weight if pulls else place[name]
                    wanted[name] = (middle, weight or 0.1)
                place.update(self._spread(column, wanted))
        return place

    def _pull(self, name: str, other: str) -> float:
        """How much two cells want to be at one height: a long line wants to be straight."""
        bends = self._cells[name].is_bend + self._cells[other].is_bend
        return (1.0, 2.0, 8.0)[bends]

    def _spread(
        self, column: Sequence[str], wanted: Mapping[str, tuple[float, float]]
    ) -> dict[str, float]:
        """The heights nearest to those wanted (squares, weighted) in order and without overlap.

        Less the room that the cells before need, that is: numbers that never fall. Neighbours that
        do are joined at their mean (pool adjacent violators).
        """
        room = [0.0]
        for upper, lower in pairwise(column):
            both = self._cells[upper], self._cells[lower]
            gap = self._gap / 2 if both[0].is_bend and both[1].is_bend else self._gap
            room.append(room[-1] + (both[0].height + both[1].height) / 2 + gap)
        pools: list[tuple[float, float, int]] = []  # mean, weight, how many
        for name, before in zip(column, room, strict=True):
            middle, weight = wanted[name]
            pool = (middle - before, weight, 1)
            while pools and pools[-1][0] > pool[0]:
                mean, other, count = pools.pop()
                total = other + pool[1]
                pool = ((mean * other + pool[0] * pool[1]) / total, total, count + pool[2])
            pools.append(pool)
        means = [mean for mean, _, count in pools for _ in range(count)]
        return {v: mean + before for v, mean, before in zip(column, means, room, strict=True)}


def _inversions(numbers: Iterable[int]) -> int:
    """How many pairs stand in the wrong order."""
    seen: list[int] = []
    count = 0
    for number in numbers:
        count += len(seen) - bisect_right(seen, number)
        insort(seen, number)
    return count


def _crossed(upper: Sequence[int], lower: Sequence[int]) -> int:
    """How many lines of two cells cross, by the sorted places of their other ends."""
    return sum(len(upper) - bisect_right(upper, end) for end in lower)
