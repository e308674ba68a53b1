"""The compiled forms of `functions` and of operators on lanes: a value of lanes is one LLVM vector.

A function is registered for exactly those types for which its compiled form does what the Python form does.
Functions of lanes emit their instructions into their callers, as Numba's own operators do: none of them is
compiled as a function of its own, which would take most of the time that a small kernel takes.
"""

import operator
from collections.abc import Callable
from functools import partial, wraps
from typing import TYPE_CHECKING, Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import infer, infer_global, make_intrinsic_template
from numba.extending import models, overload, register_model

from swarm_gym.compiler.simd.functions import (
    NUM_LANES,
    as_float,
    bits,
    broadcast,
    floor,
    load,
    look_up,
    maximum,
    minimum,
    read,
    square_root,
    store,
    total,
    where,
)

if TYPE_CHECKING:
    from numba.core.datamodel import DataModelManager


class LanesType(types.Type):
    """Numba's type of lanes of a dtype."""

    def __init__(self, dtype: types.Type):
        self.dtype = dtype
        super().__init__(name=f"Lanes({dtype})")


FLOATS = LanesType(types.float64)
WORDS = LanesType(types.uint64)
MASK = LanesType(types.boolean)

_ELEMENTS = {types.float64: ir.DoubleType(), types.uint64: ir.IntType(64), types.boolean: ir.IntType(1)}
_INDEX = ir.IntType(32)


def _vector(lanes: LanesType) -> ir.VectorType:
    return ir.VectorType(_ELEMENTS[lanes.dtype], NUM_LANES)


@register_model(LanesType)
class LanesModel(models.PrimitiveModel):
    """Lanes as LLVM sees them."""

    def __init__(self, manager: "DataModelManager", lanes: LanesType):
        super().__init__(manager, lanes, _vector(lanes))


def _lane_numbers(*lanes: int) -> ir.Constant:
    return ir.Constant(ir.VectorType(_INDEX, len(lanes)), list(lanes))


def _splat(builder: Any, value: Any, lanes: LanesType) -> Any:
    one = builder.insert_element(ir.Constant(_vector(lanes), ir.Undefined), value, _INDEX(0))
    return builder.shuffle_vector(one, one, _lane_numbers(*[0] * NUM_LANES))


def _emit(function: Callable, definition: Callable, accepts: Callable[..., bool]) -> None:
    """Have a function emit instructions into its callers, for the types that `accepts` accepts.

    Args:
        function: the Python form.
        definition: returns the signature and the generator of the instructions, as of `extending.intrinsic`.
        accepts: whether the compiled form exists, by the types of the arguments.
    """

    @wraps(definition)
    def define(context: Any, *kinds: Any) -> Any:
        return definition(context, *kinds) if accepts(*kinds) else None

    template = make_intrinsic_template(function, define, function.__name__)
    infer(template)
    infer_global(function, types.Function(template))


def _compile(function: Callable, compiled: Callable, accepts: Callable[..., bool]) -> None:
    """Register the compiled form of a function on numbers for the types that `accepts` accepts."""
    overload(function, strict=False, jit_options={"forceinline": True})(
        lambda *kinds: compiled if accepts(*kinds) else None
    )


def _are(*lanes: LanesType) -> Callable[..., bool]:
    return lambda *kinds: kinds == lanes


def _is_number(kind: Any) -> bool:
    return isinstance(kind, types.Float | types.Integer)


def _goes_with(lanes: LanesType, other: Any) -> bool:
    """Return whether an operand can be used with lanes: lanes of that kind, or a number that can be one."""
    if other == lanes:
        return True
    return _is_number(other) if lanes == FLOATS else lanes == WORDS and other == types.uint64


def _operands(*allowed: LanesType) -> Callable[[Any, Any], bool]:
    def accepts(a: Any, b: Any) -> bool:
        lanes, other = (a, b) if isinstance(a, LanesType) else (b, a)
        return lanes in allowed and _goes_with(lanes, other)

    return accepts


def _as_lanes(context: Any, builder: Any, value: Any, kind: Any, lanes: LanesType) -> Any:
    if isinstance(kind, LanesType):
        return value
    return _splat(builder, context.cast(builder, value, kind, lanes.dtype), lanes)


