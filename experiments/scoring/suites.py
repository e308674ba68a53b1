"""Scored suites: parts of the studies' suites with few seeds, small enough that everyone can run them again.

A packaged policy is scored by the suites whose patterns its recipe matches, on those of their optimizers that
it was trained on. Controllers of the study that are no policies are scored beside it.
"""

from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import cache, cached_property

from experiments.catalogue import SUITES
from experiments.runs.experiment import Experiment
from experiments.runs.groups import scenario_sets
from swarm_gym.checks import look_up
from swarm_gym.comparing.compared_runs import optima_of, refuse_unknown_optima
from swarm_gym.comparing.entrants import entrant
from swarm_gym.controllers.learned.manifest import Manifest, observes_price
from swarm_gym.controllers.learned.policy_file import load_policy, packaged_policies, resolve
from swarm_gym.controllers.names import BLINDED, ControllerName
from swarm_gym.registration import environment_id

PRICE = 1.0  # of 100,000 evaluations: what objectives charge, and what policies that observe it are told
LEARNED = "learned"


@dataclass(frozen=True)
class ScoredSet:
    """A set of scenarios that has one row of scores for each controller.

    Attributes:
        name: key of the set, see `experiments.runs.groups`.
        scenarios: names of the scenarios.
        runs: scenario and seed of every run, in order.
        first_seed: first seed of the first scenario.
        num_seeds: number of seeds of each scenario.
    """

    name: str
    scenarios: tuple[str, ...]
    runs: tuple[tuple[str, int], ...]
    first_seed: int
    num_seeds: int


@dataclass(frozen=True)
class ScoredSuite:
    """A suite whose runs give scores.

    Attributes:
        experiment: part of a suite of a study that is run, with all of its controllers.
        recipes: patterns of the recipes of packaged policies that it scores, such as `three-cases-*`.
    """

    experiment: Experiment
    recipes: tuple[str, ...]

    @property
    def name(self) -> str:
        """Name of the suite, and of its file of scores."""
        return self.experiment.name

    @cached_property
    def optimizers(self) -> tuple[str, ...]:
        """Names of the optimizers that its controllers drive."""
        found = (entrant(name, self.experiment.optimizer).optimizer for name in self.experiment.controllers)
        return tuple(dict.fromkeys(found))

    @cached_property
    def sets(self) -> dict[str, ScoredSet]:
        """Sets of scenarios by name."""
        seeds = self.experiment.seeds
        return {
            name: ScoredSet(
                name,
                scenarios,
                tuple((scenario, seed) for scenario in scenarios for seed in seeds[scenario]),
                seeds[scenarios[0]].start,
                self.experiment.num_seeds,
            )
            for name, scenarios in scenario_sets(self.experiment.scenarios).items()
        }

    @cached_property
    def optima(self) -> dict[str, float]:
        """Fitness of the optimum of every scenario, by its name.

        Raises:
            ScenarioError: if one is unknown.
        """
        scenarios = self.experiment.scenarios
        found = optima_of(scenarios, self.experiment.options)
        refuse_unknown_optima(scenarios, found)
        return dict(zip(scenarios, found.tolist(), strict=True))

    def part(self, entrants: tuple[str, ...]) -> Experiment:
        """Return the runs of some entrants on all scenarios and seeds."""
        return replace(self.experiment, controllers=entrants)

    def environment(self, optimizer: str) -> str:
        """Return the environment's name and options as text, e.g. `swarm_gym/AntColony-v0 encoding=walk`."""
        options = [f"{name}={value}" for name, value in sorted(self.experiment.options.items())]
        return " ".join([environment_id(optimizer), *options])

    def entrant(self, optimizer: str, controller: str) -> str:
        """Return the name of an entrant, which has the optimizer if the suite has several."""
        return controller if len(self.optimizers) == 1 else f"{optimizer}+{controller}"

    def fitting(self, manifest: Manifest) -> list[str]:
        """Return those optimizers of the suite that a policy was trained on."""
        trained_on = {manifest["optimizer"], *manifest.get("also_on", ())}
        return [optimizer for optimizer in self.optimizers if optimizer in trained_on]

    def entrants_of(self, policy: str, manifest: Manifest) -> list[str]:
        """Return the entrants of a policy, one for each fitting optimizer.

        Args:
            policy: name of a packaged policy, such as `three-cases/0`, or path of a file.
            manifest: manifest of the policy; if it observes the price, it is told `PRICE`.
        """
        price = f"@{PRICE:g}" if observes_price(manifest) else ""
        return [self.entrant(optimizer, f"{LEARNED}:{policy}{price}") for optimizer in self.fitting(manifest)]

    @cached_property
    def policies(self) -> tuple[str, ...]:
        """Names of the packaged policies that it scores, e.g. `three-cases/0`."""
        return tuple(
            policy
            for policy in packaged_policies()
            if any(fnmatchcase(str(ControllerName.of(LEARNED, policy).recipe), form) for form in self.recipes)
            and self.fitting(packaged_manifest(policy))
        )

    @cached_property
    def references(self) -> tuple[str, ...]:
        """Entrants that are no policies: those of the study that have no training seed, and the bases."""
        bases = [
            self.entrant(optimizer, manifest["base"])
            for manifest in map(packaged_manifest, self.policies)
            if manifest["base"] != "none"
            for optimizer in self.fitting(manifest)
        ]
        return tuple(dict.fromkeys([*filter(_is_reference, self.experiment.controllers), *bases]))

    @cached_property
    def entrants(self) -> tuple[str, ...]:
        """All entrants that ship: the references, then the packaged policies."""
        of_policies = [self.entrants_of(policy, packaged_manifest(policy)) for policy in self.policies]
        return (*self.references, *(entrant for several in of_policies for entrant in several))


@cache
def packaged_manifest(policy: str) -> Manifest:
    """Return the manifest of a packaged policy by its name, e.g. `three-cases/0`."""
    return load_policy(resolve(policy))[1]


def get_scored(name: str) -> ScoredSuite:
    """Return the scored suite of that name.

    Raises:
        UnknownNameError: if there is none.
    """
    return look_up("scored suite", name, SCORED)


def _is_reference(name: str) -> bool:
    parts = ControllerName.parse(name)
    if parts.family in (LEARNED, BLINDED) or parts.seed is not None:
        return False
    return parts.price in (None, f"{PRICE:g}")


def _scored(name: str, *recipes: str, num_seeds: int = 5, num_scenarios: int | None = None) -> ScoredSuite:
    """Return the scored part of a study's suite: the first scenarios and the first seeds."""
    whole = SUITES[name]
    scenarios = whole.scenarios[:num_scenarios]
    return ScoredSuite(replace(whole, scenarios=scenarios, num_seeds=num_seeds, snapshots=()), recipes)


SCORED: dict[str, ScoredSuite] = {
    scored.name: scored
    for scored in (
        _scored("headline", "three-cases", "three-cases-linear", "three-cases-evolution", "three-cases-ppo"),
        _scored("single-cases", "case[123]"),
        _scored("ablation", "ablation-*"),
        _scored("generalisation", "random-fields", num_seeds=1, num_scenarios=10),
        _scored("newcomers", "three-cases-extended*", "three-cases-sourced*"),
        _scored("newcomers-fields", "random-fields-*", num_seeds=1, num_scenarios=10),
        _scored("dynamic", "dynamic*", num_seeds=1),
        _scored("optimizers", "optimizers-*"),
        _scored("optimizers-cells", "optimizers-*"),
    )
}
