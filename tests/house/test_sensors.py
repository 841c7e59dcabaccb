"""A sensor is one file and one line of a table: no other module of the simulator knows its kind."""

import ast
from pathlib import Path

from lcmtools_sim import sensors

SIMULATOR = Path(sensors.__file__).parents[1]
TABLE, INTERFACE = "lcmtools_sim.sensors", "lcmtools_sim.sensors.sensor"
_KNOWS_KINDS = ("sensors", "robots")  # the kinds themselves, and the models that carry them


def others():
    """All parts of the modules that must not know a kind, each with its module's path."""
    for path in sorted(SIMULATOR.rglob("*.py")):
        name = path.relative_to(SIMULATOR)
        if name.parts[0] not in _KNOWS_KINDS:
            for node in ast.walk(ast.parse(path.read_text())):
                yield str(name), node


def test_no_other_module_has_the_name_of_a_kind_of_sensor():
    found = [
        f"{name}:{node.lineno}: {node.value!r}"
        for name, node in others()
        if isinstance(node, ast.Constant) and node.value in sensors.SENSORS
    ]
    assert found == [], "make what it decides an attribute of SensorKind or of its settings"


def test_other_modules_import_only_the_table_of_sensors_and_their_interface():
    imported = {
        (name, node.module, alias.name)
        for name, node in others()
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(TABLE)
        for alias in node.names
    } | {
        (name, alias.name, "")
        for name, node in others()
        if isinstance(node, ast.Import)
        for alias in node.names
        if alias.name.startswith(TABLE)
    }
    of_a_kind = {one for one in imported if one[1:] != (TABLE, "SENSORS") and one[1] != INTERFACE}
    assert imported, "the simulator uses its sensors"
    assert of_a_kind == set()
