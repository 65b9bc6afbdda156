# Pad Studio: `make run` serves the studio, `make test` checks everything. Both set up what is missing.

VENV   := .venv
PYTHON := $(VENV)/bin/python
STAMPS := $(VENV)/.stamps

# The first Python of 3.11 or later among the usual names.
BASE_PYTHON ?= $(shell for p in python3 python3.14 python3.13 python3.12 python3.11; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && break; done)

ARGS ?=

# Debian and Ubuntu part the venv module from Python.
SUDO := $(shell [ "$$(id -u)" -eq 0 ] || echo sudo)
INSTALL_VENV = command -v apt-get >/dev/null && $(SUDO) apt-get update -qq \
	&& $(SUDO) apt-get install -y -qq $(notdir $(BASE_PYTHON))-venv && $(BASE_PYTHON) -m venv $(VENV)

.DEFAULT_GOAL := help
.PHONY: help install run test check shootout bench reproduction soak fuzz clean

help:
	@echo 'make install   set up $(VENV) with the locked dependencies'
	@echo 'make run       serve the studio on http://127.0.0.1:8000   (ARGS="--port 9000")'
	@echo 'make test      check, then all tests, those in a browser included   (ARGS="-k camera")'
	@echo 'make check     lint, formatting and types'
	@echo 'make shootout  the readers of other boards that padstudio shootout compares with'
	@echo 'make bench     benchmarks   (ARGS="covariance --only far")'
	@echo 'make reproduction  docs/reproduction.md, made anew   (ARGS="--seeds 20")'
	@echo 'make soak      a server under kills, full disks and restarts   (ARGS="--minutes 20")'
	@echo 'make fuzz      readers of files from outside   (ARGS="--minutes 60 camera")'
	@echo 'make clean     remove $(VENV) and caches'

install: $(STAMPS)/package

$(PYTHON):
	@test -n '$(BASE_PYTHON)' || { echo 'error: Python 3.11 or newer is needed' >&2; exit 1; }
	@$(BASE_PYTHON) -m venv $(VENV) || { rm -rf $(VENV); $(INSTALL_VENV); } || { rm -rf $(VENV); \
		echo 'error: $(BASE_PYTHON) cannot make virtual environments' >&2; exit 1; }

# uv installs the locked set in seconds where pip takes a minute.
$(STAMPS)/uv: | $(PYTHON)
	@mkdir -p $(STAMPS)
	$(PYTHON) -m pip install --quiet --disable-pip-version-check uv==0.13.9
	@touch $@

$(STAMPS)/lock: requirements.lock $(STAMPS)/uv
	$(VENV)/bin/uv pip install --quiet --python $(PYTHON) --require-hashes -r requirements.lock
	@touch $@

$(STAMPS)/package: pyproject.toml $(STAMPS)/lock
	$(VENV)/bin/uv pip install --quiet --python $(PYTHON) --no-deps --no-build-isolation -e .
	$(PYTHON) -m padstudio.warm
	@touch $@

run: install
	@exec $(VENV)/bin/padstudio serve $(ARGS)

check: install
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy

# The browser and the PDF reader that tests use: what is installed, else the distribution's.
$(STAMPS)/tools: tests/install-tools.sh
	@mkdir -p $(STAMPS)
	sh tests/install-tools.sh
	@touch $@

# The tests start hundreds of processes: without bytecode each of them compiles all it imports.
test: export PYTHONDONTWRITEBYTECODE :=
test: check $(STAMPS)/tools $(STAMPS)/shootout
	$(PYTHON) tests/support/compile_loops.py
	$(PYTHON) -m pytest -n auto --dist loadfile --no-loadscope-reorder $(ARGS)

# Other makers' readers of boards, which only the shoot-out uses: where they cannot be installed,
# the shoot-out says so and goes on.
$(STAMPS)/shootout: requirements-shootout.lock $(STAMPS)/lock
	-$(VENV)/bin/uv pip install --quiet --python $(PYTHON) --no-deps --require-hashes -r $<
	@touch $@

shootout: install $(STAMPS)/shootout

bench: install
	$(PYTHON) tests/benchmarks/run.py $(ARGS)

# The page of the documentation that is made by the program: whenever a method has changed.
reproduction: install
	mkdir -p build
	$(VENV)/bin/padstudio reproduce -o build/reproduction --page docs/reproduction.md --force $(ARGS)

# Kills, full disks, restarts of the database and clocks that are set, while flights are worked on;
# what this machine has no means for is said and left out.
soak: install $(STAMPS)/tools
	$(PYTHON) tests/soak/run.py $(ARGS)

fuzz: install
	$(PYTHON) tests/fuzz/run.py $(ARGS)

clean:
	find backend -name __pycache__ -type d -exec rm -rf {} +
	rm -rf $(VENV) .mypy_cache .pytest_cache .ruff_cache .hypothesis dist build