def _binary(emit: Callable[[Any, bool], Callable], result: LanesType | None = None) -> Any:
    """Return the definition of an operator; `emit(builder, is_float)` returns its instruction."""

    def definition(context: Any, a: Any, b: Any) -> Any:
        lanes = a if isinstance(a, LanesType) else b

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            vectors = [
                _as_lanes(context, builder, value, kind, lanes)
                for value, kind in zip(arguments, signature.args, strict=True)
            ]
            return emit(builder, lanes == FLOATS)(*vectors)

        return (result or lanes)(a, b), generate

    return definition


def _arithmetic(of_floats: str, of_words: str) -> Callable[[Any, bool], Callable]:
    return lambda builder, is_float: getattr(builder, of_floats if is_float else of_words)


def _comparison(sign: str) -> Callable[[Any, bool], Callable]:
    return lambda builder, is_float: partial(
        builder.fcmp_ordered if is_float else builder.icmp_unsigned, sign
    )


_emit(operator.truediv, _binary(_arithmetic("fdiv", "")), _operands(FLOATS))
for _operator, _names in (
    (operator.add, ("fadd", "add")),
    (operator.sub, ("fsub", "sub")),
    (operator.mul, ("fmul", "mul")),
):
    _emit(_operator, _binary(_arithmetic(*_names)), _operands(FLOATS, WORDS))
for _operator, _name in ((operator.and_, "and_"), (operator.or_, "or_"), (operator.xor, "xor")):
    _emit(_operator, _binary(_arithmetic("", _name)), _operands(WORDS, MASK))
for _operator, _name in ((operator.lshift, "shl"), (operator.rshift, "lshr")):
    _emit(_operator, _binary(_arithmetic("", _name)), _operands(WORDS))
for _operator, _name in (
    (operator.lt, "<"),
    (operator.le, "<="),
    (operator.gt, ">"),
    (operator.ge, ">="),
):
    _emit(_operator, _binary(_comparison(_name), MASK), _operands(FLOATS, WORDS))


def _pointer(context: Any, builder: Any, kind: Any, array: Any, index: Any, lanes: LanesType) -> Any:
    """Return a pointer to the eight elements of `load` and `store`, checked if bounds checks are on."""
    struct = context.make_array(kind)(context, builder, array)
    if context.enable_boundscheck:
        length = builder.extract_value(struct.shape, 0)
        cgutils.do_boundscheck(context, builder, index, length)
        last = index.type(NUM_LANES - 1)
        if kind.ndim == 1:
            cgutils.do_boundscheck(context, builder, builder.add(index, last), length)
        else:
            cgutils.do_boundscheck(context, builder, last, builder.extract_value(struct.shape, 1))
    if kind.ndim == 2:
        index = builder.mul(index, builder.extract_value(struct.shape, 1))
    return builder.bitcast(builder.gep(struct.data, [index]), _vector(lanes).as_pointer())


def _holds_lanes(array: Any, *_: Any) -> bool:
    return (
        isinstance(array, types.Array)
        and array.layout == "C"
        and array.ndim in (1, 2)
        and array.dtype in (types.float64, types.uint64)
    )


def _load(context: Any, array: Any, index: Any) -> Any:
    lanes = LanesType(array.dtype)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer = _pointer(context, builder, array, arguments[0], arguments[1], lanes)
        loaded = builder.load(pointer)
        loaded.align = 8
        return loaded

    return lanes(array, types.intp), generate


_emit(load, _load, _holds_lanes)


def _read(context: Any, rows: Any, row: Any, lane: Any) -> Any:
    signature, generate = _load(context, rows, row)
    return signature.return_type(*signature.args, lane), generate


_emit(read, _read, lambda rows, row, lane: _holds_lanes(rows) and rows.ndim == 2 and lane == types.none)
_compile(
    read,
    lambda rows, row, lane: rows[row, lane],
    lambda rows, row, lane: _holds_lanes(rows) and rows.ndim == 2 and lane != types.none,
)


