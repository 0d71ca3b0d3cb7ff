"""What a twin found about a departure, in words and as named values."""

from __future__ import annotations

from collections.abc import Mapping

from eha_core.diagnosis.criteria import LEFT_IN_A_CHANNEL
from eha_core.effects import effect_title
from eha_core.quantities import quantity, within
from eha_core.report.wording import words
from eha_core.twin.explanation import Cause, Explanation, Size


def likely_cause(explanation: Explanation) -> str:
    """The explanation as one line: the cause with its size, and what cannot be distinguished from it."""
    if explanation.cause is None:
        return f"no single effect or parameter explains {explanation.seconds:.1f} s of it"
    line = f"likely cause: {_title(explanation.cause)}, {_sizes(explanation.cause)} (95 %)"
    if explanation.residual > LEFT_IN_A_CHANNEL:
        line += f", which leaves {explanation.residual:.2g} times the noise"
    if explanation.rivals:
        rivals = (_title(rival) for rival in explanation.rivals)
        line += f", cannot be distinguished from {' or '.join(rivals)}"
    return line


def as_values(explanation: Explanation) -> Mapping[str, object]:
    """The explanation as named values: the cause's name, each size with half its 95 % interval, the rivals."""
    values: dict[str, object] = {"named from": f"{explanation.seconds:.1f} s"}
    cause = explanation.cause
    if cause is None:
        return values | {"cause": "none"}
    values["cause"] = cause.name
    if cause.flow:
        values["size: flow"] = within(*cause.flow, "m^3/s")
    values |= {f"size: {size.name}": within(size.value, size.deviation, size.unit) for size in cause.sizes}
    values["residual times the noise"] = explanation.residual
    return values | {"cannot be distinguished from": ", ".join(rival.name for rival in explanation.rivals)}


def _title(cause: Cause) -> str:
    """An effect's title, or a parameter's; of one of an effect's parameters both."""
    return effect_title(cause.name).replace(".", ", ")


def _sizes(cause: Cause) -> str:
    if cause.flow:
        more = sum(size.change for size in cause.sizes) > 0.0
        return f"{within(*cause.flow, 'm^3/s')} {'more' if more else 'less'}"
    return " and ".join(_size(size, several=len(cause.sizes) > 1) for size in cause.sizes)


def _size(size: Size, several: bool) -> str:
    name = f"{words(size.name.rpartition('.')[2])} " if several else ""
    instead = f" instead of {quantity(size.modelled, size.unit)}" if size.modelled else ""
    return f"{name}{within(size.value, size.deviation, size.unit)}{instead}"
