"""Parts of what a twin keeps, and joining them."""

import numpy as np
from beside_rig import NANOSECONDS, PERIOD, comparisons, rig

from eha_core.twin import Settings, Twin
from eha_core.twin.excerpt import Excerpt, joined


def excerpt(start: int, end: int, voltage: list[tuple[int, float]], position: list[int]) -> Excerpt:
    stamps, volts = zip(*voltage, strict=True)
    series = (np.array(position, dtype=np.int64), np.array(position, dtype=np.float64))
    return Excerpt(start, end, (np.array(stamps), np.array(volts)), {"position": series})


FIRST = excerpt(0, 10, [(0, 1.0), (4, 2.0)], [1, 3, 5, 7, 9])
SECOND = excerpt(10, 20, [(10, 2.0), (15, 0.0)], [11, 13])


def test_a_part_begins_with_the_voltage_in_force_and_has_the_samples_inside() -> None:
    part = FIRST.part(3, 9)
    assert (part.start, part.end) == (3, 9)
    assert part.voltage[0].tolist() == [3, 4] and part.voltage[1].tolist() == [1.0, 2.0]
    assert part.channels["position"][0].tolist() == [3, 5, 7]
    assert FIRST.part(-5, 50).channels["position"][0].tolist() == [1, 3, 5, 7, 9]
    assert FIRST.part(4, 6).voltage[1].tolist() == [2.0]


def test_what_follows_each_other_is_joined_and_a_voltage_is_not_repeated() -> None:
    whole = joined([FIRST, SECOND])
    assert (whole.start, whole.end) == (0, 20)
    assert whole.voltage[0].tolist() == [0, 4, 15]
    assert whole.channels["position"][1].tolist() == [1.0, 3.0, 5.0, 7.0, 9.0, 11.0, 13.0]


def test_a_twin_keeps_what_it_heard_over_the_time_set_and_nothing_before_a_gap() -> None:
    record, twin = rig(6.5), Twin(settings=Settings(kept=3.0))
    for _ in comparisons(record, twin):
        assert all(one.end == other.start for one, other in zip(list(twin.kept), list(twin.kept)[1:], strict=False))
    whole = joined(twin.kept)
    assert 3.0 <= (whole.end - whole.start) / NANOSECONDS <= 4.0
    part = slice(round(whole.start / NANOSECONDS / PERIOD), round(whole.end / NANOSECONDS / PERIOD))
    for name in ("position", "pressure_a", "pressure_b"):
        assert whole.channels[name][1].tolist() == record.column(f"measured_{name}")[part].tolist()
    stamps, voltages = record.commands
    inside = (stamps > whole.start) & (stamps < whole.end)
    acting = np.interp(stamps[inside], *whole.voltage, left=np.nan)
    assert np.allclose(acting, voltages[inside])
    again = Twin()
    list(comparisons(record, again, missing=(3.3, 3.9)))
    assert again.kept[0].start / NANOSECONDS > 3.9
