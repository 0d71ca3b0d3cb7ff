"""The benchmarks compare like with like: their peers solve the plant's own equations."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from eha_core.plant import Plant

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def benchmarks_importable(monkeypatch: pytest.MonkeyPatch) -> None:
    """The benchmarks are a package of the checkout's root, which is not installed."""
    monkeypatch.setattr(sys, "path", [str(ROOT), *sys.path])


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_c_program_solves_the_same_equations() -> None:
    from benchmarks.plant_step import EVERY, STEP, compiled_reference

    voltages = 20e-3 * np.sin(2.0 * np.pi * 3.0 * STEP * np.arange(20_000))
    simulate = compiled_reference()
    assert simulate is not None
    rows = simulate(voltages)
    trajectory = Plant(step_size=STEP).run(voltages, EVERY)
    np.testing.assert_allclose(rows[:, 3], trajectory.position, rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(rows[:, 5], trajectory.pressure_a, rtol=0.0, atol=100.0)
    np.testing.assert_allclose(rows[:, 6], trajectory.pressure_b, rtol=0.0, atol=100.0)


def test_without_a_compiler_the_row_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    from benchmarks import plant_step

    monkeypatch.setattr(plant_step.shutil, "which", lambda name: None)
    monkeypatch.setattr(plant_step, "ROUNDS", 1)
    plant_step.compiled_reference.cache_clear()
    step, real_time, tick = plant_step.measure()
    assert step.met is None
    assert "cc" in step.note
    assert real_time.met is not None
    assert tick.measured.endswith("us")
    plant_step.compiled_reference.cache_clear()


def test_every_integrator_solves_the_equations_of_the_plant() -> None:
    """At tight settings all meet the judge far within what is asked: none solves another task."""
    from benchmarks import integrators

    for task in integrators.TASKS[:2]:
        judge = integrators._cvode(task, {}, 1e-9)()
        found = {
            "plant": integrators._plant(task, 1e-4),
            "RK4": integrators._rk4(task, {}, 20),
            "CVODE": integrators._cvode(task, {}, 1e-7)(),
            "odeint": integrators._scipy(integrators._odeint, task, {}, 1e-7),
        }
        for name, states in found.items():
            assert task.near(states, judge), name
            assert not task.near(states + [0, 0, 0, 2e-6, 0, 0, 0], judge), name


def test_friction_and_ends_are_the_plants_own() -> None:
    """The smoothed laws of the judge approach the plant's, which has them as they are."""
    from benchmarks import integrators

    for task in integrators.TASKS[2:]:
        judge = integrators._cvode(task, task.smoothed[-1], 1e-9)()
        assert task.near(integrators._plant(task, 1e-4), judge)
        bare = integrators._rk4(task, {"sliding": 0.0, "static": 0.0}, 20)  # neither friction nor ends
        assert not task.near(bare, judge)


def test_the_bench_of_windows_solves_what_lapack_solves() -> None:
    from benchmarks import windows

    matrix, right = windows.equations(20)
    assert np.allclose(windows.banded(matrix, right), windows.dense(matrix, right), rtol=1e-7, atol=1e-12)


def test_sleep_loop_measures_how_late_it_wakes() -> None:
    from benchmarks.sleep_loop import lateness

    # A wake cannot come early, and no loop at 100 Hz on a machine that lives is a second late.
    half, most, nearly_all = lateness(100.0, 0.2)
    assert 0.0 <= half <= most <= nearly_all < 1.0


def test_run_too_short_to_measure_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    from benchmarks.__main__ import main

    assert main(["--seconds", "5"]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "30" in message


def test_unknown_benchmark_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    from benchmarks.__main__ import main

    assert main(["plant"]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "'plant'" in message


def test_rows_are_read_back_from_the_table() -> None:
    from benchmarks.row import Row, as_markdown, from_markdown, skipped

    rows = [
        Row("a node, 10 s", "0.05 %", "-", "0.05 %", "< 1 %", True),
        Row("a trip", "2 us", "a peer: 1 us", "2.00 x", "<= 1.5 x", False),
        skipped("rclpy", "<= 1.5 x", "there is no rclpy: none at all"),
    ]
    assert from_markdown(f"2 CPUs, load 1.0\n{as_markdown(rows)}\n") == rows


def test_failure_of_the_layers_benchmarks_is_told_in_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from benchmarks import layer
    from benchmarks.__main__ import main

    monkeypatch.setattr(layer, "COMMAND", [*layer.COMMAND, "--no-such-option"])
    assert main(["layer"]) != 0
    measuring, message = capsys.readouterr().err.splitlines()
    assert message.startswith("benchmarks: layer: ")


def test_the_structural_model_has_a_place_for_every_effect() -> None:
    from benchmarks.structure import EQUATIONS, PRESSURES, _equations
    from eha_core.effects import effects

    known = {*EQUATIONS, "position_sensor", *(f"{name}_sensor" for name in PRESSURES)}
    for effect in effects():
        for row in effect.parameters:
            where = _equations(effect.id, row.name)
            assert where and set(where) <= known, (effect.id, row.name)
    assert _equations("external_leakage", "coefficient_a") == ("chamber_a",)
    assert _equations("pressure_sensor_bias", "bias_b") == ("pressure_b_sensor",)


def test_structure_isolates_a_load_from_a_leak_if_the_pressures_are_recorded() -> None:
    peer = pytest.importorskip("faultdiagnosistoolbox")
    from benchmarks.structure import PRESSURES, _by_structure

    load, leak = ("constant_load", "force"), ("external_leakage", "coefficient_a")
    friction = ("coulomb_friction", "force")
    sizes = {load, leak, friction}
    apart = _by_structure(peer, ("position", *PRESSURES), sizes)
    assert (load, leak[0]) in apart and (leak, load[0]) in apart
    assert (load, friction[0]) not in apart
    assert not _by_structure(peer, ("position",), sizes)
