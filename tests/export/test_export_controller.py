"""`eha export controller`: the C function, the Python file and the library's feedforward are one law."""

from __future__ import annotations

import ast
import ctypes
import importlib.util
import json
import shutil
import subprocess
import sys
from itertools import product
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import yaml
from exported import FIVE

from eha_core.cli import main
from eha_core.control import Measurement, Target, make_controller
from eha_core.control.inverse_model import NAMES, InverseModel
from eha_core.parameters import changed, dump_parameters, nominal_values
from eha_core.plant import PAPER, dump_plant

PERIOD = 0.002
FOUND = {
    **FIVE, "valve_deadband.rounding": 3e-5, "valve_null_offset.offset": 3e-5,
    "stribeck_friction.force": 100.0, "stribeck_friction.static_force": 180.0,
    "stribeck_friction.shape": 1.3, "presliding_friction.force": 50.0, "presliding_friction.static_force": 70.0,
    "internal_leakage": 3e-11, "turbulent_leakage.coefficient": 2e-9, "external_leakage.coefficient_a": 1e-12,
    "external_leakage.coefficient_b": 4e-13, "directional_damping.ratio": -0.2, "quadratic_damping.coefficient": 900.0,
    "spring_stiffness": 2e4, "hardening_spring.coefficient": 1e7, "constant_load.force": -400.0,
    "unequal_piston_area.ratio": 0.8, "flow_gain_asymmetry.ratio": 0.2, "flow_saturation.curvature": 80.0,
    "command_delay.delay": 4e-3, "return_pressure": 3e5,
}  # fmt: skip
"""Something of every effect that the law compensates, with FIVE's three that it does not."""

SHIPPED = Path(__file__).resolve().parents[2] / "eha_description" / "config" / "controllers.yaml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("controller")
    (made / "rig.yaml").write_text(dump_parameters(FOUND))
    assert main(["export", "controller", "--nominal", str(made / "rig.yaml"), "--out", str(made / "out")]) == 0
    return made / "out"


