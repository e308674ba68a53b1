"""Blinded policies: a policy with all inputs but the clock replaced by their mean courses.

A blinded policy decides by the iteration alone. What a policy gains over itself blinded is what it makes of
what it sees; what it gains over other controllers may be a better course of decisions.
"""

from agents.evaluation.masking import Masked, clock_columns, mean_courses
from agents.evaluation.observers import watch
from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.registry import load_learned
from swarm_gym.runs.seeds import ANALYSIS
from swarm_gym.training.config import stored_config

NUM_EPISODES = 192


def load_blinded(policy: str, limits: SizeLimits | None = None) -> Masked:
    """Return a learned policy, blinded by its mean courses over all scenarios that it was trained on.

    The episodes of the courses have seeds that neither trainings nor tests have.

    Args:
        policy: name or path of the policy, as after `learned:`.
        limits: population sizes that the environment allows.

    Raises:
        PolicyFileError: if the file is missing, damaged or made for something else.
    """
    controller = load_learned(policy, limits)
    training = stored_config(controller.manifest)
    watched = watch(
        controller,
        [],
        training.scenarios,
        ANALYSIS[:NUM_EPISODES],
        controller.observation,
        training.optimizer,
        **training.env_options(),
    )
    courses = mean_courses(watched.seen, watched.running)
    clocks = clock_columns(controller)
    return Masked(controller, courses, [k for k in range(courses.shape[1]) if k not in clocks])
