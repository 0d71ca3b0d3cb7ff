"""Processes of a benchmark: a DDS domain of their own, and scripts of this folder started in it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
_CONFIGURATION = """<CycloneDDS><Domain>
<General><AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>
<Peers><Peer address="localhost"/></Peers></Discovery>
</Domain></CycloneDDS>"""


def use_own_domain() -> None:
    """Choose a domain on this machine only, so that nobody's rig takes part, for this process and those it starts.

    The plain end knows nothing of ROS and reads CYCLONEDDS_URI, which says to it what the other two say to ROS.
    """
    os.environ["ROS_DOMAIN_ID"] = str(46 + os.getpid() % 56)
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ.setdefault("CYCLONEDDS_URI", _CONFIGURATION)


def start(name: str, *arguments: object) -> subprocess.Popen[str]:
    """Start another script of this folder as a process whose input is written and whose output is read."""
    command = [sys.executable, str(FOLDER / f"{name}.py"), *map(str, arguments)]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
