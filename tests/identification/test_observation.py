"""Every recorded channel is driven by, compared, or said not to be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eha_core.identification.observation import observe
from eha_core.recording import CHANNEL_KINDS, Channel, Recording

TIME = np.arange(0.0, 4.0, 2e-3)


def recording(*names: str) -> Recording:
    values = np.sin(3.0 * TIME) + 1e-3 * np.random.default_rng(1).standard_normal(len(TIME))
    channels = {
        name: Channel(name, TIME, values, kind.unit, name, "csv")
        for name, kind in CHANNEL_KINDS.items()
        if name in names
    }
    return Recording(Path("run.csv"), channels, 0, 4.0, {}, (), None, ())


@pytest.mark.parametrize(
    "names",
    [
        tuple(CHANNEL_KINDS),
        ("voltage_command", "position"),
        ("position", "force", "velocity", "supply_pressure"),
        ("position", "pressure_a", "pressure_b", "force"),
        ("position", "pressure_a", "pressure_b", "velocity", "flow_a"),
    ],
)
def test_no_channel_is_passed_over_in_silence(names: tuple[str, ...]) -> None:
    observation = observe(recording(*names))
    driving = {"voltage": {"voltage_command"}, "force": {"force"}, "pressures": {"pressure_a", "pressure_b"}}
    used = driving[observation.drive] | {one.name for one in observation.measured}
    said = {line.partition(":")[0] for line in observation.not_examined}
    assert used | (said & set(CHANNEL_KINDS)) == set(names)
    assert not used & said
