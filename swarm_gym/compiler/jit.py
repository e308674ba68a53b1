"""The decorators of compiled functions: `entry` for what Python calls, `kernel` for what these call."""

import typing
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numba
import numpy as np
from numba import types
from numba.core import ir
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import AnalysisPass, register_pass
from numba.core.registry import CPUDispatcher
from numba.core.typed_passes import NopythonTypeInference
from numba.extending import overload

from swarm_gym.compiler.cache import KernelCache
from swarm_gym.compiler.linked_code import EntryCode, KernelCode, empty_code
from swarm_gym.compiler.own_sources import has_file, tell_apart

if TYPE_CHECKING:
    from numba.core.compiler import StateDict
    from numba.core.compiler_machinery import PassManager

Function = TypeVar("Function", bound=Callable[..., object])
Result = TypeVar("Result")
Inline = Literal["late", "early"]
_INLINE: dict[Inline | None, dict[str, Any]] = {
    None: {},
    "late": {"forceinline": True},
    "early": {"inline": "always"},
}


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


def kernel(
    function: Function | None = None, *, inline: Inline | None = None, borrows: bool = False
) -> Function | Callable[[Function], Function]:
    """Compile a function, as `entry` does, that only compiled functions call; Python calls it uncompiled.

    The code by which Python would call it is not compiled: half the time of a small kernel with many arrays.
    What is compiled is only linked into entries, see `linked_code`.

    Args:
        function: the function; without it, a decorator with these options is returned.
        inline: when it is copied into its callers. "late": by LLVM, while they are optimised; for what runs
            once per move or oftener, since a call passes every array of a NamedTuple on the stack, which
            costs more than a small kernel does. "early": by Numba, before they are compiled; for large
            kernels with one caller or two, which then take less time to compile. None: LLVM decides, which
            inlines what is small, or called at one place of an entry.
        borrows: whether it only borrows arrays from its callers, so that references to them are not counted.
            Where the last use of an array depends on a branch, Numba counts it while the kernel runs,
            atomically, and a NamedTuple array by array: that took a fish more time than all its arithmetic.
            Only a kernel that owns no array can borrow: one that allocates or returns an array, or calls a
            kernel that returns one, is refused when it is compiled.

    Raises:
        ValueError: if a kernel that is inlined early borrows, which is up to its callers.
    """
    if inline == "early" and borrows:
        raise ValueError("a kernel that is inlined early borrows where its callers do: leave out `borrows`")

    def decorate(function: Function) -> Function:
        return _compile(
            function, _KernelDispatcher, no_cpython_wrapper=True, _nrt=not borrows, **_INLINE[inline]
        )

    return decorate if function is None else decorate(function)


def kernel_by_class(kernels: Mapping[type, Callable[..., Result]]) -> Callable[..., Result]:
    """Return a function that calls the kernel of its first argument's class, a NamedTuple.

    It is inlined into its callers. A caller is compiled once for each class that it is called with:
    nothing is decided while it runs.
    """

    def call(table: object, *arguments: object) -> Result:
        return kernels[type(table)](table, *arguments)

    def choose(counted: bool) -> Callable[..., Callable[..., Result] | None]:
        def chosen(table: types.Type, *_: types.Type) -> Callable[..., Result] | None:
            kernel = kernels.get(getattr(table, "instance_class", type(None)))
            borrows = getattr(kernel, "borrows", False)
            return None if borrows is counted else getattr(kernel, "py_func", kernel)

        return chosen

    call.kernels_by_class = kernels  # type: ignore[attr-defined]  # for messages
    for counted in (True, False):
        options = {
            "forceinline": True,
            "error_model": "numpy",
            "_nrt": counted,
            "pipeline_class": _Compiler,
        }
        overload(call, strict=False, jit_options=options)(choose(counted))
    return call


@register_pass(mutates_CFG=False, analysis_only=True)
class _CheckBorrowing(AnalysisPass):
    """A check, when all types are known, that a kernel which borrows its arrays never comes to own one.

    References to arrays are not counted in such a kernel. An array that it owned would never be freed. Numba
    refuses to allocate one in it; here, it is also refused to return one, and to call a kernel that returns
    one.
    """

    _name = "swarm_gym_check_borrowing"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: "StateDict") -> bool:
        """Raise TypeError if a kernel that borrows returns an array, or calls a kernel that returns one."""
        if state.flags.nrt:
            return False
        name = state.func_id.func_qualname
        if _holds_array(state, state.return_type):
            raise TypeError(f"{name} returns {state.return_type}, but kernels that borrow arrays return none")
        for callee, returned in _called_kernels(state):
            if _holds_array(state, returned):
                raise TypeError(
                    f"{name} borrows arrays, but calls {callee}, which returns {returned}, and would never "
                    f"free it: leave out `borrows` in {name}, or let {callee} fill an array that it is given"
                )
        return False


def _called_kernels(state: Any) -> Iterator[tuple[str, Any]]:
    """Yield the name and the return type of every kernel that is called."""
    for expression, signature in state.calltypes.items():
        if not (isinstance(expression, ir.Expr) and expression.op == "call"):
            continue
        called = state.typemap[expression.func.name]
        if isinstance(called, types.Dispatcher):
            yield called.dispatcher.py_func.__qualname__, signature.return_type
        elif isinstance(called, types.Function):
            kernels = getattr(called.typing_key, "kernels_by_class", None)
            if kernels is not None:
                kernel = kernels[signature.args[0].instance_class]
                yield getattr(kernel, "py_func", kernel).__qualname__, signature.return_type


def _holds_array(state: Any, kind: Any) -> bool:
    return state.targetctx.data_model_manager[kind].contains_nrt_meminfo()


class _Compiler(CompilerBase):
    """Numba's compiler, with a check of what borrows, and with places for the code of kernels and entries."""

    def define_pipelines(self) -> "list[PassManager]":
        if self.state.library is None:
            kind = KernelCode if self.state.flags.no_cpython_wrapper else EntryCode
            codegen = self.state.targetctx.codegen()
            self.state.library = empty_code(kind, codegen, self.state.func_id.func_qualname)
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(_CheckBorrowing, NopythonTypeInference)
        passes.finalize()
        return [passes]


class _Dispatcher(CPUDispatcher):
    def compile(self, arguments: Any) -> Any:
        try:
            return super().compile(arguments)
        finally:
            if isinstance(self._cache, KernelCache):
                self._cache.let_others_go_on(arguments)


class _KernelDispatcher(_Dispatcher):
    @property
    def borrows(self) -> bool:
        return not self.targetoptions["_nrt"]

    def __call__(self, *arguments: Any) -> Any:
        return self.py_func(*arguments)


def _compile(function: Function, kind: type[_Dispatcher], **options: Any) -> Function:
    if numba.config.DISABLE_JIT:
        # Words of a random stream wrap around by design; NumPy's scalars would warn of it.
        return np.errstate(over="ignore")(function)
    # Said of every kernel, since Numba would take what is not said from the first caller that needs it.
    said = {"_nrt": True, "forceinline": False}
    options = {**said, "nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True, **options}
    plain: Any = function
    tell_apart(plain)
    dispatcher = numba.njit(pipeline_class=_Compiler, **options)(function)
    dispatcher.__class__ = kind
    if has_file(plain):  # what is typed in is compiled in each process, see `own_sources`
        dispatcher._cache = KernelCache(function, options)
    return dispatcher
