"""Message and service classes."""

from __future__ import annotations

import array
from collections.abc import Callable

import numpy
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseWithCovariance, Quaternion
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import ByteMultiArray, Float64, Header
from std_srvs.srv import SetBool

from contract.conftest import Program


def test_defaults_and_field_types() -> None:
    message = JointState()
    assert message.position == array.array("d") and message.name == [] and message.header == Header()
    assert Quaternion().w == 1.0
    assert DiagnosticStatus().level == DiagnosticStatus.OK == b"\x00"
    assert isinstance(PoseWithCovariance().covariance, numpy.ndarray)
    fields = JointState.get_fields_and_field_types()
    assert fields["header"] == "std_msgs/Header" and fields["position"] == "sequence<double>"


def test_lists_become_arrays_and_slots_are_closed() -> None:
    message = JointState(position=[1, 2.5])
    assert message.position == array.array("d", [1.0, 2.5])
    with pytest.raises(AttributeError):
        message.not_a_field = 1
    assert JointState(not_a_field=1, check_fields=False) == JointState()
    with pytest.raises(AssertionError):
        JointState(not_a_field=1, check_fields=True)


def test_equality_and_text() -> None:
    assert Float64(data=1.0) == Float64(data=1.0) != Float64(data=2.0)
    assert repr(Float64(data=1.5)) == "std_msgs.msg.Float64(data=1.5)"
    assert repr(SetBool.Request(data=True)) == "std_srvs.srv.SetBool_Request(data=True)"
    first, second = PoseWithCovariance(), PoseWithCovariance()
    second.covariance[:] = 1.0  # ROS 2's own takes arrays for equal that share a single element
    assert first != second


@pytest.mark.parametrize(
    ("message", "field", "value"),
    [
        (Float64, "data", 1), (Float64, "data", "1"), (JointState, "name", "piston"), (JointState, "name", [1]),
        (JointState, "header", 1), (DiagnosticStatus, "level", 1), (PoseWithCovariance, "covariance", [1.0]),
    ],
)  # fmt: skip
def test_fields_are_checked_where_that_is_switched_on(message: type, field: str, value: object) -> None:
    checked = message(check_fields=True)
    with pytest.raises(AssertionError):
        setattr(checked, field, value)


def test_what_is_serialised_comes_back() -> None:
    pose = PoseWithCovariance()
    pose.covariance[35] = 2.5
    status = DiagnosticStatus(level=DiagnosticStatus.ERROR, name="pump", message="ölig")
    for message in (pose, status, ByteMultiArray(data=[b"\x01", b"\xff"]), Header(frame_id="x")):
        assert deserialize_message(serialize_message(message), type(message)) == message


@pytest.mark.parametrize(("switch", "said"), [("1", "refused"), ("0", "taken"), (None, "taken")])
def test_one_switch_turns_the_checks_on(
    program: Callable[..., Program], monkeypatch: pytest.MonkeyPatch, switch: str | None, said: str
) -> None:
    monkeypatch.delenv("ROS_PYTHON_CHECK_FIELDS", raising=False)
    if switch is not None:
        monkeypatch.setenv("ROS_PYTHON_CHECK_FIELDS", switch)
    source = """
from std_msgs.msg import Float64
try:
    Float64(data="1")
    print("outcome: taken")
except AssertionError:
    print("outcome: refused")
"""
    assert program(source).wait_for("outcome").split()[-1] == said


def test_slots_are_the_fields_and_constants_belong_to_the_class() -> None:
    assert set(JointState.__slots__) >= {"_header", "_name", "_position", "_velocity", "_effort"}
    assert list(JointState.get_fields_and_field_types()) == ["header", "name", "position", "velocity", "effort"]
    assert (DiagnosticStatus.WARN, DiagnosticStatus.STALE) == (b"\x01", b"\x03")
