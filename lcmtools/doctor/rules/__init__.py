"""The rules, one file a family. A new rule is a function with ``@rule``, listed in ``RULES``."""

from collections.abc import Iterable
from dataclasses import replace

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Finding, Rule
from lcmtools.doctor.rules import (
    bus,
    callbacks,
    channels,
    clocks,
    connections,
    content,
    listeners,
    network,
    nodes,
    traffic,
    types,
)

RULES: tuple[Rule, ...] = (
    bus.bus_works,
    network.datagrams_can_leave,
    network.large_messages_pass,
    bus.something_is_there,
    bus.programs_are_on_this_bus,
    bus.one_provider_is_used,
    bus.datagrams_go_as_far_as_they_should,
    bus.the_bus_is_ones_own,
    bus.datagrams_are_lcm,
    nodes.nodes_answer,
    nodes.nodes_have_names_of_their_own,
    nodes.simulated_time_has_a_source,
    callbacks.queues_have_room,
    callbacks.callbacks_are_quick,
    nodes.files_are_few,
    types.topics_have_one_type,
    types.types_are_known,
    connections.subscriptions_have_publishers,
    connections.publications_have_subscribers,
    traffic.topics_have_one_publisher,
    traffic.nothing_is_lost,
    traffic.publishers_publish,
    traffic.rates_do_not_fall,
    traffic.rates_are_even,
    channels.names_are_good,
    network.the_network_has_room,
    traffic.simulated_time_passes,
    listeners.buffers_have_room,
    listeners.listeners_read,
    listeners.messages_fit_buffers,
    content.numbers_are_finite,
    content.quaternions_are_rotations,
    content.covariances_are_covariances,
    clocks.clocks_agree,
    content.stamps_are_current,
    content.messages_can_be_decoded,
    listeners.the_group_is_joined_where_the_route_leads,
    listeners.datagrams_arrive_complete,
    listeners.strict_filters_are_off,
    listeners.no_firewall_is_in_the_way,
    network.the_route_leaves_the_computer,
    network.nothing_is_walled_in,
    network.the_network_has_a_querier,
    listeners.the_environment_is_in_order,
)


_EXPLAINED_BY = {"no-traffic": {"other-buses", "silent", "stuck-listeners", "loss", "malformed"}}


def examine(evidence: Evidence, rules: Iterable[Rule] = RULES) -> list[Finding]:
    """Everything that the rules find, gravest first, without what another finding explains."""
    chosen = tuple(rules)
    evidence = _without_other_rules(evidence, chosen)
    findings = [finding for rule in chosen for finding in rule.examine(evidence)]
    found = {finding.rule for finding in findings}
    findings = [f for f in findings if found.isdisjoint(_EXPLAINED_BY.get(f.rule, ()))]
    return sorted(findings, key=lambda finding: -finding.severity)


def _without_other_rules(evidence: Evidence, chosen: tuple[Rule, ...]) -> Evidence:
    """The evidence without what rules leave to others that are not chosen."""
    if bus.programs_are_on_this_bus not in chosen:
        alone = [replace(process, topics=()) for process in evidence.processes]
        evidence = replace(evidence, processes=alone)
    if nodes.nodes_answer not in chosen:
        none: frozenset[str] = frozenset()
        evidence = replace(evidence, stale_published=none, stale_subscribed=none)
    return evidence
