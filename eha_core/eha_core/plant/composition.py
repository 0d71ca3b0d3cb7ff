"""An actuator put together from a source, a cylinder and a load: which parameters and effects it has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property

from eha_core.effects import Effect, effects
from eha_core.errors import ParameterError, remedy
from eha_core.parameter import Parameter
from eha_core.parameters import ACTING, NOMINAL, PAPER_PARTS, acting_rows, catalogue, changed, check_supply
from eha_core.plant.parts import FOLDERS, Cylinder, Load, Part, Source, part, parts

TURNING = {
    "m": "rad", "m/s": "rad/s", "N": "N m", "N/m": "N m/rad", "N s/m": "N m s/rad", "N/m^3": "N m/rad^3",
    "N s^2/m^2": "N m s^2/rad^2",
}  # fmt: skip
"""The units of motion and force, and what they are of an actuator that turns."""


@dataclass(frozen=True)
class Composition:
    """Source, cylinder and load of one actuator.

    `rows`, `nominal_values` and `changed` are in the parameters of its parts. `places` brings their values to those of
    the equations, which are all that the compiled step, the lock-step and the diagnosis know; `named` brings them back.
    """

    source: Source
    cylinder: Cylinder
    load: Load

    def __str__(self) -> str:
        return f"{self.source.id}, {self.cylinder.id}, {self.load.id}"

    @property
    def names(self) -> dict[str, str]:
        """The parts' ids by kind, as a nominal file has them under `plant:`."""
        return {"source": self.source.id, "cylinder": self.cylinder.id, "load": self.load.id}

    @property
    def is_papers(self) -> bool:
        """Whether it is the paper's actuator, which every reader of this library takes."""
        return self.names == PAPER_PARTS

    @property
    def has_lockstep(self) -> bool:
        """Whether `LockStep` takes plants of it; others are simulated one after another."""
        return self.source.valve == "coil" or bool(self.source.given)

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects of the catalogue that such a plant can show: those at the sites of its source, and of those the
        ones that act on what it has."""
        source = self.source
        return tuple(
            effect for effect in effects() if effect.site in source.sites and not set(effect.needs) & set(source.hides)
        )

    @cached_property
    def rows(self) -> Mapping[str, Parameter]:
        """Every parameter that applies, by name: those of its parts, of its effects, and when the effects act."""
        mine = self._rows_of_parts()
        order = [row.name for row in NOMINAL if row.name in mine]
        found = {name: mine[name] for name in (*order, *(name for name in mine if name not in order))}
        for effect in self.effects:
            found.update(zip(effect.parameter_names(), effect.parameters, strict=True))
        found |= {row.name: row for row in ACTING}
        for effect in self.effects:
            found |= acting_rows(effect)
        return found

    def _rows_of_parts(self) -> dict[str, Parameter]:
        nominal = {row.name: row for row in NOMINAL}
        found: dict[str, Parameter] = {}
        for component in (self.source, self.cylinder, self.load):
            found |= {name: nominal[name] for name in component.uses} | {row.name: row for row in component.parameters}
        return {name: row for name, row in found.items() if not set(self.stands_for(name)) <= set(self.source.ignores)}

    def stands_for(self, name: str) -> tuple[str, ...]:
        """The places of the equations that a parameter takes."""
        for component in (self.source, self.cylinder, self.load):
            if name in component.stands_for:
                return component.stands_for[name]
        return (name,)

    @cached_property
    def place_rows(self) -> Mapping[str, Parameter]:
        """The places of the equations that its parts' parameters take, each with the row of the one that takes it."""
        return {place: row for name, row in self._rows_of_parts().items() for place in self.stands_for(name)}

    def nominal_values(self) -> dict[str, float]:
        """Every parameter that applies at its nominal value: no effect acts."""
        return {name: row.nominal for name, row in self.rows.items()}

    def changed(self, values: Mapping[str, float], changes: Mapping[str, object]) -> dict[str, float]:
        """Return `values` with `changes` applied, checked as a whole; ParameterError as `parameters.changed` says, and
        for a parameter that does not apply to these parts."""
        for name in changes:
            self.require(name)
        if self.is_papers:
            return changed(values, changes)
        result = dict(values)
        for name, value in changes.items():
            result[name] = self.rows[name].check(value, name)
        check_supply(result)
        if self.cylinder.check is not None and not self.source.ignores:
            self.cylinder.check(result)
        return result

    def require(self, name: str, where: str = "") -> None:
        """Raise ParameterError for a name that is no parameter of these parts."""
        if name in self.rows:
            return
        if name in catalogue() or name in _all_rows():
            what = f"{name} does not apply to this plant ({self}); leave it out, or name other parts under `plant:`"
        else:
            nearest = remedy(name, self.rows, "`eha effects --parameters` lists the names")
            what = f"there is no parameter named {name}; {nearest}"
        raise ParameterError(f"{where}{what}")

    def places(self, values: Mapping[str, float]) -> dict[str, float]:
        """The parameters of the equations, in the catalogue's order, and after them those of the source alone.

        What does not apply to these parts is there with its nominal value, and the step does not use it.
        """
        if self.is_papers:
            return dict(values)
        found = {name: row.nominal for name, row in catalogue().items()}
        for name, value in values.items():
            for place in self.stands_for(name):
                found[place] = value
        return found

    def as_shown(self, effect: Effect) -> Effect:
        """The effect with the units that its parameters have in such a plant: of angles and torques where it turns."""
        if self.cylinder.motion == "m":
            return effect
        rows = (replace(row, unit=TURNING.get(row.unit, row.unit)) for row in effect.parameters)
        return replace(effect, parameters=tuple(rows))

    def named(self, places: Mapping[str, float]) -> dict[str, float]:
        """The values of `places` under the names of its parts' parameters."""
        return {name: places[self.stands_for(name)[0]] for name in self.rows}


@cache
def _all_rows() -> frozenset[str]:
    """Every name of a parameter that some part has."""
    return frozenset(row.name for kind in FOLDERS for component in parts(kind).values() for row in component.parameters)


@cache
def compose(
    source: str = PAPER_PARTS["source"], cylinder: str = PAPER_PARTS["cylinder"], load: str | None = None
) -> Composition:
    """The actuator of these parts, by id; by default the paper's, and a load that moves as the cylinder does.

    Raises ParameterError for a part that there is not, and for a cylinder that turns under a load that does not.
    """
    chosen = part("cylinder", cylinder)
    assert isinstance(chosen, Cylinder)
    moved = part("load", load) if load is not None else _load_for(chosen)
    origin = part("source", source)
    assert isinstance(origin, Source) and isinstance(moved, Load)
    if moved.motion != chosen.motion:
        raise ParameterError(
            f"plant.load = {moved.id} moves in {moved.motion}, plant.cylinder = {chosen.id} in {chosen.motion}; "
            f"give {_load_for(chosen).id}"
        )
    return Composition(origin, chosen, moved)


def _load_for(cylinder: Cylinder) -> Part:
    """The load of those that move as the cylinder does: the paper's, else the first."""
    fitting = {name: load for name, load in parts("load").items() if isinstance(load, Load)}
    names = [name for name, load in fitting.items() if load.motion == cylinder.motion]
    return fitting[PAPER_PARTS["load"] if PAPER_PARTS["load"] in names else names[0]]


PAPER = compose()
"""The paper's actuator: a servo valve on voltage, a double-rod cylinder, a sprung mass."""
