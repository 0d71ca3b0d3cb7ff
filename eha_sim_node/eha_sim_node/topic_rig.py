"""A rig that is driven over its topics: one motion after another, each recorded, watched, and stopped in time."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from queue import Empty, SimpleQueue

from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import Float64

from eha_core.errors import RecordingError
from eha_core.investigation import Motion, MotionStopped, Watch
from eha_core.realtime import NANOSECONDS
from eha_core.recording import Recording, read_recording
from eha_sim_node.joints import value_of
from eha_sim_node.recorder import Recorder
from eha_sim_node.stamps import nanoseconds_of
from eha_sim_node.state_topics import OUTPUT_QUALITY

TOPICS = {"position": "joint_states", "pressure_a": "chamber_a/pressure", "pressure_b": "chamber_b/pressure"}
"""The topic that each channel is fed back on."""

COMMAND = "voltage_command"
_LOOK = 0.02  # s between two looks at keys, silent topics and what is asked for
_DISCOVERY_PERIOD = 0.1  # s
_FLUSH_PERIOD = 0.25  # s
_PRESENT = 60.0  # s that the rig has to show up in
_SETTLE = 0.5  # s after a motion in which its last messages are recorded
_LAST_ARRIVES = 2.0  # s that zero voltage may take to every subscriber


@dataclass(frozen=True)
class Settings:
    """How a rig is driven.

    `channels`: those of TOPICS that are fed back and recorded. `lockstep`: each joint_states is answered with one
    voltage; otherwise a timer of `rate` [Hz] sends them. `feedback_timeout`: the oldest feedback with which the rig
    moves on [s]. `atmosphere`: absolute pressure of the surroundings [Pa].
    """

    channels: Sequence[str]
    lockstep: bool
    rate: float
    feedback_timeout: float
    atmosphere: float


@dataclass
class _Task:
    """A motion under way: its recording's name and what becomes of it; `origin`: time of its first voltage [ns]."""

    motion: Motion
    name: str
    result: Future[Path]
    asked: float
    origin: int | None = None
    ended: float | None = None


