"""A task's RMSE against the plant alone, the controllers' own loop, and the paper's experiment."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.control import CONTROLLERS, make_controller
from eha_core.control.loop import follow
from eha_core.error_budget import Task
from eha_core.errors import ParameterError
from eha_core.paper import LEVELS, reproduce
from eha_core.parameters import changed, nominal_values
from eha_core.plant import PAPER, Plant
from eha_core.signals import from_text

NOMINAL = nominal_values()
SINE = from_text("sine:amplitude=0.01,frequency=1,offset=0.02")
RIGS = [{}, {"coulomb_friction.force": 250.0, "moving_mass": 11.0}, {"command_delay.delay": 0.0033},
        {"internal_leakage": 1e-10, "supply_pressure_droop.resistance": 2e10}]  # fmt: skip


@pytest.mark.parametrize("name", list(CONTROLLERS))
def test_together_as_each_alone(name: str) -> None:
    task = Task(SINE, name, duration=1.0, skip=0.25)
    sets = [changed(NOMINAL, rig) for rig in RIGS] * 7  # more than go in one block
    found = task.rmse(sets, NOMINAL, PAPER)
    for rig, rmse in zip(RIGS, found, strict=False):
        controller = make_controller(name, NOMINAL, 0.002, 10.0)
        alone = follow(controller, Plant(rig, 1e-4, 0.02), SINE, seconds=1.0, period=0.002, skip=0.25)
        assert rmse == pytest.approx(alone.rmse, rel=1e-9)
    assert found[: len(RIGS)].tolist() == found[-len(RIGS) :].tolist()


def test_the_error_is_that_of_the_true_position_and_the_controller_sees_the_sensor() -> None:
    """A sensor that reads 50 um too much is led 50 um short: an error that the sensor itself does not show."""
    biased = changed(NOMINAL, {"position_sensor_offset.offset": 50e-6})
    hold = from_text("step:height=0.0,offset=0.02")
    found = Task(hold, "pid", duration=2.0, skip=1.5).rmse([NOMINAL, biased], NOMINAL, PAPER)
    assert found[1] - found[0] == pytest.approx(50e-6, rel=0.02)


def test_the_paper_s_levels_have_the_paper_s_errors() -> None:
    model = NOMINAL | {"internal_leakage": 0.0}
    task = Task(from_text("sine:amplitude=8.4e-3,frequency=1"), "", duration=10.0, skip=0.0, rate=1000.0)
    found = task.rmse([NOMINAL | {"internal_leakage": level} for level in LEVELS], model, PAPER)
    assert found.tolist() == pytest.approx([level.rmse for level in reproduce().levels], rel=1e-12)


def test_what_is_skipped_does_not_count() -> None:
    """Under a constant leak the error of an open loop grows: its later half is the larger one."""
    rig, drive = NOMINAL | {"internal_leakage": 1e-9}, from_text("step:height=0.003,at=0")
    whole, late = (Task(drive, "", 2.0, skip).rmse([rig], NOMINAL, PAPER)[0] for skip in (0.0, 1.0))
    early = np.sqrt(2.0 * whole**2 - late**2)
    assert late > whole > early > 0.0


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"controller": "pda"}, "no controller 'pda'; did you mean pid"),
        ({"skip": 4.0}, "leave nothing to count"),
        ({"duration": float("nan")}, "leave nothing to count"),
        ({"rate": 300.0}, "rate = 300 Hz is not one sample"),
        ({"rate": 0.0}, "rate = 0 Hz"),
        ({"command_limit": 0.0}, "give a voltage above zero"),
    ],
)
def test_a_task_that_makes_no_sense_is_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(ParameterError, match=words):
        Task(SINE, **changes)  # type: ignore[arg-type]


def test_a_reference_outside_the_stroke_is_refused() -> None:
    with pytest.raises(ParameterError, match="begins at 0.2 m, outside the stroke"):
        Task(from_text("sine:offset=0.2")).rmse([NOMINAL], NOMINAL, PAPER)
