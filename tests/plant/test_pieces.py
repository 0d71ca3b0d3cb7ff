"""Steps taken in pieces, from where the last piece ended; and what a pump's valve lets through."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.parameters import changed, nominal_values
from eha_core.plant import COLUMNS, Plant
from eha_core.plant.lockstep import LockStep
from eha_core.plant.parts.sources.switched_pump import contribution

STEP = 2e-4
VOLTAGES = np.sin(np.arange(60.0))
CUTS = (0, 7, 8, 29, 60)
LATE = {"command_delay.delay": 5.0 * STEP}
SOON = {"coulomb_friction.force": 200.0, "coulomb_friction.acts_from": 35.0 * STEP}


def test_a_delayed_command_goes_on_from_piece_to_piece() -> None:
    late, plain = Plant(LATE, STEP), Plant({}, STEP)
    voltages = np.sin(np.arange(1100.0))  # the memory of commands goes round more than once
    shifted = plain.run(np.concatenate([np.zeros(5), voltages[:-5]]))
    pieces = [late.run(piece) for piece in np.split(voltages, (7, 8, 29, 60, 700))]
    assert np.concatenate([one.current for one in pieces]) == pytest.approx(shifted.current, rel=1e-9, abs=1e-15)
    assert np.concatenate([one.position for one in pieces]) == pytest.approx(shifted.position, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("columns", [4, len(COLUMNS)])
def test_plants_in_lock_step_go_on_from_piece_to_piece(columns: int) -> None:
    sets = [{}, LATE, SOON, {**LATE, **SOON}]

    def rows_of(cuts: tuple[int, ...]) -> np.ndarray:
        lanes = LockStep([changed(nominal_values(), one) for one in sets], STEP)
        lanes.place(np.tile([0.0, 0.0, 1.05e7, 1.05e7], (len(sets), 1)))
        lanes.start_memory()
        found = []
        for first, last in zip(cuts, cuts[1:], strict=False):
            rows = np.empty((last - first, columns, lanes.lanes))
            lanes.advance(first, VOLTAGES[None, first:last], 1, rows)
            found.append(rows)
        return np.concatenate(found)[:, :, : len(sets)]

    whole = rows_of((0, 60))
    assert rows_of(CUTS).tobytes() == whole.tobytes()
    assert not np.array_equal(whole[:, :, 0], whole[:, :, 2])


@pytest.mark.parametrize("opening", [1.0, 0.6, 0.2, 0.1, -0.1, -0.6, -1.0])
@pytest.mark.parametrize("overlap", [0.0, 0.2, 0.5])
def test_a_pumps_valve_lets_through_what_its_spool_opens_beyond_the_overlap(opening: float, overlap: float) -> None:
    """Orifices: Q = K_t s sqrt(dP), with s from 0 at the overlap to 1 at the spool's end."""
    line, tank, a, b, port = 1.6e7, 1e6, 9e6, 4e6, 2e-7
    share = max(abs(opening) - overlap, 0.0) / (1.0 - overlap)
    into_a, out_of_b, *_ = contribution(
        opening, 0.0, 0.0, 50.0, opening, a, b, line, tank, 1e-6, 0.0, 1e-9, port, 100.0, 1.0, overlap, 0.0, 5e-5
    )
    drops = (line - a, b - tank) if opening > 0.0 else (a - tank, line - b)
    flows = np.sign(opening) * share * port * np.sqrt(drops)
    assert (into_a, out_of_b) == pytest.approx(tuple(flows), rel=1e-6, abs=1e-15)
