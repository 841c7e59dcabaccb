# make demo       a virtual environment, the installation, and the Husky lab as a script
# make test       the same environment, and the tests that a change should pass at once
# make test-slow  the faults suite, the labs, every block of the documents, several hosts, programs of others
# make test-root  what only root can do, where the others were run as an ordinary user
# make docs       docs/wtf.md and docs/commands.md, from the rules of wtf and the commands
# make man        the man pages, into build/man; a built wheel has them
# make bench      what is measured, beside its anchor and its goal, in one table
# make check      types fresh, ruff, mypy, import rules, spelling

# the first that is new enough; where there is none, uv brings its own
PYTHON ?= $(shell for python in python3 python3.14 python3.13 python3.12 python3.11 python3.10; do \
  $$python -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null && \
  command -v $$python && break; done)
VENV ?= .venv
# how many tests run at a time beside those without a bus: many of them wait; simulators do not
JOBS ?= 4
SLOW_JOBS ?= 3
# -e: sources are used in place; empty: what is installed is what a user would get
EDITABLE ?= -e
BIN := $(VENV)/bin
PURE := $(addprefix tests/,unit doctor files types house cli)
LIVE := $(addprefix tests/,process physics)
# so that both lanes of `make test` take as long; the live view of spy waits for its screen, too
MOVED := $(addprefix tests/unit/,cli/spy labs)
TIMED = $(shell grep -rl mark.timing $(PURE) $(LIVE))
SLOW := $(addprefix tests/,faults labs docs hosts interop gui cpp endure)
SOURCES := lcmtools sim tests bench lcm_types hatch_build.py docs/man_pages.py docs/wtf_page.py docs/commands_page.py docs/ros_equivalents.py

.PHONY: demo test pure live test-slow test-root check javascript commands types docs man format bench clean

demo: $(VENV)/.installed
	@echo "Running the Husky lab as a script, without a window: about a minute"
	PATH="$(abspath $(BIN)):$$PATH" labs/husky/lab.sh
	@echo
	@echo "To see the robot live, in the browser, type:"
	@echo "    . $(BIN)/activate"
	@echo "    lcmtools lab start husky"

# Two lanes side by side: plain logic in one process, so that it is collected once; processes and
# physics in several. What depends on the processor (the mark timing) comes last, one by one.
test: $(VENV)/.installed-dev
	$(BIN)/python bench/suite_time.py $(MAKE) --no-print-directory -k -j2 pure live
	$(BIN)/pytest -m timing $(TIMED) $(ARGS)

# the durations of all tests are in build/pure.xml and build/live.xml
pure: $(VENV)/.installed-dev
	$(BIN)/pytest -q -m "not timing" --durations=25 --junitxml=build/pure.xml \
	  $(addprefix --ignore=,$(MOVED)) $(PURE) $(ARGS)

live: $(VENV)/.installed-dev
	$(BIN)/pytest -n $(JOBS) --dist worksteal -m "not timing" --durations=25 --junitxml=build/live.xml \
	  $(LIVE) $(MOVED) $(ARGS)

# The physics tests run with pybullet above, where it is installed, and with MuJoCo here.
test-slow: $(VENV)/.installed-dev
	$(BIN)/pytest -n $(SLOW_JOBS) --dist worksteal $(SLOW) $(ARGS)
	LCMTOOLS_ENGINE=mujoco $(BIN)/pytest -n $(SLOW_JOBS) --dist worksteal tests/physics $(ARGS)

# what only root can do: networks and hosts of a test's own
test-root: $(VENV)/.installed-dev
	$(BIN)/pytest -n $(SLOW_JOBS) --dist worksteal -m root tests $(ARGS)

check: $(VENV)/.installed-dev
	$(BIN)/python lcm_types/generate.py --check
	$(BIN)/ruff check $(SOURCES)
	$(BIN)/ruff format --check $(SOURCES)
	$(BIN)/mypy
	$(BIN)/mypy --platform darwin --cache-dir .mypy_cache/darwin  # calls that only Linux has
	$(BIN)/lint-imports
	@if command -v npm >/dev/null; then $(MAKE) --no-print-directory javascript; \
	else echo "npm is not there: the window's JavaScript is not checked"; fi
	$(BIN)/codespell README.md ARCHITECTURE.md CONTRIBUTING.md CHANGELOG.md docs/*.md labs lcm_types lcmtools sim

# the window's JavaScript: its types, by the version in tests/gui/package-lock.json
javascript: build/npm/.installed
	build/npm/node_modules/.bin/tsc --project tests/gui

build/npm/.installed: tests/gui/package.json tests/gui/package-lock.json
	mkdir -p build/npm
	cp $^ build/npm/
	npm ci --prefix build/npm --silent --no-audit --no-fund
	touch $@

commands: $(VENV)/.installed-dev
	$(BIN)/python -m lcmtools.cli.completion.from_click

types: $(VENV)/.installed-dev
	$(BIN)/python lcm_types/generate.py

docs: $(VENV)/.installed-dev
	$(BIN)/python docs/wtf_page.py
	$(BIN)/python docs/commands_page.py

man: $(VENV)/.installed-dev
	$(BIN)/python docs/man_pages.py build/man

format: $(VENV)/.installed-dev
	$(BIN)/ruff check --fix $(SOURCES)
	$(BIN)/ruff format $(SOURCES)

bench: $(VENV)/.installed-dev
	$(BIN)/python bench/goals.py $(ARGS)

$(VENV)/.venv:
	@echo "Creating a virtual environment in $(VENV)"
	@if [ -n "$(PYTHON)" ]; then \
	  $(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || { \
	    echo "lcmtools needs Python 3.10 or newer, and $(PYTHON) is $$($(PYTHON) --version)" >&2; exit 1; }; \
	  $(PYTHON) -m venv $(VENV); \
	elif command -v uv >/dev/null; then \
	  uv venv --quiet --seed --python '>=3.10' $(VENV); \
	else \
	  echo "lcmtools needs Python 3.10 or newer: install one, or uv (https://docs.astral.sh/uv/)" >&2; \
	  exit 1; \
	fi
	@touch $@

$(VENV)/.installed: pyproject.toml | $(VENV)/.venv
	@echo "Installing lcmtools with the simulator, the window and the plots: about 500 MB, a few minutes"
	$(BIN)/pip install --disable-pip-version-check $(EDITABLE) '.[plot,sim,tui,view,web]'
	touch $@

$(VENV)/.installed-dev: pyproject.toml | $(VENV)/.venv
	$(BIN)/pip install --quiet --disable-pip-version-check $(EDITABLE) '.[sim,dev]'
	touch $@

clean:
	rm -rf $(VENV) build dist .pytest_cache .mypy_cache .ruff_cache .import_linter_cache
