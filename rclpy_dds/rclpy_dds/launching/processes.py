"""Starts processes together, labels what they print, and ends them together."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from typing import IO, Any

from rclpy_dds.launching.description import Process

# How long a process may take to react before the next, stronger signal.
_GRACE = 5.0
_POLL = 0.05


def run(processes: list[Process]) -> int:
    """Start the processes and wait for all; Ctrl-C and SIGTERM end them. Returns 1 when one could not be started."""
    return _Launch(processes).run()


class _Launch:
    def __init__(self, processes: list[Process]) -> None:
        self.pending = list(processes)
        self.running: dict[Process, subprocess.Popen[bytes]] = {}
        self.readers: list[threading.Thread] = []
        self.ending = False
        self.failed = False
        self.lock = threading.Lock()
        self.next_signals = [(0.0, signal.SIGINT)]

    def run(self) -> int:
        previous = {number: signal.signal(number, self._on_signal) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            for process in self.pending:
                if not self.ending:
                    self._start(process)
            while self.running:
                self._collect()
                if self.ending:
                    self._send_due_signals()
                time.sleep(_POLL)
            for reader in self.readers:
                reader.join(1.0)
        finally:
            for number, handler in previous.items():
                signal.signal(number, handler)
        return int(self.failed)

    def _on_signal(self, number: int, frame: Any) -> None:
        if not self.ending:
            self._log(
                "WARNING",
                "launch",
                "user interrupted with ctrl-c (SIGINT)" if number == signal.SIGINT else "received SIGTERM",
            )
        self._end()

    def _end(self) -> None:
        if not self.ending:
            self.ending = True
            now = time.monotonic()
            self.next_signals = [
                (now, signal.SIGINT),
                (now + _GRACE, signal.SIGTERM),
                (now + 2 * _GRACE, signal.SIGKILL),
            ]

    def _send_due_signals(self) -> None:
        while self.next_signals and time.monotonic() >= self.next_signals[0][0]:
            _, number = self.next_signals.pop(0)
            for process, child in self.running.items():
                if child.poll() is None:
                    self._log("INFO", process.label, f"sending signal '{number.name}' to process[{process.label}]")
                    child.send_signal(number)

    def _start(self, process: Process) -> None:
        environment = {**os.environ, "PYTHONUNBUFFERED": "1", **process.environment}
        try:
            # A group of its own: Ctrl-C in the terminal reaches the children through this process only, once.
            child = subprocess.Popen(
                process.command,
                env=environment,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        except OSError as error:
            self._log("ERROR", "launch", f"cannot start {process.label}: {error}")
            self.failed = True
            self._end()
            return
        self.running[process] = child
        self._log("INFO", process.label, f"process started with pid [{child.pid}]")
        assert child.stdout is not None
        reader = threading.Thread(target=self._relay, args=(process.label, child.stdout), daemon=True)
        reader.start()
        self.readers.append(reader)

    def _relay(self, label: str, stream: IO[bytes]) -> None:
        for line in stream:
            self._print(f"[{label}] {line.decode('utf-8', 'replace').rstrip()}")

    def _collect(self) -> None:
        for process, child in list(self.running.items()):
            status = child.poll()
            if status is None:
                continue
            del self.running[process]
            if status == 0 or (self.ending and status in (-signal.SIGINT, -signal.SIGTERM, 130)):
                self._log("INFO", process.label, f"process has finished cleanly [pid {child.pid}]")
            else:
                text = f"process has died [pid {child.pid}, exit code {status}, cmd '{' '.join(process.command)}']."
                self._log("ERROR", process.label, text)
            if process.respawn and not self.ending:
                time.sleep(process.respawn_delay)
                self._start(process)
            elif process.shutdown_on_exit:
                self._end()

    def _log(self, severity: str, name: str, text: str) -> None:
        self._print(f"[{severity}] [{name}]: {text}")

    def _print(self, text: str) -> None:
        with self.lock:
            try:
                sys.stdout.write(f"{text}\n")
                sys.stdout.flush()
            except (OSError, ValueError):
                self._end()  # nobody reads any more