def _store(context: Any, array: Any, index: Any, lanes: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer = _pointer(context, builder, array, arguments[0], arguments[1], lanes)
        builder.store(arguments[2], pointer).align = 8
        return context.get_dummy_value()

    return types.void(array, types.intp, lanes), generate


_emit(
    store,
    _store,
    lambda array, index, lanes: _holds_lanes(array) and array.mutable and lanes == LanesType(array.dtype),
)


def _broadcast(context: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _splat(builder, arguments[0], FLOATS)

    return FLOATS(types.float64), generate


_emit(broadcast, _broadcast, _is_number)


def _where(context: Any, mask: Any, yes: Any, no: Any) -> Any:
    lanes = next((kind for kind in (yes, no) if isinstance(kind, LanesType)), FLOATS)

    def of_lanes(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        chosen = [_as_lanes(context, builder, arguments[k], signature.args[k], lanes) for k in (1, 2)]
        return builder.select(arguments[0], *chosen)

    def of_numbers(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.select(*arguments)

    if mask == MASK:
        return lanes(mask, yes, no), of_lanes
    return types.float64(types.boolean, types.float64, types.float64), of_numbers


def _can_choose(mask: Any, yes: Any, no: Any) -> bool:
    if mask == types.boolean:
        return _is_number(yes) and _is_number(no)
    lanes = next((kind for kind in (yes, no) if isinstance(kind, LanesType)), FLOATS)
    return mask == MASK and lanes != MASK and _goes_with(lanes, yes) and _goes_with(lanes, no)


_emit(where, _where, _can_choose)


def _larger(sign: str) -> Callable:
    """Return the definition of the larger (">") or smaller ("<") of two; the second where they are equal."""

    def definition(context: Any, a: Any, b: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            first, second = (
                _as_lanes(context, builder, value, kind, FLOATS)
                for value, kind in zip(arguments, signature.args, strict=True)
            )
            return builder.select(builder.fcmp_ordered(sign, first, second), first, second)

        return FLOATS(a, b), generate

    return definition


for _function, _sign, _choose in (
    (maximum, ">", lambda a, b: where(a > b, a, b)),
    (minimum, "<", lambda a, b: where(a < b, a, b)),
):
    _emit(_function, _larger(_sign), _operands(FLOATS))
    _compile(_function, _choose, lambda a, b: _is_number(a) and _is_number(b))


def _of_floats(name: str) -> Any:
    """Return the definition of LLVM's intrinsic of a name, from floats to floats."""

    def definition(context: Any, lanes: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            vector = _vector(FLOATS)
            callee = cgutils.get_or_insert_function(
                builder.module, ir.FunctionType(vector, [vector]), f"llvm.{name}.v{NUM_LANES}f64"
            )
            return builder.call(callee, arguments)

        return lanes(lanes), generate

    return definition


_emit(square_root, _of_floats("sqrt"), _are(FLOATS))
_emit(floor, _of_floats("floor"), _are(FLOATS))
_compile(floor, lambda values: np.floor(values), lambda kind: kind == types.float64)


def _look_up(context: Any, values: Any, indices: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        struct = context.make_array(values)(context, builder, arguments[0])
        places = builder.fptosi(arguments[1], ir.VectorType(ir.IntType(64), NUM_LANES))
        found = ir.Constant(ir.VectorType(ir.IntType(8), NUM_LANES), ir.Undefined)
        for lane in range(NUM_LANES):
            place = builder.extract_element(places, _INDEX(lane))
            if context.enable_boundscheck:
                cgutils.do_boundscheck(context, builder, place, builder.extract_value(struct.shape, 0))
            entry = builder.load(builder.gep(struct.data, [place]))
            found = builder.insert_element(found, entry, _INDEX(lane))
        return builder.uitofp(found, _vector(FLOATS))

    return FLOATS(values, indices), generate


_emit(
    look_up,
    _look_up,
    lambda values, indices: (
        isinstance(values, types.Array)
        and (values.ndim, values.layout, values.dtype) == (1, "C", types.uint8)
        and indices == FLOATS
    ),
)


def _as_float(context: Any, words: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        # The conversion is signed: some processors have one instruction for that on all lanes.
        return builder.sitofp(arguments[0], _vector(FLOATS))

    return FLOATS(words), generate


_emit(as_float, _as_float, _are(WORDS))


def _total(context: Any, lanes: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        vector, half = arguments[0], NUM_LANES // 2
        while half > 0:
            low = builder.shuffle_vector(vector, vector, _lane_numbers(*range(half)))
            high = builder.shuffle_vector(vector, vector, _lane_numbers(*range(half, 2 * half)))
            vector, half = builder.fadd(low, high), half // 2
        return builder.extract_element(vector, _INDEX(0))

    return types.float64(lanes), generate


_emit(total, _total, _are(FLOATS))


def _bits(context: Any, mask: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        byte = builder.bitcast(arguments[0], ir.IntType(NUM_LANES))
        return builder.zext(byte, ir.IntType(64))

    return types.int64(mask), generate


_emit(bits, _bits, _are(MASK))
