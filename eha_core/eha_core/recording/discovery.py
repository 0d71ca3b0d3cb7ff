"""Finds the topic of each channel: by the contract's names under one namespace, or by the topics file."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

from eha_core.errors import RecordingError
from eha_core.recording.channel_rules import DEFAULT_RULES, STATE_RULES, ChannelRule
from eha_core.recording.topics_file import TopicsFile

LEAKAGE_TOPIC = "internal_leakage"
_MEASURED = ("joint_states", "chamber_a/pressure", "chamber_b/pressure")


def _namespace(topic: str, relative: str) -> str | None:
    """The namespace in which `topic` is the relative name, without slashes at its ends; None if it is another topic."""
    name = topic.strip("/")
    if name == relative:
        return ""
    return name.removesuffix("/" + relative) if name.endswith("/" + relative) else None


def _find(topics: Collection[str], relative: str, namespace: str | None) -> str | None:
    """The topic of that relative name: in the namespace, else the only one anywhere; None if none or several."""
    found = {space: topic for topic in topics if (space := _namespace(topic, relative)) is not None}
    if namespace in found:
        return found[str(namespace)]
    return next(iter(found.values())) if len(found) == 1 else None


def _piston_namespace(where: str, topics: Collection[str]) -> str | None:
    """The one namespace with a piston's measurements; None if there is none."""
    spaces = sorted({space for topic in topics for name in _MEASURED if (space := _namespace(topic, name)) is not None})
    if len(spaces) > 1:
        names = " and ".join("/" + space for space in spaces)
        raise RecordingError(
            f"{where}: holds the pistons of namespaces {names}; choose one with `namespace: /{spaces[-1]}`"
            " or map its topics to channels, in a topics file"
        )
    return spaces[0] if spaces else None


def leakage_topic(topics: Collection[str], rules: Mapping[str, ChannelRule]) -> str | None:
    """The `internal_leakage` topic of the namespace that the channels come from."""
    spaces = {
        space
        for name, rule in rules.items()
        if (default := DEFAULT_RULES.get(name))
        and (space := _namespace(str(rule.topic), str(default.topic))) is not None
    }
    return _find(topics, LEAKAGE_TOPIC, min(spaces) if len(spaces) == 1 else None)


def find_rules(
    where: str, topics: Collection[str], topics_file: TopicsFile | None
) -> tuple[dict[str, ChannelRule], tuple[str, ...]]:
    """The rule of each channel that can be found, and remarks on what was skipped.

    Raises:
        RecordingError: there are two pistons and no choice between them, or a topic of the topics file is missing.
    """
    given = dict(topics_file.channels) if topics_file else {}
    chosen = {name: str(rule.topic) for name, rule in given.items() if rule and rule.topic}
    for name, topic in chosen.items():
        if topic not in topics:
            recorded = ", ".join(sorted(topics)) or "none"
            raise RecordingError(f"{where}: no topic {topic} for channel {name}; recorded are {recorded}")
    namespace = topics_file.namespace if topics_file else None
    if namespace is None and not (chosen.keys() & {"position", "pressure_a", "pressure_b", "force"}):
        namespace = _piston_namespace(where, topics)
    defaults = DEFAULT_RULES if chosen else _default_rules(topics, namespace)
    rules: dict[str, ChannelRule] = {}
    remarks = []
    for name in dict.fromkeys((*defaults, *given)):
        if name in given and given[name] is None:
            continue
        rule, default = given.get(name) or ChannelRule(), defaults.get(name)
        found = rule.topic or (_find(topics, str(default.topic), namespace) if default else None)
        if found:
            rules[name] = _completed(rule, default, found)
        elif default and (rivals := [topic for topic in topics if _namespace(topic, str(default.topic)) is not None]):
            remarks.append(f"{name} left out: it may be {' or '.join(sorted(rivals))}; a topics file can choose")
        elif name in given:
            raise RecordingError(f"{where}: the topics file names no topic for channel {name}; add `topic:`")
    if "force" not in given and rules.keys() >= {"pressure_a", "pressure_b"}:
        rules.pop("force", None)
    return rules, tuple(remarks)


def _default_rules(topics: Collection[str], namespace: str | None) -> dict[str, ChannelRule]:
    """The contract's topics, or the sensors' values in `state` where no sensor's own topic was recorded."""
    if any(_find(topics, name, namespace) for name in _MEASURED) or not _find(topics, "state", namespace):
        return DEFAULT_RULES
    command = DEFAULT_RULES["voltage_command"] if _find(topics, "voltage_command", namespace) else None
    return {**STATE_RULES, "voltage_command": command or STATE_RULES["voltage_command"]}


def default_rule(name: str, rule: ChannelRule) -> ChannelRule:
    """The defaults that a topics file need not repeat for a channel that is read by `rule`."""
    if rule.column is not None:
        return ChannelRule(topic=rule.topic, column=name)
    for rules in (DEFAULT_RULES, STATE_RULES):
        default = rules.get(name)
        if default and _namespace(str(rule.topic), str(default.topic)) is not None:
            return replace(default, topic=rule.topic)
    own = DEFAULT_RULES.get(name)
    return ChannelRule(field=own.field if own else "data")


def _completed(rule: ChannelRule, default: ChannelRule | None, topic: str) -> ChannelRule:
    return replace(
        rule,
        topic=topic,
        field=rule.field or (default.field if default else "data"),
        reference=rule.reference or (default.reference if default and not rule.topic else None),
    )
