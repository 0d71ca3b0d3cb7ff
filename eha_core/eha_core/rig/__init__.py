"""A rig's nominal file from what data sheets say."""

from eha_core.rig.data_sheet import DATA, Datum, quantity
from eha_core.rig.nominal_file import nominal_text
from eha_core.rig.parameters import Entry, parameters_of

__all__ = ["DATA", "Datum", "Entry", "nominal_text", "parameters_of", "quantity"]
