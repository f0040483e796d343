"""Head of a compiled module: how functions are compiled, and vectors made and passed.

Its text goes into the module before the kernels; it is never imported. Arrays come from Python
once; inside, vectors are pointers, which need neither reference counts nor checks of an index.
"""

import numpy
from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic

jit = njit(nogil=True, error_model="numpy")
kept = njit(nogil=True, cache=True, error_model="numpy")  # where machine code goes into a file


@intrinsic
def pointer(typing_context, array):
    """Return a pointer to the first element of an array."""

    def generate(context, builder, signature, arguments):
        (array_type,) = signature.args
        data = context.make_array(array_type)(context, builder, arguments[0]).data
        return builder.bitcast(data, context.get_value_type(signature.return_type))

    return types.CPointer(array.dtype)(array), generate


@intrinsic
def call_model(typing_context, w, place, name, mode, flags, t, at, to):
    """Call the equations, whose address stands in the vector of the run as the bits of a number."""

    def generate(context, builder, signature, arguments):
        vector, place, *others = arguments
        whole, real = ir.IntType(64), ir.DoubleType()
        places = builder.bitcast(vector, whole.as_pointer())
        address = builder.load(builder.gep(places, [place]))
        kind = ir.FunctionType(
            ir.VoidType(), [whole, whole, whole, real, vector.type, whole, whole]
        )
        function = builder.inttoptr(address, kind.as_pointer())
        name, mode, flags, t, at, to = others
        builder.call(function, [name, mode, flags, t, vector, at, to])
        return cgutils.get_null_value(ir.IntType(8).as_pointer())

    integers = [types.int64] * 3
    return types.void(w, types.int64, *integers, types.float64, types.int64, types.int64), generate


@intrinsic
def call_contacts(typing_context, w, place, whole, name, t, at, to):
    """Call what works out the equations of several contacts, by its address in the vector."""

    def generate(context, builder, signature, arguments):
        vector, place, wholes, name, t, at, to = arguments
        whole, real = ir.IntType(64), ir.DoubleType()
        places = builder.bitcast(vector, whole.as_pointer())
        address = builder.load(builder.gep(places, [place]))
        kind = ir.FunctionType(ir.VoidType(), [whole, real, vector.type, wholes.type, whole, whole])
        function = builder.inttoptr(address, kind.as_pointer())
        builder.call(function, [name, t, vector, wholes, at, to])
        return cgutils.get_null_value(ir.IntType(8).as_pointer())

    integer = types.int64
    return types.void(w, integer, whole, integer, types.float64, integer, integer), generate


@jit
def vector(size):
    """Return an array of zeros."""
    return numpy.zeros(size)
