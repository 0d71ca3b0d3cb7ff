"""Make rig_five_effects.mcap: a low-pressure rig with five effects at once, simulated by the exam's own truth.

The truth shares neither equations nor integrator with the plant that the diagnosis fits. Run in this folder; what is
there is never overwritten.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from eha_exam.cases import draw_case
from eha_exam.concealed import draw_effect
from eha_exam.files import write_case
from eha_exam.measuring import measure, simulate_case

SEED = 31
CONCEALED = ("coulomb_friction", "valve_deadband", "supply_pressure_droop", "constant_load", "external_leakage")
PLAIN = {"position_step": 0.0, "pressure_step": 0.0, "jitter": 0.0, "dropout": 0.0}

if __name__ == "__main__":
    target = Path("rig_five_effects.mcap")
    if target.exists():
        raise SystemExit(f"{target}: is there already; move it away to make it again")
    rig = draw_case("null_parameters", 0, SEED)
    rig = replace(rig, duration=12.0, rate=500.0, noise=1.0, shape="multisine", loop=1.0, **PLAIN)
    generator = np.random.default_rng(SEED)
    effects = tuple((name, draw_effect(name, rig.setting, generator)) for name in CONCEALED)
    case = replace(rig, tier="rig", effects=effects)
    write_case(case, measure(case, simulate_case(case)), target)
    for name, values in effects:
        print(name, ", ".join(f"{key} {value:.4g}" for key, value in values.items()))
