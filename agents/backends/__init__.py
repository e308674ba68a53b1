"""Backends: where evaluations, trainings and tunings are carried out."""

from agents.backends.backend import Backend, BackendError, Task, WorkLostError
from agents.backends.options import BackendOptions

__all__ = ["Backend", "BackendError", "BackendOptions", "Task", "WorkLostError"]
