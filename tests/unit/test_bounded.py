"""A dictionary with a bound."""

from collections import Counter

from lcmtools.bounded import MOST_ENTRIES, BoundedDict, count


def test_the_least_recently_used_entry_goes_first():
    known = BoundedDict[str, int](2)
    known["a"], known["b"] = 1, 2
    known.use("a")
    known["c"] = 3
    assert dict(known) == {"a": 1, "c": 3}
    assert known.forgotten == 1


def test_of_too_many_channels_only_the_count_of_the_most_silent_one_is_forgotten():
    counts = Counter()
    for number in range(MOST_ENTRIES):
        count(counts, f"/{number}")
    count(counts, "/0")
    count(counts, "/new")
    assert len(counts) == MOST_ENTRIES
    assert (counts["/0"], counts["/2"], "/1" in counts) == (2, 1, False)


def test_reading_does_not_use_an_entry():
    known = BoundedDict[str, int](2)
    known["a"], known["b"] = 1, 2
    assert known["a"] == known.get("a") == known.oldest() == 1
    known["c"] = 3
    assert list(known) == ["b", "c"]


def test_the_bytes_of_all_entries_are_bounded_and_the_latest_stays():
    known = BoundedDict[str, int](100, 10)
    known.put("a", 1, 4)
    known.put("b", 2, 4)
    known.put("c", 3, 4)
    assert list(known) == ["b", "c"]
    known.put("d", 4, 1000)
    assert list(known) == ["d"]


def test_setting_a_known_entry_keeps_its_size():
    known = BoundedDict[str, int](100, 10)
    known.put("a", 1, 4)
    known["a"] = 2
    known.put("b", 2, 6)
    assert dict(known) == {"a": 2, "b": 2}
    known.put("c", 3, 1)
    assert list(known) == ["b", "c"]


def test_bytes_of_removed_entries_do_not_count():
    known = BoundedDict[str, int](100, 10)
    for name in "abc":
        known.put(name, 1, 10)
        del known[name]
    known.put("d", 1, 5)
    known.put("e", 1, 5)
    assert list(known) == ["d", "e"]
    known.clear()
    known.put("f", 1, 10)
    assert list(known) == ["f"]
    assert known.use("a") is None
