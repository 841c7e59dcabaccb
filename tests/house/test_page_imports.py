"""The modules of the window's page import each other without a circle."""

import re
from graphlib import TopologicalSorter

from lcmtools.gui.server import STATIC

_IMPORT = re.compile(r'^(?:import|export)\b[^;]*?from "(\.[^"]+)";', re.MULTILINE)


def test_no_module_of_the_page_imports_itself_by_others():
    graph = {
        path: [(path.parent / name).resolve() for name in _IMPORT.findall(path.read_text())]
        for path in STATIC.resolve().rglob("*.js")
        if "vendor" not in path.parts
    }
    assert sum(map(len, graph.values())) > 50  # they are found
    TopologicalSorter(graph).prepare()  # raises a CycleError, which names the circle
