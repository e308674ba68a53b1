"""Trainings that take a second."""

from agents.train_config import TrainConfig
from agents.training_run import TrainingRun

TINY = {
    "num_swarms": 4,
    "scenarios": ("case3",),
    "initial_population_size": 4,
    "max_population_size": 12,
    "batch_size": 100,
    "epochs": 2,
    "rollouts_per_chunk": 1,
    "validation_seeds": 2,
    "hidden_layers": (8,),
    "lstm_size": 5,
}
STEPS = 4 * 100  # one rollout of one episode per swarm


def tiny_config(folder, **options):
    return TrainConfig(runs=folder, **{**TINY, "name": "ppo", "total_steps": 3 * STEPS, **options})


def train(folder, **options):
    return TrainingRun(tiny_config(folder, **options))
