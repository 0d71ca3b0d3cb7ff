"""Which stretches of a record are chosen."""

from __future__ import annotations

import numpy as np
from made import recorded

from eha_core.long_record.choose import choose
from eha_core.long_record.survey import INSTANTS, Shown, cells, shown
from eha_core.plant import PAPER
from eha_core.recording.blocks import Block


def alike(number: int, scale: float = 1.0) -> Shown:
    """A block of one and the same sine in all quantities, in its own phase."""
    phase = 2.0 * np.pi * (np.arange(INSTANTS) / INSTANTS + 0.1 * number)
    instants = scale * np.stack([np.sin(phase), np.cos(phase), -np.cos(phase), np.sin(phase), np.cos(phase)], axis=1)
    return Shown(number, 10.0 * number, 10.0 * number + 10.0, instants)


def test_a_record_that_shows_the_same_all_the_time_is_fitted_evenly_from_end_to_end() -> None:
    chosen = choose([alike(number) for number in range(360)], 6)
    assert chosen[0] == 0
    assert chosen[-1] == 359
    assert len(chosen) == 6
    assert max(np.diff(chosen)) < 2 * 359 / 5


def test_the_only_stretch_that_shows_much_is_chosen() -> None:
    blocks = [alike(number, 10.0 if number == 123 else 1.0) for number in range(360)]
    assert 123 in choose(blocks, 6)


def test_one_way_and_the_other_are_both_chosen_and_so_is_standstill() -> None:
    def one_way(number: int) -> Shown:
        block = alike(number)
        sign = -1.0 if number == 77 else 1.0
        motion = block.instants.copy()
        motion[:, 3] = 0.0 if number == 200 else sign * np.abs(motion[:, 3])
        return Shown(block.number, block.start, block.end, motion)

    assert {77, 200} <= set(choose([one_way(number) for number in range(360)], 6))


def test_first_and_last_are_of_what_moves() -> None:
    chosen = choose([alike(number) for number in range(100, 300)], 6)
    assert chosen[0] == 100
    assert chosen[-1] == 299


def test_few_blocks_are_all_chosen() -> None:
    assert choose([alike(number) for number in (3, 8)], 6) == [3, 8]


def test_a_block_shows_its_command_speed_and_pressures() -> None:
    recording = recorded({}, duration=4.0, rate=250.0, sine=1.0, amplitude=0.05)
    one = shown(Block(0, 0.0, 4.0, recording), PAPER)
    assert one is not None
    command, _, position, speed, difference = one.instants.T
    np.testing.assert_allclose([command.min(), command.max()], [-0.05, 0.05], rtol=0.01)
    # the speed is that of the position, and the pressures' difference drives it to and fro
    np.testing.assert_allclose(np.corrcoef(np.gradient(position), speed)[0, 1], 1.0, atol=0.02)
    assert difference.min() < 0.0 < difference.max()


def test_a_rig_at_rest_shows_nothing() -> None:
    recording = recorded({}, duration=4.0, rate=250.0, amplitude=1e-9)
    assert shown(Block(0, 0.0, 4.0, recording), PAPER) is None
    assert shown(Block(0, 0.0, 4.0, None, "no samples there"), PAPER) is None


def test_outliers_make_no_range() -> None:
    blocks = [alike(number) for number in range(50)]
    far = blocks[20].instants.copy()
    far[5] *= 1e6
    spoilt = [*blocks[:20], Shown(20, 200.0, 210.0, far), *blocks[21:]]
    assert len(cells(spoilt)[3]) > 0.8 * len(cells(blocks)[3])
