"""Errors name the first cause: file, line, and the types that it costs, and blame no other file."""

import json

import pytest

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.report import unchecked
from lcmtools.doctor.sentences import unchecked_text
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role
from lcmtools.messages.supply import set_supply
from lcmtools.observe.reading.decoding import remedy_of_unknown
from lcmtools.packages import provide_user_types

BROKEN = "package rover;\nstruct whale_t\n{\n  double length\n}\n"
POD = "package rover;\nstruct pod_t { int32_t n; whale_t whales[n]; }\n"
SEA = "package sea;\nstruct sea_t { rover.pod_t pod; }\n"
DEEP = "package rover;\nstruct pod_t { int8_t id;\n  salmon_t whale;\n}\n"
WHALE = "package rover;\nstruct whale_t { double length; }\n"
ENDLESS = "package rover;\nstruct whale_t { pod_t pod; }\n"
NEEDS_WHALE = "package rover;\nstruct pod_t { whale_t whale; }\n"


@pytest.fixture
def types(tmp_path, monkeypatch, tmp_path_factory):
    """``types({"a/b.lcm": text})``: makes the files of a user; gives their folder."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))

    def make(files):
        for name, text in files.items():
            path = tmp_path / "lcmtypes" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(tmp_path / "lcmtypes"))
        monkeypatch.chdir(tmp_path)
        return tmp_path / "lcmtypes"

    return make


@pytest.mark.parametrize(
    ("files", "asked", "error"),
    [
        (
            {"whale.lcm": BROKEN},
            "rover/whale_t",
            (
                "lcmtypes/whale.lcm:5: expected token ; (unusable: rover/whale_t);"
                " a ';' is missing before this"
            ),
        ),
        (
            {"whale_t.lcm": BROKEN, "pod_t.lcm": POD, "sea_t.lcm": SEA},
            "sea/sea_t",
            (
                "lcmtypes/whale_t.lcm:5: expected token ;"
                " (unusable: rover/whale_t, rover/pod_t, sea/sea_t); a ';' is missing before this"
            ),
        ),
        (
            {"whale_t.lcm": BROKEN},
            "whale_t",
            "lcmtypes/whale_t.lcm:5: expected token ;; a ';' is missing before this",
        ),
        (
            {"whale_t.lcm": WHALE, "pod_t.lcm": DEEP, "sea_t.lcm": SEA},
            "sea/sea_t",
            (
                "lcmtypes/pod_t.lcm:3: rover/pod_t: unknown type 'salmon_t' (unusable: sea/sea_t);"
                " name the folder of its .lcm file too"
            ),
        ),
        (
            {"pod_t.lcm": DEEP.replace("salmon", "whal"), "whale_t.lcm": WHALE, "sea_t.lcm": SEA},
            "pod_t",
            (
                "lcmtypes/pod_t.lcm:3: rover/pod_t: unknown type 'whal_t' (unusable: sea/sea_t);"
                " did you mean rover.whale_t?"
            ),
        ),
        (
            {"whale_t.lcm": ENDLESS, "pod_t.lcm": NEEDS_WHALE, "sea_t.lcm": SEA},
            "sea/sea_t",
            (
                "lcmtypes/pod_t.lcm: rover/pod_t contains itself (unusable: sea/sea_t);"
                " only an array of variable size can hold its own type"
            ),
        ),
        (
            {"whale_t.lcm": BROKEN},
            "rover/wale_t",
            "unknown type 'rover/wale_t'; see: lcmtools msg list",
        ),
        (
            {"whale_t.lcm": BROKEN},
            "geometry_msgs/Twst",
            "unknown type 'geometry_msgs/Twst'; did you mean geometry_msgs/Twist?",
        ),
    ],
)
def test_the_first_cause_is_named(files, asked, error, types, cli):
    types(files)
    result = cli("msg", "show", asked)
    assert (result.out, result.err) == ("", f"lcmtools msg show: {error}\n")


def test_a_dangling_link_costs_its_own_type_only(types, cli):
    folder = types({"rover/whale_t.lcm": WHALE})
    (folder / "rover" / "gone_t.lcm").symlink_to("nowhere")
    where = "lcmtypes/rover/gone_t.lcm: this link leads nowhere"
    assert cli("msg", "show", "rover/gone_t").err == f"lcmtools msg show: {where}\n"
    assert cli("msg", "show", "rover/whale_t").code == 0
    assert "unknown type 'rover/other_t'" in cli("msg", "show", "rover/other_t").err


def test_each_cause_is_listed_once(types, cli):
    folder = types({"whale_t.lcm": BROKEN, "pod_t.lcm": POD, "sea_t.lcm": SEA, "ok.lcm": WHALE})
    (folder / "ok.lcm").write_text("package rover;\nstruct ok_t { int8_t a; }\n")
    result = cli("msg", "build", "--json")
    report = json.loads(result.out)
    assert (result.code, [one["type"] for one in report["types"]]) == (1, ["rover/ok_t"])
    (problem,) = report["problems"]
    assert problem["lost"] == ["rover/whale_t", "rover/pod_t", "sea/sea_t"]


def test_another_file_with_the_type_makes_up_for_a_broken_one(types, cli):
    types({"a/whale_t.lcm": BROKEN, "b/whale_t.lcm": WHALE, "pod_t.lcm": POD})
    assert "float64 length" in cli("msg", "show", "rover/pod_t").out


def test_no_file_is_blamed_for_an_unknown_fingerprint(types):
    types({"whale_t.lcm": BROKEN})
    provide_user_types()
    try:
        said = remedy_of_unknown()
    finally:
        set_supply(None)
    assert said == (
        "LCMTOOLS_TYPE_PATH=FOLDER adds the folder of your .lcm files;"
        " lcmtools msg build shows a broken type file"
    )


def test_wtf_says_which_announced_types_cannot_be_used(types):
    types({"whale_t.lcm": BROKEN, "pod_t.lcm": POD})
    names = ("rover/pod_t", "rover/lost_t", "rover/whale_t", "std_msgs/String")
    topics = [Endpoint(f"/{n}", Role.PUBLISHER, (name,), (n + 1,)) for n, name in enumerate(names)]
    provide_user_types()
    try:
        graph = Graph((NodeInfo("/a", "1", "husky", 12, endpoints=tuple(topics)),))
        found = list(unchecked(Evidence(url="memq://", graph=graph)))
    finally:
        set_supply(None)
    assert [unchecked_text(one) for one in found] == [
        "rover/pod_t, rover/whale_t cannot be used: lcmtools msg list says why"
    ]


@pytest.mark.parametrize("name", ["build", "dist"])
def test_folders_of_builds_are_searched_last(name, types, cli):
    copy = WHALE.replace("length", "old_length")
    copies = {f"{name}/lib/msg/whale_t.lcm": copy, f"{name}/only_t.lcm": POD}
    types({**copies, "msg/whale_t.lcm": WHALE})
    assert cli("msg", "show", "rover/whale_t").out == "float64 length\n"
    assert "float64 length" in cli("msg", "show", "rover/pod_t").out


def test_a_tree_that_is_too_large_is_not_cut_in_silence(types, cli, monkeypatch):
    monkeypatch.setattr("lcmtools.packages.type_files._MOST_FOLDERS", 3)
    types({f"{n}/t{n}_t.lcm": f"struct t{n}_t {{ byte x; }}\n" for n in range(5)})
    result = cli("msg", "list")
    assert "lcmtypes: it has more than 3 folders, and the others are not searched" in result.err
