"""A DDS domain configured as ROS 2's environment variables say."""

from __future__ import annotations

import array
import atexit
import ctypes
import fcntl
import os
import socket
import struct
import sys
import threading
import time
from functools import cache
from xml.sax.saxutils import quoteattr

from cyclonedds.core import DDSException
from cyclonedds.internal import DDS

MAX_DOMAIN_ID = 232
_RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")
_LOOPBACK_TOO = '<NetworkInterface autodetermine="true"/><NetworkInterface address="127.0.0.1" multicast="false"/>'
_SIOCGIFCONF = 0x8912  # Linux: the interfaces' IPv4 addresses
_DELETION_LIMIT = 5.0  # s; it takes milliseconds
# Taken by index, a function is not the object that cyclonedds's own classes declare their arguments on.
_create_domain = DDS._dll_handle["dds_create_domain"]
_create_domain.argtypes, _create_domain.restype = (ctypes.c_uint32, ctypes.c_char_p), ctypes.c_int32
_delete = DDS._dll_handle["dds_delete"]
_delete.argtypes, _delete.restype = (ctypes.c_int32,), ctypes.c_int32
_ending = threading.Event()
_deleting: list[threading.Thread] = []


def default_domain_id() -> int:
    """Return ROS_DOMAIN_ID, 0 when it is not set.

    Raises:
        RuntimeError: it is no number from 0 to 232.
    """
    text = os.environ.get("ROS_DOMAIN_ID", "") or "0"
    if not text.isdigit() or int(text) > MAX_DOMAIN_ID:
        raise RuntimeError(f"ROS_DOMAIN_ID={text!r} is no domain; set a whole number from 0 to {MAX_DOMAIN_ID}")
    return int(text)


def discovery_range() -> str:
    """Return where participants look for each other: SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT."""
    if os.environ.get("ROS_LOCALHOST_ONLY", "") == "1":
        return "LOCALHOST"
    text = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper() or "SUBNET"
    if text not in _RANGES:
        print(f"[rclpy_dds] ROS_AUTOMATIC_DISCOVERY_RANGE={text!r} is unknown, using SUBNET", file=sys.stderr)
        return "SUBNET"
    return text


def configuration(with_loopback: bool = True) -> str:
    """Return Cyclone DDS's configuration as rmw_cyclonedds_cpp composes it, CYCLONEDDS_URI last so that it wins.

    Participants limited to this machine are found through the loopback address. Cyclone DDS 0.10, which ROS 2 has,
    heeds what comes there in any case; the one used here only where `with_loopback` selects that interface too.
    """
    reach = discovery_range()
    uri = os.environ.get("CYCLONEDDS_URI", "")
    general, discovery = "", ""
    if reach in ("SUBNET", "LOCALHOST"):
        discovery = "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    peers = [peer for peer in os.environ.get("ROS_STATIC_PEERS", "").split(";") if peer]
    if reach in ("LOCALHOST", "OFF"):
        general = "<AllowMulticast>false</AllowMulticast>"
    if reach == "LOCALHOST":
        peers.append("localhost")
        if with_loopback and "NetworkInterface" not in uri and _has_network():
            general += f"<Interfaces>{_LOOPBACK_TOO}</Interfaces>"
    if reach == "OFF":
        peers = []
        discovery = f"<ParticipantIndex>none</ParticipantIndex><Tag>rclpy_dds_{os.getpid()}</Tag>"
    if peers:
        discovery += f"<Peers>{''.join(f'<Peer address={quoteattr(peer)}/>' for peer in peers)}</Peers>"
    sections = (("General", general), ("Discovery", discovery))
    inner = "".join(f"<{name}>{content}</{name}>" for name, content in sections if content)
    parts = [f"<CycloneDDS><Domain>{inner}</Domain></CycloneDDS>"] if inner else []
    if uri:
        parts.append(uri)
    return ",".join(parts)


def _has_network() -> bool:
    """Tell whether an interface besides loopback has an address; selecting loopback twice is an error."""
    entry = struct.calcsize("16s24x")
    entries = array.array("B", bytes(entry * 256))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        answer = fcntl.ioctl(asked, _SIOCGIFCONF, struct.pack("iL", len(entries), entries.buffer_info()[0]))
    length = struct.unpack("iL", answer)[0]
    addresses = [entries[start + 20 : start + 24] for start in range(0, length, entry)]
    return any(address[0] != 127 for address in addresses)


@cache
def open_domain(domain_id: int) -> int | None:
    """Configure a domain once for this process; it is deleted when the interpreter ends.

    Returns:
        The domain's entity, None when the program opened the domain itself: then its configuration stands.

    Raises:
        RuntimeError: Cyclone DDS refuses the configuration or finds no network interface.
    """
    domain: int = _create_domain(domain_id, configuration().encode())
    if domain == DDSException.DDS_RETCODE_ERROR:
        domain = _create_domain(domain_id, configuration(with_loopback=False).encode())
    if domain == DDSException.DDS_RETCODE_PRECONDITION_NOT_MET:
        return None
    if domain < 0:
        raise RuntimeError(
            f"Cyclone DDS cannot open domain {domain_id} ({str(DDSException(domain)).rstrip('. ')}): check that a "
            "network interface is up, that CYCLONEDDS_URI is valid, and that 32 programs at most are in it here"
        )
    # Python starts no thread any more when the interpreter ends, so the one that is needed then starts here.
    thread = threading.Thread(target=_delete_at_end, args=(domain,), name="rclpy_dds_domain", daemon=True)
    thread.start()
    _deleting.append(thread)
    return domain


def _delete_at_end(domain: int) -> None:
    _ending.wait()
    _delete(domain)


@atexit.register
def _delete_domains() -> None:
    """Delete the domains while Python's threads still run, and wait for that, but not without limit.

    Cyclone DDS deletes entities in a thread of its own, which may take Python's interpreter lock to release a type
    and last of all tells the other participants. Once Python finalises, a thread that asks for the lock is ended on the
    spot, and who deletes the domain then waits for that thread for ever.
    """
    _ending.set()
    limit = time.monotonic() + _DELETION_LIMIT
    for thread in _deleting:
        thread.join(max(0.0, limit - time.monotonic()))