@pytest.fixture(scope="module")
def python(folder: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location("eha_controller", folder / "eha_controller.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def compiled(folder: Path) -> ctypes.CDLL:
    if shutil.which("cc"):
        compiler = ["cc"]
    elif importlib.util.find_spec("ziglang"):
        compiler = [sys.executable, "-m", "ziglang", "cc"]
    else:
        pytest.skip("no C compiler is installed")
    words = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O2", "-shared", "-fPIC"]
    words += ["-ffp-contract=off"]  # a fused operation rounds otherwise than Python, and rates magnify that
    subprocess.run([*compiler, *words, "eha_controller.c", "-lm", "-o", "law.so"], cwd=folder, check=True)
    library = ctypes.CDLL(str(folder / "law.so"))
    library.eha_voltage.restype = library.eha_follow.restype = ctypes.c_double
    library.eha_voltage.argtypes = [ctypes.c_double] * 4
    library.eha_follow.argtypes = [ctypes.c_void_p, *[ctypes.c_double] * 4]
    return library


def motion(samples: int = 1000) -> list[tuple[float, float]]:
    """Position and velocity of two sines, with reversals and rests among them."""
    time = PERIOD * np.arange(samples)
    position = 0.03 * np.sin(2 * np.pi * time) + 0.004 * np.sin(2 * np.pi * 7.0 * time)
    velocity = 0.06 * np.pi * np.cos(2 * np.pi * time) + 0.056 * np.pi * np.cos(2 * np.pi * 7.0 * time)
    velocity[300:400] = 0.0
    return list(zip(position.tolist(), velocity.tolist(), strict=True))


def test_the_c_function_is_the_python_one_over_a_grid(python: ModuleType, compiled: ctypes.CDLL) -> None:
    velocities = (-0.5, -0.05, -1e-3, -1e-6, 0.0, 1e-7, 2e-4, 3e-3, 0.08, 0.9)
    grid = product((-0.09, -0.01, 0.0, 0.04), velocities, (-20.0, -0.3, 0.0, 5.0), (3e6, 1.4e7, 2.1e7))
    rows = [(compiled.eha_voltage(*point), python.ACTUATOR.voltage(*point)) for point in grid]
    in_c, in_python = np.array(rows).T
    np.testing.assert_allclose(in_c, in_python, rtol=1e-12, atol=0.0)
    assert np.ptp(in_python) > 1.0


def test_a_motion_in_c_and_in_python_is_the_feedforward_s(python: ModuleType, compiled: ctypes.CDLL) -> None:
    controller = make_controller("feedforward", changed(nominal_values(), FOUND), PERIOD, 1e6)
    memory = (ctypes.c_double * 4)()  # an eha_motion: an int, padded, and three doubles
    python.ACTUATOR.reset()
    for position, velocity in motion():
        volts = controller.voltage(Measurement(position, velocity, 0.0), Target(position, velocity))
        assert python.ACTUATOR.follow(position, velocity, PERIOD) == volts
        supply = ctypes.c_double.in_dll(compiled, "eha_supply_pressure").value
        in_c = compiled.eha_follow(ctypes.addressof(memory), position, velocity, PERIOD, supply)
        assert in_c == pytest.approx(volts, rel=1e-12, abs=0.0)


def test_the_python_file_needs_math_alone(folder: Path) -> None:
    tree = ast.parse((folder / "eha_controller.py").read_text())
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    assert [node.module for node in imports if isinstance(node, ast.ImportFrom)] == ["math"] and len(imports) == 1
    code = "from eha_controller import ACTUATOR; print(ACTUATOR.voltage(0.0, 0.1, 0.0))"
    done = subprocess.run([sys.executable, "-S", "-c", code], cwd=folder, capture_output=True, text=True, check=True)
    assert float(done.stdout) > 0.0


@pytest.mark.parametrize("name", NAMES)
def test_every_value_acts(name: str) -> None:
    values = changed(nominal_values(), FOUND)
    model, other = InverseModel(values), InverseModel({**values, name: 1.1 * values[name] + 1e-6 * (values[name] == 0)})
    assert any(model.follow(*each, PERIOD) != other.follow(*each, PERIOD) for each in motion())


def test_the_gains_have_the_form_of_the_shipped_ones(folder: Path) -> None:
    made, shipped = (yaml.safe_load(path.read_text()) for path in (folder / "controllers.yaml", SHIPPED))

    def keys(node: object) -> object:
        return {key: keys(value) for key, value in node.items()} if isinstance(node, dict) else type(node)

    assert set(made) == {f"/**/{name}" for name in ("controller_manager", "joint_trajectory_controller",
                                                    "pid_controller")}  # fmt: skip
    for section in ("/**/joint_trajectory_controller", "/**/pid_controller"):
        assert keys(made[section]) == keys(shipped[section])
    assert made["/**/controller_manager"]["ros__parameters"]["update_rate"] == 500


def test_of_a_diagnosis_it_says_what_is_compensated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    document = {"schema": "eha.diagnosis/1", "plant": PAPER.names, "fitted_values": FIVE}
    (tmp_path / "diagnosis.json").write_text(json.dumps(document))
    words = ["--from", str(tmp_path / "diagnosis.json"), "--out", str(tmp_path / "out"), "--rate", "1000"]
    assert main(["export", "controller", *words]) == 0
    said = capsys.readouterr().out
    assert "effects compensated: valve_deadband, coulomb_friction\n" in said
    assert "not compensated: supply_pressure_droop, position_sensor_lag, thermal_drift\n" in said
    assert '"coulomb_friction.force": 250.0,' in (tmp_path / "out" / "eha_controller.py").read_text()
    assert "update_rate: 1000\n" in (tmp_path / "out" / "controllers.yaml").read_text()
    # fitted.yaml, which a diagnosis writes beside it, is the same plant
    (tmp_path / "fitted.yaml").write_text(dump_plant(FIVE, PAPER))
    words[1], words[3] = str(tmp_path / "fitted.yaml"), str(tmp_path / "same")
    assert main(["export", "controller", *words]) == 0
    assert capsys.readouterr().out == said.replace("/out:", "/same:")
    for path in (tmp_path / "out").iterdir():
        text = (tmp_path / "same" / path.name).read_text()
        assert text.replace("from fitted.yaml", "from diagnosis.json") == path.read_text()
