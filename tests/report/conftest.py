"""A diagnosis to present: a rig with dry friction, simulated, against the nominal plant that lacks it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from eha_core.diagnosis.result import (
    Alternative,
    ChannelFit,
    Correlation,
    Diagnosis,
    Experiment,
    FittedParameter,
    FittedValue,
    Location,
    NamedEffect,
    Pictures,
    Residual,
    Step,
    UnknownLaw,
)
from eha_core.plant import Plant

NOISE = {"position": 1e-5, "pressure_a": 1e4, "pressure_b": 1e4}
STEP, EVERY, SECONDS = 1e-4, 20, 6.0


def _voltage() -> np.ndarray:
    time = np.arange(round(SECONDS / STEP)) * STEP
    return 0.02 * np.sin(2 * np.pi * 1.3 * time) + 0.01 * np.sin(2 * np.pi * 4.1 * time)


def _fits(measured: dict, models: list[dict]) -> dict[str, ChannelFit]:
    def rmse(name: str, model: dict) -> float:
        return float(np.sqrt(np.mean((measured[name] - model[name]) ** 2)))

    return {name: ChannelFit(*(rmse(name, model) for model in models), NOISE[name]) for name in NOISE}


@pytest.fixture(scope="session")
def simulated() -> SimpleNamespace:
    """Measured with noise; before, calibrated and after; states of the calibrated model."""
    voltage = _voltage()
    plants = [{}, {"damping_coefficient": 2500.0}, {"coulomb_friction.force": 200.0}]
    runs = [Plant(changes, STEP).run(voltage, EVERY) for changes in plants]
    models = [{name: getattr(run, f"measured_{name}") for name in NOISE} for run in runs]
    generator = np.random.default_rng(7)
    measured = {
        name: values + NOISE[name] * generator.standard_normal(len(values)) for name, values in models[2].items()
    }
    return SimpleNamespace(time=runs[0].time, voltage=voltage, measured=measured, models=models, states=runs[1])


@pytest.fixture(scope="session")
def friction(simulated: SimpleNamespace) -> Diagnosis:
    """Missing physics, found."""
    time = dict.fromkeys(NOISE, simulated.time)
    time["voltage_command"] = np.arange(len(simulated.voltage)) * STEP
    variables = {name: getattr(simulated.states, name) for name in ("velocity", "position", "spool_position")}
    pictures = Pictures(
        time,
        {**simulated.measured, "voltage_command": simulated.voltage},
        *simulated.models,
        {**variables, "time": simulated.time},
        {"force": (simulated.time[::50], 30.0 * np.sign(simulated.states.velocity[::50]))},
        ((1.0, 2.0), (4.0, 5.0)),
    )
    fits = _fits(simulated.measured, simulated.models)
    return Diagnosis(
        path="bags/a rig & its <friction>.mcap",
        duration=SECONDS,
        channels=("voltage_command", "pressure_a", "pressure_b", "position"),
        not_examined=(),
        remarks=("pressure_a: 3 outliers were excluded",),
        damaged=None,
        verdict="missing_physics",
        summary="Physics is missing: the seals rub with 200 N.",
        location=(
            Location("force", 0.93, "near zero speed", ((1.0, 1.5), (3.0, 3.25))),
            Location("chamber", 0.04, "near zero speed", ()),
        ),
        parameters=(
            FittedParameter("moving_mass", 9.0, 10.946, 0.035, "kg", True),
            FittedParameter("internal_leakage", 1e-12, 1.02e-12, 3e-14, "m^3/(s Pa)", False),
            FittedParameter("return_pressure", 0.0, 1200.0, float("inf"), "Pa", False, "held"),
        ),
        effects=(
            NamedEffect(
                "coulomb_friction", "force", "M_p x_p'' = ... - force sign(x_p')",
                {"force": FittedValue(200.4, 1.3, "N")}, 5321.0, "the seals rub with 200 N",
            ),
        ),
        alternatives=(),
        unknown=None,
        training=fits,
        held_out=fits,
        next_experiment=None,
        rivals=((("coulomb_friction",), 5321.0), (("stribeck_friction",), 5290.0), (("end_stop",), -12.0)),
        whiteness={"position": 1.1},
        fitted_values={"coulomb_friction.force": 200.4, "moving_mass": 10.946, "internal_leakage": 1e-12},
        pictures=pictures,
        start_stamp=1_700_000_000_000_000_000,
    )  # fmt: skip


@pytest.fixture(scope="session")
def ambiguous(friction: Diagnosis) -> Diagnosis:
    """Two causes that the recording does not tell apart, with the test that would."""
    reference = {"mode": "voltage", "signal": "sine", "sine.amplitude": 0.02, "sine.frequency": 3.0}
    return replace(
        friction,
        verdict="ambiguous",
        summary="Physics is missing, most likely: the seals rub.",
        alternatives=(Alternative(("stribeck_friction",), 3.1),),
        next_experiment=Experiment("A sine tells them apart", ("coulomb_friction", "stribeck_friction"), reference),
    )


def residual(position: float, pressure: float) -> Residual:
    """Position and both pressures, as many samples of each."""
    overall = float(np.sqrt((position**2 + 2.0 * pressure**2) / 3.0))
    return Residual({"position": position, "pressure_a": pressure, "pressure_b": pressure}, overall)


@pytest.fixture(scope="session")
def several(friction: Diagnosis) -> Diagnosis:
    """Three effects, with the residual without each; the overlap's edge is not distinguished from a sharp one."""
    overlap = {"half_width": FittedValue(5.96e-5, 4.3e-7, "A"), "rounding": FittedValue(0.0, 3.2e-5, "A")}
    effects = (
        NamedEffect("valve_deadband", "orifice", "opening = ...", overlap, 9000.0, "the lands overlap: 59.6 µA"),
        *friction.effects,
        NamedEffect(
            "constant_load",
            "force",
            "M_p x_p'' = ... - force",
            {"force": FittedValue(-76.4, 0.52, "N")},
            700.0,
            "a steady load of 76.4 N pushes towards extension",
        ),
    )
    steps = (
        Step("nominal", residual(300.0, 160.0)),
        Step("recalibrated", residual(46.0, 54.0)),
        Step("augmented", residual(1.0, 1.0)),
    )
    without = {
        "valve_deadband": residual(30.0, 31.0),
        "coulomb_friction": residual(9.0, 8.0),
        "constant_load": residual(6.0, 5.0),
    }
    pair = Correlation(
        ("valve_gain", "valve_deadband.half_width", "constant_load.force"),
        ((1.0, 0.95, 0.1), (0.95, 1.0, -0.2), (0.1, -0.2, 1.0)),
    )
    return replace(friction, effects=effects, steps=steps, without=without, correlation=pair)


