"""Answers to questions about launch files and plans, as rows of text and as values for JSON."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence

from lcmtools.errors import ValueMismatch
from lcmtools.launch.arguments import arguments_of
from lcmtools.launch.file import File
from lcmtools.launch.packages import lab_files
from lcmtools.launch.parameter_yaml import read_parameters, value_of
from lcmtools.launch.plan import NodePlan, Plan
from lcmtools.messages.setting import ANY, read_setting, write_setting

Answer = tuple[object, Sequence[str]]  # a value for JSON, and rows of text


def list_answer() -> Answer:
    """Return the labs' launch files."""
    known = lab_files()
    records = [{"package": package, "file": name} for package, name in known]
    return records, [f"{package} {name}" for package, name in known]


def arguments_answer(files: Sequence[File]) -> Answer:
    """Return the arguments of files, in roslaunch's form."""
    arguments = [argument for file in files for argument in arguments_of(file.root)]
    records = [{"name": one.name, "default": one.default, "doc": one.doc} for one in arguments]
    rows: list[str] = []
    for title, is_required in (("Required", True), ("Optional", False)):
        group = [argument for argument in arguments if (argument.default is None) is is_required]
        rows += [f"{title} Arguments:"] if group else []
        for argument in group:
            default = f" (default {json.dumps(argument.default)})" if not is_required else ""
            doc = " ".join(argument.doc.split())
            rows.append(f"  {argument.name}{default}{f': {doc}' if doc else ''}")
    return records, rows or ["No arguments."]


def _names(plan: Plan, _node: str) -> Answer:
    names = [node.name for node in plan.nodes]
    return names, names


def _line(plan: Plan, name: str) -> Answer:
    node = plan.find(name)
    return to_json(node), [node.command_line()]


def _place(plan: Plan, name: str) -> Answer:
    node = plan.find(name)
    return {"node": node.name, "place": node.place}, [node.place]


def _dry_run(plan: Plan, _node: str) -> Answer:
    return list(map(to_json, plan.nodes)), [row for node in plan.nodes for row in to_lines(node)]


def to_lines(node: NodePlan) -> Iterator[str]:
    """Yield the lines of a planned node: a comment, and its command line."""
    about = [f"output {node.output.value}"]
    if node.respawn:
        about.append(f"respawn after {node.respawn_delay:g} s" if node.respawn_delay else "respawn")
    if node.is_required:
        about.append("required")
    yield f"# {node.name} ({node.place}; {', '.join(about)})"
    yield node.command_line()


def to_json(node: NodePlan) -> dict[str, object]:
    """Return a planned node for JSON."""
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


def _parameters(plan: Plan, _node: str) -> Answer:
    """Return the nodes' parameters in the form of param dump for running nodes."""
    records, rows = [], []
    for node in plan.nodes:
        values = {name: _value(text, name) for name, text in node.parameters.items()}
        records.append(
            {"node": node.name, "parameters": {name: value for name, (value, _) in values.items()}}
        )
        rows += [f"{write_setting(node.name)}:"] if values else []
        rows += [f"  {write_setting(name)}: {text}" for name, (_, text) in values.items()]
    return records, rows


def _value(text: str, name: str) -> tuple[object, str]:
    """Return a parameter's value and its text; a node refuses one with a mapping in it."""
    try:
        value = read_setting(text, ANY, name)
    except ValueMismatch:
        return value_of(read_parameters(text, f"parameter {name}")), text
    return value, write_setting(value)


PLAN_ANSWERS: Mapping[str, Callable[[Plan, str], Answer]] = {
    "nodes": _names,
    "args": _line,
    "find-node": _place,
    "dump-params": _parameters,
    "files": lambda plan, _node: (list(plan.files), plan.files),
    "dry-run": _dry_run,
}
"""Answers to questions about a plan, or about one of its nodes."""
