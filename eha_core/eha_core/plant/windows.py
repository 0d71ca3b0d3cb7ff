"""The compiled step, and the lock-step, taken through a record's windows, in each of which the piston begins anew.

Windows are short where friction is to be seen, and a loop over them outside would take as long as their steps. What the
functions take are pieces, as `active_intervals.stretches` cuts them; the first one's window is begun by the caller,
before the effects that begin to act there.
"""

from __future__ import annotations

from eha_core.compiled import compiled
from eha_core.plant import lane_rows as at
from eha_core.plant.active_intervals import BEGINS, ENDS, EVERY, FIRST, FIRST_ROW, LAST, LAST_ROW
from eha_core.plant.state import AT

from . import lanes as lock_step
from . import step


@compiled
def begin(window, time, starts, shown, slots, state, memory):
    """Put the piston into the state in which a window starts, and sensors that trail to what they showed then.

    starts: (windows, 4); shown: (windows, slots); slots: of the memory, which are those sensors'.
    """
    state[AT.time] = time
    for place in range(4):
        state[AT.position + place] = starts[window, place]
    for place in range(len(slots)):
        memory[slots[place]] = shown[window, place]


@compiled
def advance(
    pieces, starts, shown, slots, ends, state, memory, history, parameters, active, propagator, inputs, step_size, rows,
):
    """`step.advance` through windows; fills `ends` (windows, 4) with the piston's state at the end of each."""
    for number in range(len(pieces)):
        first, last, window = pieces[number, FIRST], pieces[number, LAST], pieces[number, BEGINS]
        if number and window >= 0:
            begin(window, first * step_size, starts, shown, slots, state, memory)
        step.advance(
            state, memory, history, parameters, active, propagator, inputs[first:last], step_size,
            pieces[number, EVERY], rows[pieces[number, FIRST_ROW] : pieces[number, LAST_ROW]],
        )
        if pieces[number, ENDS] >= 0:
            ends[pieces[number, ENDS]] = state[AT.position : AT.position + 4]


@compiled
def advance_driven(
    pieces, starts, shown, slots, ends, state, memory, parameters, active, pressures_a, pressures_b, step_size, rows,
):
    """The same of `step.advance_driven`."""
    for number in range(len(pieces)):
        first, last, window = pieces[number, FIRST], pieces[number, LAST], pieces[number, BEGINS]
        if number and window >= 0:
            begin(window, first * step_size, starts, shown, slots, state, memory)
        step.advance_driven(
            state, memory, parameters, active, pressures_a[first:last], pressures_b[first:last], step_size,
            pieces[number, EVERY], rows[pieces[number, FIRST_ROW] : pieces[number, LAST_ROW]],
        )
        if pieces[number, ENDS] >= 0:
            ends[pieces[number, ENDS]] = state[AT.position : AT.position + 4]


@compiled
def begin_lanes(window, time, starts, shown, leaking, slots, block, lanes):
    """`begin` in every lane of a block, and the internal leakage of that window.

    starts: (windows, 4, lanes); shown: (windows, slots); leaking: (windows, lanes); slots: (slots, lanes) places in
    `block`.
    """
    for lane in range(lanes):
        block[at.TIME + lane] = time
        block[at.STATED_LEAKAGE + lane] = leaking[window, lane]
        for place in range(4):
            block[at.POSITION + place * at.LANES + lane] = starts[window, place, lane]
        for place in range(len(slots)):
            block[slots[place, lane]] = shown[window, place]


@compiled
def end_lanes(window, ends, block, lanes):
    """Keep the pistons' states (windows, 4, lanes) at a window's end."""
    for place in range(4):
        for lane in range(lanes):
            ends[window, place, lane] = block[at.POSITION + place * at.LANES + lane]


@compiled
def advance_lanes(
    pieces, starts, shown, leaking, slots, ends, block, lanes, history, active, voltages, step_size, rows,
):
    """`lanes.advance` through windows."""
    for number in range(len(pieces)):
        first, last, window = pieces[number, FIRST], pieces[number, LAST], pieces[number, BEGINS]
        if number and window >= 0:
            begin_lanes(window, first * step_size, starts, shown, leaking, slots, block, lanes)
        lock_step.advance(
            block, lanes, history, active, voltages[first:last], step_size, pieces[number, EVERY],
            rows[pieces[number, FIRST_ROW] : pieces[number, LAST_ROW]],
        )
        if pieces[number, ENDS] >= 0:
            end_lanes(pieces[number, ENDS], ends, block, lanes)


@compiled
def advance_lanes_driven(
    pieces, starts, shown, leaking, slots, ends, block, lanes, active, pressures_a, pressures_b, step_size, rows,
):
    """The same of `lanes.advance_driven`."""
    for number in range(len(pieces)):
        first, last, window = pieces[number, FIRST], pieces[number, LAST], pieces[number, BEGINS]
        if number and window >= 0:
            begin_lanes(window, first * step_size, starts, shown, leaking, slots, block, lanes)
        lock_step.advance_driven(
            block, lanes, active, pressures_a[first:last], pressures_b[first:last], step_size, pieces[number, EVERY],
            rows[pieces[number, FIRST_ROW] : pieces[number, LAST_ROW]],
        )
        if pieces[number, ENDS] >= 0:
            end_lanes(pieces[number, ENDS], ends, block, lanes)
