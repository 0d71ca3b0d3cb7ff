"""The hybrid automaton of piston and chambers, carried from sample to sample by SUNDIALS CVODE with root finding."""

from __future__ import annotations

import os
import warnings
from contextlib import redirect_stdout

import numpy as np
from numba import njit
from numpy.typing import NDArray
from sksundae.cvode import CVODE

from eha_exam.errors import ExamError
from eha_exam.truth.laws import (
    CONTACT,
    DIRECTION,
    END,
    MOTION,
    POSITION,
    REVERSAL_SPEED,
    VELOCITY,
    derivatives,
    events,
    margins,
)
from eha_exam.truth.valve import Valve, evaluate

# what goes wrong is raised; SUNDIALS would write it into whatever is printed, too
os.environ.setdefault("SUNLOGGER_WARNING_FILENAME", os.devnull)

ABSOLUTE_TOLERANCE = np.array([1e-11, 1e-9, 1.0, 1.0, 1.0, 1.0, 1e-11, 1e-12, 1e-12, 1e-12, 1e-12] + [1.0] * 4)
RELATIVE_TOLERANCE = 1e-8
EVENTS = 5
ROOT_FOUND = 2
"""CVODE's status for a step that ended on an event. Its list of events is the history since the start, latest last."""
SHORTEST_SPAN = 1e-9
"""Seconds too few to integrate over: an event this close to the end of a span counts as happening at the end."""
EVENTS_PER_SAMPLE = 500
"""More changes of mode than this within one sample are no motion but a fault of the model."""


@njit(cache=True)
def _piece_at(table, cursor, time):  # type: ignore[no-untyped-def]
    while table[cursor[0] + 1, 0] <= time:
        cursor[0] += 1
    while cursor[0] > 0 and table[cursor[0], 0] > time:
        cursor[0] -= 1
    return table[cursor[0]]


def _rates(time, y, rates, automaton):  # type: ignore[no-untyped-def]
    piece = _piece_at(automaton.valve.table, automaton.cursor, time)
    try:
        derivatives(time, y, rates, evaluate(piece, time, automaton.records)[2], automaton.mode, automaton.records)
    except ZeroDivisionError:  # a state that ran away; raised from here, the solver would turn it into another error
        rates[:] = np.nan


def _events(time, y, values, automaton):  # type: ignore[no-untyped-def]
    events(time, y, values, automaton.mode, automaton.records)


_events.direction = [-1, -1, -1, 0, 0]  # type: ignore[attr-defined]
_events.terminal = [True] * EVENTS  # type: ignore[attr-defined]


class Automaton:
    """State and mode of the truth; `advance` moves them to a later time."""

    def __init__(self, valve: Valve, records: NDArray[np.void], state: NDArray[np.float64], time: float = 0.0) -> None:
        self.valve = valve
        self.records = records
        self.cursor = np.zeros(1, np.int64)
        self.mode = np.array([float(state[VELOCITY] != 0.0), np.sign(state[VELOCITY]), 0.0, 0.0])
        self.time = time
        self.state = state
        self._solver = CVODE(
            _rates,
            method="Adams",
            rtol=RELATIVE_TOLERANCE,
            atol=ABSOLUTE_TOLERANCE[: len(state)],
            max_num_steps=100_000,
            eventsfn=_events,
            num_events=EVENTS,
            userdata=self,
        )
        self._settle()

    @property
    def record(self) -> np.void:
        """The parameters in force."""
        record: np.void = self.records[0]
        return record

    def change_record(self, records: NDArray[np.void]) -> None:
        """Put other parameters in force from now on."""
        self.records = records
        speed = float(self.state[VELOCITY])
        if self.mode[MOTION] == 1.0 and abs(speed) > REVERSAL_SPEED:
            # without dry friction the piston may have turned round unnoticed
            self.mode[DIRECTION] = np.sign(speed)
        self._settle()

    def advance(self, stop: float) -> None:
        """Integrate to `stop` [s] through every change of mode on the way; ExamError where that cannot be solved."""
        if stop - self.time < SHORTEST_SPAN:
            return
        for _ in range(EVENTS_PER_SAMPLE):
            with warnings.catch_warnings(), redirect_stdout(None):
                warnings.simplefilter("ignore")
                result = self._solver.step(stop, tstop=stop)
            self.time, self.state = float(result.t), np.array(result.y)
            if self.mode[MOTION] == 0.0:
                self.state[POSITION], self.state[VELOCITY] = self._rest, 0.0
            if not result.success or not np.all(np.isfinite(self.state)):
                raise ExamError(f"the truth cannot be integrated past {self.time:.6f} s: {result.message}")
            if result.status != ROOT_FOUND:
                return
            arrived = stop - self.time < SHORTEST_SPAN
            self.time = stop if arrived else self.time
            self._settle(np.reshape(result.i_events, (-1, EVENTS))[-1])
            if arrived:
                return
        raise ExamError(f"the truth changes its mode without end at {self.time:.6f} s; the case is not physical")

    def valve_state(self) -> tuple[float, float, float, float]:
        """Coil current, spool target and spool position [A], and spool rate [A/s], now."""
        piece = _piece_at(self.valve.table, self.cursor, self.time)
        state: tuple[float, float, float, float] = evaluate(piece, self.time, self.records)
        return state

    def _settle(self, happened: NDArray[np.int64] | None = None) -> None:
        """Choose the mode at the present state, given the events that just happened, and restart the integrator."""
        mode, y, r = self.mode, self.state, self.record
        fired = np.zeros(EVENTS) if happened is None else happened
        x = y[POSITION]
        mode[CONTACT] = 1.0 if x > r["end_stop_upper"] else -1.0 if x < r["end_stop_lower"] else 0.0
        if fired[3]:
            mode[CONTACT] = 1.0 if y[VELOCITY] > 0.0 else 0.0
        elif fired[4]:
            mode[CONTACT] = -1.0 if y[VELOCITY] < 0.0 else 0.0
        reach = r["actuator_displacement"]
        stopped = mode[MOTION] == 0.0
        if mode[MOTION] == 1.0 and (fired[1] or fired[2]):
            mode[END] = 1.0 if fired[1] else -1.0
            y[POSITION] = mode[END] * reach
            stopped = True
        elif mode[MOTION] == 1.0 and fired[0]:
            stopped = True
        if stopped:
            y[VELOCITY] = 0.0
            force, forward, backward = margins(self.time, y, mode, self.records)
            if -backward < force < forward:
                mode[MOTION] = 0.0
            else:
                mode[MOTION], mode[DIRECTION], mode[END] = 1.0, 1.0 if force >= forward else -1.0, 0.0
        self._rest = float(y[POSITION])
        self._solver.init_step(self.time, y)
