"""The text of a nominal file: a ROS 2 parameters file with units and origins as comments."""

from __future__ import annotations

from collections.abc import Sequence

from eha_core.parameters import UNKNOWN, catalogue, dump_parameters
from eha_core.rig.parameters import Entry

_HEADING = f"""\
# Nominal model of a rig, made by `eha init-rig`. SI units; pressures above atmosphere.
# `{UNKNOWN}`: `eha diagnose` finds the value with no more than what rigs have to go by; a number narrows its search.
# What differs between recordings of this rig is listed so: per_recording: [supply_pressure]
"""


def nominal_text(entries: Sequence[Entry], assume: bool = False) -> str:
    """The file's text; with `assume`, the catalogue's value, marked as assumed, in place of each unknown one."""
    rows = [_row(entry, assume) for entry in entries]
    width = max(len(row) for row, _ in rows)
    lines = [f"    {row:{width}}  # {comment}" for row, comment in rows]
    return "\n".join([f"{_HEADING}/**/eha_sim:", "  ros__parameters:", *lines]) + "\n"


def _row(entry: Entry, assume: bool) -> tuple[str, str]:
    row = catalogue()[entry.name]
    unit = row.unit if row.unit != "-" else "no unit"
    value, how = entry.value, entry.how
    if value is None and assume:
        value, how = row.nominal, f"assumed: the catalogue's ({row.source})"
    if value is None:
        return f"{entry.name}: {UNKNOWN}", f"{unit}; {row.meaning}: {how}"
    # The value as ROS and YAML 1.1 read it, to six digits: data sheets have fewer.
    text = dump_parameters({entry.name: float(f"{value:.6g}")}).splitlines()[-1].strip()
    return text, f"{unit}; {row.meaning}: {how}"
