"""Parameters while the node runs: changed by itself and by others, all or none, or refused."""

from functools import partial

import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools import Node
from lcmtools.errors import LcmtoolsError, ServiceError, ServiceTimeout, UsageError
from lcmtools.node.parameters import Parameter, SetParametersResult
from lcmtools.publish.remote_parameters import (
    RefusedParameters,
    request_parameters,
    value_of,
)


@pytest.fixture
def node(begin):
    """A node with some parameters."""
    begin()
    node = Node("driver")
    node.declare_parameter("gain", 1.0, "effort [N]", minimum=0.0, maximum=10.0)
    node.declare_parameter("name", "bob")
    node.declare_parameter("steps", [1, 2], maximum=5)
    return node


@pytest.fixture
def remote(node, serve):
    """The same node's parameters, seen from another one."""
    serve(node)
    return partial(request_parameters, Node("other", tool=True), "/driver")


def test_a_changed_parameter_is_what_get_gives(node):
    assert node.has_parameter("gain")
    assert not node.has_parameter("gian")
    results = node.set_parameters([Parameter("gain", 2), Parameter("name", "eve")])
    assert results == [SetParametersResult(), SetParametersResult()]
    assert node.get_parameter("gain").value == 2.0
    assert isinstance(node.get_parameter("gain").value, float)
    assert node.get_parameter("name").value == "eve"
    assert node.describe_parameter("gain").description == "effort [N]"


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("gain", "2", "parameter gain: expected a number, got '2'"),
        ("gain", -0.5, "parameter gain: -0.5 is less than 0.0"),
        ("gain", 11, "parameter gain: 11.0 is more than 10.0"),
        ("gain", float("nan"), "parameter gain: nan is less than 0.0"),
        ("steps", [1, 6], "parameter steps: 6 is more than 5"),
        ("name", 5, "parameter name: expected text, got 5"),
        ("gian", 5, "/driver has no parameter 'gian'; did you mean gain?"),
        (
            "use_sim_time",
            True,
            (
                "parameter use_sim_time cannot change while the node runs;"
                " start it again with _use_sim_time:=true"
            ),
        ),
    ],
)
def test_what_does_not_fit_is_refused_and_changes_nothing(node, name, value, reason):
    result = node.set_parameters_atomically([Parameter("name", "eve"), Parameter(name, value)])
    assert result == SetParametersResult(successful=False, reason=reason)
    assert node.get_parameter("name").value == "bob"


def test_one_by_one_the_good_ones_are_set(node):
    results = node.set_parameters([Parameter("name", 1), Parameter("gain", 3.0)])
    assert [result.successful for result in results] == [False, True]
    assert node.get_parameter("gain").value == 3.0


def test_callbacks_are_asked_before_a_change_and_may_refuse(node):
    seen = []

    def check(parameters):
        (parameter,) = parameters
        seen.append((parameter.name, parameter.value, node.get_parameter(parameter.name).value))
        if parameter.value == 9.0:
            return SetParametersResult(successful=False, reason="nine is too much")
        if parameter.value == 8.0:
            raise LcmtoolsError("eight is", "take seven")
        return None

    node.add_on_set_parameters_callback(check)
    reasons = [node.set_parameters([Parameter("gain", v)])[0].reason for v in (9.0, 8.0, 7.0)]
    assert reasons == ["nine is too much", "eight is; take seven", ""]
    assert seen == [("gain", 9.0, 1.0), ("gain", 8.0, 1.0), ("gain", 7.0, 1.0)]
    assert node.get_parameter("gain").value == 7.0
    node.remove_on_set_parameters_callback(check)
    assert node.set_parameters([Parameter("gain", 9.0)])[0].successful


def test_a_parameter_is_declared_once_and_within_its_range(begin):
    begin("_gain:=11")
    node = Node("a")
    with raises_saying(UsageError, "parameter gain", "11.0", "10.0"):
        node.declare_parameter("gain", 1.0, maximum=10.0)
    with raises_saying(UsageError, "/a", "'use_sim_time'", "twice"):
        node.declare_parameter("use_sim_time", default=False)


def test_another_node_sees_all_parameters_in_order(remote):
    found = remote(5.0)
    assert list(found) == ["gain", "name", "steps", "use_sim_time"]
    gain = found["gain"]
    assert (gain.type, gain.value, value_of(gain)) == ("float", "1.0", 1.0)
    assert (gain.description, gain.minimum, gain.maximum) == ("effort [N]", "0.0", "10.0")
    assert value_of(found["steps"]) == [1, 2]
    assert found["use_sim_time"].read_only


def test_another_node_changes_all_or_none(node, remote):
    found = remote(5.0, {"gain": "2.5", "name": "on", "steps": "[3, 0x4]"})
    assert (found["gain"].value, value_of(found["name"])) == ("2.5", "on")
    assert node.get_parameter("steps").value == [3, 4]
    with pytest.raises(RefusedParameters) as caught:
        remote(5.0, {"gain": "3", "name": "x", "steps": "[a]", "gian": "1"})
    step, gain = caught.value.reasons
    assert_says(step, "parameter steps[0]: ", "integer", "'a'")
    assert_says(gain, "/driver", "'gian'", "did you mean gain?")
    assert node.get_parameter("gain").value == 2.5
    assert node.get_parameter("name").value == "on"


def test_a_callback_that_raises_is_told_to_who_asked_and_logged(node, remote, logged, wait_until):
    def fail(_):
        raise RuntimeError("broken")

    node.add_on_set_parameters_callback(fail)
    with pytest.raises(ServiceError, match=r"/driver: RuntimeError\('broken'\)"):
        remote(5.0, {"gain": "2"})
    assert node.get_parameter("gain").value == 1.0
    wait_until(lambda: logged("raised RuntimeError: broken"))


def test_a_node_that_does_not_spin_does_not_answer(node):
    with pytest.raises(ServiceTimeout, match=r"/driver .* 0\.05 s") as caught:
        request_parameters(Node("other", tool=True), node.name, 0.05)
    assert caught.value.exit_code == 4


def test_tools_and_nodes_with_long_names_have_no_service_for_it(begin):
    begin()
    longest = "n" * (63 - len("//_parameters/_request"))
    for name, tool, expected in (("a", True, 0), (longest, False, 1), (f"{longest}n", False, 0)):
        node = Node(name, tool=tool)
        node.declare_parameter("gain", 1.0)
        assert node.set_parameters([Parameter("gain", 2.0)])[0].successful
        services = [e for e in node.describe().endpoints if e.topic.endswith("/_parameters")]
        assert len(services) == expected
