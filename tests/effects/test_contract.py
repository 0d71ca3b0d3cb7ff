"""What every file of the catalogue must be: declared in full, absent at its neutral value, there at its typical one."""

from __future__ import annotations

import inspect
from importlib import import_module
from pathlib import Path
from string import Formatter

import numpy as np
import pytest

from eha_core.effects import effect as effect_of
from eha_core.effects import effects
from eha_core.effects.declaration import MEMORY_STARTS, Effect
from eha_core.effects.sites import SITES
from eha_core.parameters import nominal_values
from eha_core.plant import Plant, hooks, step
from eha_core.plant.composite import compiled_step
from eha_core.plant.packing import active_effects, pack
from eha_core.plant.ring import LONGEST_DELAY
from eha_core.plant.state import COLUMNS

CATALOGUE = [
    "command_delay", "spool_hysteresis", "valve_deadband", "valve_null_offset", "flow_gain_asymmetry",
    "valve_null_leakage", "supply_pressure_droop", "return_back_pressure", "turbulent_leakage", "external_leakage",
    "entrained_air", "unequal_piston_area", "coulomb_friction", "stribeck_friction", "presliding_friction",
    "quadratic_damping", "constant_load", "hardening_spring", "end_stop", "position_sensor_lag",
    "position_sensor_backlash", "position_sensor_scale", "pressure_sensor_bias", "leakage_onset", "thermal_drift",
    "directional_damping", "load_friction", "flow_saturation", "pressure_sensor_scale", "position_sensor_offset",
    "bore_wear_leakage", "pressure_sensor_lag",
]  # fmt: skip
"""The least that the catalogue must hold."""

EVERY = [pytest.param(effect, id=effect.id) for effect in effects()]
NAMED = [pytest.param(effect, id=effect.id) for effect in effects() if effect.named]

STEP = 1e-4
VOLTAGES = 0.2 * np.sin(2.0 * np.pi * 2.0 * STEP * np.arange(6000))


def typical(effect: Effect, only: str = "") -> dict[str, float]:
    """The effect's typical size, or that of one parameter alone."""
    rows = zip(effect.parameter_names(), effect.parameters, strict=True)
    return {name: row.typical for name, row in rows if only in ("", row.name)}


def shapes(effect: Effect) -> dict[str, float]:
    """The effect at its neutral value, with every parameter that does not switch it set off its nominal value."""
    rows = zip(effect.parameter_names(), effect.parameters, strict=True)
    return {name: 0.5 * (row.nominal + row.upper) for name, row in rows if not row.switches}


def test_the_catalogue_is_there() -> None:
    assert {effect.id for effect in effects()} >= set(CATALOGUE)


@pytest.mark.parametrize("effect", EVERY)
def test_docstring_has_its_parts_in_order(effect: Effect) -> None:
    text = inspect.getdoc(import_module(f"eha_core.effects.{effect.id}")) or ""
    summary, _, rest = text.partition("\n\n")
    assert summary.endswith(".")
    parts = [line.partition(":")[0] for line in rest.splitlines() if line.partition(":")[0] in PARTS]
    assert parts == PARTS


PARTS = ["Signature", "Equation", "Sign", "Validity", "Source"]


@pytest.mark.parametrize("effect", EVERY)
def test_declaration_is_complete(effect: Effect) -> None:
    assert effect.site in SITES
    assert effect.equation
    assert set(effect.memory) <= set(MEMORY_STARTS)
    assert set(effect.needs) <= set(COLUMNS)
    assert any(row.switches for row in effect.parameters)
    assert len({row.name for row in effect.parameters}) == len(effect.parameters)
    for row in effect.parameters:
        assert row.symbol
        assert row.unit
        assert row.meaning
        assert row.source
        assert row.lower <= row.nominal <= row.upper
        assert row.lower < row.upper
        if row.logarithmic:
            assert row.lower > 0.0


@pytest.mark.parametrize("effect", NAMED)
def test_typical_sizes_are_within_bounds_and_switch_the_effect_on(effect: Effect) -> None:
    for row in effect.parameters:
        assert row.lower <= row.typical <= row.upper
        assert row.starts
        if row.switches:
            assert row.typical != row.nominal
            on = nominal_values() | typical(effect, only=row.name)
            assert effect.is_active(on)
            assert active_effects(on) == tuple(each.is_active(on) for each in effects())


def test_the_longest_delay_fits_the_plants_memory_of_commands() -> None:
    assert effect_of("command_delay").parameters[0].upper < LONGEST_DELAY


