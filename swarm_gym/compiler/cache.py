"""The cache of compiled kernels, which cannot be stale.

Numba's cache looks at the file of the cached function only: it does not notice an edit in a *called* function
of another file. It reuses code without bounds checks where they are asked for. Here a digest of all sources
that hold kernels and of the bounds-check flag names the cache folder, so that neither can happen. What is
compiled for classes of users has folders of its own, named by a digest of their sources.
"""

import hashlib
import logging
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numba
from filelock import FileLock
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile

from swarm_gym.compiler.own_sources import UnknownSourceError, digest_of_modules, own_modules
from swarm_gym.files import digest_of_sources, user_cache

if TYPE_CHECKING:  # private names, which may change without any harm
    from numba import types
    from numba.core.base import BaseContext
    from numba.core.codegen import Codegen
    from numba.core.compiler import CompileResult
    from numba.core.typing.templates import Signature

# The types of the arguments for which a function is compiled, and perhaps the type of the result.
Signed: TypeAlias = "tuple[types.Type, ...] | Signature"

# Only these folders and files of the package hold kernels, which call nothing from outside of them.
KERNEL_SOURCES = (
    "compiler",
    "corridors.py",
    "final_repair",
    "history.py",
    "population.py",
    "sources.py",
    "problem",
    "optimizers",
    "planning/cell_graph.py",
    "planning/curves",
    "reference/a_star.py",
    "reference/any_angle.py",
    "reference/disc_arcs.py",
    "reference/disc_tangents.py",
    "reference/free_arcs.py",
    "reference/grid_sight.py",
    "reference/layered_flights.py",
    "reference/onemax/adaptive.py",
    "reference/onemax/iteration.py",
    "reference/onemax/runtimes.py",
    "reference/priority_queue.py",
    "reference/solids.py",
    "reference/tangents.py",
    "reference/taut_polyline.py",
    "reference/visibility.py",
    "reference/waypoint_optimum.py",
)
COMPILE_TIMEOUT = 600.0  # seconds that a process waits for the kernel that another one compiles


@cache
def cache_folder() -> Path:
    """Return the folder for compiled kernels of exactly these sources, in the user's cache."""
    package = Path(__file__).parents[1]
    parts = [digest_of_sources(package / part) for part in KERNEL_SOURCES]
    digest = hashlib.sha256(f"{parts} boundscheck={numba.config.BOUNDSCHECK}".encode()).hexdigest()[:16]
    return user_cache() / "kernels" / digest


@cache
def announce_compilation() -> None:
    """Log a warning, once per process, if nothing of these sources is cached and all has to be compiled."""
    if not numba.config.DISABLE_JIT and not any(cache_folder().rglob("*.nbi")):
        logging.getLogger("swarm_gym").warning(
            "compiling the kernels for these sources, once; this takes about ten seconds for each optimizer"
        )


