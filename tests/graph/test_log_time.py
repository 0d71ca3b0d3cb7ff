"""Log times in simulated time, against a sequence of events written down by hand."""

from __future__ import annotations

import struct

import pytest

from eha_sim_node.log_time import SimulatedTime, leading_stamp


@pytest.mark.parametrize(("order", "flag"), [("<", 1), (">", 0)])
def test_the_stamp_is_read_in_either_byte_order(order: str, flag: int) -> None:
    data = bytes([0, flag, 0, 0]) + struct.pack(f"{order}iI", 12, 345) + b"rest"
    assert leading_stamp(data) == 12_000_000_345


def test_a_message_gets_the_time_in_force_when_it_was_published() -> None:
    time = SimulatedTime()
    assert time.at(100) == 0
    assert not time.certain(100)
    time.tick(published=1000, simulated=0)
    time.tick(published=2000, simulated=20)
    assert not time.certain(2500)  # a clock of 2400 may still be on its way
    time.tick(published=3000, simulated=40)
    assert time.certain(2500)
    assert [time.at(published) for published in (1500, 2000, 2500, 9000)] == [0, 20, 20, 40]
