"""A check, while a kernel is compiled, that one which borrows its arrays never comes to own one.

References to arrays are not counted in such a kernel. An array that it owned would never be freed. Numba
refuses to allocate one in it; here, it is also refused to return one, and to call a kernel that returns one.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from numba.core import ir, types
from numba.core.compiler_machinery import AnalysisPass, register_pass

if TYPE_CHECKING:
    from numba.core.compiler import StateDict


@register_pass(mutates_CFG=False, analysis_only=True)
class CheckBorrowing(AnalysisPass):
    """The check, for when all types are known."""

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
