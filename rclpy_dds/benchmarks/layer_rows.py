"""The nodes' rclpy against plain Cyclone DDS for Python, between processes; what its executor costs and holds out."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from statistics import median, quantiles

from layer_processes import start, use_own_domain

Row = tuple[str, str, str, str, str, str]
HEAD: Row = ("what", "measured", "peer", "figure", "target", "met")
KINDS = {"Float64": "a Float64", "JointState": "a JointState", "Image": "an Image of 100 kB"}
ENDS = ("node", "plain")
BLOCKS = 4
ROUND_TRIPS = 300  # of each end in a block; the blocks of both ends take turns, so that both meet the same machine
BURST = {"Float64": 5000, "JointState": 5000, "Image": 100}  # messages sent back to back in a block
CALLBACKS = 20_000
STREAM_SECONDS = 10.0
STREAMS = 10
IDLE_SECONDS = 10.0
LATENCY_TARGET = 1.5
OVERHEAD_TARGET = 50e-6
IDLE_TARGET = 0.01
_PEER = "plain Cyclone DDS writer and reader"
_WHAT = "rclpy"


def measure() -> list[Row]:
    """Measure latency and throughput of three messages, ten streams, the executor, and an idle node."""
    missing = next((name for name in ("rclpy", "cyclonedds") if find_spec(name) is None), None)
    if missing is not None:
        why = f"not measured: there is no {missing} in this environment"
        return [(_WHAT, "-", "-", "-", f"<= {LATENCY_TARGET:g} x", why)]
    use_own_domain()
    rows = [_latency(kind) for kind in KINDS]
    rows += [_throughput(kind) for kind in KINDS]
    return [*rows, _streams(), _overhead(), _idle()]


def as_markdown(rows: list[Row]) -> str:
    """Return the table in Markdown."""
    head, *lines = (f"| {' | '.join(row)} |" for row in (HEAD, *rows))
    return "\n".join([head, "|---" * len(HEAD) + "|", *lines])


def _met(met: bool) -> str:
    return "yes" if met else "no"


def _latency(kind: str) -> Row:
    times = _in_turns(kind, 1, ROUND_TRIPS)
    node, plain = (median(times[end]) for end in ENDS)
    late = {end: quantiles(times[end], n=100)[-1] for end in ENDS}
    return (
        f"{_WHAT}: round trip of {KINDS[kind]} at 1 kHz between two processes",
        f"median {node * 1e6:.0f} us, p99 {late['node'] * 1e6:.0f} us",
        f"{_PEER}: median {plain * 1e6:.0f} us, p99 {late['plain'] * 1e6:.0f} us",
        f"{node / plain:.2f} x",
        f"<= {LATENCY_TARGET:g} x",
        _met(node <= LATENCY_TARGET * plain),
    )


def _throughput(kind: str) -> Row:
    times = _in_turns(kind, BURST[kind], 1)
    node, plain = (BURST[kind] / median(times[end]) for end in ENDS)
    return (
        f"{_WHAT}: {KINDS[kind]} sent as fast as it goes, reliable, all kept",
        f"{node:,.0f} messages/s",
        f"{_PEER}: {plain:,.0f} messages/s",
        f"{node / plain:.2f} x",
        "stated",
        "yes",
    )


def _in_turns(kind: str, every: int, count: int) -> dict[str, list[float]]:
    """Return the times [s] that the drivers of both ends print, the first block of each left out."""
    times: dict[str, list[float]] = {end: [] for end in ENDS}
    with _pair("node", kind, every) as node, _pair("plain", kind, every) as plain:
        for block in range(BLOCKS + 1):
            for end, driver in zip(ENDS, (node, plain), strict=True):
                _tell(driver, str(count))
                taken = [float(text) for text in _line(driver).split()]
                times[end] += taken if block else []
    return times


@contextmanager
def _pair(end: str, kind: str, every: int) -> Iterator[subprocess.Popen[str]]:
    """Run an echo and a driver that have found each other; gives the driver."""
    with _programs(*(("layer_exchange", role, end, kind, every) for role in ("echo", "drive"))) as (_, driver):
        yield driver


@contextmanager
def _programs(*commands: tuple[object, ...]) -> Iterator[list[subprocess.Popen[str]]]:
    """Run scripts of this folder, each until its input ends; all have said that they are ready."""
    started = [start(str(name), *arguments) for name, *arguments in commands]
    try:
        for process in started:
            _line(process)
        yield started
    finally:
        for process in started:
            try:
                process.communicate(timeout=10.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.communicate()


def _tell(process: subprocess.Popen[str], text: str) -> None:
    assert process.stdin is not None
    process.stdin.write(f"{text}\n")
    process.stdin.flush()


def _line(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    line = process.stdout.readline()
    if not line:
        raise RuntimeError("a process of the benchmark ended early; what it said stands above")
    return line


def _streams() -> Row:
    commands = [("layer_streams", role, STREAM_SECONDS) for role in ("receive", "send")]
    with _programs(*commands) as (receiver, sender):
        _tell(sender, "begin")
        received, share = _line(receiver).split()
    sent = round(STREAMS * STREAM_SECONDS * 1000.0)
    return (
        f"{_WHAT}: {STREAMS} subscriptions at 1 kHz each, depth 100, {STREAM_SECONDS:g} s",
        f"{int(received):,} messages, {float(share) * 100:.0f} % of one core",
        f"{sent:,} sent by another process",
        f"{sent - int(received)} lost",
        "none lost",
        _met(int(received) == sent),
    )


def _overhead() -> Row:
    *by_executor, bare = (float(text) for text in _output("layer_executor", "callbacks", CALLBACKS))
    guard, timer, subscription = (time * 1e6 for time in by_executor)
    overhead = max(by_executor) - bare
    return (
        f"{_WHAT}: one callback by the executor",
        f"guard condition {guard:.1f} us, timer {timer:.1f} us, subscription {subscription:.1f} us",
        f"the same call in a bare loop: {bare * 1e6:.2f} us",
        f"{overhead * 1e6:.1f} us more",
        f"< {OVERHEAD_TARGET * 1e6:g} us",
        _met(overhead < OVERHEAD_TARGET),
    )


def _idle() -> Row:
    (share,) = (float(text) for text in _output("layer_executor", "idle", IDLE_SECONDS))
    return (
        f"{_WHAT}: a node that nobody talks to, {IDLE_SECONDS:g} s",
        f"{share * 100:.2f} % of one core",
        "-",
        f"{share * 100:.2f} %",
        f"< {IDLE_TARGET * 100:g} %",
        _met(share < IDLE_TARGET),
    )


def _output(name: str, *arguments: object) -> list[str]:
    """Return the words of the line that a script prints."""
    process = start(name, *arguments)
    words = _line(process).split()
    process.communicate()
    return words
