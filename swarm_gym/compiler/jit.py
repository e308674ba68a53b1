"""The decorators of compiled functions, with a cache that cannot be stale.

Numba's cache looks at the file of the cached function only: an edit in a *called* function of another
file goes unnoticed, and code compiled without bounds checks is reused when they are asked for. Here the
cache folder is named by a digest of all sources that hold kernels and of the bounds-check flag, so neither
can happen.
"""

import hashlib
import logging
import typing
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, Literal, TypeVar

import numba
import numpy as np
from filelock import FileLock
from numba.core import types
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.registry import CPUDispatcher
from numba.core.types.containers import BaseTuple
from numba.extending import overload

from swarm_gym.files import digest_of_sources, user_cache

# Kernels stand in these folders and files of the package alone, and call nothing from outside of them.
KERNEL_SOURCES = ("compiler", "population.py", "problem", "optimizers", "reference")
PATIENCE = 600.0  # seconds that a process waits for the kernel that another one compiles

Function = TypeVar("Function", bound=Callable[..., Any])
Inline = Literal["late", "early"]
_INLINE: dict[Inline, dict[str, Any]] = {"late": {"forceinline": True}, "early": {"inline": "always"}}


@cache
def cache_folder() -> Path:
    """Folder for compiled kernels of exactly these sources, in the user's cache."""
    package = Path(__file__).parents[1]
    parts = [digest_of_sources(package / part) for part in KERNEL_SOURCES]
    digest = hashlib.sha256(f"{parts} boundscheck={numba.config.BOUNDSCHECK}".encode()).hexdigest()[:16]
    return user_cache() / "kernels" / digest


@cache
def announce_compilation() -> None:
    """Say, once per process, that kernels are about to be compiled, if none of these sources are cached."""
    if not numba.config.DISABLE_JIT and not any(cache_folder().rglob("*.nbi")):
        logging.getLogger("swarm_gym").warning(
            "compiling the kernels for these sources, once; this takes about half a minute for each optimizer"
        )


def entry(function: Function) -> Function:
    """Compile a function that Python calls.

    It takes and returns arrays, numbers and NamedTuples of these, and is compiled when it is first called.
    The interpreter lock is released while it runs. Floating-point sums keep the order they are written in (no
    `fastmath`), so a kernel gives the same bits wherever it is called from.
    """
    return _compile(function, _Dispatcher)


@typing.overload
def kernel(function: Function) -> Function: ...


@typing.overload
def kernel(*, inline: Inline | None = None, borrows: bool = False) -> Callable[[Function], Function]: ...


def kernel(function: Any = None, *, inline: Inline | None = None, borrows: bool = False) -> Any:
    """Compile a function, as `entry` does, that only compiled functions call; Python calls it uncompiled.

    The code by which Python would call it is not compiled: half the time of a small kernel with many arrays.

    Args:
        function: the function; without it, a decorator with these options is returned.
        inline: when it is copied into its callers. "late": by LLVM, while they are optimised; for what runs
            once per move or oftener, since a call passes every array of a NamedTuple on the stack, which
            costs more than a small kernel does. "early": by Numba, before they are compiled; for large
            kernels with one caller or two, since code is optimised anew at each level of calls. None: LLVM
            decides.
        borrows: whether it only borrows arrays from its callers, so that references to them are not counted.
            Where the last use of an array depends on a branch, Numba counts it while the kernel runs,
            atomically, and a NamedTuple array by array: that took a fish more time than all its arithmetic.
            Only a kernel that owns no array can borrow. It must not allocate one (Numba refuses it), return
            one (refused here), or call a kernel that returns one, since nobody would free it.

    Raises:
        ValueError: if a kernel that is inlined early borrows, which is up to its callers.
    """
    if inline == "early" and borrows:
        raise ValueError("a kernel that is inlined early borrows where its callers do: leave out `borrows`")

    def decorate(function: Function) -> Function:
        options = {} if inline is None else _INLINE[inline]
        return _compile(function, _InnerDispatcher, no_cpython_wrapper=True, _nrt=not borrows, **options)

    return decorate if function is None else decorate(function)


def kernel_by_class(kernels: dict[type, Callable[..., Any]]) -> Callable[..., Any]:
    """Return a function that calls the kernel of its first argument's class, a NamedTuple.

    It is inlined into its callers. A caller is compiled once for each class that it is called with:
    nothing is decided while it runs.
    """

    def call(table: Any, *arguments: Any) -> Any:
        return kernels[type(table)](table, *arguments)

    def choose(counted: bool) -> Callable[..., Callable[..., Any] | None]:
        def chosen(table: Any, *_: Any) -> Callable[..., Any] | None:
            kernel = kernels.get(getattr(table, "instance_class", type(None)))
            borrows = getattr(kernel, "borrows", False)
            return None if borrows is counted else getattr(kernel, "py_func", kernel)

        return chosen

    for counted in (True, False):
        options = {"forceinline": True, "error_model": "numpy", "_nrt": counted}
        overload(call, strict=False, jit_options=options)(choose(counted))
    return call


