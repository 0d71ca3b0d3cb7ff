"""A controller made of what `eha export controller` wrote: its Python law ahead, a PI loop with its gains behind.

    eha export controller --from out/diagnosis/diagnosis.json --out out/controller
    python3 examples/exported_controller.py --ros-args -p folder:=out/controller

It answers as `position_controller.py` beside it does, and needs of this project that file and the folder alone.
"""

from __future__ import annotations

import sys
from pathlib import Path

import yaml
from position_controller import AnsweringController, run


class ExportedController(AnsweringController):
    """voltage = law(reference position, velocity) + p error + i integral of the error."""

    def __init__(self) -> None:
        super().__init__("eha_controller")
        folder = Path(self.declare_parameter("folder", "out/controller").value)
        document = yaml.safe_load((folder / "controllers.yaml").read_text())
        self.period = 1.0 / document["/**/controller_manager"]["ros__parameters"]["update_rate"]
        self.gains = document["/**/pid_controller"]["ros__parameters"]["gains"]["piston"]
        sys.path.insert(0, str(folder))
        from eha_controller import ACTUATOR  # the file in the folder

        self.actuator = ACTUATOR
        self.integral = 0.0  # m s

    def law(self, position: float, velocity: float, error: float) -> float:
        ahead = self.actuator.follow(position, velocity, self.period)
        voltage = ahead + self.gains["p"] * error + self.gains["i"] * self.integral
        limited = min(max(voltage, self.gains["u_clamp_min"]), self.gains["u_clamp_max"])
        if limited == voltage or voltage * error < 0.0:  # conditional integration
            self.integral += error * self.period
        return limited


if __name__ == "__main__":
    run(ExportedController)
