"""The text of a nominal file: a ROS 2 parameters file with units and origins as comments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eha_core.parameter import Parameter
from eha_core.parameters import UNKNOWN, effect_names, number_text
from eha_core.plant import PAPER, Composition
from eha_core.rig.parameters import Entry

_HEADING = f"""\
# Nominal model of a rig, made by `eha init-rig`. SI units; pressures above atmosphere.
# `{UNKNOWN}`: `eha diagnose` searches the value over the whole range of rigs; a number narrows the search.
# What differs between recordings of this rig is listed so: per_recording: [supply_pressure]
"""


def nominal_text(entries: Sequence[Entry], assume: bool = False, composition: Composition = PAPER) -> str:
    """The file's text.

    With `assume`, as a simulation needs it: the catalogue's value, marked as assumed, in place of each unknown one, and
    measured effects in force. Without, these are comments: a diagnosis finds effects itself, but holds those of its
    model, so that a bench's error of some percent would look like another fault.
    """
    lines = [line for entry in entries for line in _lines(entry, assume, composition.rows)]
    if not composition.is_papers:
        source = composition.source
        says = f"# {source.summary}, driven by {' and '.join(source.inputs)}"
        lines = [says, f"plant: {{source: {source.id}}}", *lines]
    return "\n".join([f"{_HEADING}/**/eha_sim:", "  ros__parameters:", *(f"    {line}" for line in lines)]) + "\n"


def _lines(entry: Entry, assume: bool, rows: Mapping[str, Parameter]) -> tuple[str, str]:
    row = rows[entry.name]
    value, how = entry.value, entry.how
    if value is None and assume:
        value, how = row.nominal, f"assumed: the catalogue's ({row.source})"
    comment = f"# {row.meaning} [{row.unit}]: {how}"
    if value is None:
        return comment, f"{entry.name}: {UNKNOWN}"
    if entry.name in effect_names() and not assume:
        return f"{comment}; not in force, as a diagnosis finds effects itself", f"# {entry.name}: {_number(value)}"
    return comment, f"{entry.name}: {_number(value)}"


def _number(value: float) -> str:
    """As ROS and YAML 1.1 read a number, to six digits: data sheets have fewer."""
    return number_text(float(f"{value:.6g}"))
