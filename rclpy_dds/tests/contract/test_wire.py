"""On the wire: against peers that know nothing of the layer, and byte for byte."""

from __future__ import annotations

import random

import pytest

from contract.conftest import Graph, Program, only_layer

pytestmark = only_layer

# A plain Cyclone DDS process with a type declared by hand, as rmw_cyclonedds_cpp would announce it.
PEER = """
import os, sys, time
from dataclasses import dataclass
from cyclonedds.core import Policy, Qos, WaitSet, ReadCondition, ViewState, InstanceState, SampleState
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct, annotations, types
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy_dds.wire.domain import configuration

@dataclass
@annotations.final
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: types.int32
    nanosec: types.uint32

@dataclass
@annotations.final
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str

@dataclass
@annotations.final
class JointState(IdlStruct, typename="sensor_msgs::msg::dds_::JointState_"):
    header: Header
    name: types.sequence[str]
    position: types.sequence[types.float64]
    velocity: types.sequence[types.float64]
    effort: types.sequence[types.float64]

number = int(os.environ["ROS_DOMAIN_ID"])
domain = Domain(number, configuration())
participant = DomainParticipant(number)
qos = Qos(Policy.Reliability.Reliable(10**9), Policy.History.KeepLast(10),
          Policy.DataRepresentation(use_cdrv0_representation=True))
reader = DataReader(participant, Topic(participant, "rt/to_peer", JointState), qos)
writer = DataWriter(participant, Topic(participant, "rt/from_peer", JointState), qos)
print("ready", flush=True)
while not (reader.get_matched_publications() and writer.get_matched_subscriptions()):
    time.sleep(0.01)
print("matched", flush=True)
waitset = WaitSet(participant)
waitset.attach(ReadCondition(reader, ViewState.Any | InstanceState.Alive | SampleState.NotRead))
waitset.wait(20 * 10**9)
[sample] = reader.take(1)
sample.position.append(sample.header.stamp.sec / 2)
sample.name[0] += " seen"
writer.write(sample)
time.sleep(1.0)
"""


def test_a_plain_cyclone_dds_peer_reads_and_answers(graph: Graph, program: type[Program]) -> None:
    from sensor_msgs.msg import JointState

    node, received = graph.node("layer"), []
    peer = program(PEER)
    peer.wait_for("ready")
    publisher = node.create_publisher(JointState, "/to_peer", 10)
    subscription = node.create_subscription(JointState, "/from_peer", received.append, 10)
    assert graph.spin_until(lambda: publisher.get_subscription_count() and subscription.get_publisher_count())
    peer.wait_for("matched")  # each side finds the other in its own time, and nobody repeats what was missed
    sent = JointState(name=["piston"], position=[0.25], effort=[5.0])
    sent.header.stamp.sec = 7
    publisher.publish(sent)
    assert graph.spin_until(lambda: received)
    assert (received[0].name, list(received[0].position), list(received[0].effort)) == (
        ["piston seen"],
        [0.25, 3.5],
        [5.0],
    )


def _fill(message: object, generator: random.Random) -> object:
    """Give every field of a message a value of its type."""
    import array

    import numpy

    from rclpy_dds.interfaces.definition import STRINGS
    from rclpy_dds.interfaces.message import Message, message_class
    from rclpy_dds.interfaces.store import message as definition

    for field in definition(message.__ros_name__).fields:  # type: ignore[attr-defined]
        kind, value = field.type, getattr(message, field.name)
        count = kind.size if kind.container == "array" else min(generator.randrange(4), kind.size or 9)
        if kind.is_message:
            made = [_fill(message_class(kind.base)(), generator) for _ in range(count if kind.container else 1)]
        elif kind.base in STRINGS:
            made = [
                "".join(generator.choices("aü€ ", k=generator.randrange(5)))
                for _ in range(count if kind.container else 1)
            ]
        elif kind.base == "byte":
            made = [bytes([generator.randrange(256)]) for _ in range(count if kind.container else 1)]
        else:
            whole = generator.choices(range(2 if kind.base == "bool" else 100), k=count if kind.container else 1)
            made = (
                [bool(n) for n in whole]
                if kind.base == "bool"
                else [n / 4 if "float" in kind.base else n for n in whole]
            )
        if isinstance(value, array.array):
            value = array.array(value.typecode, made)
        elif isinstance(value, numpy.ndarray):
            value = numpy.array(made, dtype=value.dtype)
        else:
            value = made if kind.container else made[0]
        setattr(message, field.name, value)
        assert not isinstance(value, Message) or value == getattr(message, field.name)
    return message


def test_the_codec_agrees_with_rosbags_on_every_type_and_both_byte_orders() -> None:
    from rclpy_dds.interfaces.codec import decoder, encoder
    from rclpy_dds.interfaces.message import message_class
    from rclpy_dds.interfaces.store import typestore

    generator, store = random.Random(1), typestore()
    names = sorted(store.fielddefs)
    assert len(names) > 100
    for name in names:
        message = _fill(message_class(name)(), generator)
        data = encoder(name)(message)
        assert decoder(name)(data) == message, name
        other = store.deserialize_cdr(data, name)
        assert bytes(store.serialize_cdr(other, name, little_endian=True)).ljust(len(data), b"\0") == data, name
        assert decoder(name)(bytes(store.serialize_cdr(other, name, little_endian=False))) == message, name


