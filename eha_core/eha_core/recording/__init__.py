"""Recordings: written crash-safe as MCAP, read from MCAP, rosbag2 folders and tables into channels in SI units."""

from eha_core.recording.channel_rules import ChannelRule
from eha_core.recording.mcap_summary import is_finished
from eha_core.recording.message_types import definition_of, encode
from eha_core.recording.reader import read_recording
from eha_core.recording.recording import CHANNEL_KINDS, Channel, ChannelKind, Recording
from eha_core.recording.topics_file import TopicsFile, load_topics_file, topics_of
from eha_core.recording.writer import PARAMETERS_RECORD, OfferedQuality, RecordingWriter, free_path

__all__ = [
    "CHANNEL_KINDS",
    "PARAMETERS_RECORD",
    "Channel",
    "ChannelKind",
    "ChannelRule",
    "OfferedQuality",
    "Recording",
    "RecordingWriter",
    "TopicsFile",
    "definition_of",
    "encode",
    "free_path",
    "is_finished",
    "load_topics_file",
    "read_recording",
    "topics_of",
]
