"""Training seeds of a recipe belong together, and so do scenarios of a set; suites are sound data."""

from dataclasses import replace

import pytest

from agents import make_controller
from experiments.catalogue import COLLECTIONS, SUITES, TABLES, figures
from experiments.runs.experiment import FRESH_SEEDS
from experiments.runs.groups import group_controllers, scenario_sets
from experiments.runs.suite import ControllerFamily, Suite
from experiments.studies.controllers import training_seeds
from experiments.studies.dynamic.suites import NEVER_USED as OF_CHANGES
from experiments.studies.learned.suites import NEVER_USED as NEWEST
from experiments.studies.newcomers.suites import NEVER_USED
from experiments.studies.optimizers.suites import LATER_SEEDS as LATER_OF_OPTIMIZERS
from experiments.studies.optimizers.suites import NEVER_USED as OF_OPTIMIZERS
from experiments.studies.strong.entrants import TUNED
from helpers.adapted import ADAPTED, missing
from helpers.shipped import policies_of_wishes, policies_on_maps
from swarm_gym.comparing.entrants import entrant
from swarm_gym.controllers.names import BLINDED, ControllerName
from swarm_gym.controllers.open_loop import packaged_open_loops
from swarm_gym.runs.seeds import TEST, VALIDATION
from swarm_gym.scenarios import expand_name

LEARNED = {"headline", "generalisation", "out-of-distribution", "single-cases", "ablation"}


def test_training_seeds_of_a_recipe_are_one_group():
    controllers = ("spsfa", "learned:a/0", "fixed:60", "learned:a/1", "learned:b/0", "learned:a/12")
    assert group_controllers(controllers) == {
        "spsfa": ("spsfa",),
        "learned:a/*": ("learned:a/0", "learned:a/1", "learned:a/12"),
        "fixed:60": ("fixed:60",),
        "learned:b/*": ("learned:b/0",),
    }


def test_a_chosen_tuning_is_in_its_group_and_stands_alone():
    family = ControllerFamily(
        "loops", ("open-loop:a/0@1", "open-loop:a/1@1"), blind=True, alone=("open-loop:a/1@1",)
    )
    expected = {
        "open-loop:a/*@1": ("open-loop:a/0@1", "open-loop:a/1@1"),
        "open-loop:a/1@1": ("open-loop:a/1@1",),
    }
    assert group_controllers(family.controllers, family.alone) == expected
    assert family.groups == tuple(expected)
    suite = Suite("any", ("spsfa", *family.controllers), ("case1",), 1, "spsfa", families=(family,))
    assert suite.alone == ("open-loop:a/1@1",)
    # A part of the suite without that tuning has no such group.
    assert replace(suite, controllers=("spsfa", "open-loop:a/0@1")).alone == ()


@pytest.mark.parametrize("suite", SUITES.values(), ids=SUITES)
def test_what_stands_alone_in_a_suite_is_in_its_family(suite):
    for family in suite.families:
        assert set(family.alone) <= set(family.controllers)


@pytest.mark.parametrize("alone", ["learned:a", "learned:runs/mine/best.safetensors", "fixed:60"])
def test_a_policy_that_is_no_training_seed_is_not_pooled_with_any(alone):
    assert group_controllers([alone, "learned:a/0"]) == {alone: (alone,), "learned:a/*": ("learned:a/0",)}


def test_scenarios_of_a_set_belong_together():
    scenarios = ("case1", "random-fields:test:0", "random-fields:denser:7", "random-fields:test:11", "case2")
    scenarios += ("dynamic:case1-gate@20", "dynamic:case1-gate@71", "dynamic:rooms:0-block@5")
    scenarios += ("function:bbob-8-5-1", "function:bbob-8-5-12", "function:bbob-8-2-1", "function:booth-2")
    scenarios += ("dynamic:case1-gate@20-drive@4,every=2,distance=3",)
    assert scenario_sets(scenarios) == {
        "case1": ("case1",),
        "random-fields:test": ("random-fields:test:0", "random-fields:test:11"),
        "random-fields:denser": ("random-fields:denser:7",),
        "case2": ("case2",),
        "dynamic:case1-gate": ("dynamic:case1-gate@20", "dynamic:case1-gate@71"),
        "dynamic:rooms:0-block": ("dynamic:rooms:0-block@5",),
        "function:bbob-8-5": ("function:bbob-8-5-1", "function:bbob-8-5-12"),
        "function:bbob-8-2": ("function:bbob-8-2-1",),
        "function:booth-2": ("function:booth-2",),
        "dynamic:case1-gate-drive@4,every=2,distance=3": scenarios[-1:],
    }


def test_policies_that_are_told_different_prices_are_different_groups():
    names = training_seeds("learned:a", 2, 0.3, 4)
    assert names == ("learned:a/0@0.3", "learned:a/1@0.3", "learned:a/0@4", "learned:a/1@4")
    assert group_controllers(names) == {"learned:a/*@0.3": names[:2], "learned:a/*@4": names[2:]}


def marks_of(suite):
    """Return the marks that skip the test of a suite where libraries of its controllers are missing."""
    text = " ".join(suite.controllers)
    return [missing(library) for library in ADAPTED if f"swarm_gym.adapters.{library}" in text]


@pytest.mark.parametrize(
    "suite", [pytest.param(suite, id=name, marks=marks_of(suite)) for name, suite in SUITES.items()]
)
def test_what_a_suite_names_is_there_and_ships(suite):
    assert set(suite.tables) <= set(TABLES)
    assert set(suite.figures) <= set(figures())
    groups = group_controllers(suite.controllers, suite.alone)
    assert suite.baseline in groups
    assert {group for family in suite.families for group in family.groups} <= set(groups)
    assert len(set(suite.controllers)) == len(suite.controllers)
    assert len(set(suite.scenarios)) == len(suite.scenarios)
    for controller in suite.controllers:
        seeing = controller.replace("blinded:", "learned:")
        assert make_controller(entrant(seeing, suite.optimizer).controller)
    for scenario in suite.scenarios:
        assert expand_name(scenario) == (scenario,)