def test_type_hashes_agree_with_rosbags() -> None:
    from rclpy_dds.interfaces.store import message, typestore
    from rclpy_dds.wire.hashes import type_hash

    def has_char(name: str) -> bool:
        types = [field.type.base for field in message(name).fields]
        return "char" in types or any(has_char(base) for base in types if "/" in base)

    # char is uint8 to ROS 2; rosbags numbers it on its own.
    for name in sorted(typestore().fielddefs):
        if not has_char(name):
            assert type_hash(name) == typestore().hash_rihs01(name), name


def test_cyclone_dds_itself_still_works_beside_the_layer(program: type[Program]) -> None:
    source = """
import rclpy
from cyclonedds.core import GuardCondition, WaitSet
from cyclonedds.domain import DomainParticipant
with rclpy.init():
    rclpy.create_node("beside")
    participant = DomainParticipant(rclpy.get_default_context().get_domain_id())
    waitset, guard = WaitSet(participant), GuardCondition(participant)
    waitset.attach(guard)
    guard.set(True)
    print("woken by", waitset.wait(10**9))
"""
    assert program(source).wait_for("woken").strip() == "woken by 1"


def test_truncated_bytes_are_malformed_and_never_a_message() -> None:
    from sensor_msgs.msg import JointState

    from rclpy_dds.interfaces.codec import MalformedSample, decoder, encoder

    message = JointState(name=["a", "b"], position=[1.0, 2.0, 3.0], velocity=[4.0], effort=[5.0])
    data = encoder("sensor_msgs/msg/JointState")(message)
    for length in range(len(data)):
        with pytest.raises(MalformedSample):
            decoder("sensor_msgs/msg/JointState")(data[:length])


def test_a_malformed_sample_is_logged_and_the_executor_goes_on(
    graph: Graph, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from std_msgs.msg import Float64

    from rclpy_dds.interfaces.codec import MalformedSample

    node, received = graph.node("layer"), []
    publisher = node.create_publisher(Float64, "x", 10)
    subscription = node.create_subscription(Float64, "x", received.append, 10)
    decode, seen = subscription._decode, []

    def decode_all_but_the_first(data: bytes) -> Float64:
        seen.append(data)
        return decode(data if len(seen) > 1 else data[:6])

    with pytest.raises(MalformedSample):
        decode(b"\0\1\0\0\0\0")
    monkeypatch.setattr(subscription, "_decode", decode_all_but_the_first)
    publisher.publish(Float64(data=1.0))
    publisher.publish(Float64(data=2.0))
    assert graph.spin_until(lambda: received)
    assert received == [Float64(data=2.0)]
    assert "dropped a malformed sample on '/x'" in capfd.readouterr().err


@pytest.mark.parametrize(
    "text", ["float64", "float64 1x", "Float64[ x", "int8 A=text", "float64 x\nfloat64 x", "nonsense x y"]
)
def test_an_unparsable_definition_names_type_and_line(text: str) -> None:
    from rclpy_dds.interfaces.definition import DefinitionError, parse_message

    with pytest.raises(DefinitionError, match=r"some_msgs/msg/Bad, line \d"):
        parse_message("some_msgs/msg/Bad", text)


def test_definitions_hold_defaults_bounds_and_constants() -> None:
    from rclpy_dds.interfaces.definition import Constant, Field, FieldType, parse_message

    text = (
        "# head\nint8 LOW=-5\nstring NAME='a#b'  # text\nfloat64[3] x [1, 2.5, -3]\n"
        "string<=4[<=2] words\nHeader header\nbool on true\n"
    )
    definition = parse_message("some_msgs/msg/Some", text)
    assert definition.constants == (Constant("LOW", "int8", -5), Constant("NAME", "string", "a#b"))
    assert definition.fields == (
        Field("x", FieldType("float64", "array", 3), [1.0, 2.5, -3.0]),
        Field("words", FieldType("string", "sequence", 2, 4)),
        Field("header", FieldType("std_msgs/msg/Header")),
        Field("on", FieldType("bool"), True),
    )


def test_what_is_not_offered_says_so_at_import() -> None:
    for module in ("action", "lifecycle", "service_introspection"):
        with pytest.raises(ImportError, match="install ROS 2"):
            __import__(f"rclpy.{module}")


def test_who_is_heard_through_loopback_alone_is_found(
    graph: Graph, program: type[Program], monkeypatch: pytest.MonkeyPatch
) -> None:
    observer = graph.node("observer")
    interfaces = '<Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>'
    pinned = f"<CycloneDDS><Domain><General>{interfaces}</General></Domain></CycloneDDS>"
    monkeypatch.setenv("CYCLONEDDS_URI", pinned)
    program("import rclpy; rclpy.init(); n = rclpy.create_node('near'); print('up'); rclpy.spin(n)").wait_for("up")
    assert graph.spin_until(lambda: "near" in observer.get_node_names())
