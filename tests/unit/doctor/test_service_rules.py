"""Services that are offered twice, or not at all."""

import pytest
from fixtures.judging import judge

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Severity
from lcmtools.doctor.rules import services
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness


def node(name, role, service, command="", pid=1):
    end = Endpoint(service, role, ("std_srvs/Trigger",), (4,))
    return Node(name, f"{name} {pid}", "here", pid, command=command, endpoints=(end,))


def found(*nodes, remote=frozenset()):
    evidence = Evidence("udpm://", graph=Graph(nodes), remote=remote)
    findings = judge(evidence, [services.services_are_offered_once])
    assert all(finding.severity is Severity.WARNING for finding in findings)
    return [(*finding.items, *finding.remedies) for finding in findings]


ARM, LEG = (node(name, Role.SERVICE, "/go", pid=pid) for name, pid in (("/arm", 7), ("/leg", 8)))
PILOT = node("/pilot", Role.CLIENT, "/go")


def test_a_service_that_one_node_offers_and_another_calls_is_no_finding():
    assert found(ARM, PILOT) == []
    assert found(ARM) == []


def test_a_service_that_two_nodes_offer_is_told_with_the_ways_to_part_them():
    remedy = "end one of them (kill 7) or (kill 8), or start /leg with /go:=/go_2"
    assert found(ARM, LEG, PILOT) == [(" * /go: /arm and /leg", remedy)]
    remapped = LEG._replace(command="leg walk:=/go")
    (remapped_found,) = found(ARM, remapped, remote=frozenset({ARM.id}))
    assert remapped_found[1] == "end one of them, or start /leg with walk:=/go_2"


def test_two_nodes_of_one_name_are_others_business():
    assert found(ARM, ARM._replace(id="again", pid=9)) == []
    assert found(ARM, LEG._replace(stale=Staleness.ENDED)) == []


@pytest.mark.parametrize(
    ("service", "remedy"),
    [
        ("/left/go", "/left/go is offered: start /pilot with go:=/left/go"),
        ("/halt", "start a node that offers /go; to see what is offered: lcmtools service list"),
    ],
)
def test_a_service_that_nobody_offers_is_told_with_what_connects_it(service, remedy):
    server = node("/arm", Role.SERVICE, service)
    assert found(server, PILOT) == [(" * /pilot calls /go", remedy)]


def test_who_calls_a_node_that_was_killed_is_excused_and_commands_are():
    assert found(PILOT, ARM._replace(stale=Staleness.HANGS, endpoints=())) == []
    assert found(PILOT._replace(tool=True)) == []
    assert found(node("/pilot", Role.CLIENT, "/arm/_parameters")) == []
