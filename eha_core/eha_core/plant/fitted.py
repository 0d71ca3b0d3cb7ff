"""The plant that a diagnosis.json describes: its parts, and the values that were fitted with all effects found."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from eha_core.errors import EhaError
from eha_core.plant.composition import Composition
from eha_core.plant.plant_file import composition_of


class FittedPlant(NamedTuple):
    """The actuator's parts, and every parameter of the equations [SI]."""

    composition: Composition
    places: dict[str, float]


def read_diagnosis(path: str | Path) -> Any:
    """The document in a file; EhaError, naming it, where it cannot be read or is no JSON."""
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise EhaError(f"{path}: cannot be read ({error.strerror}); give the diagnosis.json of a diagnosis") from error
    except ValueError as error:
        raise EhaError(f"{path}: no JSON; give the diagnosis.json that `eha diagnose` writes") from error


def fitted_plant(document: Mapping[str, Any], source: str) -> FittedPlant:
    """The plant of a diagnosis, as `diagnosis.json` has it; of several recordings, with the values of the first.

    Raises EhaError, naming `source`, where it is no such document or has no fitted values.
    """
    if not isinstance(document, Mapping) or document.get("schema") != "eha.diagnosis/1":
        raise EhaError(f"{source}: no diagnosis; give the diagnosis.json that `eha diagnose` writes")
    if not document.get("fitted_values") or "plant" not in document:
        raise EhaError(f"{source}: it has no fitted_values to simulate; diagnose the recording of an actuator again")
    composition = composition_of(document["plant"])
    return FittedPlant(composition, composition.places(composition.nominal_values()) | document["fitted_values"])
