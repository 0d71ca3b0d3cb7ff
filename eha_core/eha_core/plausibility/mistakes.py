"""The mistakes that are made in recordings, one function for each kind: its description, and the corrected channels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from eha_core.plausibility.finding import Suspect, rescaled
from eha_core.plausibility.signals import on_grid
from eha_core.recording import Channel, Recording

POSITION_UNITS = {"mm": 1e-3, "cm": 1e-2, "inches": 0.0254, "um": 1e-6}
FARTHEST_ZERO = 5.0
"""Largest distance of a sensor's zero from mid-stroke, in half strokes: a rod longer than the cylinder (assumed).
Beyond it, the unit is wrong."""
ABOVE_THE_ATMOSPHERE = ("bar", "MPa", "psi")
"""Units of gauge pressures to which a driver may have added the atmospheric pressure in Pa."""
PRESSURE_UNITS = {"bar": 1e5, "MPa": 1e6, "kPa": 1e3, "psi": 6894.757, "a tenth of Pa": 0.1, "tens of Pa": 10.0}


def suspects(recording: Recording, nominal: Mapping[str, float]) -> Iterator[Suspect]:
    """Every single mistake that may have been made in channels that are named correctly, the more usual first."""
    for kind in (reversed_signs, swapped_chambers, position_units, other_units, pressure_units, zero_of_position):
        yield from kind(recording, nominal)


def _all_there(recording: Recording, *names: str) -> bool:
    return all(name in recording.channels for name in names)


def reversed_signs(recording: Recording, nominal: Mapping[str, float]) -> Iterator[Suspect]:
    """A channel of the opposite sign."""
    for names, mistake in (
        (("voltage_command",), "the piston moves against voltage_command: its sign, or the valve's, is reversed"),
        (("force",), "force has the opposite sign"),
        (("position",), "position has the opposite sign"),
        (("velocity",), "velocity has the opposite sign"),
        (("position", "velocity"), "position and velocity have the opposite sign"),
    ):
        if _all_there(recording, *names):
            yield Suspect(mistake, {name: rescaled(recording, name, -1.0) for name in names})


def swapped_chambers(recording: Recording, nominal: Mapping[str, float]) -> Iterator[Suspect]:
    """The two chambers' sensors swapped."""
    if _all_there(recording, "pressure_a", "pressure_b"):
        a, b = (recording.channels[name] for name in ("pressure_a", "pressure_b"))
        undone = {"pressure_a": replace(b, name="pressure_a"), "pressure_b": replace(a, name="pressure_b")}
        yield Suspect("pressure_a and pressure_b are swapped", undone)


def position_units(recording: Recording, nominal: Mapping[str, float]) -> Iterator[Suspect]:
    """A position, perhaps with its velocity, in another unit of length, perhaps measured from an end of the stroke.

    If the piston stands still, the unit cannot be found: the range of noise is plausible in any unit.
    """
    signals = on_grid(recording)
    if signals is None or not signals.is_motion_seen:
        return
    for unit, factor in POSITION_UNITS.items():
        scaled = rescaled(recording, "position", factor)
        velocity = {"velocity": rescaled(recording, "velocity", factor)} if _all_there(recording, "velocity") else {}
        yield Suspect(f"position is in {unit}", {"position": scaled})
        if velocity:
            yield Suspect(f"velocity is in {unit}/s", velocity)
            yield Suspect(f"position is in {unit} and velocity in {unit}/s", {"position": scaled, **velocity})
        shift = _shift_to_middle(scaled, nominal) or _shift_from_end(scaled, nominal)
        if shift:
            counted = f"position is in {unit} and is not measured from mid-stroke"
            yield Suspect(counted, {"position": rescaled(recording, "position", factor, shift)}, moves_zero=True)


def other_units(recording: Recording, nominal: Mapping[str, float]) -> Iterator[Suspect]:
    """A command in mV, a force in kN."""
    for name, unit, factor in (("voltage_command", "mV", 1e-3), ("force", "kN", 1e3)):
        if _all_there(recording, name):
            yield Suspect(f"{name} is in {unit}", {name: rescaled(recording, name, factor)})


def pressure_units(recording: Recording, nominal: Mapping[str, float]) -> Iterator[Suspect]:
    """Pressures in another unit, both or one of them."""
    there = [name for name in ("pressure_a", "pressure_b") if name in recording.channels]
    choices = [there] if len(there) < 2 else [there, *([name] for name in there)]
    for unit, factor in PRESSURE_UNITS.items():
        for names in choices if there else ():
            mistake = f"{' and '.join(names)} {'is' if len(names) == 1 else 'are'} in {unit}"
            yield Suspect(mistake, {name: rescaled(recording, name, factor) for name in names})
    for unit in ABOVE_THE_ATMOSPHERE:
        for names in choices if there else ():
            have = "has" if len(names) == 1 else "have"
            mistake = f"{' and '.join(names)} {have} the atmosphere in Pa added to {unit}"
            yield Suspect(mistake, {name: _above_atmosphere(recording, name, PRESSURE_UNITS[unit]) for name in names})


def _above_atmosphere(recording: Recording, name: str, factor: float) -> Channel:
    """The corrected channel of a gauge pressure in another unit to which the atmosphere was added in Pa."""
    values = recording.channels[name].values
    return rescaled(recording, name, factor, float(factor * values[0] - rescaled(recording, name, factor).values[0]))


def zero_of_position(recording: Recording, nominal: Mapping[str, float]) -> Iterator[Suspect]:
    """A position measured from an end of the stroke, or from elsewhere."""
    shift = _shift_to_middle(recording.channels["position"], nominal)
    if shift:
        moved = rescaled(recording, "position", 1.0, shift)
        yield Suspect("position is not measured from mid-stroke", {"position": moved})


def _shift_to_middle(position: Channel, nominal: Mapping[str, float]) -> float:
    """The shift that brings a position into the stroke [m], to three digits: half the stroke, if that suffices.

    Zero if it is inside, or if its zero would be too far off.
    """
    middle = 0.5 * float(np.min(position.values) + np.max(position.values))
    stroke = nominal["actuator_displacement"]
    if abs(abs(middle) - stroke) < 0.25 * stroke:
        middle = float(np.copysign(stroke, middle))
    outside = abs(middle) + 0.5 * float(np.ptp(position.values)) > stroke
    return -float(f"{middle:.3g}") if outside and abs(middle) < FARTHEST_ZERO * stroke else 0.0


def _shift_from_end(position: Channel, nominal: Mapping[str, float]) -> float:
    """The shift [m] of a position that is measured from an end of the stroke; zero if it has both signs."""
    stroke = nominal["actuator_displacement"]
    if np.min(position.values) > 0.0:
        return -stroke
    return stroke if np.max(position.values) < 0.0 else 0.0


def unrelated(recording: Recording, nominal: Mapping[str, float]) -> Iterator[Suspect]:
    """A command, or a velocity, of another run."""
    for name in ("voltage_command", "velocity"):
        if name in recording.channels:
            yield Suspect(f"{name} is unrelated to the motion: it may be of another run", {name: None})
