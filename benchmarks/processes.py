"""Processes of a benchmark: a DDS domain of their own, and modules of this package started in it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).resolve().parent.parent
_CONFIGURATION = """<CycloneDDS><Domain>
<General><AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>
<Peers><Peer address="localhost"/></Peers></Discovery>
</Domain></CycloneDDS>"""


def use_own_domain() -> None:
    """Choose a domain on this machine only, so that nobody's rig takes part, for this process and those it starts.

    Programs that know nothing of ROS read CYCLONEDDS_URI; it says to them what the other two variables say to ROS.
    """
    os.environ["ROS_DOMAIN_ID"] = str(46 + os.getpid() % 56)
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ.setdefault("CYCLONEDDS_URI", _CONFIGURATION)


def start(name: str, *arguments: object) -> subprocess.Popen[str]:
    """Start another module of this package as a process whose input is written and whose output is read."""
    command = [sys.executable, "-m", f"benchmarks.{name}", *map(str, arguments)]
    return subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


@dataclass(frozen=True)
class Used:
    """What a process took: s by the clock, s of CPU time, and the most memory that it had [bytes]."""

    seconds: float
    cpu: float
    memory: float


def timed(command: Sequence[str]) -> Used:
    """Run a command to its end. Raises RuntimeError where it fails."""
    begin = perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}")
    return Used(perf_counter() - begin, used.ru_utime + used.ru_stime, 1024.0 * used.ru_maxrss)
