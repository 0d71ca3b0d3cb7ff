"""The thread that writes outlives an interrupt between any two steps of the one that waits for it."""

from __future__ import annotations

import sys
import threading
import weakref
from types import FrameType
from typing import Any

import pytest

from eha_core.recording.own_thread import OwnThread


def interrupted_at(step: int, thread: OwnThread, done: list[int]) -> bool:
    """Whether KeyboardInterrupt, raised before the step-th instruction on the way to an action, came before its end."""
    left = step

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal left
        frame.f_trace_opcodes = True
        if event == "opcode":
            left -= 1
            if left == 0:
                raise KeyboardInterrupt
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        thread.do(lambda: done.append(step))
    except KeyboardInterrupt:
        return True
    finally:
        sys.settrace(before)
    return False


def test_it_serves_on_after_an_interrupt_before_any_instruction() -> None:
    done: list[int] = []
    thread = OwnThread("interrupted")
    step = 1
    while interrupted_at(step, thread, done):
        thread.do(lambda: done.append(0))
        assert done[-1] == 0
        assert done.count(step) <= 1
        step += 1
    assert step > 10
    assert done[-1] == step
    thread.end()


def test_an_error_of_an_action_is_raised_where_it_was_asked_for() -> None:
    thread = OwnThread("erring")
    with pytest.raises(OSError, match="no space"):
        thread.do(lambda: (_ for _ in ()).throw(OSError("no space")))
    thread.do(lambda: None)
    thread.end()


def test_it_ends_after_what_it_was_given() -> None:
    thread, names = OwnThread("ending"), []
    thread.do(lambda: names.append(threading.current_thread()))
    thread.end()
    names[0].join(10.0)
    assert not names[0].is_alive()


def test_it_keeps_its_owner_not_alive_and_ends_with_it() -> None:
    class Owner:
        def __init__(self) -> None:
            self.thread, self.served_by = OwnThread("owned"), threading.current_thread()
            self.thread.do(self.serve)

        def serve(self) -> None:
            self.served_by = threading.current_thread()

    owner = Owner()
    served_by, gone = owner.served_by, weakref.ref(owner)
    del owner
    served_by.join(10.0)
    assert gone() is None and not served_by.is_alive()
