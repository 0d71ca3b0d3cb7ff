"""A test of an investigation: a voltage of some duration, and its purpose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.detectability.design import kinds
from eha_core.detectability.margins import Margins
from eha_core.diagnosis.experiment.command_signal import CommandSignal
from eha_core.diagnosis.experiment.limits import Limits
from eha_core.diagnosis.result import Experiment
from eha_core.errors import EhaError
from eha_core.nominal import NominalModel
from eha_core.signals import from_text

FIRST_DURATION = 10.0
"""s; default duration of a first test, and shortest of a proposed one."""

FIRST_SHARE = 0.5
"""Share of the largest amplitude at which no rig within the priors exceeds a limit: the missing physics is not known
yet (assumed)."""

RATE = 500.0
"""Hz; rate at which a first test is simulated with the model."""


@dataclass(frozen=True)
class VoltageTest:
    """A voltage that drives a rig for `duration` [s]; `purpose` in a sentence."""

    signal: CommandSignal
    duration: float
    purpose: str

    @classmethod
    def proposed(cls, experiment: Experiment) -> VoltageTest:
        """The test that a diagnosis proposes."""
        return cls(CommandSignal.of(experiment.reference), experiment.duration, experiment.statement)

    @property
    def largest(self) -> float:
        """Its largest voltage [V], either sign."""
        times = np.arange(round(self.duration * RATE)) / RATE
        return float(np.max(np.abs(self.signal.voltage(times))))


def first_test(command: str, duration: float, model: NominalModel, limits: Limits) -> VoltageTest:
    """The test that an investigation begins with.

    Args:
        command: a signal of voltage such as "multisine:amplitude=0.05"; empty: a multisine whose amplitude is half of
            the largest at which no rig within the model's priors exceeds a limit.
        duration: its length [s]; 0: FIRST_DURATION.
        model: the rig as modelled. limits: those of the rig.

    Raises:
        ParameterError: the command is no signal.
        EhaError: its voltage is beyond the limit, or no multisine stays within the limits.
    """
    length = duration or FIRST_DURATION
    if command:
        made = from_text(command)
        values = {row.name: getattr(made, row.name) for row in made.parameters()}
        test = VoltageTest(CommandSignal(made.name, values), length, "a first look at the rig")
    else:
        make = kinds()["multisine"][1]
        largest = Margins.of(model, limits).largest_amplitude(make, np.arange(round(length * RATE)) / RATE)
        if largest == 0.0:
            raise EhaError("no multisine of voltage stays within the limits; give wider ones, or a command")
        test = VoltageTest(make(float(f"{FIRST_SHARE * largest:.2g}")), length, "a first look, well within the limits")
    if test.largest > limits.voltage:
        raise EhaError(f"the first test reaches {test.largest:.3g} V, the limit is {limits.voltage:.3g} V; give less")
    return test
