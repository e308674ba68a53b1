# Every target makes the virtual environment it needs first; once that is made, no network is used.
# Virtual environments on Windows have another layout. Nobody has tried these targets on Windows yet.
ifeq ($(OS),Windows_NT)
PYTHON ?= python
SCRIPTS := Scripts
else
PYTHON ?= python3
SCRIPTS := bin
endif
VENV ?= .venv
BIN := $(VENV)/$(SCRIPTS)
INSTALLED := $(VENV)/.installed
SEEDS ?= 20
SECONDS = 3600
comma := ,
EXTRAS = maps,terrain,render,video,study,planners,adapters,ray,slurm
EVERYTHING = --editable '.[$(EXTRAS)]' --group docs --group dev
# Packages that rows over terrain compare with. mealpy asks for NumPy 1.26 or older and works with newer ones.
WITHOUT_NEEDS = mealpy==3.0.3
EIGHT_TERRAINS = terrain:test:0-3 terrain:test:28-31
# Terrains that no choice was made on, for what the test terrains had shown.
FRESH_TERRAINS = terrain:validation-few:1000-1027 terrain:validation-many:1000-1027
# Rows over terrain of 100,000 evaluations, without planned flights and with them.
UNPLANNED = "PSO, spherical, uniform" "L-SHADE, spherical, uniform" "L-SHADE, waypoints, uniform" "L-SHADE, waypoints, smooth" "multivariate, waypoints, smooth"
PLANNED = "L-SHADE, waypoints, guided" "fireflies, waypoints, guided" "multivariate, waypoints, guided" "CMA-ES, waypoints, guided" "L-SHADE, SPSFA-TIP, tuned, waypoints" "linear reduction, waypoints, guided" "linear reduction, shifted, guided" "L-SHADE, learned, size and phi" "L-SHADE, learned, with sources, waypoints" "planned flight"
# Of each library the row with the least mean excess after 2,500 evaluations.
LIBRARIES = "cmaes CMA-ES, spherical" "pymoo DE, waypoints" "niapy L-SHADE, waypoints" "mealpy L-SHADE, waypoints"
# Tables over terrain share their runs. Run again, these commands make no run: they measure all tables from the
# same best known flights, which the first pass may have improved.
RUNS_OVER_TERRAIN = $(BIN)/python -m experiments.terrain --runs 31 --runs-folder results/terrain/runs
TERRAIN = $(RUNS_OVER_TERRAIN) --keep-best --keep-libraries
define OVER_TERRAIN
$(TERRAIN) --evaluations 100000 --rows $(UNPLANNED) --without cmaes pymoo niapy mealpy --output results/terrain/longest
$(TERRAIN) --evaluations 100000 --policy-runs 7 --peer-runs 1 --rows $(PLANNED) $(LIBRARIES) --without blinded --validation terrain:validation:0-7 --output results/terrain/longest-guided
$(TERRAIN) --evaluations 20000 --without cmaes pymoo niapy mealpy "blind schedule" learned "shifted, uniform" --output results/terrain/longer
$(TERRAIN) --evaluations 20000 --policy-runs 7 --peer-runs 31 --rows guided "planned flight" "linear reduction" $(LIBRARIES) --validation terrain:validation:0-7 --output results/terrain/longer-guided
$(TERRAIN) --evaluations 2500 --peer-runs 31 --output results/terrain/all
endef
STUDY_SUITES = headline generalisation out-of-distribution single-cases ablation parameters
PYTHONS = python3.11 python3.12 python3.13 python3.14
NEWEST = .venv-newest-$(notdir $(PYTHON))
KERNEL_TESTS = $(addprefix tests/swarm_gym/,compiler problem optimizers test_population.py test_sources.py \
    test_corridors.py test_golden.py scenarios/test_functions.py)
BOUNDS_TESTS = $(KERNEL_TESTS) tests/reliability/test_determinism.py \
    $(addprefix tests/swarm_gym/,test_vector_env.py controllers/test_schedules.py)
# A command that is left out with OFFLINE=1.
online = $(if $(filter 1,$(OFFLINE)),,$(BIN)/python -m $(1))

