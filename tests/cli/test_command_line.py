"""The command line around its verbs: what it refuses, and how it ends."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from eha_core.cli import main, verbs


@pytest.mark.parametrize("words", [[], ["diagnos"]])
def test_no_verb_is_answered_in_one_line_that_names_them_all(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert all(verb in message for verb in verbs())


@pytest.mark.parametrize("buffering", [[], ["-u"]])
def test_a_reader_that_has_seen_enough_ends_it_quietly(buffering: list[str]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    try:
        command = [sys.executable, *buffering, "-m", "eha_core.cli", "effects"]
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
        ended = subprocess.run(
            command, stdout=writer, stderr=subprocess.PIPE, text=True, env=environment, timeout=60, check=False
        )
    finally:
        os.close(writer)
    assert (ended.returncode, ended.stderr) == (141, "")
