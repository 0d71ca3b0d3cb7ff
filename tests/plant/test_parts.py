"""What every part must be: found by its file, declared in full, and the plant that it makes has what applies to it."""

from __future__ import annotations

import inspect
import os
import re
import shutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import eha_core
from eha_core.effects import effects
from eha_core.errors import ParameterError
from eha_core.parameters import ACTING, NOMINAL, PAPER_PARTS, catalogue, nominal_values
from eha_core.plant import COLUMNS, PAPER, Composition, Plant, compose, simulate_many
from eha_core.plant.composite import given_sources, write_source
from eha_core.plant.parts import FOLDERS, Source, parts
from eha_core.plant.parts.sources.servo_valve import contribution as servo_valve

EVERY = [pytest.param(kind, name, id=name) for kind in FOLDERS for name in parts(kind)]
SOURCES = {name: compose(source=name, cylinder="single_rod") for name in parts("source")}
VANES = {f"{name} vane": compose(source=name, cylinder="rotary_vane") for name in parts("source")}
SIZE = {
    "voltage_command": 5.0, "current": 0.02, "spool": 0.02, "flow_a": 2e-3, "flow_b": 2e-3, "pump_speed": 2000.0,
    "pressure_a": 2e7, "pressure_b": 2e7, "force": 1e4,
}  # fmt: skip
"""Enough to run a piston into both ends and to boil the oil behind it."""


def drive(composition: Composition, steps: int = 4000) -> np.ndarray:
    """Waves of that size, (steps, inputs), jumping like a controller gone wrong."""
    time = 1e-4 * np.arange(steps)
    columns = []
    for place, name in enumerate(composition.source.inputs):
        wave = np.sin(2.0 * np.pi * 5.0 * time + 0.7 * place) + 0.5 * np.sign(np.sin(2.0 * np.pi * 13.0 * time))
        columns.append(SIZE[name] * (np.abs(wave) if name.startswith("pressure") else wave))
    return columns[0] if composition.source.valve == "coil" else np.stack(columns, axis=1)


def rows(composition: Composition, parameters: dict[str, float], steps: int = 4000) -> np.ndarray:
    plant = Plant(parameters, composition=composition)
    return np.nan_to_num(plant.run(drive(composition, steps), 10).values)


@pytest.mark.parametrize(("kind", "name"), EVERY)
def test_a_part_is_declared_in_full(kind: str, name: str) -> None:
    module = import_module(f"eha_core.plant.parts.{FOLDERS[kind]}.{name}")
    summary, _, rest = (inspect.getdoc(module) or "").partition("\n\n")
    assert summary.endswith(".")
    heads = [line.partition(":")[0] for line in rest.splitlines()]
    assert [head for head in heads if head in HEADS] == HEADS
    part = parts(kind)[name]
    assert part.summary
    nominal = {row.name for row in NOMINAL}
    assert set(part.uses) <= nominal
    assert all(set(places) <= nominal for places in part.stands_for.values())
    assert set(part.stands_for) <= {row.name for row in part.parameters}
    for row in part.parameters:
        assert row.symbol and row.unit and row.meaning and row.source
        assert row.lower <= row.nominal <= row.upper and row.lower < row.upper
        assert row.logarithmic == (row.lower > 0.0)  # what can be zero is moved by sums, all else by factors
        assert row.lower <= row.typical <= row.upper
        assert row.typical > 0.0 or row.nominal == 0.0
    if isinstance(part, Source):
        assert part.inputs and set(part.hides) <= set(COLUMNS) and set(part.ignores) <= nominal


HEADS = ["Equation", "Sign", "Validity", "Source"]


@pytest.mark.parametrize("source", given_sources(), ids=lambda source: source.id)
def test_a_contribution_has_the_servo_valves_head_and_then_its_own_parameters(source: Source) -> None:
    contribution = import_module(f"eha_core.plant.parts.sources.{source.id}").contribution
    head = list(inspect.signature(servo_valve.py_func).parameters)
    expected = [*head, *(row.name for row in source.own)]
    assert list(inspect.signature(contribution.py_func).parameters) == expected
    assert inspect.getdoc(contribution.py_func)
    assert write_source().count(f"return {source.id}(") == 1
    module = import_module(f"eha_core.plant.parts.sources.{source.id}")
    assert hasattr(module, "feed") == source.line
    if source.line:
        pressures = ["line_pressure", "supply_pressure", "return_pressure"]
        taken = ["spool_position", "first", "second", *pressures, *(row.name for row in source.own)]
        assert list(inspect.signature(module.feed.py_func).parameters) == taken


def test_the_default_is_the_papers() -> None:
    assert PAPER.names == PAPER_PARTS == {"source": "servo_valve", "cylinder": "double_rod", "load": "sprung_mass"}
    assert list(PAPER.rows) == list(catalogue())
    assert PAPER.nominal_values() == nominal_values()
    assert PAPER.effects == effects()
    assert Plant().composition is PAPER


@pytest.mark.parametrize("composition", [*SOURCES.values(), *VANES.values()], ids=[*SOURCES, *VANES])
def test_each_parameter_that_applies_matters_and_no_other_is_taken(composition: Composition) -> None:
    found = rows(composition, {})
    assert np.all(np.isfinite(found))
    stroke = composition.places(composition.nominal_values())["actuator_displacement"]
    assert np.max(np.abs(found[:, COLUMNS.index("position")])) <= stroke
    apply = [name for name in composition.rows if "." not in name and name not in {row.name for row in ACTING}]
    for name in apply:
        row = composition.rows[name]
        changed = 0.9 * row.nominal or row.typical or (1e-12 if "leakage" in name else 100.0)
        assert rows(composition, {name: changed}).tobytes() != found.tobytes(), name
    for name in set(catalogue()) - set(composition.rows):
        with pytest.raises(ParameterError, match=f"{name} does not apply to this plant"):
            composition.changed(composition.nominal_values(), {name: catalogue()[name].typical})


