"""The compiled step as LLVM text that no Python stands behind."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

import numpy as np
from numba import njit, types
from numba.np.numpy_support import carray
from numba.np.unsafe.ndarray import to_fixed_tuple

from eha_core.effects import effects
from eha_core.parameters import step_rows
from eha_core.plant.composite import compiled_step
from eha_core.plant.state import AT, COLUMNS

DYNAMICS = 10
"""Numbers of the valve's propagator; see `eha_core.plant.step.advance`."""

MEMORY = max(1, sum(len(effect.memory) for effect in effects()))
"""Numbers that the effects remember."""

NAME = "eha_kernel_advance"
"""The function: int (void **, void **, double *state, double *memory, double *history, int64_t places of history,
double *parameters, bool *active, double *propagator, double *voltages, int64_t steps, double step_size, double *row);
zero unless memory ran out."""

# the wrappers that Python and `cfunc` call have Python's error path
_OPTIONS: dict[str, Any] = {
    "error_model": "numpy", "nogil": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True
}  # fmt: skip
_FIXED: Any = to_fixed_tuple


@cache
def kernel_text() -> str:
    """LLVM text of `advance` of the whole catalogue under the name NAME, for any target of 64 bits.

    It calls malloc, free and functions of C's mathematics, and no others.
    """
    advance, fixed = compiled_step().advance, _FIXED
    states, memories, values, acting, columns = len(AT), MEMORY, len(step_rows()), len(effects()), len(COLUMNS)
    numbers, flags = types.CPointer(types.double), types.CPointer(types.boolean)
    count, number = types.int64, types.double
    signature = types.void(numbers, numbers, numbers, count, numbers, flags, numbers, numbers, count, number, numbers)

    @njit(signature, **_OPTIONS)
    def kernel(state, memory, history, ring, parameters, active, propagator, voltages, steps, step_size, row):
        advance(
            carray(state, (states,), np.float64), carray(memory, (memories,), np.float64),
            carray(history, (ring,), np.float64),
            fixed(carray(parameters, (values,), np.float64), values),
            fixed(carray(active, (acting,), np.bool_), acting),
            fixed(carray(propagator, (DYNAMICS,), np.float64), DYNAMICS),
            carray(voltages, (steps,), np.float64), step_size, steps, carray(row, (1, columns), np.float64),
        )  # fmt: skip

    made: Any = next(iter(kernel.overloads.values()))
    return _without_python(made.library.get_llvm_str(), made.fndesc.mangled_name)


def _without_python(text: str, name: str) -> str:
    """Text of which one function remains visible, under NAME.

    Once all others are internal the compiler drops what nothing calls, such as Numba's reports of errors to Python. The
    target's layout and triple are left to the compiler, and memory comes from C.
    """
    text = re.sub(r"^target .*\n", "", text, flags=re.MULTILINE)
    text = text.replace("define linkonce_odr", "define internal").replace("common local_unnamed_addr", "internal")
    text = re.sub(rf'^define (.*@"?){re.escape(name)}', rf"define hidden \1{name}", text, flags=re.MULTILINE)
    return text.replace(name, NAME).replace("@NRT_Allocate", "@malloc").replace("@NRT_Free", "@free")
