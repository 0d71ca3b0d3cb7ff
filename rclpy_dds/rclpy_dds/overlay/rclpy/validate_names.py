"""The rules for names, in one place; the validate_* modules raise what rclpy raises."""

from __future__ import annotations

import re

MAX_NAMESPACE_LENGTH = 245
MAX_NAME_LENGTH = 255


def _check_text(name: object) -> None:
    if not isinstance(name, str):
        raise TypeError(f"a name is a str, not {type(name).__name__}")


def full_topic_name_problem(name: str) -> tuple[str, int] | None:
    """Return what is wrong with a fully qualified topic name, and where; None when it is valid."""
    _check_text(name)
    if not name:
        return "topic name must not be empty string", 0
    if name[0] != "/":
        return "topic name must be absolute, it must lead with a '/'", 0
    if len(name) > 1 and name.endswith("/"):
        return "topic name must not end with '/'", len(name) - 1
    if match := re.search(r"[^A-Za-z0-9_/]", name):
        return "topic name must not contain characters other than alphanumerics, '_', or '/'", match.start()
    if match := re.search(r"//", name):
        return "topic name must not contain repeated '/'", match.start() + 1
    if match := re.search(r"/(?=[0-9])", name):
        return "topic name must not have a token that starts with a number", match.start() + 1
    if name == "/":
        return "topic name must not end with '/'", 0
    return None


def namespace_problem(name: str) -> tuple[str, int] | None:
    """Return what is wrong with a namespace, and where; None when it is valid."""
    if name == "/":
        return None
    problem = full_topic_name_problem(name)
    if problem:
        return problem[0].replace("topic name", "namespace", 1), problem[1]
    if len(name) > MAX_NAMESPACE_LENGTH:
        return "namespace should not exceed '245'", MAX_NAMESPACE_LENGTH - 1
    return None


def node_name_problem(name: str) -> tuple[str, int] | None:
    """Return what is wrong with a node's name, and where; None when it is valid."""
    _check_text(name)
    if not name:
        return "node name must not be empty", 0
    if match := re.search(r"[^A-Za-z0-9_]", name):
        return "node name must not contain characters other than alphanumerics or '_'", match.start()
    if name[0].isdigit():
        return "node name must not start with a number", 0
    if len(name) > MAX_NAME_LENGTH:
        return "node name length should not exceed '255'", MAX_NAME_LENGTH - 1
    return None


def topic_name_problem(name: str) -> tuple[str, int] | None:
    """Return what is wrong with a topic name as users write it, with ~ and {substitutions}; None when it is valid."""
    _check_text(name)
    if not name:
        return "topic name must not be empty string", 0
    if name.endswith("/"):
        return "topic name must not end with '/'", len(name) - 1
    opened: int | None = None
    for index, character in enumerate(name):
        if character == "{":
            if opened is not None:
                return "topic name has unbalanced (unmatched) curly braces", opened
            opened = index
        elif character == "}":
            if opened is None:
                return "topic name has unbalanced (unmatched) curly braces", index
            opened = None
        elif opened is not None:
            if not (character.isascii() and (character.isalnum() or character == "_")):
                return (
                    "topic name must not contain substitution tokens with characters other than alphanumerics or '_'",
                    index,
                )
            if index == opened + 1 and character.isdigit():
                return "topic name must not have substitution tokens that start with a number", index
        elif character == "~":
            if index:
                return "topic name must not contain a tilde '~' other than at the start", index
        elif not (character.isascii() and (character.isalnum() or character in "_/")):
            return (
                "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'",
                index,
            )
    if opened is not None:
        return "topic name has unbalanced (unmatched) curly braces", opened
    if name[0].isdigit():
        return "topic name token must not start with a number", 0
    if len(name) > 1 and name[0] == "~" and name[1] != "/":
        return "topic name has a tilde '~' that is not followed by a forward slash '/'", 1
    if match := re.search(r"//", name):
        return "topic name must not contain repeated '/'", match.start() + 1
    if match := re.search(r"/(?=[0-9])", name):
        return "topic name token must not start with a number", match.start() + 1
    return None
