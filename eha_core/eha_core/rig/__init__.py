"""A rig's nominal file from what data sheets say, and from measured curves of its valve."""

from eha_core.rig.data_sheet import DATA, Datum, quantity
from eha_core.rig.measured_curves import measured_entries
from eha_core.rig.nominal_file import nominal_text
from eha_core.rig.parameters import Entry, asked_of, parameters_of
from eha_core.rig.travel import require_possible_travel

__all__ = [
    "DATA", "Datum", "Entry", "asked_of", "measured_entries", "nominal_text", "parameters_of", "quantity",
    "require_possible_travel",
]  # fmt: skip
