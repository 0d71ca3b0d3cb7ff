"""Writing MCAP recordings as `ros2 bag record` does."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import yaml
from mcap.writer import CompressionType, Writer
from rclpy.duration import Infinite
from rclpy.qos import QoSProfile

from rclpy_dds.interfaces.text import schema_text
from rclpy_dds.wire.hashes import type_hash

DISTRIBUTION = "jazzy"
_METADATA_VERSION = 9
_CHUNK = 768 * 1024


@dataclass
class _Topic:
    channel: int
    type: str
    qos: str
    count: int = 0


class RecordingWriter:
    """One recording in a new folder: an .mcap file and, once closed, metadata.yaml."""

    def __init__(self, folder: str) -> None:
        """Create folder and file.

        Raises:
            FileExistsError: the folder is there already. OSError: it cannot be made.
        """
        os.makedirs(folder)
        self.folder = folder
        self.file_name = f"{os.path.basename(os.path.normpath(folder))}_0.mcap"
        self._file = open(os.path.join(folder, self.file_name), "wb")  # noqa: SIM115 - open as long as the recording
        self._writer = Writer(self._file, chunk_size=_CHUNK, compression=CompressionType.ZSTD)
        self._writer.start(profile="ros2", library="rclpy_dds")
        self._topics: dict[str, _Topic] = {}
        self._schemas: dict[str, int] = {}
        self._start = self._end = 0

    def add_topic(self, name: str, type_name: str, offered: list[QoSProfile]) -> None:
        """Add a topic with the profiles its publishers offer."""
        if type_name not in self._schemas:
            self._schemas[type_name] = self._writer.register_schema(
                type_name, "ros2msg", schema_text(type_name).encode()
            )
        qos = yaml.safe_dump([_profile(profile) for profile in offered])
        metadata = {"offered_qos_profiles": qos, "topic_type_hash": type_hash(type_name)}
        channel = self._writer.register_channel(name, "cdr", self._schemas[type_name], metadata)
        self._topics[name] = _Topic(channel, type_name, qos)

    def write(self, topic: str, data: bytes, received: int, published: int) -> None:
        """Add a serialised message with its times in ns."""
        known = self._topics[topic]
        self._writer.add_message(
            known.channel, log_time=received, data=data, publish_time=published, sequence=known.count
        )
        known.count += 1
        self._start = min(self._start or received, received)
        self._end = max(self._end, received)

    @property
    def count(self) -> int:
        """Return the number of messages written."""
        return sum(topic.count for topic in self._topics.values())

    def close(self) -> None:
        """Finish the file and write the metadata."""
        information = self._information()
        text = yaml.safe_dump(information, sort_keys=False)
        self._writer.add_metadata("rosbag2", {"ROS_DISTRO": DISTRIBUTION, "serialized_metadata": text})
        self._writer.finish()
        self._file.close()
        with open(os.path.join(self.folder, "metadata.yaml"), "w", encoding="utf-8") as file:
            yaml.safe_dump({"rosbag2_bagfile_information": information}, file, sort_keys=False)

    def _information(self) -> dict[str, Any]:
        def times() -> dict[str, Any]:  # one object in two places would be an alias, which careful readers refuse
            return {
                "duration": {"nanoseconds": self._end - self._start},
                "starting_time": {"nanoseconds_since_epoch": self._start},
            }

        topics = [
            {
                "topic_metadata": {
                    "name": name,
                    "type": topic.type,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": yaml.safe_load(topic.qos),
                    "type_description_hash": type_hash(topic.type),
                },
                "message_count": topic.count,
            }
            for name, topic in self._topics.items()
        ]
        return {
            "version": _METADATA_VERSION,
            "storage_identifier": "mcap",
            **times(),
            "message_count": self.count,
            "topics_with_message_count": topics,
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [self.file_name],
            "files": [{"path": self.file_name, **times(), "message_count": self.count}],
            "custom_data": None,
            "ros_distro": DISTRIBUTION,
        }


def _profile(profile: QoSProfile) -> dict[str, Any]:
    def seconds(duration: Any) -> dict[str, int]:
        whole, rest = divmod((duration if duration.nanoseconds else Infinite).nanoseconds, 10**9)
        return {"sec": whole, "nsec": rest}

    return {
        "history": profile.history.short_key,
        "depth": profile.depth,
        "reliability": profile.reliability.short_key,
        "durability": profile.durability.short_key,
        "deadline": seconds(profile.deadline),
        "lifespan": seconds(profile.lifespan),
        "liveliness": profile.liveliness.short_key,
        "liveliness_lease_duration": seconds(profile.liveliness_lease_duration),
        "avoid_ros_namespace_conventions": profile.avoid_ros_namespace_conventions,
    }