PIP_OPTIONS = --quiet --disable-pip-version-check --no-compile
# A virtual environment with packages: $(1) is its folder, $(2) a file of constraints or nothing, and $(3) names the
# packages. The pip that comes with Python 3.11 is upgraded first, since it knows no dependency groups. Modules are
# compiled when they are imported; most never are.
define install_into
@echo "== installing into $(1) (once; a few minutes)"
	$(PYTHON) -m venv $(1)
	$(1)/$(SCRIPTS)/python -m pip install $(PIP_OPTIONS) $(addprefix --constraint ,$(2)) --upgrade pip
	$(1)/$(SCRIPTS)/python -m pip install $(PIP_OPTIONS) $(addprefix --constraint ,$(2)) $(3)
endef
# Python keeps bytecode even where the environment says otherwise: else each process compiles all libraries.
export PYTHONDONTWRITEBYTECODE =

# Each worker begins with a run of neighbours, which share fixtures; one that has none left takes from the others.
SPREAD = -n auto --dist worksteal

# The tests in a virtual environment.
define test_in
$(1)/$(SCRIPTS)/python -m swarm_gym.warm_up
	$(1)/$(SCRIPTS)/python -m pytest $(SPREAD)
endef

.DEFAULT_GOAL := help
.NOTPARALLEL:
.PHONY: help install browser study study-full test test-slow test-supply test-lowest test-newest fuzz check check-workflows format \
    benchmark benchmark-gpu benchmark-peers benchmark-scaling docs paper docs-results docs-study docs-planners docs-known-optimum docs-strong-optimizers docs-terrain docs-scaling docs-scores \
    docs-gallery docs-plans dist clean

help: ## show this list
	@grep -E '^[a-z-]+%?:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "%-16s %s\n", $$1, $$2}'

install: $(INSTALLED) ## make the virtual environment

$(INSTALLED): pyproject.toml constraints.txt
	$(call install_into,$(VENV),constraints.txt,$(EVERYTHING))
	$(BIN)/python -m pip install $(PIP_OPTIONS) --no-deps $(WITHOUT_NEEDS)
	@touch $@

browser: $(INSTALLED) ## find or install Chromium, which the tests of reports look at pages with
	@for name in chromium chromium-browser google-chrome google-chrome-stable; do command -v $$name && exit; done; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get > /dev/null; then \
	    apt-get -qq update && apt-get -qq --yes --no-install-recommends install chromium fonts-dejavu-core > /dev/null; \
	else $(BIN)/python -m playwright install chromium; fi

study: $(INSTALLED) ## run the SPSFA paper's study; tables, figures and report.html are in results/paper then
	$(BIN)/python -m experiments.evaluate --suite paper --seeds $(SEEDS)
	$(BIN)/python -m experiments.report results/paper.sqlite

study-full: $(INSTALLED) ## run all suites of the study into results/study; OFFLINE=1: from its databases alone
	@for suite in $(STUDY_SUITES); do echo "== suite $$suite"; \
	    $(BIN)/python -m experiments.evaluate --suite $$suite --output results/study \
	        $(if $(filter 1,$(OFFLINE)),--no-simulate) || exit 1; done

test: $(INSTALLED) ## run the tests
	$(call test_in,$(VENV))

test-slow: $(INSTALLED) ## run the tests that take minutes; of kernels also with the JIT off, with bounds checks, and for GPUs in a simulator
	$(call test_in,$(VENV)) -m slow
	NUMBA_ENABLE_CUDASIM=1 $(BIN)/python -m pytest $(SPREAD) -m '' tests/swarm_gym/gpu
	$(BIN)/python -m pytest $(SPREAD) -m fuzzed --hypothesis-profile=thorough
	NUMBA_DISABLE_JIT=1 $(BIN)/python -m pytest $(SPREAD) $(KERNEL_TESTS)
	NUMBA_BOUNDSCHECK=1 $(BIN)/python -m swarm_gym.warm_up
	NUMBA_BOUNDSCHECK=1 $(BIN)/python -m pytest $(SPREAD) $(BOUNDS_TESTS)
	@$(MAKE) test-supply

