# Everything runs in .venv, which the first target that needs it creates.
# Another interpreter: make PYTHON=python3.12 test

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check install --quiet --no-compile -c constraints.txt
RUN := $(VENV)/.installed
DEV := $(VENV)/.installed-dev
WORKERS ?= 2
PYTEST := $(BIN)/python -m pytest -n $(WORKERS) --dist loadscope
heading = @printf '\n== %s ==\n' '$(1)'

# Measured records that are not part of the repository; where they exist, tests must use them.
ifneq ($(wildcard ../shared/data/.),)
export STICKSLIP_DATA ?= $(abspath ../shared/data)
export REQUIRE_DATA ?= 1
endif

# Tests, examples and pages share their machine code, so that nothing is compiled twice.
unit docs slow kernels: export STICKSLIP_CACHE ?= $(or $(TMPDIR),/tmp)/stickslip/tests
# The cores are taken by the workers: more threads only wait for each other.
unit docs slow kernels: export OPENBLAS_NUM_THREADS ?= 1
unit docs slow kernels: export STICKSLIP_THREADS ?= 1
# Nothing is compiled beside what is measured or tested.
unit docs slow kernels bench: export STICKSLIP_BACKGROUND ?= 0
# Nor is Python text compiled anew by each process, or are assertions rewritten by each worker.
unit docs slow kernels: export PYTHONDONTWRITEBYTECODE :=

.DEFAULT_GOAL := help
.PHONY: help select test stubs lint types architecture unit docs bench slow kernels lowest newest package fuzz format clean

help: ## list the targets
	@sed -n 's/^\([a-z]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 14

select: $(RUN) ## run the main job on the bundled rig; the report goes to demo-report/
	$(BIN)/stickslip demo --force

# Side by side: what waits for one compiler would leave cores idle.
test: $(DEV) ## run every check but the slow tests and the documentation
	$(MAKE) --no-print-directory --jobs 2 --output-sync=line lint types architecture unit

stubs: $(DEV) ## write the stubs of packages that load their names lazily
	$(BIN)/python tools/stubs.py

lint: $(DEV) ## formatting, lint rules and sections of docstrings
	$(call heading,ruff format --check)
	$(BIN)/ruff format --check .
	$(call heading,ruff check)
	$(BIN)/ruff check .
	$(call heading,docstrings)
	$(BIN)/python -m tools.docstrings

types: $(DEV) ## static types, on this system and on Windows
	$(call heading,mypy)
	$(BIN)/mypy
	$(BIN)/mypy --platform win32 --cache-dir .mypy_cache/win32

architecture: $(DEV) ## import contracts, and the size of each room beside its budget
	$(call heading,lint-imports)
	$(BIN)/lint-imports
	$(BIN)/python -m tools.budget

unit: $(DEV) ## tests and the examples in docstrings
	$(call heading,pytest)
	$(PYTEST) --doctest-modules tests src

docs: $(DEV) ## documentation in docs/_build/html, warnings are errors
	$(call heading,docs)
	rm -rf docs/reference/generated
	$(BIN)/python -m sphinx -j $(WORKERS) -E -W --keep-going -q -b html docs docs/_build/html
	$(BIN)/python docs/check_offline.py docs/_build/html
	$(BIN)/python -m tools.site docs/_build/html --check

bench: $(DEV) ## benchmarks
	$(BIN)/python -m benchmarks

# All of them, or those of some folders.
SLOW ?= tests
slow: $(DEV) ## tests that take long, which `make test` leaves out, and all examples of random ones
	HYPOTHESIS_PROFILE=thorough $(PYTEST) -m 'slow or hypothesis' $(SLOW)

kernels: $(DEV) ## what decides something, under other kernels of linear algebra and machine code
	$(call heading,kernels)
	WORKERS=$(WORKERS) $(BIN)/python -m tools.kernels

# A part of the tests, which meets every dependency.
SMOKE := tests/test_simulation.py tests/test_tables.py tests/cli/test_commands.py \
  tests/cli/test_doctor.py tests/cli/test_extras.py tests/cli/test_records.py tests/cli/test_terminal.py \
  tests/data/test_logs.py tests/data/test_units.py \
  tests/identify/test_resting_joints.py tests/identify/test_tables.py tests/identify/kinds/test_travel_verdict.py \
  tests/show/plots/test_axes.py tests/show/report/test_page.py tests/study/sweep/test_bands.py
EXTRAS := dask logs mdf optimise parquet sensitivity tdms xarray xlsx
comma := ,
space := $(subst ,, )
FRESH := -m pip --disable-pip-version-check install --quiet --no-compile --only-binary :all:
TESTING := pytest pytest-xdist hypothesis
lowest newest: export OPENBLAS_NUM_THREADS ?= 1
lowest newest: export STICKSLIP_THREADS ?= 1

# Indirect dependencies are the newest, whose warnings about the lowest direct ones are no fault.
lowest: ## tests with the lowest versions of the dependencies that pyproject.toml allows
	$(PYTHON) -m venv --clear .venv-lowest
	$(PYTHON) tools/lowest.py $(EXTRAS) > .venv-lowest/lowest.txt
	.venv-lowest/bin/python $(FRESH) -r .venv-lowest/lowest.txt -e . $(TESTING)
	.venv-lowest/bin/python -m pytest -n $(WORKERS) --dist loadscope -p no:cacheprovider -W ignore::DeprecationWarning $(SMOKE)

# PRE=--pre also takes versions that are not released yet.
newest: ## the same tests with the newest versions, whatever constraints.txt says
	$(PYTHON) -m venv --clear .venv-newest
	.venv-newest/bin/python $(FRESH) --upgrade $(PRE) -e '.[$(subst $(space),$(comma),$(EXTRAS))]' $(TESTING)
	.venv-newest/bin/python -m pip list
	.venv-newest/bin/python -m pytest -n $(WORKERS) --dist loadscope -p no:cacheprovider $(if $(PRE),-W ignore::DeprecationWarning -W ignore::FutureWarning) $(SMOKE)

package: ## build wheel and sdist in dist/, install them in empty environments, follow the README there
	$(PYTHON) -m tools.package

fuzz: $(DEV) ## 42,000 random simulations, half of them of several contacts (two hours); tests run 250
	$(BIN)/python -m tests.properties.fuzzing --cases 20000 --seed 1 --processes $(WORKERS)
	$(BIN)/python -m tests.properties.fuzzing --cases 20000 --seed 2 --several --tier compiled --structures 0 --steps 2000 --seconds 30 --tiers 100 --processes $(WORKERS)
	$(BIN)/python -m tests.properties.fuzzing --cases 2000 --seed 3 --loops --tier compiled --structures 0 --steps 2000 --seconds 30 --processes $(WORKERS)

format: $(DEV) ## format the code and apply safe fixes
	$(BIN)/ruff check --fix-only .
	$(BIN)/ruff format .

clean: ## remove builds and caches; .venv and reports stay
	rm -rf build dist docs/_build docs/reference/generated
	rm -rf .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	find src tests benchmarks docs -name __pycache__ -type d -prune -exec rm -rf {} + 2>/dev/null || true

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit("Python 3.11 or newer is needed." if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); exit 1; }

$(RUN): pyproject.toml constraints.txt | $(BIN)/python
	@echo 'Installing the package (half a minute or more).'
	$(PIP) -e .
	@touch $@

$(DEV): pyproject.toml constraints.txt | $(BIN)/python
	@echo 'Installing the package and its tools (a minute or more).'
	$(PIP) -e '.[dev]'
	@touch $(RUN) $@
