"""Rigs of a pump, a valve switched by sign and a single-rod cylinder, diagnosed: how often the answer is right.

    python -m tools.pump_rigs --rigs 12 --seed 7

Each is drawn from the seed and simulated by the exam's truth, which shares no code with the plant. The model is given
the data sheet's values, up to a tenth off, and nothing of how the valve switches or of the pump's line, which stay at
the catalogue's. Concealed is in turn nothing, dry friction, a leak, a steady load.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from time import monotonic

import numpy as np

import eha_core as eha
from eha_core.identification.numbers import Array
from eha_core.nominal import nominal_of
from eha_core.plant import compose
from eha_exam.truth.record import Effect
from eha_exam.truth.simulate import COLUMNS, SteppedTruth

RATE, SECONDS = 500.0, 16.0
VOLTS, AMPERES = 10.0, 0.02
"""The valve's signal, and the current at which its spool is at its end."""

NOISE = {"position": 1e-5, "pressure_a": 1e4, "pressure_b": 1e4}
LOWEST = -5e4
"""Pa; a recording that falls below is not one that a rig gives."""

KINDS = ("nothing", "friction", "leakage", "load")
RIG = compose("switched_pump", "single_rod")


@dataclass(frozen=True)
class PumpRig:
    """A rig: the truth's parameters, the concealed effect (or none), what the model is given, and what was recorded."""

    truth: dict[str, float]
    concealed: Effect | None
    given: dict[str, float]
    recording: eha.Recording


def draw(number: int, seed: int) -> PumpRig:
    """Rig `number` of a seed; one whose oil would boil, which the truth does not model, is drawn anew."""
    for attempt in range(100):
        g = np.random.default_rng([seed, number, attempt])
        truth = _draw_truth(g)
        concealed = _draw_effect(KINDS[number % len(KINDS)], truth, g)
        rig = PumpRig(truth, concealed, _told(truth, g), _record(truth, concealed, g))
        lowest = min(float(np.min(rig.recording.channels[name].values)) for name in ("pressure_a", "pressure_b"))
        if lowest > LOWEST:
            return rig
    raise RuntimeError(f"rig {number} of seed {seed}: no test without a vacuum was drawn")


def _draw_truth(g: np.random.Generator) -> dict[str, float]:
    area = 0.25 * np.pi * g.uniform(0.032, 0.063) ** 2
    flow = area * g.uniform(0.05, 0.12)
    displacement = flow / 100.0
    relief = g.uniform(8e6, 20e6)
    overlap = g.uniform(0.0, 0.15)
    tandem = g.random() < 0.5
    return {
        "coil_resistance": VOLTS / AMPERES,
        "coil_inductance": 0.02,
        "saturation_current": AMPERES,
        "valve_natural_frequency": g.uniform(40.0, 200.0),
        "valve_damping_ratio": g.uniform(0.7, 1.0),
        "valve_gain": flow / float(np.sqrt(g.uniform(2e5, 1e6))) / AMPERES,
        "piston_area": area,
        "piston_area_b": area * g.uniform(0.5, 0.8),
        "actuator_displacement": g.uniform(0.15, 0.4),
        "moving_mass": g.uniform(10.0, 80.0),
        "damping_coefficient": g.uniform(500.0, 4000.0),
        "spring_stiffness": 0.0,
        "bulk_modulus": g.uniform(0.8e9, 1.5e9),
        "internal_leakage": g.uniform(0.5e-12, 3e-12),
        "line_volume": g.uniform(3e-5, 2e-4),
        "supply_pressure": relief,
        "return_pressure": g.uniform(3e5, 8e5),
        "pump_displacement": displacement,
        "pump_leakage": g.uniform(0.01, 0.05) * flow / relief,
        "pump_relief_gain": flow / (0.1 * relief),
        "pump_line_volume": float(np.exp(g.uniform(np.log(2e-5), np.log(3e-4)))),
        "pump_bypass_gain": flow / float(np.sqrt(g.uniform(1e5, 3e5))) if tandem else 0.0,
        "pump_bypass_spool": AMPERES * max(0.05, overlap) * g.uniform(0.7, 1.3),
        "overlap": AMPERES * overlap,
    }


def _draw_effect(kind: str, truth: dict[str, float], g: np.random.Generator) -> Effect | None:
    force = g.uniform(0.05, 0.2) * truth["piston_area"] * truth["supply_pressure"] * float(g.choice((-1.0, 1.0)))
    if kind == "friction":
        return "coulomb_friction", {"force": abs(force)}
    if kind == "load":
        return "constant_load", {"force": force}
    if kind == "leakage":
        leak = g.uniform(0.03, 0.1) * 100.0 * truth["pump_displacement"] / 1e6
        return "external_leakage", {"coefficient_a": leak, "coefficient_b": leak * g.uniform(0.0, 1.0)}
    return None


