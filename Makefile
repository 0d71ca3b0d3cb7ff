# Every target makes the environment in .venv/ when it is missing or stale, and needs nothing but make and a Python.
VENV := .venv
RUN := $(VENV)/bin
# Without PYTHON=... an environment that is there keeps its Python, whatever other environment the shell has activated.
PYTHON ?= $(shell test -x $(RUN)/python && echo $(RUN)/python || echo python3)
WITH_PATH := PATH="$(CURDIR)/$(RUN):$$PATH"
# A sourced ROS 2 brings pytest plugins that are not made for this pytest.
PYTEST_OPTIONS := $(if $(ROS_DISTRO),-p no:launch_testing -p no:launch_ros)
# Tests start hundreds of processes: without bytecode each would compile every package that it imports.
unexport PYTHONDONTWRITEBYTECODE
# The community's rclpy on PyPI is built for this one.
PYTHON_OF_RCLPY ?= python3.12
# How long each trial of `make hostile` goes on, and what it is drawn from.
HOSTILE_SECONDS := 20
HOSTILE_SEED := 1
# How many places of each group `make mutants` changes, what they are drawn from, and after how long each group ends.
MUTANTS := 60
MUTANTS_SEED := 1
MUTANTS_MINUTES := 20
# What the diagnosis scored in the small exam when its answers last changed: raise it with the score.
EXAM_MARK := 0.9
TYPED := eha_core/eha_core eha_exam/eha_exam eha_sim_node/eha_sim_node rclpy_dds/rclpy_dds tools

.DEFAULT_GOAL := help
.PHONY: help env test lint demo demo-realtime controllers contract bench docs wheels exam hostile mutants

help:  ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 24

env:  ## make .venv/, or bring it up to date; PYTHON=... makes it anew with another interpreter (3.10 to 3.13)
	@$(PYTHON) tools/make_env.py $(VENV)

test: lint  ## lint, types, architecture and every test
	$(WITH_PATH) $(RUN)/python -m pytest $(PYTEST_OPTIONS) --numprocesses 2 --durations 30

lint: env  ## style, types and the walls between the packages
	$(RUN)/ruff check .
	$(RUN)/ruff format --check .
	$(RUN)/mypy $(TYPED)
	$(RUN)/lint-imports --no-cache

contract: env  ## the contract tests on a real rclpy from PyPI (x86_64; PYTHON_OF_RCLPY=python3.12), then with it
	@$(PYTHON_OF_RCLPY) -c "import sys; sys.exit(sys.version_info[:2] != (3, 12))" || \
	    { echo "PYTHON_OF_RCLPY=$(PYTHON_OF_RCLPY) is no Python 3.12; name one" >&2; exit 2; }
	test -x .venv-rclpy/bin/pytest || { $(PYTHON_OF_RCLPY) -m venv .venv-rclpy && \
	    .venv-rclpy/bin/pip install --quiet setuptools==79.0.1 && \
	    .venv-rclpy/bin/pip install --quiet --requirement requirements/rclpy.txt; }
	$(WITH_PATH) .venv-rclpy/bin/python -m pytest rclpy_dds/tests/contract -rs -p no:launch_testing \
	    --timeout=120 --timeout-method=thread -p no:cacheprovider -W ignore::DeprecationWarning
	$(WITH_PATH) $(RUN)/python -m pytest rclpy_dds/tests/peers

demo: env  ## the paper's experiment over DDS, a concealed rig diagnosed, one that interrogates itself; in out/demo/
	$(WITH_PATH) $(RUN)/python examples/paper_demo.py
	$(WITH_PATH) $(RUN)/python examples/concealed_demo.py
	$(WITH_PATH) $(RUN)/python examples/investigation_demo.py

demo-realtime: env  ## the same against the wall clock
	$(WITH_PATH) $(RUN)/python examples/paper_demo.py --realtime

controllers: env  ## every controller over leakage and concealed friction, on the nodes; all in out/controllers/
	$(WITH_PATH) $(RUN)/python examples/compare_controllers.py

bench: env  ## speed as ratios to named peers; BENCHMARKS="layer node" for some
	$(WITH_PATH) $(RUN)/python -m benchmarks $(BENCHMARKS)

docs: env  ## the documentation's site in out/docs/, its links checked
	$(RUN)/pip install --quiet --disable-pip-version-check --requirement requirements/docs.txt
	NO_MKDOCS_2_WARNING=1 $(RUN)/mkdocs build --strict --quiet

wheels: env  ## build wheels in out/wheels, install them into a clean environment, and use them there
	$(RUN)/python tools/check_wheels.py out/wheels

exam: env  ## a small fixed exam of the diagnosis, which fails when fewer cases than its mark are right
	rm -rf out/exam_mark
	$(WITH_PATH) $(RUN)/eha exam --cases 10 --seed 2026 --jobs 2 --out out/exam_mark --require $(EXAM_MARK)

hostile: env  ## mutated files, killed recorders, hostile commands and nodes under attack; fails where one does harm
	$(WITH_PATH) $(RUN)/python -m tools.hostile --seconds $(HOSTILE_SECONDS) --seed $(HOSTILE_SEED)

mutants: env  ## whether quick tests notice small changes in plant, recording, verdict; GROUPS="plant" for some
	$(RUN)/pip install --quiet --disable-pip-version-check --requirement requirements/mutants.txt
	$(WITH_PATH) $(RUN)/python -m tools.mutants --places $(MUTANTS) --seed $(MUTANTS_SEED) --minutes $(MUTANTS_MINUTES) $(GROUPS)
