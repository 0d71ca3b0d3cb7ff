"""The plant for other tools: an FMU for co-simulation, or a C header with a library, neither of which needs Python.

Both are compiled from the LLVM text of the same kernel that `eha_core.plant.Plant` runs. The files in `c/` hold what
`Plant` does around it: parameters, effects that begin and cease to act, the start at rest; and FMI's functions.
"""

from eha_core.export.fmu import write_fmu
from eha_core.export.library import write_library
from eha_core.export.model import ExportedModel, exported_model

__all__ = ["ExportedModel", "exported_model", "write_fmu", "write_library"]
