"""What a file of `sources`, `cylinders` or `loads` declares."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from eha_core.parameter import Parameter
from eha_core.parameters import NOMINAL

CONTINUITY = ("bulk_modulus", "internal_leakage", "external_leakage", "line_volume", "atmospheric_pressure")
"""Nominal parameters that only equations (4) to (9) have: what the oil in the chambers and between them does."""


@dataclass(frozen=True)
class Part:
    """A source, a cylinder or a load: what an actuator is put together from.

    Attributes:
        summary: completes "an actuator with ...".
        uses: the rows of `eha_core.parameters.NOMINAL` that the part is described by.
        parameters: rows of its own. One named like a nominal row takes that row's place.
        stands_for: the nominal parameters whose place in the equations a row of its own takes.
        id: the file's name, filled in on discovery.
    """

    summary: str
    uses: tuple[str, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    stands_for: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    id: str = ""

    @property
    def own(self) -> tuple[Parameter, ...]:
        """The rows that neither are nor stand for a nominal one, in the order in which `contribution` takes them."""
        nominal = {row.name for row in NOMINAL}
        return tuple(row for row in self.parameters if row.name not in nominal and row.name not in self.stands_for)


@dataclass(frozen=True)
class Source(Part):
    """Where the oil comes from, or what takes its place.

    Attributes:
        inputs: the recorded channels that drive it, in the order in which they are given.
        optional: a further channel; where it is missing, the first takes its place.
        valve: what moves its spool: "coil" (equations (1) and (2)), "current" ((2) alone), "spool" (the input is the
            spool's position) or "" where there is no spool.
        given: what replaces the chambers' oil: "" (nothing), "pressures" or "force".
        sites: of effects that such a plant has; see `eha_core.effects.sites`.
        ignores: nominal parameters that its equations do not contain.
        hides: columns of `eha_core.plant.state.Row` that it has no value for.
        idle: whether its chambers rest at the return line's pressure, in place of midway to the supply's.
        switched: rows of its own, damping ratio and natural frequency of a spool that follows the sign of the last
            input by equation (2), to 1 or -1; () where none does.
        line: whether the pressure at the valve's supply port is a state; then its file has `feed` beside
            `contribution`.
        held: rows of its own that no recording of moderate length tells, and a diagnosis therefore does not move.
        spread: how far what a data sheet says of its rows is off: the standard deviation of the logarithm (of one that
            can be zero, in units of `typical` or, if larger, of its nominal value), and the largest factor (or number
            of such units; 0: any). Others of its own are taken to be as uncertain as a valve's gain.
    """

    inputs: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    valve: str = ""
    given: str = ""
    sites: tuple[str, ...] = ("chamber", "force", "sensor", "schedule")
    ignores: tuple[str, ...] = ()
    hides: tuple[str, ...] = ()
    idle: bool = False
    switched: tuple[str, ...] = ()
    line: bool = False
    held: tuple[str, ...] = ()
    spread: Mapping[str, tuple[float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class Cylinder(Part):
    """What turns pressure into motion.

    Attributes:
        motion: unit of its position: "m" or "rad".
        balanced: whether it starts with the pressures that hold it at rest, in place of equal ones.
        check: raises ParameterError for values (complete) that are no such cylinder.
    """

    motion: str = "m"
    balanced: bool = False
    check: Callable[[Mapping[str, float]], None] | None = None


@dataclass(frozen=True)
class Load(Part):
    """What is moved. `motion` as for a cylinder."""

    motion: str = "m"
