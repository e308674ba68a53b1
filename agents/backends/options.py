"""The options that say where work is carried out: a part of the command lines that have work for many."""

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
    """Where work is carried out."""

    backend: Literal["local", "ray", "slurm"] = "local"
    """Processes of this machine, a Ray cluster (extra `ray`), or Slurm jobs (extra `slurm`)."""
    address: str | None = None
    """Of a Ray cluster, as `ray.init` takes it; by default, Ray is started on this machine. Of Slurm, a
    partition; `local` runs its jobs on this machine."""
    jobs: Annotated[int, tyro.conf.arg(metavar="N")] = 0
    """How many processes, or Slurm jobs, at a time; 0 takes all cores, but Slurm has to be told."""

    @property
    def elsewhere(self) -> bool:
        """Whether work is carried out by anything but processes of this command."""
        return self.backend != "local"

    def check(self) -> None:
        """Refuse options that cannot be.

        Raises:
            ValueError: naming the option.
        """
        if self.jobs < 0:
            raise ValueError(f"--jobs must be positive, or 0 for all cores, got {self.jobs}")
        if self.address is not None and not self.elsewhere:
            raise ValueError(f"--address {self.address}: --backend {self.backend} has none")

    def make(self, folder: Path, controllers: Iterable[str] = ()) -> Backend:
        """The backend.

        Args:
            folder: which all workers see, for what it needs there.
            controllers: names of those that workers make, whose files they need.

        Raises:
            MissingExtraError: if its library is missing.
            BackendError: if it cannot be used.
            ValueError: for options that cannot be.
        """
        self.check()
        if self.backend == "ray":
            return RayBackend(self.address, self.jobs, list(files_of(controllers)))
        if self.backend == "slurm":
            return SlurmBackend(self.address, self.jobs, folder / "slurm")
        return LocalBackend(self.jobs)
