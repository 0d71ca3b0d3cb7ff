"""Short step tests of a machine's valve, read together: dead zone, gain, delay, saturation and end stops."""

from eha_core.step_tests.columns import Selection
from eha_core.step_tests.reading import records_of
from eha_core.step_tests.result import Direction, Estimate, Step, StepTests
from eha_core.step_tests.study import read_steps

__all__ = ["Direction", "Estimate", "Selection", "Step", "StepTests", "read_steps", "records_of"]
