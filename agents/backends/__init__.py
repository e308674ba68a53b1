"""Backends that run evaluations, trainings and tunings: processes of this machine, Ray, Slurm."""

from agents.backends.backend import Backend, BackendError, Task, WorkLostError
from agents.backends.options import BackendOptions

__all__ = ["Backend", "BackendError", "BackendOptions", "Task", "WorkLostError"]