def test_an_entrant_names_its_optimizer_and_how_many_iterations():
    assert entrant("spsfa-tip", "firefly") == ("firefly", "spsfa-tip", None)
    assert entrant("multivariate+fixed:65", "firefly") == ("multivariate", "fixed:65", None)
    found = entrant("multivariate(50)+fixed:65", "firefly")
    assert found == ("multivariate", "fixed:65", 50)
    assert found.options == {"iterations": 50}
    assert entrant("spsfa", "firefly").options == {}
    assert entrant("learned:a+b", "firefly").controller == "learned:a+b"


def test_a_collection_is_of_suites():
    for name, suites in COLLECTIONS.items():
        assert name not in SUITES
        assert set(suites) <= set(SUITES)


def test_policies_that_ship_are_in_a_suite():
    run = {controller for suite in SUITES.values() for controller in suite.controllers}
    run = {str(ControllerName.parse(name).controller) for name in run}  # without the optimizer of an entrant
    learned = {name.partition("@")[0] for name in run if name.startswith("learned:")}
    assert {f"learned:{name}" for name in (*policies_on_maps(), *policies_of_wishes())} == learned
    # A reacting loop is an open loop that begins again.
    loops = {name.replace("reacting-loop:", "open-loop:") for name in run}
    # Loops over terrain, of CMA-ES and of L-SHADE are rows of `experiments.terrain` and `experiments.strong`.
    others = ("terrain-", *(name for tuned in TUNED.values() for name in tuned))
    on_maps = {f"open-loop:{name}" for name in packaged_open_loops() if not name.startswith(others)}
    assert on_maps <= loops


@pytest.mark.parametrize("suite", [s for s in SUITES.values() if s.families], ids=lambda suite: suite.name)
def test_families_of_a_suite_are_what_it_runs_beside_chance_and_blinded_policies(suite):
    of_families = [controller for family in suite.families for controller in family.controllers]
    others = [name for name in suite.controllers if name not in of_families]
    assert [name for name in others if ControllerName.parse(name).family != BLINDED] in ([], ["random"])


def test_blind_families_see_nothing_but_the_iteration():
    blind = {name for s in SUITES.values() for f in s.families if f.blind for name in f.controllers}
    seeing = {name for s in SUITES.values() for f in s.families if not f.blind for name in f.controllers}
    assert {name for name in blind if not name.startswith("open-loop:")} == {
        "fixed:60", "fixed:80", "fixed:100", "linear-reduction",
        *training_seeds("tuned:dynamic-periodic", 10, 1),
    }  # fmt: skip
    assert seeing >= {"spsfa-tip", "learned:three-cases/0@1"}


@pytest.mark.parametrize("suite", SUITES.values(), ids=SUITES)
def test_suites_run_on_test_seeds(suite):
    assert list(suite.seeds) == list(suite.scenarios)
    for seeds in suite.seeds.values():
        assert len(seeds) == suite.num_seeds
        among = VALIDATION if "bends" in suite.options else TEST  # the kind of bends is chosen by results
        assert seeds[0] in among
        assert seeds[-1] in among
    first = min(seeds[0] for seeds in suite.seeds.values())
    if "bends" in suite.options:
        assert all(name.startswith(("case", "random-fields:validation:")) for name in suite.scenarios)
    elif suite.name.startswith("newcomers"):
        assert first == NEVER_USED
    elif suite.name in LEARNED:
        assert first == NEWEST
    elif suite.name in ("dynamic", "dynamic-fields", "dynamic-robots"):
        assert first == OF_CHANGES
    elif suite.name in ("optimizers", "optimizers-cells"):
        assert first == OF_OPTIMIZERS
    elif suite.name.startswith("optimizers-"):
        assert first == LATER_OF_OPTIMIZERS
    elif suite.name == "cases-at-budgets":
        assert first == 73_000
    elif suite.name not in ("paper", "parameters"):  # on seeds that nothing was chosen by
        assert first == FRESH_SEEDS


def test_seeds_and_fields_of_the_newest_studies_are_in_no_other():
    newcomers = {name for name in SUITES if name.startswith("newcomers")}
    for study, first in ((newcomers, NEVER_USED), (LEARNED, NEWEST)):
        others = [suite for name, suite in SUITES.items() if name not in study]
        own = [SUITES[name] for name in study if "bends" not in SUITES[name].options]
        seeds = {seed for suite in own for seeds in suite.seeds.values() for seed in seeds}
        assert min(seeds) == first
        assert seeds.isdisjoint(k for suite in others for seeds in suite.seeds.values() for k in seeds)
        fields = {scenario for suite in own for scenario in suite.scenarios if ":test:" in scenario}
        assert len(fields) == 200
        assert fields.isdisjoint(scenario for suite in others for scenario in suite.scenarios)


def test_fields_have_a_seed_of_their_own():
    for name in ("generalisation", "out-of-distribution"):
        seeds = [seed for seeds in SUITES[name].seeds.values() for seed in seeds]
        assert len(seeds) == len(set(seeds)) == 200
    assert SUITES["paper"].seeds == dict.fromkeys(("case1", "case2", "case3"), range(20))
    assert [len(of) for of in scenario_sets(SUITES["out-of-distribution"].scenarios).values()] == [40] * 5
