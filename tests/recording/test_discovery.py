"""Which topic each channel is taken from, by names under one namespace and by what a topics file says."""

from __future__ import annotations

import pytest

from eha_core.errors import RecordingError
from eha_core.recording.channel_rules import DEFAULT_RULES, ChannelRule
from eha_core.recording.discovery import default_rule, find_rules, leakage_topic
from eha_core.recording.topics_file import TopicsFile

CONTRACT = ("voltage_command", "joint_states", "chamber_a/pressure", "chamber_b/pressure")


def under(namespace: str, *names: str) -> list[str]:
    return [f"{namespace}/{name}" for name in names or CONTRACT]


def topics_of(rules: dict[str, ChannelRule]) -> dict[str, str | None]:
    return {name: rule.topic for name, rule in rules.items()}


LEAKAGES = ["/a/internal_leakage", "/b/internal_leakage"]


@pytest.mark.parametrize(
    ("of_channels", "topics", "found"),
    [
        ({"position": "/a/joint_states", "pressure_a": "/a/chamber_a/pressure"}, LEAKAGES, "/a/internal_leakage"),
        ({"position": "/b/joint_states"}, LEAKAGES, "/b/internal_leakage"),
        ({"position": "/joint_states"}, [*LEAKAGES, "/internal_leakage"], "/internal_leakage"),
        ({"position": "/a/joint_states", "pressure_a": "/b/chamber_a/pressure"}, LEAKAGES, None),
        ({"position": "/a/joint_states", "pressure_a": "/b/chamber_a/pressure"}, LEAKAGES[1:], "/b/internal_leakage"),
        ({"position": "/c/joint_states"}, LEAKAGES, None),
        ({"position": "/c/joint_states"}, LEAKAGES[:1], "/a/internal_leakage"),
        ({"position": "/laser"}, LEAKAGES, None),  # no namespace can be found from it
        ({"position": "/laser", "velocity": "/b/joint_states"}, LEAKAGES, "/b/internal_leakage"),
        ({"current": "/a/current", "position": "/b/joint_states"}, LEAKAGES, "/b/internal_leakage"),
        ({"position": "/a/joint_states"}, ["/a/no_internal_leakage", "/a/internal_leakage/raw"], None),
    ],
)
def test_the_leakage_is_that_of_the_channels_namespace(
    of_channels: dict[str, str], topics: list[str], found: str | None
) -> None:
    assert leakage_topic(topics, {name: ChannelRule(topic) for name, topic in of_channels.items()}) == found


@pytest.mark.parametrize("namespace", ["", "/rig", "/lab/rig"])
def test_the_contract_s_names_are_found_under_one_namespace(namespace: str) -> None:
    rules, remarks = find_rules("run", under(namespace), None)
    assert remarks == ()
    assert topics_of(rules) == {
        "voltage_command": f"{namespace}/voltage_command",
        "position": f"{namespace}/joint_states",
        "velocity": f"{namespace}/joint_states",
        "pressure_a": f"{namespace}/chamber_a/pressure",
        "pressure_b": f"{namespace}/chamber_b/pressure",
    }
    assert {rules[name].reference for name in ("pressure_a", "pressure_b")} == {"absolute"}
    assert (rules["position"].field, rules["voltage_command"].field) == ("position[piston]", "data")


def test_a_name_counts_from_a_slash_on() -> None:
    rules, _ = find_rules("run", ["/my_joint_states", "/voltage_command/raw", "/rig/chamber_a/pressure"], None)
    assert topics_of(rules) == {"pressure_a": "/rig/chamber_a/pressure"}


def test_a_command_outside_the_pistons_namespace_serves_where_it_is_alone() -> None:
    topics = [*under("/rig", "joint_states"), "/plc/voltage_command"]
    assert topics_of(find_rules("run", topics, None)[0])["voltage_command"] == "/plc/voltage_command"
    rules, remarks = find_rules("run", [*topics, "/hmi/voltage_command"], None)
    assert "voltage_command" not in rules
    assert remarks == (
        "voltage_command left out: it may be /hmi/voltage_command or /plc/voltage_command; a topics file can choose",
    )
    both = [*topics, "/rig/voltage_command"]
    assert topics_of(find_rules("run", both, None)[0])["voltage_command"] == "/rig/voltage_command"


def test_two_pistons_need_a_word_and_the_last_is_the_example() -> None:
    topics = [*under("/a"), *under("/b")]
    with pytest.raises(RecordingError, match="the pistons of namespaces /a and /b; .* `namespace: /b`"):
        find_rules("run", topics, None)
    with pytest.raises(RecordingError, match="namespaces /a and /b and /c; .* `namespace: /c`"):
        find_rules("run", [*topics, "/c/joint_states"], None)
    for namespace in ("a", "b"):
        rules, _ = find_rules("run", topics, TopicsFile({}, namespace))
        assert {str(rule.topic).split("/")[1] for rule in rules.values()} == {namespace}


