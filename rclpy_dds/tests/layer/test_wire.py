"""On the wire: Cyclone DDS without the layer, its own settings, and what is malformed."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from contract.conftest import Graph, Program
from contract.test_environment import NODE, Start

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


REFUSED = "import rclpy\ntry:\n    rclpy.init()\nexcept RuntimeError as error:\n    print('refused:', error)"


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


def test_who_is_heard_through_loopback_alone_is_found(
    graph: Graph, program: type[Program], monkeypatch: pytest.MonkeyPatch
) -> None:
    observer = graph.node("observer")
    interfaces = '<Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>'
    pinned = f"<CycloneDDS><Domain><General>{interfaces}</General></Domain></CycloneDDS>"
    monkeypatch.setenv("CYCLONEDDS_URI", pinned)
    program("import rclpy; rclpy.init(); n = rclpy.create_node('near'); print('up'); rclpy.spin(n)").wait_for("up")
    assert graph.spin_until(lambda: "near" in observer.get_node_names())


def test_cyclone_dds_is_configured_by_its_own_variable(
    program: Start, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    log = tmp_path / "cyclone.log"
    tracing = f"<Tracing><Verbosity>config</Verbosity><OutputFile>{log}</OutputFile></Tracing>"
    monkeypatch.setenv("CYCLONEDDS_URI", f"<CycloneDDS><Domain>{tracing}</Domain></CycloneDDS>")
    program(NODE).wait_for("ready")
    assert "Discovery/Peers" in log.read_text()  # the layer's own settings stand beside the user's


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("ROS_DOMAIN_ID", "233", "ROS_DOMAIN_ID='233'"),
        ("ROS_DOMAIN_ID", "one", "ROS_DOMAIN_ID='one'"),
        (
            "CYCLONEDDS_URI",
            '<General><Interfaces><NetworkInterface name="none0"/></Interfaces></General>',
            "network interface",
        ),
        ("CYCLONEDDS_URI", "<General><Nonsense/></General>", "CYCLONEDDS_URI"),
    ],
)
def test_what_cannot_be_joined_is_an_error_that_says_why(
    program: Start, monkeypatch: pytest.MonkeyPatch, name: str, value: str, expected: str
) -> None:
    monkeypatch.setenv(name, value)
    assert expected in program(REFUSED).wait_for("refused")


def test_one_program_too_many_in_a_domain_is_told(program: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    domain = int(os.environ["ROS_DOMAIN_ID"]) % 40 + 1  # tests that run beside this one take higher ones
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    one = "<Discovery><MaxAutoParticipantIndex>1</MaxAutoParticipantIndex></Discovery>"
    monkeypatch.setenv("CYCLONEDDS_URI", f"<CycloneDDS><Domain>{one}</Domain></CycloneDDS>")
    program(NODE).wait_for("ready")
    assert "32 programs at most are in it" in program(REFUSED).wait_for("refused")
