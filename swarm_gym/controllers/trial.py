"""A trial of a controller that somebody else wrote: two decisions for three swarms."""

import numpy as np

from swarm_gym.action import make_action
from swarm_gym.controllers.controller import Controller, SizeLimits
from swarm_gym.errors import shown
from swarm_gym.observation import ITERATION, make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.settings import Settings

NUM_SWARMS = 3


def require_trial(controller: object) -> None:
    """Raise an error if an object is no controller, or decides in another form than its layouts say.

    It decides for `NUM_SWARMS` swarms, in their first iteration and in the next one.

    Raises:
        ValueError: naming what was found and what was expected.
    """
    if not isinstance(controller, Controller):
        raise ValueError(f"expected a Controller of swarm_gym.controllers, got {shown(controller)}")
    size = getattr(controller, "initial_population_size", None)
    if not isinstance(size, int | np.integer) or isinstance(size, bool) or size < 1:
        raise ValueError(f"initial_population_size must be a positive integer, got {shown(size)}")
    num_features = len(make_observation(controller.observation).features)
    limits = controller.needed_limits or SizeLimits(2, max(int(size), SizeLimits().largest))
    settings = Settings(
        action=controller.action,
        initial_population_size=int(size),
        min_population_size=limits.smallest,
        max_population_size=limits.largest,
        max_evaluations=controller.max_evaluations,
    )
    space = make_action(settings, get_optimizer(controller.made_for or "firefly")).space
    controller.reset(NUM_SWARMS, seed=0)
    for iteration in range(2):
        seen = np.zeros((NUM_SWARMS, num_features))
        seen[:, ITERATION] = iteration
        try:
            decided = np.asarray(controller.act(seen))
        except Exception as error:  # somebody else's code may raise anything
            raise ValueError(f"act raised {error!r} for observations of shape {seen.shape}") from error
        expected = (NUM_SWARMS, *space.shape)
        if decided.shape != expected or decided.dtype.kind not in "fiu":
            raise ValueError(
                f"act must return numbers of shape {expected} for {NUM_SWARMS} swarms in the layout "
                f"{controller.action!r}, got {decided.dtype} of shape {decided.shape}"
            )
        if not np.isfinite(decided).all():
            raise ValueError(f"act must return finite numbers, got {shown(decided.tolist())}")
