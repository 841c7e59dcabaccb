"""A plan and its end, as rows of text and for JSON."""

import json
import shlex
from collections.abc import Iterator, Mapping, Sequence

from lcmtools.launch.plan import Argument, NodePlan
from lcmtools.launch.supervisor import Outcome
from lcmtools.messages.plain import plain_json
from lcmtools.messages.setting import ANY, Setting, read_setting, write_setting


def argument_rows(arguments: Sequence[Argument]) -> Iterator[str]:
    """Return the arguments of a file, in roslaunch's form."""
    for title, is_required in (("Required", True), ("Optional", False)):
        group = [argument for argument in arguments if (argument.default is None) is is_required]
        if group:
            yield f"{title} Arguments:"
        for argument in group:
            default = f" (default {json.dumps(argument.default)})" if not is_required else ""
            doc = " ".join(argument.doc.split())
            yield f"  {argument.name}{default}: {doc}" if doc else f"  {argument.name}{default}"
    if not arguments:
        yield "No arguments."


def argument_record(argument: Argument) -> dict[str, object]:
    """Return an argument, for JSON."""
    return {"name": argument.name, "default": argument.default, "doc": argument.doc}


def node_rows(node: NodePlan) -> Iterator[str]:
    """Return a node as it would be run: a comment, and a line for the shell."""
    about = [f"output {node.output.value}"]
    if node.respawn:
        about.append(f"respawn after {node.respawn_delay:g} s" if node.respawn_delay else "respawn")
    if node.is_required:
        about.append("required")
    yield f"# {node.name} ({node.place}; {', '.join(about)})"
    yield node.command_line()


def node_record(node: NodePlan) -> dict[str, object]:
    """Return a node as it would be run, for JSON."""
    return {
        "node": node.name,
        "command": list(node.command),
        "line": node.command_line(),
        "environment": dict(node.environment),
        "directory": node.directory,
        "place": node.place,
        "output": node.output.value,
        "respawn": node.respawn,
        "respawn_delay": node.respawn_delay,
        "required": node.is_required,
    }


def parameter_rows(node: NodePlan) -> Iterator[str]:
    """Return the parameters of a node, as param dump writes those of nodes that run."""
    parameters = _parameters(node)
    if parameters:
        yield f"{write_setting(node.name)}:"
    for name, value in parameters.items():
        yield f"  {write_setting(name)}: {write_setting(value)}"


def parameter_record(node: NodePlan) -> dict[str, object]:
    """Return the parameters of a node, for JSON."""
    plain = {
        name: json.loads(plain_json(list(value) if isinstance(value, (list, tuple)) else value))  # type: ignore[arg-type] # a list of scalars
        for name, value in _parameters(node).items()
    }
    return {"node": node.name, "parameters": plain}


def _parameters(node: NodePlan) -> Mapping[str, Setting]:
    return {name: read_setting(text, ANY, name) for name, text in node.parameters.items()}


def outcome_rows(outcomes: Sequence[Outcome]) -> list[str]:
    """Return the closing table."""
    rows = [("node", "end", "restarts", "log")]
    rows += [
        (o.node, o.end, str(o.restarts), shlex.quote(o.log) if o.log else "-") for o in outcomes
    ]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
