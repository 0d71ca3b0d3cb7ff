"""How the numerical core is compiled: one decorator, so that every piece follows the same rules of arithmetic."""

from __future__ import annotations

import numpy as np
from numba import njit, types
from numba.extending import intrinsic, overload
from numba.np.numpy_support import carray
from numpy.typing import NDArray

# IEEE division without a test for zero at each: the core never divides by what can be zero, and the test costs a third
compiled = njit(cache=True, error_model="numpy", nogil=True)

inlined = njit(cache=True, error_model="numpy", nogil=True, inline="always")

# what the step calls without inlining it has no cache of its own, which would outlive a change in what it calls in turn
called = njit(error_model="numpy", nogil=True)


@intrinsic
def _pointer(context, address):  # type: ignore[no-untyped-def]
    """The address, an integer, as a pointer."""

    def generate(codegen, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return builder.inttoptr(arguments[0], codegen.get_value_type(types.voidptr))

    return types.voidptr(address), generate


def unowned(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same numbers without a count of who refers to them; the caller keeps `array` alive while they are in use.

    Numba counts each hand-over of an array to an inlined function. In the step's loop that costs a third of the time.
    """
    return array


@intrinsic
def _data(context, array):  # type: ignore[no-untyped-def]
    """Where an array's numbers begin, as a pointer to them."""

    def generate(codegen, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return codegen.make_array(signature.args[0])(codegen, builder, arguments[0]).data

    return types.CPointer(array.dtype)(array), generate  # type: ignore[no-untyped-call]


def bare(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same numbers without a length, for places that are known to be inside; the caller keeps `array` alive.

    An array that is handed to an inlined function, as the effects' memory is, and an index that might count from the
    end keep the compiler from taking all lanes at once.
    """
    return array


@overload(bare, inline="always")
def _bare(array):  # type: ignore[no-untyped-def]
    return lambda array: _data(array)  # type: ignore[call-arg]


@overload(unowned, inline="always")
def _unowned(array):  # type: ignore[no-untyped-def]
    return lambda array: carray(_pointer(array.ctypes.data), (array.size,), np.float64)  # type: ignore[call-arg]