test-supply: ## run the tests with the lowest versions allowed, and with the newest on every Python there is
	@$(MAKE) test-lowest
	@for python in $(PYTHONS); do \
	    if $$python --version > /dev/null 2>&1; then $(MAKE) test-newest PYTHON=$$python || exit 1; \
	    else echo "== no $$python here: skipped"; fi; done

test-newest: ## run the tests with the newest versions there are, on PYTHON
	rm -rf $(NEWEST)
	$(call install_into,$(NEWEST),,$(EVERYTHING))
	$(call test_in,$(NEWEST))

# Without adapters, which need a newer NumPy, and without docs, which no test imports.
test-lowest: pyproject.toml constraints-lowest.txt ## run the tests with the lowest versions allowed
	$(call install_into,.venv-lowest,constraints-lowest.txt,--editable '.[$(subst adapters$(comma),,$(EXTRAS))]' --group dev)
	$(call test_in,.venv-lowest)

fuzz: .venv-fuzz/.installed ## fuzz the parsers of files for SECONDS; finds are kept in tests/reliability/fuzz_finds
	PYTHONPATH=.:tests:tests/reliability .venv-fuzz/$(SCRIPTS)/python tests/reliability/fuzz.py --seconds $(SECONDS)

.venv-fuzz/.installed .venv-peers/.installed: .venv-%/.installed: pyproject.toml constraints.txt
	$(call install_into,.venv-$*,constraints.txt,--editable '.$(if $(filter fuzz,$*),[maps])' --group $*)
	@touch $@

check: $(INSTALLED) ## lint, formatting, types, layers, language, security of the workflows
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python tests/language.py swarm_gym agents experiments tests
	$(BIN)/zizmor --offline --quiet --strict-collection .github

check-workflows: .venv-workflows/.installed ## check the workflows of .github with actionlint, whose installation needs GitHub
	.venv-workflows/$(SCRIPTS)/actionlint

.venv-workflows/.installed: pyproject.toml constraints.txt
	$(call install_into,.venv-workflows,constraints.txt,--group workflows)
	@touch $@

format: $(INSTALLED) ## format the sources
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

benchmark: $(INSTALLED) ## measure speed on a quiet machine, write results/benchmark (about four minutes)
	$(BIN)/python -m swarm_gym.warm_up
	$(BIN)/python -m experiments.benchmark

benchmark-peers: .venv-peers/.installed ## measure other libraries beside it, in an environment of their own
	.venv-peers/$(SCRIPTS)/python -m swarm_gym.warm_up
	.venv-peers/$(SCRIPTS)/python -m experiments.speed.peers

benchmark-gpu: $(INSTALLED) ## measure speed on a GPU beside the CPU: results/benchmark-gpu; needs the extra gpu
	$(BIN)/python -m experiments.benchmark_gpu

benchmark-scaling: $(INSTALLED) ## measure what Ray adds on logical nodes, and predict clusters: results/scaling (15 minutes)
	$(BIN)/python -m experiments.scaling

docs: $(INSTALLED) ## build the documentation site in build/docs, run its notebooks and check its links (some minutes)
	rm -rf build/docs
	$(BIN)/python -m swarm_gym.warm_up
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs build/docs
	$(BIN)/python -m experiments.site.check_links build/docs

paper: $(INSTALLED) ## write the paper, build/paper.pdf, with the numbers of README.md and docs/results.md
	mkdir -p build
	$(BIN)/python -c "import typst; typst.compile('paper/paper.typ', output='build/paper.pdf', root='.')"

docs-results: $(INSTALLED) benchmark-peers benchmark ## regenerate what README.md and docs/performance.md show (15 minutes)
	$(BIN)/python -m experiments.evaluate --suite paper --seeds 1000 --output results/docs
	$(BIN)/python -m experiments.publish results
	$(BIN)/python -m experiments.frame docs/results/frame.png
	$(BIN)/python -m experiments.video --iterations 60 --output docs/results/video.gif

