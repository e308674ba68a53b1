"""Optimizers: algorithms that solve a problem with a swarm, each in a file or folder of its own.

Each entry of `OPTIMIZERS` is the environment `swarm_gym/<Class>-v0`, and the contract tests cover it. So is
each entry of `SPECIAL_OPTIMIZERS`, which has a problem of its own and no paths.
CONTRIBUTING.md lists the steps to add one.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from swarm_gym.own_code import find

if TYPE_CHECKING:
    from swarm_gym.optimizers.optimizer import Optimizer

__all__ = ["ALL_OPTIMIZERS", "OPTIMIZERS", "SPECIAL_OPTIMIZERS", "get_optimizer"]

# Module and class by name; a module is imported at its first use, since importing Numba takes a while.
OPTIMIZERS: dict[str, tuple[str, str]] = {
    "firefly": ("swarm_gym.optimizers.firefly", "Firefly"),
    "generational-firefly": ("swarm_gym.optimizers.generational_firefly", "GenerationalFirefly"),
    "particle-swarm": ("swarm_gym.optimizers.particle_swarm", "ParticleSwarm"),
    "elite-genetic": ("swarm_gym.optimizers.elite_genetic", "EliteGenetic"),
    "multivariate": ("swarm_gym.optimizers.multivariate.multivariate", "Multivariate"),
    "fish-swarm": ("swarm_gym.optimizers.fish.standard", "FishSwarm"),
    "improved-fish-swarm": ("swarm_gym.optimizers.fish.improved", "ImprovedFishSwarm"),
    "hybrid-fish-swarm": ("swarm_gym.optimizers.fish.hybrid", "HybridFishSwarm"),
    "glowworm": ("swarm_gym.optimizers.glowworm.glowworm", "Glowworm"),
    "ant-colony": ("swarm_gym.optimizers.ant_colony.ant_colony", "AntColony"),
    "differential-evolution": ("swarm_gym.optimizers.differential_evolution", "DifferentialEvolution"),
    "cma-es": ("swarm_gym.optimizers.cma_es.cma_es", "CmaEs"),
}
# Optimizers of a problem of their own, which have no paths and no repair.
SPECIAL_OPTIMIZERS: dict[str, tuple[str, str]] = {
    "one-plus-lambda-lambda": ("swarm_gym.optimizers.one_plus_lambda_lambda", "OnePlusLambdaLambda"),
}
ALL_OPTIMIZERS = OPTIMIZERS | SPECIAL_OPTIMIZERS


def get_optimizer(name: str) -> "type[Optimizer]":
    """Return the optimizer class with this name, or the one that a name of own code stands for.

    Raises:
        UnknownNameError: if there is none.
        OwnCodeError: if own code cannot be imported, or is no optimizer.
    """
    found = find("optimizer", name, ALL_OPTIMIZERS, _is_optimizer, "a subclass of Optimizer")
    if not isinstance(found, tuple):
        return found
    module, cls = found
    return getattr(import_module(module), cls)


def _is_optimizer(found: object) -> bool:
    base = import_module("swarm_gym.optimizers.optimizer").Optimizer
    return isinstance(found, type) and issubclass(found, base)
