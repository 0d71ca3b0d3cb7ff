"""The plant as an actuator of a MuJoCo model, compared with the plant on its own, which moves its mass itself.

python examples/mujoco_actuator.py [SECONDS [TIMESTEP]]
"""

import sys
from pathlib import Path

import mujoco
import numpy as np
import xacro

from eha_core.export import ExportedModel
from eha_core.export.mujoco_actuator import EhaActuator
from eha_core.plant import PAPER, Plant
from eha_core.signals.multisine import Multisine

URDF = Path(__file__).resolve().parent.parent / "eha_description" / "urdf" / "actuator.urdf.xacro"
seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
timestep = float(sys.argv[2]) if len(sys.argv) > 2 else 1e-4

spec = mujoco.MjSpec.from_string(xacro.process_file(str(URDF)).toxml())
spec.option.timestep = timestep
spec.add_actuator(name="valve", trntype=mujoco.mjtTrn.mjTRN_JOINT, target="piston")
model = spec.compile()
data = mujoco.MjData(model)

values = {**PAPER.nominal_values(), "coulomb_friction.force": 250.0, "valve_deadband.half_width": 1e-4}
actuator = EhaActuator(model, data, "valve", ExportedModel(PAPER, values))

voltages = Multisine(amplitude=0.15).shape(timestep * np.arange(round(seconds / timestep)))
positions = np.empty(len(voltages))
for index, voltage in enumerate(voltages):
    data.ctrl[0] = voltage
    actuator.step()
    positions[index] = data.qpos[0]

plant = Plant(values)
steps = round(timestep / plant.step_size)
deviations = 1e6 * (positions - plant.run(np.repeat(voltages, steps), every=steps).position)
print(
    f"{seconds:g} s at {1e3 * timestep:g} ms, {1e3 * np.ptp(positions):.1f} mm of motion: MuJoCo deviates from the"
    f" plant by {np.sqrt(np.mean(deviations**2)):.3f} um RMS, at most {np.max(np.abs(deviations)):.3f} um"
)
