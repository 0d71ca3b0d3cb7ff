"""SUNDIALS' CVODE from the library that scikit-sundae ships, with a compiled right-hand side and a compiled loop.

scikit-sundae itself calls a Python function for each evaluation, which would measure Python. After A. C. Hindmarsh et
al., "SUNDIALS", ACM Transactions on Mathematical Software 31 (2005).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from importlib.metadata import files
from typing import Any

import numba
import numpy as np

from benchmarks.actuator import SCALES, Array, cvode_rate

MOST_STEPS = 1_000_000
_BDF, _NORMAL = 2, 1
_integer, _real, _whole = ctypes.c_int64, ctypes.c_double, ctypes.c_int  # pointers as integers, as numba passes them


@cache
def _library(name: str) -> ctypes.CDLL:
    for file in files("scikit-sundae") or ():
        if file.name.startswith(f"libsundials_{name}-"):
            return ctypes.CDLL(str(file.locate()), mode=ctypes.RTLD_GLOBAL)
    raise OSError(f"scikit-sundae ships no libsundials_{name} here")


def _function(library: str, name: str, result: Any, *arguments: Any) -> Any:
    found = _library(library)[name]
    found.argtypes, found.restype = arguments, result
    return found


class Cvode:
    """CVODE with its BDF method and a dense Jacobian by differences, at tolerances relative to SCALES.

    Raises:
        OSError: the library is not there.
    """

    def __init__(self, tolerance: float, setting: Array) -> None:
        for name in ("core", "nvecserial", "sunmatrixdense", "sunlinsoldense"):
            _library(name)
        self._state, self._absolute, self._told = np.zeros(7), tolerance * SCALES, setting.copy()
        context = _integer()
        _function("core", "SUNContext_Create", _whole, _whole, ctypes.c_void_p)(0, ctypes.byref(context))
        vector = _function("nvecserial", "N_VMake_Serial", _integer, _whole, _integer, _integer)
        self._vector = vector(7, self._state.ctypes.data, context)
        content = ctypes.c_int64.from_address(self._vector).value
        if ctypes.c_int64.from_address(content + 8).value != self._state.ctypes.data:
            raise OSError("scikit-sundae's SUNDIALS was built with indices of 64 bits, another layout than is known")
        absolute = vector(7, self._absolute.ctypes.data, context)
        matrix = _function("sunmatrixdense", "SUNDenseMatrix", _integer, _whole, _whole, _integer)(7, 7, context)
        solver = _function("sunlinsoldense", "SUNLinSol_Dense", _integer, *[_integer] * 3)(
            self._vector, matrix, context
        )
        self._memory = _function("cvode", "CVodeCreate", _integer, _whole, _integer)(_BDF, context)
        start = _function("cvode", "CVodeInit", _whole, _integer, ctypes.c_void_p, _real, _integer)
        start(self._memory, cvode_rate.address, 0.0, self._vector)
        _function("cvode", "CVodeSVtolerances", _whole, _integer, _real, _integer)(self._memory, tolerance, absolute)
        _function("cvode", "CVodeSetLinearSolver", _whole, *[_integer] * 3)(self._memory, solver, matrix)
        _function("cvode", "CVodeSetUserData", _whole, *[_integer] * 2)(self._memory, self._told.ctypes.data)
        _function("cvode", "CVodeSetMaxNumSteps", _whole, _integer, ctypes.c_long)(self._memory, MOST_STEPS)

    def run(self, state: Array, voltages: Array, hold: float, anew: bool) -> Array:
        """The states (n, 7) at each hold's end; `anew`: started again at each, as its manual says for a jump."""
        loop, advance, again = _compiled_loop()
        self._state[:] = state
        arguments = self._memory, self._vector, self._state, self._told
        rows: Array = loop(advance, again, *arguments, voltages, hold, anew)
        if np.isnan(rows).any():
            raise ArithmeticError("CVODE gave up")
        return rows


@cache
def _compiled_loop() -> tuple[Callable[..., Array], Any, Any]:
    advance = _function("cvode", "CVode", _whole, _integer, _real, _integer, _integer, _whole)
    again = _function("cvode", "CVodeReInit", _whole, _integer, _real, _integer)

    @numba.njit
    def loop(
        advance: Any, again: Any, memory: int, vector: int, state: Array, setting: Array, voltages: Array, hold: float,
        anew: bool,
    ) -> Array:  # fmt: skip
        rows = np.full((len(voltages), 7), np.nan)
        reached = np.zeros(1)
        again(memory, 0.0, vector)
        for k in range(len(voltages)):
            setting[0] = voltages[k]
            if anew and k > 0:
                again(memory, k * hold, vector)
            if advance(memory, (k + 1) * hold, vector, reached.ctypes.data, 1) < 0:
                break
            rows[k] = state
        return rows

    return loop, advance, again
