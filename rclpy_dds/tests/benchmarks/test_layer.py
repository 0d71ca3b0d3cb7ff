"""The benchmarks of the nodes' rclpy: both ends exchange the same, and what is lost is counted as lost."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
pytest.importorskip("rclpy")
pytest.importorskip("cyclonedds")


@pytest.fixture(autouse=True)
def own_domain(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the benchmarks importable, and put back the environment that they choose."""
    monkeypatch.setattr(sys, "path", [str(BENCHMARKS), *sys.path])
    for name in ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE", "CYCLONEDDS_URI"):
        monkeypatch.setenv(name, "0")
    monkeypatch.delenv("CYCLONEDDS_URI")
    from layer_processes import use_own_domain

    use_own_domain()


@pytest.mark.parametrize("kind", ["Float64", "JointState", "Image"])
def test_both_ends_send_the_same_bytes(kind: str) -> None:
    from rclpy.serialization import serialize_message

    from layer_ends import plain_message, ros_message

    ours, plain = serialize_message(ros_message(kind)), plain_message(kind).serialize(use_version_2=False)
    # Behind the header, and without the padding that ends a message, which is the writer's own affair.
    assert ours[4:].rstrip(b"\0") == plain[4:].rstrip(b"\0")
    if kind == "Image":
        assert len(ours) > 100_000


def test_round_trips_of_both_ends_are_timed(monkeypatch: pytest.MonkeyPatch) -> None:
    import layer_rows

    monkeypatch.setattr(layer_rows, "BLOCKS", 1)
    times = layer_rows._in_turns("Float64", 1, 20)
    assert {end: len(values) for end, values in times.items()} == {"node": 20, "plain": 20}
    # No message crosses two processes and back within a microsecond, and none takes seconds.
    assert all(1e-6 < time < 5.0 for values in times.values() for time in values)


def test_messages_that_were_never_sent_are_missing() -> None:
    from layer_rows import _line, _programs, _tell

    with _programs(("layer_streams", "receive", 0.2), ("layer_streams", "send", 0.1)) as (receiver, sender):
        _tell(sender, "begin")
        received, share = _line(receiver).split()
    assert int(received) == 1000  # of the 2,000 expected: ten topics, 100 ticks
    assert 0.0 < float(share) < 3.0


def test_a_callback_costs_more_than_a_bare_call() -> None:
    from layer_rows import _output

    *by_executor, bare = (float(word) for word in _output("layer_executor", "callbacks", 200))
    assert len(by_executor) == 3
    assert all(time > bare > 0.0 for time in by_executor)


def test_a_process_that_ends_early_is_told_in_one_line() -> None:
    import layer_rows

    with pytest.raises(RuntimeError, match="ended early"), layer_rows._programs(("layer_executor", "unknown", "word")):
        pass
