"""Training seeds of a recipe belong together, and so do scenarios of a set; suites are sound data."""

import pytest

from agents import make_controller
from agents.runs.seeds import TEST, VALIDATION
from experiments.catalogue import COLLECTIONS, SUITES, TABLES, figures
from experiments.runs.entrants import entrant
from experiments.runs.groups import group_controllers, scenario_sets
from experiments.runs.suite import FRESH_SEEDS, Family
from experiments.studies.controllers import training_seeds
from experiments.studies.learned.suites import Fitted, controllers_of, families_of
from experiments.studies.newcomers.suites import NEVER_USED
from swarm_gym.controllers.learned.policy_file import packaged_policies
from swarm_gym.controllers.open_loop import packaged_open_loops
from swarm_gym.scenarios import expand_name


def test_training_seeds_of_a_recipe_are_one_group():
    controllers = ("spsfa", "learned:a/0", "fixed:60", "learned:a/1", "learned:b/0", "learned:a/12")
    assert group_controllers(controllers) == {
        "spsfa": ("spsfa",),
        "learned:a/*": ("learned:a/0", "learned:a/1", "learned:a/12"),
        "fixed:60": ("fixed:60",),
        "learned:b/*": ("learned:b/0",),
    }


@pytest.mark.parametrize("alone", ["learned:a", "learned:runs/mine/best.safetensors", "fixed:60"])
def test_a_policy_that_is_no_training_seed_is_not_pooled_with_any(alone):
    assert group_controllers([alone, "learned:a/0"]) == {alone: (alone,), "learned:a/*": ("learned:a/0",)}


def test_scenarios_of_a_set_belong_together():
    scenarios = ("case1", "random-fields:test:0", "random-fields:denser:7", "random-fields:test:11", "case2")
    assert scenario_sets(scenarios) == {
        "case1": ("case1",),
        "random-fields:test": ("random-fields:test:0", "random-fields:test:11"),
        "random-fields:denser": ("random-fields:denser:7",),
        "case2": ("case2",),
    }


def test_policies_that_are_told_different_prices_are_different_groups():
    names = training_seeds("learned:a", 2, 0.3, 4)
    assert names == ("learned:a/0@0.3", "learned:a/1@0.3", "learned:a/0@4", "learned:a/1@4")
    assert group_controllers(names) == {"learned:a/*@0.3": names[:2], "learned:a/*@4": names[2:]}


@pytest.mark.parametrize("suite", SUITES.values(), ids=SUITES)
def test_what_a_suite_names_is_there_and_ships(suite):
    assert set(suite.tables) <= set(TABLES)
    assert set(suite.figures) <= set(figures())
    groups = group_controllers(suite.controllers)
    assert suite.baseline in groups
    assert {group for family in suite.families for group in family.groups} <= set(groups)
    assert len(set(suite.controllers)) == len(suite.controllers)
    assert len(set(suite.scenarios)) == len(suite.scenarios)
    for controller in suite.controllers:
        assert make_controller(entrant(controller, suite.optimizer).controller)
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
    learned = {name.partition("@")[0] for name in run if name.startswith("learned:")}
    assert {f"learned:{name}" for name in packaged_policies()} == learned
    assert {f"open-loop:{name}" for name in packaged_open_loops()} <= run


def test_families_of_a_suite_are_what_it_runs_beside_chance():
    fitted = Fitted(learned=training_seeds("learned:a", 2), open_loops=("open-loop:b",))
    families = families_of(fitted, Family("others", ()), Family("more", ("learned:c",)))
    assert [family.name for family in families] == [
        "fixed sizes", "schedules", "open loops (size, φ)", "learned (size, φ)", "more",
    ]  # fmt: skip
    assert families[3].groups == ("learned:a/*",)
    last = ("open-loop:b", "learned:a/0", "learned:a/1", "learned:c", "random")
    assert controllers_of(families)[-5:] == last


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
    elif suite.name not in ("paper", "parameters"):  # on seeds that nothing was chosen by
        assert first == FRESH_SEEDS


def test_seeds_and_fields_of_the_newest_study_are_in_no_other():
    newest = {name for name in SUITES if name.startswith("newcomers")}
    others = [suite for name, suite in SUITES.items() if name not in newest]
    assert max(seeds[-1] for suite in others for seeds in suite.seeds.values()) < NEVER_USED
    fields = {scenario for name in newest for scenario in SUITES[name].scenarios if ":test:" in scenario}
    assert len(fields) == 200
    assert fields.isdisjoint(scenario for suite in others for scenario in suite.scenarios)


def test_fields_have_a_seed_of_their_own():
    for name in ("generalisation", "out-of-distribution"):
        seeds = [seed for seeds in SUITES[name].seeds.values() for seed in seeds]
        assert len(seeds) == len(set(seeds)) == 200
    assert SUITES["paper"].seeds == dict.fromkeys(("case1", "case2", "case3"), range(20))
    assert [len(of) for of in scenario_sets(SUITES["out-of-distribution"].scenarios).values()] == [40] * 5
