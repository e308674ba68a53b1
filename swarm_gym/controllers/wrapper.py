"""A controller around another one, which sees or decides something else."""

from swarm_gym.controllers.controller import Controller


class Wrapper(Controller):
    """Asks for the environment that the wrapped controller asks for, and counts iterations.

    A subclass decides in `act`, once per iteration: it asks `_controller` and adds one to `_iteration`.

    Args:
        controller: what is wrapped.
    """

    def __init__(self, controller: Controller):
        self._controller = controller
        self._iteration = 0
        self.observation = controller.observation
        self.action = controller.action
        self.initial_population_size = controller.initial_population_size
        self.max_evaluations = controller.max_evaluations
        self.price = controller.price
        self.corrects = controller.corrects

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Begin episodes; all swarms go through them side by side."""
        self._iteration = 0
        self._controller.reset(num_swarms, seed)
