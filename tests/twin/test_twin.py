"""The twin beside simulated rigs: quiet where the rig is as modelled, and naming the equation where it is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from beside_rig import NANOSECONDS, PERIOD, beside, comparisons, rig

from eha_core.errors import ParameterError
from eha_core.plant.state import COLUMNS
from eha_core.recording.simulated import Experiment, Simulated, simulate
from eha_core.signals import make_signal
from eha_core.twin import Settings, Twin

CHAMBERS = {"chamber A", "chamber B"}


@pytest.mark.parametrize("noise", [0.0, 1.0, 5.0])
def test_a_rig_as_modelled_is_followed_to_the_noise(noise: float) -> None:
    found = beside(rig(10.0, noise), Twin())
    assert len(found) == 9
    assert not any(comparison.departs for _, comparison in found)
    assert max(max(comparison.ratios.values()) for _, comparison in found) < 2.0
    if noise:  # residuals in units of their noise are of size one
        everything = [list(comparison.ratios.values()) for _, comparison in found]
        assert np.sqrt(np.mean(np.square(everything), axis=0)) == pytest.approx(np.ones(4), abs=0.25)


def quiet(record: Simulated, twin: Twin) -> float:
    """The most evidence of a departure, in a rig that has none."""
    evidence = []
    for _, comparison in comparisons(record, twin):
        assert not comparison.departs
        evidence.append(twin.evidence[0])
    return max(evidence)


def test_fast_motion_at_low_pressure_is_followed_to_the_noise() -> None:
    """A period of the command is as long as the time from which a window's state is estimated, and the pressures' noise
    changes the flow more than it changes the oil's volume."""
    plant = {"supply_pressure": 5e6, "valve_gain": 5e-5, "piston_area": 4.7e-4, "moving_mass": 6.5}
    times = np.arange(5000) * PERIOD
    shape = {"amplitude": 0.42, "lowest": 2.0, "highest": 20.0, "count": 16, "period": 10.0}
    voltages = make_signal("multisine", shape).value(times)
    record = simulate(Experiment(times, voltages, 10.0, parameters=plant, noise=3.0))
    assert quiet(record, Twin(plant)) < 0.0
    friction = simulate(Experiment(times, voltages, 10.0, {**plant, "coulomb_friction.force": 100.0}, noise=3.0))
    assert all("force balance" in comparison.departs for _, comparison in beside(friction, Twin(plant))[1:])


def test_a_piston_at_the_end_of_its_stroke_departs_from_nothing() -> None:
    times = np.arange(0.0, 20.0, 1.5)
    voltages = 0.8 * (-1.0) ** np.arange(len(times))
    record = simulate(Experiment(times, voltages, 20.0, noise=3.0))
    assert np.max(np.abs(record.column("position"))) == pytest.approx(0.1, abs=1e-9)
    assert quiet(record, Twin(settings=Settings(command_timeout=0.0))) < 2.0


def test_leakage_turned_up_is_raised_within_two_seconds_in_the_chambers() -> None:
    found = beside(rig(8.0, changes=[(5.0, "internal_leakage", 5e-11)]), Twin())
    raised = [(stamp, comparison) for stamp, comparison in found if comparison.departs]
    stamp, first = raised[0]
    assert 5.0 < stamp < 7.0
    assert set(first.departs) == CHAMBERS
    for comparison in (one for _, one in raised):
        assert set(comparison.departs) == CHAMBERS
        assert [since / NANOSECONDS for since in comparison.departs.values()] == pytest.approx([5.0, 5.0], abs=0.1)
        assert comparison.ratios["force balance"] < 2.0


@pytest.mark.parametrize("before_the_end", np.arange(0.05, 0.5, 0.05))
def test_a_leak_that_begins_late_in_a_window_is_the_chambers_from_the_first(before_the_end: float) -> None:
    """The position is off by many times its noise before the chambers' equations are sure."""
    end = next(comparisons(rig(2.0), Twin()))[1].end / NANOSECONDS
    leak = (end + 2.0 - before_the_end, "internal_leakage", 5e-11)
    first = next(one for _, one in comparisons(rig(6.0, changes=[leak]), Twin()) if one.departs)
    assert set(first.departs) <= CHAMBERS


def test_dry_friction_is_raised_in_the_force_balance_alone() -> None:
    found = beside(rig(4.0, parameters={"coulomb_friction.force": 100.0}), Twin())
    assert [list(comparison.departs) for _, comparison in found] == [["force balance"]] * 3
    # 100 N against what 10 kPa of noise on 645 mm^2, two chambers, leave in a test function of 120 ms
    assert all(20 < comparison.ratios["force balance"] < 80 for _, comparison in found)


def test_what_the_model_has_is_not_raised() -> None:
    friction = {"coulomb_friction.force": 250.0, "moving_mass": 11.0}
    found = beside(rig(5.0, parameters=friction), Twin(friction))
    assert len(found) == 4 and not any(comparison.departs for _, comparison in found)


def test_a_departure_that_ends_is_forgotten() -> None:
    changes = [(2.0, "internal_leakage", 1e-10), (3.0, "internal_leakage", 1e-12)]
    found = beside(rig(7.0, changes=changes), Twin())
    assert set(found[2][1].departs) == CHAMBERS
    assert not found[-1][1].departs


