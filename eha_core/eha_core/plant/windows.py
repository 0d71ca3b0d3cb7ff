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
def of_steps(piece, inputs):
    """The inputs of the piece's steps."""
    return inputs[piece[FIRST] : piece[LAST]]


@compiled
def of_rows(piece, rows):
    """The rows that the piece fills."""
    return rows[piece[FIRST_ROW] : piece[LAST_ROW]]


@compiled
def begin(piece, step_size, starts, shown, slots, state, memory):
    """Put the piston into the state in which the piece's window starts, and sensors that trail to what they showed
    then; nothing where no window begins.

    starts: (windows, 4); shown: (windows, slots); slots: of the memory, which are those sensors'.
    """
    window = piece[BEGINS]
    if window < 0:
        return
    state[AT.time] = piece[FIRST] * step_size
    for place in range(4):
        state[AT.position + place] = starts[window, place]
    for place in range(len(slots)):
        memory[slots[place]] = shown[window, place]


@compiled
def end(piece, state, ends):
    """Keep the piston's state in `ends` (windows, 4) where a window ends with the piece."""
    if piece[ENDS] >= 0:
        ends[piece[ENDS]] = state[AT.position : AT.position + 4]


@compiled
def advance(
    pieces, starts, shown, slots, ends, state, memory, history, parameters, active, propagator, inputs, step_size, rows,
):  # fmt: skip
    """`step.advance` through windows; fills `ends`."""
    for number in range(len(pieces)):
        if number:
            begin(pieces[number], step_size, starts, shown, slots, state, memory)
        step.advance(
            state, memory, history, parameters, active, propagator, of_steps(pieces[number], inputs), step_size,
            pieces[number, EVERY], of_rows(pieces[number], rows),
        )  # fmt: skip
        end(pieces[number], state, ends)


@compiled
def advance_driven(
    pieces, starts, shown, slots, ends, state, memory, parameters, active, pressures_a, pressures_b, step_size, rows,
):  # fmt: skip
    """The same of `step.advance_driven`."""
    for number in range(len(pieces)):
        if number:
            begin(pieces[number], step_size, starts, shown, slots, state, memory)
        step.advance_driven(
            state, memory, parameters, active, of_steps(pieces[number], pressures_a),
            of_steps(pieces[number], pressures_b), step_size, pieces[number, EVERY], of_rows(pieces[number], rows),
        )  # fmt: skip
        end(pieces[number], state, ends)


@compiled
def begin_lanes(piece, step_size, starts, shown, leaking, slots, block, lanes):
    """`begin` in every lane of a block, and the internal leakage of that window.

    starts: (windows, 4, lanes); shown: (windows, slots); leaking: (windows, lanes); slots: (slots, lanes) places in
    `block`.
    """
    window = piece[BEGINS]
    if window < 0:
        return
    for lane in range(lanes):
        block[at.TIME + lane] = piece[FIRST] * step_size
        block[at.STATED_LEAKAGE + lane] = leaking[window, lane]
        for place in range(4):
            block[at.POSITION + place * at.LANES + lane] = starts[window, place, lane]
        for place in range(len(slots)):
            block[slots[place, lane]] = shown[window, place]


@compiled
def end_lanes(piece, block, lanes, ends):
    """Keep the pistons' states in `ends` (windows, 4, lanes) where a window ends with the piece."""
    window = piece[ENDS]
    if window < 0:
        return
    for place in range(4):
        for lane in range(lanes):
            ends[window, place, lane] = block[at.POSITION + place * at.LANES + lane]


@compiled
def advance_lanes(
    pieces, starts, shown, leaking, slots, ends, block, lanes, history, active, voltages, step_size, rows,
):  # fmt: skip
    """`lanes.advance` through windows."""
    for number in range(len(pieces)):
        if number:
            begin_lanes(pieces[number], step_size, starts, shown, leaking, slots, block, lanes)
        lock_step.advance(
            block, lanes, history, active, of_steps(pieces[number], voltages), step_size, pieces[number, EVERY],
            of_rows(pieces[number], rows),
        )  # fmt: skip
        end_lanes(pieces[number], block, lanes, ends)


@compiled
def advance_lanes_driven(
    pieces, starts, shown, leaking, slots, ends, block, lanes, active, pressures_a, pressures_b, step_size, rows,
):  # fmt: skip
    """The same of `lanes.advance_driven`."""
    for number in range(len(pieces)):
        if number:
            begin_lanes(pieces[number], step_size, starts, shown, leaking, slots, block, lanes)
        lock_step.advance_driven(
            block, lanes, active, of_steps(pieces[number], pressures_a), of_steps(pieces[number], pressures_b),
            step_size, pieces[number, EVERY], of_rows(pieces[number], rows),
        )  # fmt: skip
        end_lanes(pieces[number], block, lanes, ends)
