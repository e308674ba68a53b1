"""The options of commands that choose a backend."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from agents.backends.backend import Backend
from agents.backends.local import LocalBackend
from agents.backends.packing import files_of
from agents.backends.ray_backend import RayBackend
from agents.backends.slurm import SlurmBackend


@dataclass(frozen=True)
class BackendOptions:
    """The options of a backend."""

    backend: Literal["local", "ray", "slurm"] = "local"
    """Workers to use: processes of this machine, Ray (extra ray), or Slurm jobs (extra slurm)."""
    address: str | None = None
    """Address of a Ray cluster, e.g. auto or ray://head:10001; by default Ray is started on this machine. For
    Slurm, the partition; local runs the jobs on this machine."""
    jobs: Annotated[int, tyro.conf.arg(metavar="N")] = 0
    """Number of processes, or of Slurm jobs in the queue at a time; 0 is all cores, and invalid for Slurm."""

    @property
    def elsewhere(self) -> bool:
        """True if work runs anywhere but in processes of this command."""
        return self.backend != "local"

    def check(self) -> None:
        """Raise an error for invalid options.

        Raises:
            ValueError: naming the option.
        """
        if self.jobs < 0:
            raise ValueError(f"--jobs must be positive, or 0 for all cores, got {self.jobs}")
        if self.address is not None and not self.elsewhere:
            raise ValueError(f"--address {self.address}: --backend {self.backend} has no address")

    def make(self, folder: Path, controllers: Iterable[str] = ()) -> Backend:
        """Return the backend.

        Args:
            folder: folder that all workers see, for files of the backend.
            controllers: names of the controllers that workers make; their files are packed for the workers.

        Raises:
            MissingExtraError: if the library of the backend is missing.
            BackendError: if the backend cannot be used.
            ValueError: for invalid options.
        """
        self.check()
        if self.backend == "ray":
            return RayBackend(self.address, self.jobs, list(files_of(controllers)))
        if self.backend == "slurm":
            return SlurmBackend(self.address, self.jobs, folder / "slurm")
        return LocalBackend(self.jobs)
