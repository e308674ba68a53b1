"""PPO whose policy chooses from a grid of decisions."""

import pytest

from helpers.bits import OPTIMIZER
from helpers.trainings import tiny_config
from swarm_gym.training.learners import make_learner

BITS = {
    "optimizer": OPTIMIZER, "scenarios": ("onemax:20",), "observation": "theory-scaled", "reward": "runtime",
    "price": (0.0,), "iterations": 40, "initial_population_size": 1, "min_population_size": 1,
    "max_population_size": 8, "num_swarms": 4, "rollout_steps": 10, "action": "extended-normalised",
    "algorithm": "choice-ppo", "size_choices": (-1.0, 1.0), "degree_choices": (0.0,),
}  # fmt: skip


def test_each_decision_has_its_choices_also_where_two_texts_are_the_same(tmp_path):
    learner = make_learner(tiny_config(tmp_path, **BITS, further_choices=("-1 0.5", "0.25", "0.25")))
    assert learner.choices.tolist() == [
        [size, 0.0, children, 0.25, 0.25] for size in (-1.0, 1.0) for children in (-1.0, 0.5)
    ]
    assert learner.shape() == {"num_choices": 4}


@pytest.mark.parametrize(
    ("further", "message"),
    [
        (("0.5",), "5 decisions, but there are choices for 3"),
        (("0.5", "0.5", "1 1"), "further_choices 3, '1 1', must be different numbers"),
        (("0.5", "0.5", "1.5"), r"further_choices 3, '1.5', must lie in \[-1, 1\], got 1.5"),
        (("0.5", "0.5", "a lot"), "further_choices: expected numbers such as '-1 0 1', got 'a lot'"),
    ],
)
def test_wrong_choices_are_refused_by_their_place(tmp_path, further, message):
    with pytest.raises(ValueError, match=message):
        make_learner(tiny_config(tmp_path, **BITS, further_choices=further))