@pytest.mark.parametrize("channel", ["position", "pressure_a", "pressure_b", "force"])
def test_a_measured_channel_that_is_named_needs_no_word_on_pistons(channel: str) -> None:
    topics = [*under("/a"), *under("/b"), "/mine"]
    rules, _ = find_rules("run", topics, TopicsFile({channel: ChannelRule("/mine", "data")}))
    assert rules[channel] == ChannelRule("/mine", "data")


def test_a_command_that_is_named_leaves_the_pistons_open() -> None:
    topics = [*under("/a"), *under("/b"), "/mine"]
    with pytest.raises(RecordingError, match="the pistons of namespaces"):
        find_rules("run", topics, TopicsFile({"voltage_command": ChannelRule("/mine")}))


def test_both_pressures_stand_for_the_force_unless_it_is_named() -> None:
    assert "force" not in find_rules("run", under(""), None)[0]
    assert "force" in find_rules("run", under("", "joint_states", "chamber_a/pressure"), None)[0]
    assert "force" in find_rules("run", under("", "joint_states", "chamber_b/pressure"), None)[0]
    rules, _ = find_rules("run", [*under(""), "/cell"], TopicsFile({"force": ChannelRule("/cell", "data")}))
    assert rules["force"].topic == "/cell" and {"pressure_a", "pressure_b"} <= rules.keys()


def test_the_state_serves_where_no_sensor_s_topic_is() -> None:
    rules, _ = find_rules("run", ["/state"], None)
    assert set(topics_of(rules).values()) == {"/state"}
    assert (rules["voltage_command"].field, rules["position"].field) == ("voltage", "measured_position")
    assert {rules[name].reference for name in ("pressure_a", "pressure_b")} == {"gauge"}
    rules, _ = find_rules("run", ["/state", "/voltage_command"], None)
    assert (rules["voltage_command"].topic, rules["voltage_command"].field) == ("/voltage_command", "data")
    assert rules["position"].topic == "/state"
    rules, _ = find_rules("run", ["/state", "/chamber_b/pressure"], None)
    assert topics_of(rules) == {"pressure_b": "/chamber_b/pressure"}


def test_what_a_topics_file_says_comes_before_the_defaults() -> None:
    given = {
        "velocity": None,
        "position": ChannelRule(field="position[1]", scale=1e-3),
        "pressure_a": ChannelRule("/chamber_a/pressure"),
        "current": ChannelRule("/coil"),
        "pressure_b": ChannelRule(reference="gauge"),
    }
    rules, _ = find_rules("run", [*under(""), "/coil"], TopicsFile(given))
    assert "velocity" not in rules
    assert rules["position"] == ChannelRule("/joint_states", "position[1]", scale=1e-3)
    # a topic that was named may be another sensor than the contract's: nothing is known of its reference
    assert rules["pressure_a"] == ChannelRule("/chamber_a/pressure", "fluid_pressure")
    assert rules["pressure_b"] == ChannelRule("/chamber_b/pressure", "fluid_pressure", reference="gauge")
    assert rules["current"] == ChannelRule("/coil", "data")


def test_what_is_not_there_is_refused_by_name() -> None:
    with pytest.raises(RecordingError, match="no topic /p for channel pressure_a; recorded are /a, /b"):
        find_rules("run", ["/b", "/a"], TopicsFile({"pressure_a": ChannelRule("/p")}))
    with pytest.raises(RecordingError, match="recorded are none"):
        find_rules("run", [], TopicsFile({"pressure_a": ChannelRule("/p")}))
    with pytest.raises(RecordingError, match="names no topic for channel current; add `topic:`"):
        find_rules("run", under(""), TopicsFile({"current": ChannelRule(scale=2.0)}))


def test_a_topics_file_need_not_say_what_is_known_without_it() -> None:
    assert default_rule("position", ChannelRule("/rig/joint_states", "x")) == ChannelRule(
        "/rig/joint_states", "position[piston]"
    )
    assert default_rule("pressure_a", ChannelRule("/rig/state")) == ChannelRule(
        "/rig/state", "measured_pressure_a", reference="gauge"
    )
    assert default_rule("position", ChannelRule("/laser")) == ChannelRule(field=DEFAULT_RULES["position"].field)
    assert default_rule("current", ChannelRule("/coil")) == ChannelRule(field="data")
    assert default_rule("position", ChannelRule("x_mm", column="x_mm")) == ChannelRule("x_mm", column="position")