def test_a_slow_drift_that_no_equation_shows_is_the_positions() -> None:
    found = beside(rig(6.0, parameters={"valve_null_offset.offset": 1e-6}), Twin())
    assert any(list(comparison.departs) == ["position"] for _, comparison in found)
    assert not any(comparison.departs.keys() & (CHAMBERS | {"force balance"}) for _, comparison in found)


def test_position_and_command_alone_are_compared() -> None:
    record, twin = rig(4.0, changes=[(2.5, "internal_leakage", 5e-11)]), Twin()
    commands = dict(zip(record.commands[0].tolist(), record.commands[1].tolist(), strict=True))
    found = []
    for stamp, position in zip(record.stamps.tolist(), record.column("measured_position").tolist(), strict=True):
        twin.position(stamp, position, stamp)
        if stamp in commands:
            twin.command(stamp, commands[stamp])
        found += [comparison] if (comparison := twin.compare()) else []
    assert [set(comparison.ratios) for comparison in found] == [{"position"}] * 3
    assert [list(comparison.departs) for comparison in found] == [[], [], ["position"]]


def test_a_gap_and_a_clock_set_back_begin_anew_and_raise_nothing() -> None:
    twin, record = Twin(), rig(5.0)
    found = beside(record, twin, missing=(2.3, 2.9))
    starts = [comparison.start / NANOSECONDS for _, comparison in found]
    assert starts == pytest.approx([0.2, 1.2, 3.1], abs=0.01)
    again = beside(record, twin, published_from=100 * NANOSECONDS)
    assert len(again) == 4
    assert not any(comparison.departs for _, comparison in [*found, *again])


def test_the_drives_timeout_and_limit_are_the_twins_too() -> None:
    times, voltages = np.array([0.0, 0.5, 1.5]), np.array([0.05, -0.05, 0.0])
    record = simulate(Experiment(times, voltages, 4.0, noise=1.0))  # a rig that holds its last voltage
    holding = beside(record, Twin(settings=Settings(command_timeout=0.0)))
    assert not any(comparison.departs for _, comparison in holding)
    assert beside(record, Twin(settings=Settings(command_timeout=0.5)))[1][1].departs  # from 1.0 s on
    assert beside(record, Twin(settings=Settings(command_timeout=0.0, command_limit=0.02)))[0][1].departs


def test_a_change_of_the_model_is_checked_and_acts() -> None:
    twin = Twin()
    with pytest.raises(ParameterError, match="moving_mass"):
        twin.set_parameters({"moving_mass": -1.0})
    changes = {"coulomb_friction.force": 250.0}
    twin.set_parameters(changes)
    assert not any(one.departs for _, one in beside(rig(3.0, parameters=changes), twin))


def test_the_voltage_that_the_rig_tells_is_taken_before_the_commands() -> None:
    record, twin = rig(4.0), Twin()
    for stamp, voltage in zip(record.stamps.tolist(), record.column("voltage").tolist(), strict=True):
        twin.applied(stamp, voltage)
    found = beside(record, twin, published_from=3_000_000)  # as if each command came late
    late = Simulated(record.stamps, record.states, (record.commands[0] + 30_000_000, record.commands[1]), {}, ())
    assert len(found) == 3 and not any(comparison.departs for _, comparison in found)
    assert beside(late, Twin())[0][1].departs


def frozen(record: Simulated, name: str, begin: float, end: float) -> Simulated:
    """A record in which a sensor repeats its last sample from `begin` to `end` [s]."""
    states, column = record.states.copy(), COLUMNS.index(f"measured_{name}")
    inside = (record.stamps >= begin * NANOSECONDS) & (record.stamps < end * NANOSECONDS)
    states[inside, column] = states[inside, column][0]
    return replace(record, states=states)


@pytest.mark.parametrize("name", ["position", "pressure_a"])
def test_a_frozen_sensor_is_told_as_such_and_no_equation_departs(name: str) -> None:
    found = beside(frozen(rig(6.0), name, 2.5, 3.6), Twin())
    assert not any(comparison.departs for _, comparison in found)
    unsound = [comparison.unsound for _, comparison in found if comparison.unsound]
    assert [set(one) for one in unsound] == [{name}] * len(unsound) and len(unsound) == 2
    what, since = unsound[0][name]
    assert what == "frozen" and since / NANOSECONDS == pytest.approx(2.5, abs=0.01)


def test_a_rig_without_noise_may_rest() -> None:
    times = np.arange(2500) * PERIOD
    record = simulate(Experiment(times, np.where(times < 2.0, 0.05 * np.sin(12.0 * times), 0.0), 5.0))
    assert not any(comparison.unsound for _, comparison in beside(record, Twin()))


def test_a_pressure_that_no_longer_comes_is_stale() -> None:
    record, twin = rig(5.0), Twin()
    commands = dict(zip(record.commands[0].tolist(), record.commands[1].tolist(), strict=True))
    columns = [record.column(f"measured_{name}").tolist() for name in ("position", "pressure_a", "pressure_b")]
    found = []
    for stamp, position, pressure_a, pressure_b in zip(record.stamps.tolist(), *columns, strict=True):
        twin.position(stamp, position, stamp)
        twin.pressure("a", stamp, pressure_a)
        if stamp < 2 * NANOSECONDS:
            twin.pressure("b", stamp, pressure_b)
        if stamp in commands:
            twin.command(stamp, commands[stamp])
        found += [comparison] if (comparison := twin.compare()) else []
    assert not any(comparison.departs for comparison in found)
    assert found[-1].unsound == {"pressure_b": ("stale", 1_998_000_000)}
