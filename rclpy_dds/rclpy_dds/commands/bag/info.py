"""Print information about a bag to the screen."""

from __future__ import annotations

import argparse
import os
import time

from rclpy_dds.recordings.reading import Recording, summarise

_UNITS = ("B", "KiB", "MiB", "GiB", "TiB")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    parser.add_argument("bag_path", help="Bag to open")
    parser.add_argument("-s", "--storage", choices=["mcap"], help="Storage implementation of the bag")
    parser.add_argument("-t", "--topic-name", action="store_true", help="Only display topic names")
    parser.add_argument("-v", "--verbose", action="store_true", help="Accepted for compatibility")


def main(args: argparse.Namespace) -> None:
    """Print files, size, times and topics."""
    recording = summarise(args.bag_path)
    if args.topic_name:
        print(*sorted(recording.topics), sep="\n")
        return
    print(describe(recording))


def describe(recording: Recording) -> str:
    """Return what `ros2 bag info` prints."""
    topics = [
        f"Topic: {name} | Type: {topic.type} | Count: {topic.count} | Serialization Format: {topic.encoding}"
        for name, topic in sorted(recording.topics.items())
    ]
    indent = " " * 19
    rows = [
        ("Files:", f"\n{indent}".join(os.path.basename(name) for name in recording.files)),
        ("Bag size:", _size(recording.size)),
        ("Storage id:", "mcap"),
        ("ROS Distro:", recording.distribution),
        ("Duration:", f"{(recording.end - recording.start) / 1e9:.9f}s"),
        ("Start:", _time(recording.start)),
        ("End:", _time(recording.end)),
        ("Messages:", str(recording.count)),
        ("Topic information:", f"\n{indent}".join(topics)),
        ("Service:", "0"),
        ("Service information:", ""),
    ]
    return "\n" + "\n".join(f"{title:<18} {value}".rstrip() for title, value in rows) + "\n"


def _size(size: float) -> str:
    unit = 0
    while size >= 1024 and unit < len(_UNITS) - 1:
        size, unit = size / 1024, unit + 1
    return f"{size:.1f} {_UNITS[unit]}" if unit else f"{size:.0f} B"


def _time(nanoseconds: int) -> str:
    seconds, rest = divmod(nanoseconds, 10**9)
    local = time.localtime(seconds)
    day = time.strftime("%b", local) + f" {local.tm_mday:2d} " + time.strftime("%Y %H:%M:%S", local)
    return f"{day}.{rest:09d} ({seconds}.{rest:09d})"
