"""YAML files of strangers: what grows without bound, or is none, is refused in one line and at once."""

from __future__ import annotations

import time
from importlib.util import find_spec
from pathlib import Path

import pytest

from eha_core.errors import EhaError, ParameterError, RecordingError
from eha_core.nominal import load_nominal
from eha_core.parameters import load_parameters
from eha_core.recording import load_topics_file, read_recording
from eha_core.yaml_file import load_yaml

LAUGHS = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{new}: &{new} [{', '.join(['*' + old] * 9)}]\n" for old, new in zip("abcdefgh", "bcdefghi", strict=True)
)
HOSTILE = {
    "aliases": (LAUGHS + "channels: *i\n", "line 2: aliases are not read"),
    "an alias of itself": ("channels: &a [*a]\n", "aliases are not read"),
    "depth": ("[" * 5000, "nested more than 20 levels deep"),
    "digits": ("channels: {position: {scale: " + "9" * 6000 + "}}", "a number of more than 30 digits"),
    "sixties": ("channels: {position: {scale: " + "1:" * 5000 + "1}}", "a number of more than 30 digits"),
    "a date that is none": ("channels: {position: {scale: 2024-99-99}}", "holds a value that is none"),
    "a Python object": ("channels: !!python/object/apply:os.system [true]", "could not determine a constructor"),
    "a key twice": ("a: {}\nchannels: {}\nchannels: {}\n", "line 3: channels is already in line 2"),
    "size": ("# " + "x" * 2**20 + "\nchannels: {}\n", "is larger than 1 MB"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_one_line_for_what_is_hostile(tmp_path: Path, name: str) -> None:
    text, expected = HOSTILE[name]
    path = tmp_path / "file.yaml"
    path.write_text(text)
    for load, error in ((load_topics_file, RecordingError), (load_parameters, ParameterError)):
        with pytest.raises(error) as caught:
            load(path)
        assert expected in str(caught.value) and "\n" not in str(caught.value) and str(path) in str(caught.value)


@pytest.mark.parametrize(
    "value", [".nan", ".inf", "-.inf", "0", "0.0", "1e400", "true-ish", "[1]", "2024-01-01", "!!binary aGk="]
)
def test_a_scale_is_a_number_that_keeps_what_was_recorded(tmp_path: Path, value: str) -> None:
    path = tmp_path / "topics.yaml"
    path.write_text(f"channels: {{position: {{scale: {value}}}}}")
    with pytest.raises(RecordingError, match=r"topics\.yaml: channel position: scale "):
        load_topics_file(path)


def test_what_is_read_is_what_the_safe_loader_reads(tmp_path: Path) -> None:
    path = tmp_path / "file.yaml"
    path.write_text("a: 1\nb: [1.0e-3, two, null, true]\nc: {d: '12345678901234567890123456789012345'}\n")
    assert load_yaml(path, EhaError, "file") == {
        "a": 1, "b": [1e-3, "two", None, True], "c": {"d": "12345678901234567890123456789012345"},
    }  # fmt: skip


def test_numbers_are_those_of_ros_2_s_own_reader(tmp_path: Path) -> None:
    """No sixties, and no point where there is an exponent."""
    path = tmp_path / "file.yaml"
    path.write_text("[1:30:00, -1:30.5, 1e-10, -2.5E3, .inf, 0x1F, 7, 0.0, 1e5x, +.5]")
    assert load_yaml(path, EhaError, "file") == [
        "1:30:00", "-1:30.5", 1e-10, -2500.0, float("inf"), 31, 7, 0.0, "1e5x", 0.5,
    ]  # fmt: skip


def test_a_nominal_file_of_sixty_thousand_unknown_keys_is_refused_in_linear_time(tmp_path: Path) -> None:
    def seconds(count: int) -> float:
        path = tmp_path / f"{count}.yaml"
        path.write_text("eha_sim:\n  ros__parameters:\n" + "".join(f"    k{k}: 1\n" for k in range(count)))
        started = time.process_time()
        with pytest.raises(ParameterError, match=r"there is no parameter named k0;"):
            load_nominal(path)
        return time.process_time() - started

    # ten times as long where linear, a hundred times where quadratic; the least of three, for other work only adds
    many, few = (min(seconds(count) for _ in range(3)) for count in (60_000, 6_000))
    assert many < 10.0**1.5 * few


def test_both_packages_read_by_the_same_file() -> None:
    """A link: neither may import the other, and nothing is written twice."""
    of_layer, of_library = (find_spec(f"{package}.bounded_yaml") for package in ("rclpy_dds", "eha_core"))
    assert of_layer and of_library and Path(str(of_layer.origin)).samefile(str(of_library.origin))


def test_messages_hold_no_escape_sequence_and_end(tmp_path: Path) -> None:
    path = tmp_path / "topics.yaml"
    path.write_text('channels: {"\\e]0;owned\\a\\e[2J\\u202e": {scale: 1.0}}')
    with pytest.raises(RecordingError) as caught:
        load_topics_file(path)
    assert str(caught.value).isprintable() and "owned" in str(caught.value)
    assert len(str(EhaError("x" * 100_000))) < 1100


@pytest.mark.parametrize("listed", ["../secret.mcap", "/etc/passwd", "a/../../b.mcap"])
def test_a_bag_lists_no_files_outside_its_folder(tmp_path: Path, listed: str) -> None:
    folder = tmp_path / "bag"
    folder.mkdir()
    (folder / "metadata.yaml").write_text(f"rosbag2_bagfile_information: {{relative_file_paths: ['{listed}']}}")
    with pytest.raises(RecordingError, match="which is not in its folder"):
        read_recording(folder)
