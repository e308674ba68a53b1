# Every target makes the virtual environment it needs first; once that is made, no network is used.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
SEEDS ?= 20

comma := ,
EVERYTHING = --editable '.[maps,render,video,study,ray,slurm,dev]'

# A virtual environment, with what these options of pip say. A module is compiled when it is imported; most never are.
define install_into
$(PYTHON) -m venv $(1)
	$(1)/bin/python -m pip install --quiet --disable-pip-version-check --no-compile $(2)
endef

# The tests in a virtual environment.
define test_in
$(1)/bin/python -m swarm_gym.warm_up
	$(1)/bin/python -m pytest -n auto
endef

.DEFAULT_GOAL := help
.NOTPARALLEL:
.PHONY: help install browser study study-full test test-slow test-supply test-lowest test-newest fuzz check format \
    benchmark benchmark-peers benchmark-scaling docs-results docs-study docs-moa docs-iafsa docs-brand-yu docs-dynamic \
    docs-scaling docs-gallery clean

help: ## show this list
	@grep -E '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "%-16s %s\n", $$1, $$2}'

install: $(INSTALLED) ## make the virtual environment

$(INSTALLED): pyproject.toml constraints.txt
	@echo "== installing into $(VENV) (once; a few minutes)"
	$(call install_into,$(VENV),--constraint constraints.txt $(EVERYTHING))
	@touch $@

browser: $(INSTALLED) ## find or install Chromium, which the tests of reports look at pages with
	@for name in chromium chromium-browser google-chrome google-chrome-stable; do command -v $$name && exit; done; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get > /dev/null; then \
	    apt-get -qq update && apt-get -qq --yes --no-install-recommends install chromium fonts-dejavu-core > /dev/null; \
	else $(BIN)/python -m playwright install chromium; fi

study: $(INSTALLED) ## run the paper's study; its tables, figures and report.html are in results/paper then
	@echo "== the paper's study, $(SEEDS) seeds: controllers x cases x seeds, then tables and figures"
	$(BIN)/python -m experiments.evaluate --suite paper --seeds $(SEEDS)
	$(BIN)/python -m experiments.report results/paper.sqlite

STUDY_SUITES = headline generalisation out-of-distribution ablation parameters

study-full: $(INSTALLED) ## run all suites of the study into results/study; OFFLINE=1: from its databases alone
	@for suite in $(STUDY_SUITES); do \
	    echo "== suite $$suite"; \
	    $(BIN)/python -m experiments.evaluate --suite $$suite --output results/study \
	        $(if $(filter 1,$(OFFLINE)),--no-simulate) || exit 1; \
	done

test: $(INSTALLED) ## run the tests
	@echo "== compiling the kernels"
	$(BIN)/python -m swarm_gym.warm_up
	@echo "== running the tests"
	$(BIN)/python -m pytest -n auto

test-slow: $(INSTALLED) ## run the tests that take minutes, and those of all kernels with the JIT off and with bounds checks on
	$(BIN)/python -m swarm_gym.warm_up
	@echo "== running the slow tests"
	$(BIN)/python -m pytest -n auto -m slow
	@echo "== any input: 10,000 examples of each"
	$(BIN)/python -m pytest -n auto -m fuzzed --hypothesis-profile=thorough
	@echo "== kernels as plain Python"
	NUMBA_DISABLE_JIT=1 $(BIN)/python -m pytest -n auto $(KERNEL_TESTS)
	@echo "== compiling the kernels with bounds checks"
	NUMBA_BOUNDSCHECK=1 $(BIN)/python -m swarm_gym.warm_up
	NUMBA_BOUNDSCHECK=1 $(BIN)/python -m pytest -n auto $(KERNEL_TESTS) tests/swarm_gym/test_vector_env.py \
	    tests/swarm_gym/controllers/test_schedules.py tests/reliability/test_determinism.py
	@$(MAKE) test-supply

KERNEL_TESTS = $(addprefix tests/swarm_gym/,compiler problem optimizers test_population.py test_golden.py \
    scenarios/test_test_functions.py)

NEWEST = .venv-newest-$(notdir $(PYTHON))
PYTHONS = python3.11 python3.12 python3.13 python3.14

test-supply: ## run the tests with the lowest versions allowed, and with the newest on every Python there is
	@$(MAKE) test-lowest
	@for python in $(PYTHONS); do \
	    if $$python --version > /dev/null 2>&1; then $(MAKE) test-newest PYTHON=$$python || exit 1; \
	    else echo "== no $$python here: skipped"; fi; \
	done

test-newest: ## run the tests with the newest versions there are, on PYTHON
	@echo "== installing the newest versions into $(NEWEST)"
	rm -rf $(NEWEST)
	$(call install_into,$(NEWEST),$(EVERYTHING))
	$(call test_in,$(NEWEST))

