"""The numbers that decide what of a long record is fitted stay what their origins say."""

from __future__ import annotations

from eha_core.diagnosis.criteria import CHANCE, OF_SAMPLES
from eha_core.long_record import limits


def test_the_limits_are_those_whose_origins_are_written_beside_them() -> None:
    stated = {name: value for name, value in vars(limits).items() if name.isupper()}
    assert stated == {
        "LONGEST_WHOLE": 120.0,
        "STRETCH": 10.0,
        "STRETCHES": 6,
        "ENDS": 0.1,
        "NEARLY": 0.05,
        "WINDOW": 1.0,
        "ITERATIONS": 4,
        "DEPARTS": 1.5,
    }


def test_a_stretch_holds_as_many_samples_as_name_anything() -> None:
    """Where what a hypothesis must gain begins to grow with the samples, three channels at 1 kHz have filled a
    stretch."""
    assert CHANCE / OF_SAMPLES <= 3 * 1000.0 * limits.STRETCH


def test_where_stretches_are_fitted_at_least_half_is_left_out() -> None:
    assert limits.STRETCH * limits.STRETCHES <= 0.5 * limits.LONGEST_WHOLE
