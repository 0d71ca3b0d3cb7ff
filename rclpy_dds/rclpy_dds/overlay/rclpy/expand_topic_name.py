"""From a name as written to a fully qualified one."""

from __future__ import annotations

from rclpy.validate_names import namespace_problem, node_name_problem, topic_name_problem


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """Resolve `~`, `{node}`, `{ns}`, `{namespace}` and a missing leading slash.

    Raises:
        ValueError: a name is invalid or a substitution unknown.
    """
    for what, name, problem in (
        ("topic name", topic_name, topic_name_problem(topic_name)),
        ("node name", node_name, node_name_problem(node_name)),
        ("namespace", node_namespace, namespace_problem(node_namespace)),
    ):
        if problem:
            raise ValueError(f"{what} is invalid: {name!r}: {problem[0]}")
    namespace = "" if node_namespace == "/" else node_namespace
    name = topic_name
    if name.startswith("~"):
        name = f"{namespace}/{node_name}{name[1:]}"
    for token, value in (("{node}", node_name), ("{ns}", node_namespace), ("{namespace}", node_namespace)):
        if name.startswith(token) and value.startswith("/"):
            name = name.replace(token, namespace, 1)
        name = name.replace(token, value.strip("/") if token != "{node}" else value)
    if "{" in name:
        raise ValueError(f"topic name is invalid: {topic_name!r} has an unknown substitution")
    return name if name.startswith("/") else f"{namespace}/{name}"
