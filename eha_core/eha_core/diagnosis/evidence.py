"""Everything that the stages found in one recording: what the conclusion rests on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from eha_core.diagnosis.balance import Balance
from eha_core.diagnosis.calibrate import Calibration
from eha_core.diagnosis.facts import Facts
from eha_core.diagnosis.observation import Observation
from eha_core.diagnosis.result import Location
from eha_core.diagnosis.tournament import Tournament
from eha_core.diagnosis.unknown import Recovery
from eha_core.diagnosis.verdict import Decision


@dataclass(frozen=True)
class Evidence:
    """Every stage's result, in their order. `equations`: the balances that lack least; `balances`: those of each model
    that they were chosen from."""

    observation: Observation
    nominal: Mapping[str, float]
    calibration: Calibration
    facts: Facts
    equations: tuple[Balance, ...]
    balances: tuple[tuple[Balance, ...], ...]
    tournament: Tournament
    recovery: Recovery | None
    decision: Decision
    location: tuple[Location, ...]
