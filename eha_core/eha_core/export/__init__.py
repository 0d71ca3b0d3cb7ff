"""The plant for other tools, without this library: an FMU for co-simulation, a C library, and a controller made
from the model.

FMU and C library are compiled from the LLVM text of the same kernel that `eha_core.plant.Plant` runs. The files in `c/`
hold what `Plant` does around it: parameters, effects that begin and cease to act, the start at rest; FMI's functions;
and the controller's law.

`mujoco_actuator`, which is imported by its own name, is the plant in Python as an actuator of a MuJoCo model.
"""

from eha_core.export.controller import write_controller
from eha_core.export.fmu import write_fmu
from eha_core.export.library import write_library
from eha_core.export.model import ExportedModel, exported_model

__all__ = ["ExportedModel", "exported_model", "write_controller", "write_fmu", "write_library"]