class _Dispatcher(CPUDispatcher):
    def compile(self, arguments: Any) -> Any:
        try:
            return super().compile(arguments)
        finally:
            if isinstance(self._cache, _KernelCache):
                self._cache.let_others_go_on(arguments)


class _InnerDispatcher(_Dispatcher):
    @property
    def borrows(self) -> bool:
        return not self.targetoptions["_nrt"]

    def __call__(self, *arguments: Any) -> Any:
        return self.py_func(*arguments)

    def compile(self, arguments: Any) -> Any:
        entry_point = super().compile(arguments)
        returned = self.overloads[arguments].signature.return_type
        if self.borrows and _holds_array(returned):
            raise TypeError(
                f"{self.py_func.__qualname__} returns {returned}, but kernels that borrow arrays return none"
            )
        return entry_point


def _holds_array(kind: Any) -> bool:
    if isinstance(kind, BaseTuple):
        return any(_holds_array(part) for part in kind)
    return isinstance(kind, types.Array)


def _compile(function: Function, kind: type[_Dispatcher], **options: Any) -> Function:
    if numba.config.DISABLE_JIT:
        # Words of a random stream wrap around by design; NumPy's scalars would warn of it.
        return np.errstate(over="ignore")(function)
    always = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
    # Whether references are counted is said of every kernel: else it goes by who calls it first.
    dispatcher = numba.njit(**{"_nrt": True, **always, **options})(function)
    dispatcher.__class__ = kind
    dispatcher._cache = _KernelCache(function)
    return dispatcher


class _Place:
    """Where the code of a function is cached: in our folder, which may be a read-only one."""

    def __init__(self, function: Callable[..., Any], file: str):
        self._folder = cache_folder() / function.__module__
        self._file = file
        self._line = function.__code__.co_firstlineno

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> "_Place":
        return cls(function, file)

    def ensure_cache_path(self) -> None:
        self._folder.mkdir(parents=True, exist_ok=True)

    def get_cache_path(self) -> str:
        return str(self._folder)

    def get_source_stamp(self) -> bytes:
        return _digest_of_file(self._file)

    def get_disambiguator(self) -> str:
        return str(self._line)


class _Code(CompileResultCacheImpl):
    _locator_classes = (_Place,)


class _KernelCache(FunctionCache):
    """Numba's cache, in our folder; without it, kernels are compiled in every process, which is said once.

    Of processes that need the same code, one compiles it, and the others wait: dozens of workers that start
    with an empty cache take as long as one. Who compiles waits only for kernels that its own one calls, so
    that no two processes wait for each other.

    Processes save one after the other: Numba numbers the files of a function by its index, two processes that
    save at once may take the same number, and what the index then names is the code of another signature.
    """

    _impl_class = _Code

    def __init__(self, function: Callable[..., Any]):
        super().__init__(function)
        self._compiling: dict[Any, FileLock] = {}

    def load_overload(self, signature: Any, context: Any) -> Any:
        found = self._load(signature, context)
        if found is not None or not self._wait_for_others(signature):
            return found
        return self._load(signature, context)

    def let_others_go_on(self, signature: Any) -> None:
        """Whatever became of what was not in the cache."""
        lock = self._compiling.pop(signature, None)
        if lock is not None:
            lock.release()

    def _wait_for_others(self, signature: Any) -> bool:
        """Have this process alone compile a signature; whether another one may have done so meanwhile."""
        digest = hashlib.sha256(f"{self._impl.filename_base} {signature}".encode()).hexdigest()[:16]
        lock = FileLock(Path(self.cache_path, f"{digest}.lock"), timeout=PATIENCE)
        try:
            Path(self.cache_path).mkdir(parents=True, exist_ok=True)
            lock.acquire()
        # Compiled twice, then; the second, of file systems without locks.
        except (OSError, NotImplementedError):  # `Timeout` is an OSError, too
            return False
        self._compiling[signature] = lock
        return True

    def _load(self, signature: Any, context: Any) -> Any:
        try:
            return super().load_overload(signature, context)
        except OSError:
            return None
        except Exception as error:  # half a file, after a power failure, may be anything
            _warn_once(f"compiled kernels in {self.cache_path} are damaged ({error!r}) and compiled anew")
            with suppress(OSError):
                self.flush()
            return None

    def save_overload(self, signature: Any, data: Any) -> None:
        folder = cache_folder()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with FileLock(folder / "lock"):
                super().save_overload(signature, data)
        # The second, of file systems without locks.
        except (OSError, NotImplementedError) as error:
            _warn_once(
                f"compiled kernels cannot be kept in {folder} ({error}): each process compiles them again. "
                "SWARM_GYM_CACHE names another folder"
            )


@cache
def _digest_of_file(file: str) -> bytes:
    return hashlib.sha256(Path(file).read_bytes()).digest()


@cache
def _warn_once(message: str) -> None:
    logging.getLogger("swarm_gym").warning(message)
