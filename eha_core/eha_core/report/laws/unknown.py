"""A recovered law that is not in the catalogue."""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.result import UnknownLaw
from eha_core.report.laws.law import Axis, Law
from eha_core.report.laws.models import Models
from eha_core.report.wording import LAW_AXES


def unknown_law(models: Models, found: UnknownLaw) -> Law:
    """The recovered curve over its variable; the nominal model has none of it."""
    x, y = (np.array([sample[place] for sample in found.samples], dtype=np.float64) for place in (0, 1))
    title, unit, x_unit = LAW_AXES.get((found.site, found.function_of), ("law", "-", "-"))
    across = Axis(found.function_of.partition(",")[0], x_unit)
    return Law(f"Recovered: {title}", across, Axis(title.capitalize(), unit), x, y, y, y, 0.0 * x)
