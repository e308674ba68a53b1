"""A row of a matrix as a NamedTuple, so that kernels read its entries by name.

A kernel that advances many swarms gets the parameters of all of them as one array. An array for each
parameter would take longer: a call from Python spends about 0.2 microseconds on each array.
"""

from typing import Any, NamedTuple, TypeVar

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

Row = TypeVar("Row", bound=NamedTuple)


def named_row(like: Row, matrix: NDArray[np.float64], row: int) -> Row:
    """Return a row of a matrix as a NamedTuple.

    Args:
        like: NamedTuple of the class to return; its values do not matter.
        matrix: (B, number of fields), contiguous, float64.
        row: number of the row, at least 0.
    """
    return type(like)._make(matrix[row])


@intrinsic
def _named_row(context: Any, like: Any, matrix: Any, row: Any) -> Any:  # noqa: ARG001
    numbers = types.NamedUniTuple(types.float64, len(like), like.instance_class)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ARG001
        struct = context.make_array(matrix)(context, builder, arguments[1])
        height, width = (builder.extract_value(struct.shape, axis) for axis in (0, 1))
        if context.enable_boundscheck:
            cgutils.do_boundscheck(context, builder, arguments[2], height)
            cgutils.do_boundscheck(context, builder, width.type(len(like) - 1), width)
        first = builder.mul(arguments[2], width)
        entries = [
            builder.load(builder.gep(struct.data, [builder.add(first, first.type(k))]))
            for k in range(len(like))
        ]
        return context.make_tuple(builder, numbers, entries)

    return numbers(like, matrix, types.intp), generate


@overload(named_row, strict=False, jit_options={"forceinline": True})
def _compiled(like: Any, matrix: Any, row: Any) -> Any:
    if not isinstance(like, types.BaseNamedTuple) or not isinstance(row, types.Integer):
        return None
    if not isinstance(matrix, types.Array) or matrix.dtype != types.float64:
        return None
    if (matrix.ndim, matrix.layout) != (2, "C"):
        return None
    return lambda like, matrix, row: _named_row(like, matrix, row)  # noqa: PLW0108 (no intrinsic is taken)
