"""Contract tests: what node code may expect of rclpy, run on whichever rclpy is present."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

# A domain of their own, on this machine only. Ports of domains above 101 collide with Linux' ephemeral ones.
os.environ["ROS_DOMAIN_ID"] = os.environ.get("EHA_TEST_DOMAIN_ID", str(46 + os.getpid() % 56))
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

IS_LAYER = getattr(rclpy, "__rclpy_dds__", False)


class Graph:
    """Nodes of one test and the executor that runs them."""

    def __init__(self) -> None:
        self.executor = SingleThreadedExecutor()
        self.nodes: list[Node] = []

    def node(self, name: str, **options: Any) -> Node:
        """Make a node the executor serves."""
        node = Node(name, **options)
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def spin_until(self, condition: Callable[[], Any], timeout: float = 5.0) -> bool:
        """Run callbacks until the condition is true; False when the time (s) is up."""
        end = time.monotonic() + timeout
        while not condition():
            if time.monotonic() > end:
                return False
            self.executor.spin_once(timeout_sec=0.02)
        return True

    def close(self) -> None:
        """Destroy executor and nodes."""
        self.executor.shutdown(1.0)
        for node in self.nodes:
            node.destroy_node()


@pytest.fixture
def graph() -> Iterator[Graph]:
    """Give an initialised rclpy and an executor; leave nothing behind."""
    rclpy.init(args=[])
    made = Graph()
    yield made
    made.close()
    rclpy.try_shutdown()


class Program:
    """A node in a process of its own, from Python source; its output is read line by line."""

    def __init__(self, source: str, *arguments: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-u", "-c", source, *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def wait_for(self, text: str) -> str:
        """Return the first line that holds a text; fails when the program ends before."""
        assert self.process.stdout is not None
        seen = []
        for line in self.process.stdout:
            seen.append(line)
            if text in line:
                return line
        raise AssertionError(f"{text!r} never came; the program said: {''.join(seen)}")

    def end(self) -> int:
        """Wait for the end and return the exit status."""
        try:
            return self.process.wait(10)
        finally:
            if self.process.poll() is None:
                self.process.kill()
                self.process.wait()
            if self.process.stdout is not None:
                self.process.stdout.close()


@pytest.fixture
def program() -> Iterator[Callable[..., Program]]:
    """Give a function that starts programs; ends the rest of them.

    They are asked to end: for as long as a killed one is missed, every other's last messages wait for it.
    """
    started: list[Program] = []

    def start(source: str, *arguments: str) -> Program:
        started.append(Program(source, *arguments))
        return started[-1]

    yield start
    for one in started:
        if one.process.poll() is None:
            one.process.terminate()
        try:
            one.end()
        except subprocess.TimeoutExpired:  # and killed; ROS 2's own now and then does not end when it is left so
            if IS_LAYER:
                raise
