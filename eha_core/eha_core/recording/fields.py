"""Takes one number from a decoded message by its path, such as `data`, `wrench.force.x` or `position[0]`."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from eha_core.errors import RecordingError

_STEP = re.compile(r"([A-Za-z_]\w*)((?:\[\w+\])*)")
PISTON = "piston"


def field_getter(topic: str, path: str, message: Any) -> Callable[[Any], float]:
    """Return a function from message to number; `message`, the topic's first, is what the path is checked against.

    An index may be a number or, in a message with joint names, a joint: `position[piston]` is the joint of that name,
    or the only one. A message in which the element is missing gives NaN.

    Raises:
        RecordingError: the message has no such field, it holds no number, or which joint is meant is open.
    """
    steps: list[tuple[str, bool]] = []
    for part in path.split("."):
        match = _STEP.fullmatch(part)
        if match is None:
            raise RecordingError(f"{topic}: field {path!r} is no path such as data, wrench.force.x or position[0]")
        steps.append((match[1], False))
        steps.extend((_joint(topic, index, message), True) for index in re.findall(r"\w+", match[2]))

    def get(message: Any) -> float:
        value = message
        for step, is_index in steps:
            if is_index:
                if len(value) <= int(step):
                    return float("nan")
                value = value[int(step)]
            else:
                value = getattr(value, step)
        return float(value)

    try:
        get(message)
    except AttributeError:
        names = ", ".join(name for name in vars(message) if not name.startswith("_"))
        raise RecordingError(f"{topic}: its message has no field {path!r}; its fields are {names}") from None
    except (TypeError, ValueError):
        raise RecordingError(f"{topic}: field {path!r} is not one number; name an element such as {path}[0]") from None
    return get


def _joint(topic: str, index: str, message: Any) -> str:
    if index.isdigit():
        return index
    names = list(getattr(message, "name", []))
    if index in names:
        return str(names.index(index))
    if len(names) > 1:
        raise RecordingError(
            f"{topic}: holds the joints {', '.join(names)} and none is called {index};"
            " say which in a topics file, for example `position: {field: position[0]}`"
        )
    return "0"