@pytest.mark.parametrize("effect", EVERY)
def test_contribution_has_the_head_of_its_site(effect: Effect) -> None:
    contribution = import_module(f"eha_core.effects.{effect.id}").contribution
    head = list(inspect.signature(getattr(hooks, effect.site)).parameters)[:-2]
    parameters = inspect.signature(contribution.py_func).parameters.values()
    if "memory" in head:
        after, count = head.index("memory") + 1, max(1, len(effect.memory))
        slots = [parameter.name for parameter in parameters][after : after + count]
        assert all(name.startswith("slot") for name in slots)
        head[after:after] = slots
    assert [parameter.name for parameter in parameters][: len(head)] == head
    own = list(parameters)[len(head) :]
    if own[-1].kind is not inspect.Parameter.VAR_POSITIONAL:
        assert len(own) == len(effect.parameters)
    assert inspect.getdoc(contribution.py_func)


def test_quantities_are_those_that_each_hook_returns() -> None:
    for site, (_, count) in SITES.items():
        hook = getattr(hooks, site).py_func
        head = list(inspect.signature(hook).parameters)
        arguments = [object() for _ in head]
        returned = hook(*arguments)
        returned = returned if isinstance(returned, tuple) else (returned,)
        assert list(returned) == arguments[:count]


@pytest.mark.parametrize("effect", EVERY)
def test_neutral_is_the_nominal_step_bit_for_bit(effect: Effect) -> None:
    values = nominal_values() | shapes(effect)
    assert not effect.is_active(values)
    rows = {}
    for name, module in (("nominal", step), ("catalogue", compiled_step())):
        vector, active, valve = pack(nominal_values() if name == "nominal" else values, STEP)
        state = np.array([0.0, 0.0, 2.1e7, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.05e7, 1.05e7])
        rows[name] = np.empty((3000, len(COLUMNS)))
        memory, history = np.zeros(64), np.zeros(2503)
        module.advance(state, memory, history, vector, active, valve, VOLTAGES[:3000], STEP, 1, rows[name])
    assert rows["nominal"].tobytes() == rows["catalogue"].tobytes()


@pytest.mark.parametrize("effect", NAMED)
def test_typical_size_shows_in_what_sensors_say(effect: Effect) -> None:
    nominal, changed = Plant().run(VOLTAGES), Plant(typical(effect)).run(VOLTAGES)
    position = np.sqrt(np.mean((nominal.measured_position - changed.measured_position) ** 2))
    pressure = np.sqrt(np.mean((nominal.measured_pressure_a - changed.measured_pressure_a) ** 2))
    assert position > 1e-6 or pressure > 1e3
    assert np.all(np.isfinite(changed.values))


@pytest.mark.parametrize("effect", NAMED)
def test_statement_quotes_the_effects_parameters_in_one_line(effect: Effect) -> None:
    quoted = {field for _, field, _, _ in Formatter().parse(effect.statement) if field}
    assert quoted <= {row.name for row in effect.parameters}
    assert quoted
    text = effect.describe({row.name: row.typical for row in effect.parameters})
    assert "{" not in text
    assert "\n" not in text
    assert not text.endswith(".")


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("effect", EVERY)
def test_any_legal_size_under_any_command_stays_finite(effect: Effect, seed: int) -> None:
    generator = np.random.default_rng([seed, *effect.id.encode()])
    values = {}
    for name, row in zip(effect.parameter_names(), effect.parameters, strict=True):
        if row.lower < 0.0:
            drawn = generator.uniform(row.lower, row.upper)
        else:
            drawn = np.exp(generator.uniform(*np.log([max(row.lower, 1e-9 * row.upper), row.upper])))
        values[name] = float(generator.choice([drawn, drawn, row.upper]))
    size = 10.0 ** generator.uniform(-2.0, 9.0)
    step_size = float(generator.choice([1e-5, 1e-4, 1e-3]))
    found = Plant(values, step_size).run(np.repeat(size * generator.normal(size=40), 25))
    assert np.all(np.isfinite(found.values))
    assert np.max(np.abs(found.position)) <= 0.1
    assert min(found.pressure_a.min(), found.pressure_b.min()) >= -101325.0


def test_one_file_is_all_that_an_effect_takes() -> None:
    package = Path(inspect.getfile(Effect)).parent
    files = {path.stem for path in package.glob("*.py")} - {"__init__", "declaration", "friction_rows", "sites"}
    assert files == {effect.id for effect in effects()}