docs-study: study-full ## fill docs/study.md and docs/study-tables.md from all suites of the study; OFFLINE=1: from what is in results/study
	$(call online,experiments.sensitivity --output results/study/sensitivity)
	$(call online,experiments.branching --output results/study/branching)
	$(BIN)/python -m experiments.publish study study-tables

docs-planners: $(INSTALLED) ## run planners that people use beside the swarms, and fill docs/planners.md (three hours)
	$(BIN)/python -m experiments.planners
	$(BIN)/python -m experiments.planners --replanning --tasks 10 --seeds 3
	$(BIN)/python -m experiments.planners.streams
	$(BIN)/python -m experiments.planners.curves --tasks 20
	$(BIN)/python -m experiments.publish planners

docs-known-optimum: $(INSTALLED) ## compare controllers on OneMax with the optimum, and fill docs/known-optimum.md (an hour on one core); PUBLISHED=folder of OneMax-MPDAC
	$(BIN)/python -m experiments.onemax --published $(PUBLISHED)
	$(BIN)/python -m experiments.publish known-optimum

docs-strong-optimizers: $(INSTALLED) ## run CMA-ES and L-SHADE on MetaBox's functions, and fill docs/strong-optimizers.md (hours)
	$(BIN)/python -m experiments.strong
	$(BIN)/python -m experiments.strong --table repeated
	$(BIN)/python -m experiments.strong --table bbob --runs 4
	$(BIN)/python -m experiments.strong --table pycma --runs 10
	$(BIN)/python -m experiments.strong --table libraries --runs 4
	$(BIN)/python -m experiments.evaluate --suite cases-at-budgets --output results/strong
	$(BIN)/python -m experiments.publish strong-optimizers

docs-terrain: $(INSTALLED) ## run optimizers over 56 terrains, and fill docs/terrain.md and its appendices (days)
	$(OVER_TERRAIN)
	$(OVER_TERRAIN)
	$(RUNS_OVER_TERRAIN) --evaluations 20000 --policy-runs 7 --rows L-SHADE --without waypoints spherical uniform --validation terrain:validation:0-7 --terrains $(FRESH_TERRAINS) --output results/terrain/fresh
	$(BIN)/python -m experiments.terrain --cost documented --terrains $(EIGHT_TERRAINS) --without learned "blind schedule" constants shifted cmaes pymoo niapy mealpy --output results/terrain/eight
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps metaevobox==2.0.2
	$(BIN)/python -m experiments.terrain --beside-metabox --output results/terrain/speed
	$(BIN)/python -m experiments.publish terrain terrain-budgets

docs-scaling: benchmark-scaling ## measure backends, and fill docs/scaling.md
	$(BIN)/python -m experiments.publish scaling

docs-scores: $(INSTALLED) ## score the packaged controllers that scores/ lacks, and rank all in docs/scores.md
	$(BIN)/python -m experiments.scores
	$(BIN)/python -m experiments.publish scores

docs-gallery: $(INSTALLED) ## regenerate docs/gallery.md, every optimizer on every kind of map
	$(BIN)/python -m experiments.gallery

docs-plans: $(INSTALLED) ## draw the planned paths that the pages on planning show
	$(BIN)/python -m experiments.plans

docs-%: $(INSTALLED) ## run the suites of a document and fill it: docs-adapters, docs-bbob, docs-moa, docs-iafsa (15 minutes), docs-brand-yu, docs-driving, docs-dynamic, docs-newcomers, docs-optimizers
	$(BIN)/python -m experiments.publish $* --evaluate

dist: $(INSTALLED) ## build the source archive and the wheel into dist/, and check their metadata
	rm -rf dist
	$(BIN)/python -m build --outdir dist .
	$(BIN)/twine check --strict dist/*

clean: ## delete environments, caches and results (not trained policies)
	rm -rf $(VENV) .venv-lowest .venv-newest-* .venv-fuzz .venv-peers .venv-workflows build dist results .pytest_cache .mypy_cache .ruff_cache \
	    .hypothesis .import_linter_cache *.egg-info docs/environments docs/reference docs/contributing.md docs/changelog.md
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