def _told(truth: dict[str, float], g: np.random.Generator) -> dict[str, float]:
    """The nominal file: areas and lines as they are, what is measured badly up to a tenth off, the valve's size."""
    exact = ("piston_area", "piston_area_b", "actuator_displacement", "line_volume", "spring_stiffness",
             "return_pressure")  # fmt: skip
    vague = ("moving_mass", "damping_coefficient", "bulk_modulus", "internal_leakage", "supply_pressure",
             "pump_displacement", "pump_leakage")  # fmt: skip
    given = {name: truth[name] for name in exact}
    given |= {name: truth[name] * g.uniform(0.9, 1.1) for name in vague}
    return given | {
        "tank_gain": truth["valve_gain"] * (AMPERES - truth["overlap"]) * g.uniform(0.9, 1.1),
        "relief_gain": truth["pump_relief_gain"] * g.uniform(0.9, 1.1),
    }


def _record(truth: dict[str, float], concealed: Effect | None, g: np.random.Generator) -> eha.Recording:
    """The piston sent to and fro for random times, with rests, and back where it comes near an end."""
    plant = {name: value for name, value in truth.items() if name != "overlap"}
    effects: list[Effect] = [("valve_deadband", {"half_width": truth["overlap"]})]
    effects += [concealed] if concealed else []
    count = round(RATE * SECONDS) + 1
    stepped, reach = SteppedTruth(plant, effects, RATE, count), 0.6 * truth["actuator_displacement"]
    time, (slow, fast) = np.arange(count) / RATE, g.uniform(0, 6, 2)

    def speed(instants: Array) -> Array:
        share = 1.0 + 0.35 * np.sin(0.9 * instants + slow) + 0.15 * np.sin(4.3 * instants + fast)
        return np.asarray(100.0 * share)

    # a pump's speed does not change in steps when it is sampled: what the truth holds is that of midway to the next
    between = speed(time + 0.5 / RATE)
    signs, rows = np.empty(count), np.empty((count, len(COLUMNS)))
    sign = until = 0.0
    for k in range(count):
        position = stepped.sense()[0]
        if abs(position) > reach and sign * position > 0.0:
            sign, until = -float(np.sign(position)), float(time[k]) + g.uniform(0.3, 0.8)
        elif time[k] >= until:
            sign = 0.0 if sign and g.random() < 0.3 else float(g.choice((-1.0, 1.0)))
            until = float(time[k]) + (g.uniform(0.2, 0.5) if sign == 0.0 else g.uniform(0.4, 1.4))
        signs[k] = sign
        rows[k] = stepped.hold(VOLTS * sign, float(between[k]))
    return _as_recording(time, signs, speed(time), rows, g)


def _as_recording(time: Array, signs: Array, speed: Array, rows: Array, g: np.random.Generator) -> eha.Recording:
    position, pressure_a, pressure_b = (
        rows[:, COLUMNS.index(f"measured_{name}")] + noise * g.standard_normal(len(time))
        for name, noise in NOISE.items()
    )
    return eha.Recording.from_arrays(
        time=time, pressures="gauge", voltage_command=VOLTS * signs, pump_speed=speed, position=position,
        pressure_a=pressure_a, pressure_b=pressure_b,
    )  # fmt: skip


def main() -> None:
    """Draw, diagnose, and print a line a rig and the count of right answers."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rigs", type=int, default=8)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    right = 0
    for number in range(arguments.first, arguments.first + arguments.rigs):
        rig, begun = draw(number, arguments.seed), monotonic()
        found = eha.diagnose(rig.recording, nominal_of(rig.given, composition=RIG), jobs=1)
        concealed = [rig.concealed[0]] if rig.concealed else []
        named = [effect.id for effect in found.effects]
        is_right = named == concealed and found.diagnosis.verdict not in ("unknown_physics", "ambiguous")
        right += is_right
        values = "; ".join(
            f"{name} {value.value:.5g} +- {value.std:.2g}" for effect in found.effects
            for name, value in effect.parameters.items()
        )  # fmt: skip
        print(
            f"{number:3} {'+'.join(concealed) or 'nothing':18} {found.diagnosis.verdict:16} {'+'.join(named) or '-':30}"
            f" {'right' if is_right else 'wrong'}  {rig.concealed[1] if rig.concealed else ''} {values}"
            f"  ({monotonic() - begun:.0f} s)",
            flush=True,
        )
    print(f"{right} of {arguments.rigs} right")


if __name__ == "__main__":
    main()
