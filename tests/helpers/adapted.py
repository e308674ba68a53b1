"""The adapted algorithms of libraries, by library, for parameters of tests."""

from importlib.util import find_spec

import pytest

ADAPTED = {
    "pymoo": ("Genetic", "ParticleSwarm"),
    "niapy": ("ParticleSwarm", "Firefly"),
}


def missing(library, extra="adapters"):
    """Return a mark that skips a test where the library of an extra is missing."""
    return pytest.mark.skipif(find_spec(library) is None, reason=f"needs {library}, of the extra `{extra}`")


def adapted():
    """Return the names of all adapted algorithms, each with the mark of its library."""
    return [
        pytest.param(f"swarm_gym.adapters.{library}:{cls}", marks=missing(library))
        for library, classes in ADAPTED.items()
        for cls in classes
    ]


def episode_of(env, controller):
    """Run one episode with seed 0 to its end; return the first best fitness and the last info."""
    controller.reset(1, 0)
    observation, info = env.reset(seed=0)
    first, ended = info["best_fitness"], False
    while not ended:
        observation, _, ended, _, info = env.step(controller.act(observation[None])[0])
    return first, info
