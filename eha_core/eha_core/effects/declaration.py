"""What a file of the catalogue declares beside its compiled contribution."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from eha_core.parameter import Parameter
from eha_core.quantities import Quantity

MEMORY_STARTS = ("zero", "current", "position", "velocity", "pressure_a", "pressure_b")
"""What a memory slot of an effect can hold when the effect begins to act."""

ACTS = ("acts_from", "acts_until")
"""What follows an effect's id in the names of when it begins and ceases to act."""

ASSUMED = "assumed: an order of magnitude for a bench actuator"


@dataclass(frozen=True)
class Effect:
    """One physical effect that the nominal equations leave out.

    `site` is one of `sites.SITES`. `statement` completes the sentence "the recording shows that ..." and may quote
    parameters by name; they are shown in readable units (see `Quantity`). `opposite` is said in its place, of the
    magnitude, where the first parameter is negative.
    `memory` names what each of the effect's state slots starts from (one of MEMORY_STARTS). `order` ranks effects of
    one site where their sequence matters physically; equal ranks go by id. `needs` lists measured columns without which
    no recording can show the effect. Effects of one `kind` are forms of one law: never two of them are named together.
    `approximate` says that the literature writes the law in other ways too: where the name is right, the form can still
    leave something over. `zeros` are pairs of a parameter and the channel whose reading it shifts, which a topics file
    can undo. `named` is False for a curve in place of a law nobody has named. `id` is the file's name,
    filled in on discovery.
    """

    site: str
    statement: str
    equation: str
    parameters: tuple[Parameter, ...]
    memory: tuple[str, ...] = ()
    order: int = 0
    needs: tuple[str, ...] = ()
    kind: str = ""
    approximate: bool = False
    named: bool = True
    opposite: str = ""
    zeros: tuple[tuple[str, str], ...] = ()
    id: str = ""

    def parameter_names(self) -> tuple[str, ...]:
        """Full names, `<effect id>.<parameter>`, as ROS and parameter files carry them."""
        return tuple(f"{self.id}.{row.name}" for row in self.parameters)

    def acting_names(self) -> tuple[str, ...]:
        """Full names of when it begins and ceases to act [s]; none of a curve's, which always acts."""
        return tuple(f"{self.id}.{name}" for name in ACTS) if self.named else ()

    @property
    def only_delays(self) -> bool:
        """Whether it does nothing but delay signals: a lag, or a dead time."""
        return all(row.unit == "s" for row in self.parameters)

    def is_active(self, values: Mapping[str, float]) -> bool:
        """True unless every parameter that switches the effect stands at its neutral, that is nominal, value."""
        return any(row.switches and values[f"{self.id}.{row.name}"] != row.nominal for row in self.parameters)

    def describe(self, values: Mapping[str, float]) -> str:
        """The statement with the given parameter values (short names, SI) filled in."""
        shown = {row.name: Quantity(values[row.name], row.unit) for row in self.parameters if row.name in values}
        first = self.parameters[0]
        if self.opposite and values[first.name] < 0.0:
            return self.opposite.format(**{**shown, first.name: Quantity(-values[first.name], first.unit)})
        return self.statement.format(**shown)