@pytest.mark.parametrize("composition", SOURCES.values(), ids=SOURCES)
def test_each_effect_of_a_composition_acts_in_it(composition: Composition) -> None:
    plain = rows(composition, {})
    for effect in composition.effects:
        if effect.named and effect.id not in ("end_stop", "leakage_onset"):  # which wait for a place and for a time
            typical = dict(zip(effect.parameter_names(), (row.typical for row in effect.parameters), strict=True))
            assert rows(composition, typical).tobytes() != plain.tobytes(), effect.id


def test_effects_belong_to_parts() -> None:
    names = {source: {effect.id for effect in one.effects} for source, one in SOURCES.items()}
    valve = {"valve_deadband", "flow_gain_asymmetry", "valve_null_offset"}
    assert valve <= names["measured_spool"] & names["measured_current"] & names["servo_valve"]
    assert not valve & (names["measured_flow"] | names["switched_pump"] | names["measured_force"])
    assert "spool_hysteresis" in names["measured_current"] and "spool_hysteresis" not in names["measured_spool"]
    assert "command_delay" in names["servo_valve"] and "command_delay" not in names["measured_current"]
    assert "entrained_air" in names["switched_pump"] and "entrained_air" not in names["measured_pressures"]
    assert all("coulomb_friction" in found for found in names.values())
    assert "pressure_sensor_bias" not in names["measured_force"]


@pytest.mark.parametrize("composition", [*SOURCES.values(), *VANES.values()], ids=[*SOURCES, *VANES])
def test_many_plants_are_each_of_them_alone_to_the_last_bit(composition: Composition) -> None:
    """Those that have a lock-step go in it; the others are simulated one after another."""
    name = {"m": "damping_coefficient", "rad": "rotational_damping"}[composition.load.motion]
    sets = [{name: composition.rows[name].nominal * factor, "coulomb_friction.force": 5.0} for factor in (1.0, 1.4)]
    given = drive(composition, 900)
    found = simulate_many(sets, given, every=3, composition=composition).values
    alone = np.array([Plant(one, composition=composition).run(given, 3).values for one in sets])
    assert found.tobytes() == alone.tobytes()
    assert composition.has_lockstep == (composition.source.valve == "coil" or bool(composition.source.given))


@pytest.mark.parametrize("composition", [*SOURCES.values(), *VANES.values()], ids=[*SOURCES, *VANES])
def test_names_and_places_lead_back_to_each_other(composition: Composition) -> None:
    values = {name: 1.1 * value for name, value in composition.nominal_values().items()}
    assert composition.named(composition.places(values)) == values


PAGE = Path(__file__).parents[2] / "CONTRIBUTING.md"
(NEW,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
"""The architecture that CONTRIBUTING.md shows."""

RUN = """
import numpy as np
from eha_core.plant import Plant, compose
plant = Plant({"pump_flow": 3e-5, "internal_leakage": 0.0}, 1e-3, composition=compose(source="constant_pump"))
found = plant.run(np.ones(400), 400)
print(found.velocity[-1], found.flow_a[-1])
from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.nominal import nominal_of
model = nominal_of({"pump_flow": 3e-5}, composition=compose(source="constant_pump"))
free = free_nominal_parameters(model.values, "measured", 0.05, model.unknown, model.composition)
print(next(one.value(one.coordinate(4e-5)) for one in free if one.name == "pump_flow"))
"""


def test_a_new_source_is_one_file(tmp_path: Path) -> None:
    package = tmp_path / "eha_core"
    shutil.copytree(Path(eha_core.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    (package / "plant" / "parts" / "sources" / "constant_pump.py").write_text(NEW)
    variables = os.environ | {"EHA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", RUN], env=variables | {"NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True,
        timeout=100, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    velocity, flow, freed = map(float, done.stdout.split())
    assert freed == pytest.approx(4e-5)
    assert flow == 3e-5
    assert velocity == pytest.approx(3e-5 / 645e-6, rel=1e-6)


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="there is no compiler to compare with")
def test_the_interpreter_finds_the_same_numbers_of_a_pump(tmp_path: Path) -> None:
    text = (
        "import numpy as np\nfrom eha_core.plant import Plant, compose\n"
        "values = {'pump_displacement': 2e-6, 'coulomb_friction.force': 100.0}\n"
        "plant = Plant(values, composition=compose('switched_pump'))\n"
        "print(plant.run(40.0 * np.sin(0.02 * np.arange(400)), 40).values[:, 4:8].tobytes().hex())\n"
    )
    variables = os.environ | {"EHA_CACHE_DIR": str(tmp_path), "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(
        [sys.executable, "-c", text], env=variables, capture_output=True, text=True, timeout=100, check=False
    )
    assert done.returncode == 0, done.stderr
    interpreted = np.frombuffer(bytes.fromhex(done.stdout.strip())).reshape(10, 4)
    plant = Plant({"pump_displacement": 2e-6, "coulomb_friction.force": 100.0}, composition=compose("switched_pump"))
    compiled = plant.run(40.0 * np.sin(0.02 * np.arange(400)), 40).values[:, 4:8]
    assert interpreted == pytest.approx(compiled, rel=1e-11, abs=1e-15)