test-lowest: pyproject.toml constraints-lowest.txt ## run the tests with the lowest versions allowed
	@echo "== installing the lowest versions into .venv-lowest"
	$(call install_into,.venv-lowest,--constraint constraints-lowest.txt $(EVERYTHING))
	$(call test_in,.venv-lowest)

SECONDS = 3600

fuzz: .venv-fuzz/.installed ## fuzz the parsers of files for SECONDS; finds are kept in tests/reliability/fuzz_finds
	PYTHONPATH=.:tests:tests/reliability .venv-fuzz/bin/python tests/reliability/fuzz.py --seconds $(SECONDS)

.venv-fuzz/.installed: pyproject.toml constraints.txt
	@echo "== installing a fuzzer into .venv-fuzz"
	$(call install_into,.venv-fuzz,--constraint constraints.txt --editable '.[maps$(comma)fuzz]')
	@touch $@

check: $(INSTALLED) ## lint, formatting, types, layers
	@echo "== ruff, mypy, import-linter"
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(INSTALLED) ## format the sources
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

benchmark: $(INSTALLED) ## measure speed, write results/benchmark (about four minutes)
	@echo "== benchmark (keep the machine quiet)"
	$(BIN)/python -m swarm_gym.warm_up
	$(BIN)/python -m experiments.benchmark

benchmark-peers: .venv-peers/.installed ## the same beside other libraries, in an environment of its own
	@echo "== benchmark beside other libraries (keep the machine quiet)"
	.venv-peers/bin/python -m swarm_gym.warm_up
	.venv-peers/bin/python -m experiments.speed.peers

.venv-peers/.installed: pyproject.toml constraints.txt
	@echo "== installing other libraries into .venv-peers"
	$(call install_into,.venv-peers,--constraint constraints.txt --editable '.[peers]')
	@touch $@

docs-results: $(INSTALLED) benchmark-peers benchmark ## regenerate what the documents show: 1000 seeds, speed, pictures (15 minutes)
	$(BIN)/python -m experiments.evaluate --suite paper --seeds 1000 --output results/docs
	$(BIN)/python -m experiments.publish results/docs/paper results/benchmark
	$(BIN)/python -m experiments.frame docs/results/frame.png
	$(BIN)/python -m experiments.video --iterations 60 --output docs/results/video.gif

docs-study: study-full ## fill docs/study.md from all suites of the study; OFFLINE=1: from what is in results/study
	$(if $(filter 1,$(OFFLINE)),,$(BIN)/python -m experiments.sensitivity --output results/study/sensitivity)
	$(if $(filter 1,$(OFFLINE)),,$(BIN)/python -m experiments.branching --output results/study/branching)
	$(BIN)/python -m experiments.publish_study results/study

docs-moa: $(INSTALLED) ## regenerate docs/moa-paper.md; needs the map den400d (two minutes)
	$(BIN)/python -m experiments.evaluate --suite moa-paper --output results/docs
	$(BIN)/python -m experiments.publish_suite results/docs/moa-paper docs/moa-paper.md

docs-iafsa: $(INSTALLED) ## regenerate docs/iafsa-paper.md; needs the maps turtlebot3_world and playground (15 minutes)
	$(BIN)/python -m experiments.evaluate --suite iafsa-paper --output results/docs
	$(BIN)/python -m experiments.publish_suite results/docs/iafsa-paper docs/iafsa-paper.md

docs-brand-yu: $(INSTALLED) ## regenerate docs/brand-yu-paper.md
	$(BIN)/python -m experiments.evaluate --suite brand-yu --output results/docs
	$(BIN)/python -m experiments.publish_suite results/docs/brand-yu docs/brand-yu-paper.md

docs-dynamic: $(INSTALLED) ## regenerate docs/dynamic.md
	$(BIN)/python -m experiments.evaluate --suite dynamic --output results/docs
	$(BIN)/python -m experiments.publish_suite results/docs/dynamic docs/dynamic.md

benchmark-scaling: $(INSTALLED) ## measure what Ray adds on logical nodes, and predict clusters: results/scaling (15 minutes)
	@echo "== benchmark of backends (keep the machine quiet)"
	$(BIN)/python -m experiments.scaling

docs-scaling: benchmark-scaling ## the same, into docs/scaling.md
	$(BIN)/python -m experiments.publish_suite results/scaling docs/scaling.md

docs-gallery: $(INSTALLED) ## regenerate docs/gallery.md, every optimizer on every kind of map
	$(BIN)/python -m experiments.gallery

clean: ## delete environments, caches and results (not trained policies)
	rm -rf $(VENV) .venv-lowest .venv-newest-* .venv-fuzz .venv-peers build results .pytest_cache .mypy_cache .ruff_cache .hypothesis \
	    .import_linter_cache *.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
