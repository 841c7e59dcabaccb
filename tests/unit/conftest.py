"""Types that no package of ours has, made by lcm-gen itself."""

import importlib
import sys

import lcm
import pytest

ODD_TYPES = {
    "Nothing": """
        struct Nothing {
        }
    """,
    "Shapes": """
        struct Shapes {
            int32_t rows;
            int32_t columns;
            byte grid[rows][columns];
            float numbers[rows][3];
            byte key[4];
            byte keys[2][3];
            boolean flags[2];
            string words[2][2];
            odd.Nothing pairs[2][2];
            odd.Nothing nothing;
        }
    """,
    "Shared": """
        struct Shared {
            int8_t count;
            double left[count];
            string right[count];
        }
    """,
    "Tree": """
        struct Tree {
            int32_t children_length;
            int16_t value;
            odd.Tree children[children_length];
        }
    """,
    "Limits": """
        struct Limits {
            const int16_t LOWEST = -200;
            const int8_t ONE = 1;
            const double HALF = 0.5;
            int8_t small;
            int16_t middle;
            int32_t large;
            int64_t huge;
            byte unsigned;
            float single;
        }
    """,
    "Kinds": """
        struct Kinds {
            int16_t count;
            int32_t other;
            boolean flags[count];
            byte bytes[other];
            int8_t small[count];
            int16_t middle[count];
            int32_t large[other];
            int64_t huge[count];
            string words[other];
            float single[count];
            int64_t some[65];
            double grid[other][count];
            int64_t few[3];
            byte key[2];
        }
    """,
    "Rows": """
        struct Rows {
            int32_t count;
            odd.Keyed keyed[count];
            odd.Kinds kinds[2];
        }
    """,
    "Keyed": """
        struct Keyed {
            byte key[3];
            double place[3];
            float many[65];
        }
    """,
    "Many": """
        struct Many {
            int32_t items_length;
            odd.Nothing items[items_length];
        }
    """,
    "Flat": """
        struct Flat {
            int32_t rows;
            int32_t columns;
            double grid[rows][columns];
        }
    """,
}


@pytest.fixture(scope="session")
def odd(tmp_path_factory):
    """The module of the types above, below a prefix as users' own packages will be."""
    folder = tmp_path_factory.mktemp("odd")
    for name, struct in ODD_TYPES.items():
        (folder / f"{name}.lcm").write_text(f"package odd;\n{struct}")
    sources = [str(path) for path in sorted(folder.glob("*.lcm"))]
    options = ["--python", "--ppath", str(folder), "--package-prefix", "odd_prefix"]
    assert lcm.run_script("lcm-gen", [*options, *sources]) == 0
    sys.path.insert(0, str(folder))
    yield importlib.import_module("odd_prefix.odd")
    sys.path.remove(str(folder))
    for name in [name for name in sys.modules if name.startswith("odd_prefix")]:
        del sys.modules[name]