class KernelCache(FunctionCache):
    """Numba's cache of one function, in our folder.

    If the folder cannot be written to, every process compiles its kernels, and logs a warning once.

    When several processes need the same code, one compiles it and the others wait: dozens of workers that
    start with an empty cache take as long as one. A process that compiles a kernel waits only for kernels
    that this one calls, so that no two processes wait for each other.

    Processes save one after the other. Numba numbers the files of a function by its index: two processes that
    save at once may take the same number, and the index would then name the code of another signature.

    Code for classes or functions of users lies in a folder for their sources. Where these have no file, as
    in a notebook, or were executed again, nothing is kept: it is compiled in each process.

    Args:
        function: the function.
        options: with which it is compiled. Code that was compiled with other options is not reused.
        folder: name of the folder for sources of users; empty for this package's own code.
    """

    def __init__(self, function: Callable[..., object], options: Mapping[str, object], folder: str = ""):
        super().__init__(function)
        self._given = options
        self._options = repr(sorted(options.items()))
        self._compiling: dict[Signed, FileLock] = {}
        self._of_users: dict[str, KernelCache] = {}
        if folder:
            self._move_to(folder)

    def load_overload(self, signature: Signed, context: "BaseContext") -> "CompileResult | None":
        """Return what is cached for a signature, or None: then this process has to compile it."""
        place = self._place(signature)
        if place is None:
            return None
        found = place._load(signature, context)
        if found is not None or not place._wait_for_others(signature):
            return found
        return place._load(signature, context)

    def let_others_go_on(self, signature: Signed) -> None:
        """End the wait of other processes for a signature, whether it was compiled or not."""
        for place in (self, *self._of_users.values()):
            lock = place._compiling.pop(signature, None)
            if lock is not None:
                lock.release()

    def _place(self, signature: Signed) -> "KernelCache | None":
        """Return the cache for a signature; None where sources of users are unknown: nothing is kept then."""
        names = own_modules(self._py_func.__module__, getattr(signature, "args", signature))
        if not names:
            return self
        try:
            folder = f"own-{digest_of_modules(names)}"
        except UnknownSourceError:
            return None
        if folder not in self._of_users:
            self._of_users[folder] = KernelCache(self._py_func, self._given, folder)
        return self._of_users[folder]

    def _move_to(self, folder: str) -> None:
        """Keep files in a folder below the one of the function's module."""
        self._impl.locator.move_to(folder)
        self._cache_path = self._impl.locator.get_cache_path()
        self._cache_file = IndexDataCacheFile(
            cache_path=self._cache_path,
            filename_base=self._impl.filename_base,
            source_stamp=self._impl.locator.get_source_stamp(),
        )

    def _wait_for_others(self, signature: Signed) -> bool:
        """Reserve a signature for this process; return whether another one may have compiled it meanwhile."""
        digest = hashlib.sha256(f"{self._impl.filename_base} {signature}".encode()).hexdigest()[:16]
        lock = FileLock(Path(self.cache_path, f"{digest}.lock"), timeout=COMPILE_TIMEOUT)
        try:
            Path(self.cache_path).mkdir(parents=True, exist_ok=True)
            lock.acquire()
        # A timeout is an OSError, too; file systems without locks raise NotImplementedError.
        except (OSError, NotImplementedError):
            return False  # both processes compile it
        self._compiling[signature] = lock
        return True

    def _load(self, signature: Signed, context: "BaseContext") -> "CompileResult | None":
        try:
            return super().load_overload(signature, context)
        except OSError:
            return None
        except Exception as error:  # half a file, after a power failure, may raise anything
            _warn_once(f"compiled kernels in {self.cache_path} are damaged ({error!r}) and compiled anew")
            with suppress(OSError):
                self.flush()
            return None

    def save_overload(self, signature: Signed, data: "CompileResult") -> None:
        """Cache what was compiled for a signature, or log a warning where that is not possible."""
        place = self._place(signature)
        if place is None:
            return
        folder = cache_folder()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with FileLock(folder / "lock"):
                FunctionCache.save_overload(place, signature, data)
        except (OSError, NotImplementedError) as error:  # NotImplementedError: a file system without locks
            _warn_once(
                f"compiled kernels cannot be kept in {folder} ({error}): each process compiles them again. "
                "SWARM_GYM_CACHE names another folder"
            )

    def _index_key(self, signature: Signed, codegen: "Codegen") -> tuple[object, ...]:
        return (*super()._index_key(signature, codegen), self._options)


class _Locator:
    """The place of a function's cached code: a folder of ours, which may be a read-only one."""

    def __init__(self, function: Callable[..., object], file: str):
        self._folder = cache_folder() / function.__module__
        self._file = file
        self._line = function.__code__.co_firstlineno

    @classmethod
    def from_function(cls, function: Callable[..., object], file: str) -> "_Locator":
        return cls(function, file)

    def move_to(self, folder: str) -> None:
        """Use a folder below the one of the function's module."""
        self._folder /= folder

    def ensure_cache_path(self) -> None:
        self._folder.mkdir(parents=True, exist_ok=True)

    def get_cache_path(self) -> str:
        return str(self._folder)

    def get_source_stamp(self) -> bytes:
        return _digest_of_file(self._file)

    def get_disambiguator(self) -> str:
        return str(self._line)


class _Code(CompileResultCacheImpl):
    _locator_classes = (_Locator,)


KernelCache._impl_class = _Code


@cache
def _digest_of_file(file: str) -> bytes:
    return hashlib.sha256(Path(file).read_bytes()).digest()


@cache
def _warn_once(message: str) -> None:
    logging.getLogger("swarm_gym").warning(message)