class TopicRig:
    """The `Rig` of an investigation over topics. `run` and `check` are called in another thread than the node's.

    Args:
        node: owner of publishers, subscriptions and timers.
        directory: where recordings go.
        settings: how the rig is driven.
        watch: makes what looks out for limits, anew for each motion.
        pressed: whether a key was pressed that stops the rig.
    """

    def __init__(
        self, node: Node, directory: Path, settings: Settings, watch: Callable[[], Watch], pressed: Callable[[], bool]
    ) -> None:
        self._node, self._settings, self._make_watch, self._pressed = node, settings, watch, pressed
        self._watch = watch()
        simulated = settings.lockstep or bool(node.get_parameter("use_sim_time").value)
        resolve = node.resolve_topic_name
        handlers = {resolve("joint_states"): self._on_joint_states}
        handlers |= {resolve(TOPICS[name]): self._pressure_receiver(name)
                     for name in settings.channels if name != "position"}  # fmt: skip
        self._recorder = Recorder(node, directory, "", simulated, handlers)
        self._publisher = node.create_publisher(Float64, COMMAND, OUTPUT_QUALITY)
        self._feedback = [resolve(TOPICS[name]) for name in settings.channels]
        self._asked: SimpleQueue[_Task] = SimpleQueue()
        self._task: _Task | None = None
        self._stopped = ""
        self._has_moved = False
        self._heard: dict[str, float] = {}
        self._pressures: dict[str, float] = {}
        self._position: float | None = None
        self._unanswered: int | None = None  # stamp of a joint_states that a lockstep waits with [ns]
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(_DISCOVERY_PERIOD, self._recorder.discover, clock=steady)
        node.create_timer(_FLUSH_PERIOD, self._recorder.flush, clock=steady)
        node.create_timer(_LOOK, self._look, clock=steady)
        self._clock = node.get_clock() if simulated else steady
        if not settings.lockstep:
            node.create_timer(1.0 / settings.rate, self._on_timer, clock=self._clock)

    def run(self, motion: Motion, name: str) -> Recording:
        """Run a motion and return what was recorded of it; see `Rig`."""
        self.check()
        task = _Task(motion, name, Future(), time.monotonic())
        self._asked.put(task)
        recording = read_recording(task.result.result())
        kept = {name: channel for name, channel in recording.channels.items()
                if name in (*self._settings.channels, COMMAND)}  # fmt: skip
        return replace(recording, channels=kept, parameters={})  # a simulator's topics tell more than a rig's

    def check(self) -> None:
        """Raise MotionStopped if the rig was stopped."""
        if self._stopped:
            raise MotionStopped(self._stopped)

    def stop(self, reason: str) -> None:
        """Zero voltage, and no motion from now on; called in the node's thread."""
        if self._stopped:
            return
        with suppress(Exception):  # where the middleware has ended already, nobody can be told
            if self._has_moved:
                self._publisher.publish(Float64(data=0.0))
                self._publisher.wait_for_all_acked(Duration(seconds=_LAST_ARRIVES))
        self._stopped = reason
        if self._task is not None:
            self._task.ended = self._task.ended or time.monotonic()

    def close(self) -> None:
        """Stop, finish the recording, and let nobody wait for a motion."""
        self.stop("the node was ended")
        self._start_next()
        if self._task is not None:
            self._finish(self._task)

    def _look(self) -> None:
        """What the time brings: a key, a silent topic, the next motion, the end of one."""
        if self._pressed():
            self.stop("a key was pressed")
        self._start_next()
        task, now = self._task, time.monotonic()
        if task is None:
            return
        if task.ended is not None:
            if now - task.ended > _SETTLE:
                self._finish(task)
        elif task.origin is not None:
            self._look_at_motion(now)
        elif self._recorder.path is None:
            self._begin_recording(task, now)
        elif now - task.asked > _PRESENT:
            self.stop(f"nothing comes on {' or '.join(self._feedback)} for {_PRESENT:g} s; start the rig")
        else:
            self._answer()  # a lockstep waits with the latest joint_states

    def _look_at_motion(self, now: float) -> None:
        """Stop where a topic is silent or nothing is recorded any more."""
        if self._recorder.failure is not None:
            self.stop(self._recorder.failure)
        for topic, heard in self._heard.items():
            if now - heard > self._settings.feedback_timeout:
                self.stop(f"{topic} is lost: nothing for {now - heard:.2g} s")

    def _start_next(self) -> None:
        with suppress(Empty):
            self._task = self._task or self._asked.get_nowait()
        if self._task is not None and self._stopped:
            self._task.ended = self._task.ended or time.monotonic()

    def _begin_recording(self, task: _Task, now: float) -> None:
        """Begin when rig and recorder are there: a test is recorded from its first sample on."""
        command = self._node.resolve_topic_name(COMMAND)
        missing = [topic for topic in (*self._feedback, command) if topic not in self._recorder.topics]
        listeners = self._publisher.get_subscription_count()
        if not missing and listeners >= 2:  # the rig and the recorder
            self._watch = self._make_watch()
            try:
                self._recorder.start(task.name)
            except RecordingError as error:
                self.stop(str(error))
        elif now - task.asked > _PRESENT:
            what = f"nobody publishes {' and '.join(missing)}" if missing else f"nobody listens to {command}"
            self.stop(f"{what} for {_PRESENT:g} s; start the rig, or give the channels that it has")

    def _finish(self, task: _Task) -> None:
        self._task = None
        path = self._recorder.stop() if self._recorder.path else None
        if self._stopped or path is None:
            where = f"; the recording up to then is {path}" if path else ""
            task.result.set_exception(MotionStopped(f"{self._stopped}{where}"))
        else:
            task.result.set_result(path)

    def _on_joint_states(self, data: bytes) -> None:
        message = deserialize_message(data, JointState)
        self._position = value_of(message.name, message.position)
        self._note("joint_states")
        stamp = nanoseconds_of(message.header.stamp)
        if self._is_moving and self._position is not None:
            trouble = self._watch.trouble(stamp / NANOSECONDS, self._position, self._pressures)
            if trouble:
                self.stop(trouble)
        self._unanswered = stamp
        self._answer()

    def _pressure_receiver(self, channel: str) -> Callable[[bytes], None]:
        def receive(data: bytes) -> None:
            pressure = deserialize_message(data, FluidPressure).fluid_pressure
            self._pressures[channel] = pressure - self._settings.atmosphere
            self._note(TOPICS[channel])

        return receive

    def _note(self, topic: str) -> None:
        self._heard[self._node.resolve_topic_name(topic)] = time.monotonic()

    @property
    def _is_moving(self) -> bool:
        """Whether voltages are sent: recording, and neither over nor stopped."""
        task = self._task
        return task is not None and task.ended is None and self._recorder.path is not None and not self._stopped

    def _answer(self) -> None:
        """In lockstep, one voltage for each joint_states."""
        if self._settings.lockstep and self._unanswered is not None and self._is_moving:
            stamp, self._unanswered = self._unanswered, None
            self._command(stamp)

    def _on_timer(self) -> None:
        if self._is_moving and self._is_fed(time.monotonic()):
            self._command(self._clock.now().nanoseconds)

    def _is_fed(self, now: float) -> bool:
        """Whether every feedback is younger than the bound; where one is not, `_look` stops what moves."""
        oldest = now - self._settings.feedback_timeout
        return all(self._heard.get(topic, oldest) > oldest for topic in self._feedback)

    def _command(self, now: int) -> None:
        """Send the motion's voltage of this time [ns]; at its end zero."""
        task, position = self._task, self._position
        if task is None or position is None:
            return
        if task.origin is None:
            task.origin = now
            self._has_moved = True
            self._heard = dict.fromkeys(self._feedback, time.monotonic())
        voltage = task.motion((now - task.origin) / NANOSECONDS, position)
        if voltage is None:
            task.ended = time.monotonic()
        self._publisher.publish(Float64(data=voltage or 0.0))
