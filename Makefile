# make demo       a virtual environment, the installation, and the Husky lab as a script
# make test       the same environment, and the tests that a change should pass at once
# make test-slow  the faults suite, the labs, every block of the documents, several hosts
# make man        the man pages, into build/man; a built wheel has them
# make check      types fresh, ruff, mypy, import rules, spelling

# pybullet has wheels for Python 3.9 to 3.11; an interpreter that it fits is preferred
PYTHON ?= $(shell command -v python3.11 || command -v python3.10 || command -v python3)
VENV ?= .venv
# how many tests run at a time: more than processors, for many of them wait; simulators do not
JOBS ?= 4
SLOW_JOBS ?= 3
# -e: sources are used in place; empty: what is installed is what a user would get
EDITABLE ?= -e
BIN := $(VENV)/bin
FAST := $(addprefix tests/,unit house cli physics process)
SLOW := $(addprefix tests/,faults labs docs hosts)
SOURCES := lcmtools sim tests bench lcm_types hatch_build.py docs/man_pages.py

.PHONY: demo test test-slow check types man format bench clean

demo: $(VENV)/.installed
	PATH="$(abspath $(BIN)):$$PATH" labs/husky/lab.sh

# What depends on the processor (the mark timing) comes last, one after the other.
test: $(VENV)/.installed-dev
	$(BIN)/pytest -n $(JOBS) --dist worksteal -m "not timing" $(FAST) $(ARGS)
	$(BIN)/pytest -m timing $(FAST) $(ARGS)

test-slow: $(VENV)/.installed-dev
	$(BIN)/pytest -n $(SLOW_JOBS) --dist worksteal $(SLOW) $(ARGS)

check: $(VENV)/.installed-dev
	$(BIN)/python lcm_types/generate.py --check
	$(BIN)/ruff check $(SOURCES)
	$(BIN)/ruff format --check $(SOURCES)
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/codespell README.md ARCHITECTURE.md CONTRIBUTING.md CHANGELOG.md docs/*.md labs lcm_types lcmtools sim

types: $(VENV)/.installed-dev
	$(BIN)/python lcm_types/generate.py

man: $(VENV)/.installed-dev
	$(BIN)/python docs/man_pages.py build/man

format: $(VENV)/.installed-dev
	$(BIN)/ruff check --fix $(SOURCES)
	$(BIN)/ruff format $(SOURCES)

bench: $(VENV)/.installed-dev
	for script in $(filter-out bench/common.py bench/commands.py bench/compared.py,$(wildcard bench/*.py)); do echo "== $$script"; $(BIN)/python $$script || exit 1; done

$(VENV)/.venv:
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 11))' || { \
	  echo "the simulator's pybullet has no wheel for $$($(PYTHON) --version); type:" >&2; \
	  echo '  uv python install 3.11 && make $(MAKECMDGOALS) PYTHON="$$(uv python find 3.11)"' >&2; \
	  exit 1; }
	$(PYTHON) -m venv $(VENV)
	touch $@

$(VENV)/.installed: pyproject.toml | $(VENV)/.venv
	$(BIN)/pip install --quiet --disable-pip-version-check $(EDITABLE) '.[sim,tui,view]'
	touch $@

$(VENV)/.installed-dev: pyproject.toml | $(VENV)/.venv
	$(BIN)/pip install --quiet --disable-pip-version-check $(EDITABLE) '.[sim,dev]'
	touch $@

clean:
	rm -rf $(VENV) build dist .pytest_cache .mypy_cache .ruff_cache .import_linter_cache