@pytest.fixture(scope="session")
def unknown(friction: Diagnosis) -> Diagnosis:
    """A law outside the catalogue, recovered as a curve."""
    samples = tuple((float(at), float(250.0 * np.tanh(20.0 * at))) for at in np.linspace(-0.1, 0.1, 15))
    law = UnknownLaw("force", "velocity", "250 tanh(20 v)", 0.98, samples)
    return replace(friction, verdict="unknown_physics", effects=(), unknown=law, summary="A force is missing.")


@pytest.fixture(scope="session")
def law_beside_names(several: Diagnosis, unknown: Diagnosis) -> Diagnosis:
    """Effects of the catalogue, and beside them a law that is in none."""
    return replace(several, verdict="unknown_physics", unknown=unknown.unknown)


@pytest.fixture(scope="session")
def consistent(friction: Diagnosis, simulated: SimpleNamespace) -> Diagnosis:
    """The same rig against a model that has its friction."""
    after = simulated.models[2]
    fits = _fits(simulated.measured, [after] * 3)
    (force, _) = friction.pictures.equations["force"]
    noise = np.random.default_rng(2).standard_normal(len(force))
    models = {"before": after, "calibrated": after, "after": after}
    pictures = replace(friction.pictures, **models, equations={"force": (force, noise)})
    return replace(
        friction, verdict="consistent", summary="Nothing is missing.", location=(), effects=(), rivals=(),
        training=fits, held_out=fits, pictures=pictures,
    )  # fmt: skip


@pytest.fixture(scope="session")
def position_alone(friction: Diagnosis) -> Diagnosis:
    """Only position and force were recorded; nothing was held out and no state is known."""
    pictures = friction.pictures
    kept = [
        {"position": one["position"]}
        for one in (pictures.measured, pictures.before, pictures.calibrated, pictures.after)
    ]
    only = {"position": friction.training["position"]}
    return replace(
        friction, channels=("position", "force"), training=only, held_out={},
        pictures=Pictures({"position": pictures.time["position"]}, *kept),
        not_examined=("continuity of both chambers: force alone was recorded",), damaged="the first 4 s",
    )  # fmt: skip


@pytest.fixture(
    params=["friction", "several", "ambiguous", "unknown", "law_beside_names", "consistent", "position_alone"]
)
def any_diagnosis(request: pytest.FixtureRequest) -> Diagnosis:
    """Each kind of diagnosis in turn."""
    return request.getfixturevalue(request.param)
