"""The proposed test as a ROS parameters file for the reference node, with the commands that run and record it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from eha_core.diagnosis.result import Diagnosis, Experiment

FILE = "next_experiment.yaml"
NODE = "eha_reference"
"""The node whose parameters the file holds: see `eha_sim_node.reference`."""

USUAL = {
    "voltage_command": "voltage_command",
    "position": "joint_states",
    "pressure_a": "chamber_a/pressure",
    "pressure_b": "chamber_b/pressure",
}
"""The topic of each channel that a test has to record."""


def channels_to_record(diagnosis: Diagnosis, experiment: Experiment) -> tuple[str, ...]:
    """The recording's channels and those that the test needs."""
    wanted = {*diagnosis.channels, *experiment.record}
    return tuple(name for name in USUAL if name in wanted)


def commands(experiment: Experiment, file: str = FILE) -> str:
    """The commands that run the test on the rig or on the simulator, and that diagnose it."""
    launch = f"ros2 launch eha_sim_node next_experiment.launch.yaml file:={file}"
    return (
        f"{launch}                  # on the rig, {experiment.duration:g} s\n"
        f"{launch} simulate:=true   # on the simulator\n"
        f"eha diagnose FIRST_RECORDING bags/next_experiment.mcap"
    )


def experiment_file(diagnosis: Diagnosis, experiment: Experiment) -> str:
    """The file's text: comments for people, then the node's parameters, as ROS reads them."""
    heading = [
        experiment.statement,
        f"It lasts {experiment.duration:g} s. Record {', '.join(channels_to_record(diagnosis, experiment))}.",
        *commands(experiment).splitlines(),
    ]
    return reference_file(heading, {**experiment.reference, "duration": float(experiment.duration)})


def reference_file(heading: Sequence[str], parameters: Mapping[str, object]) -> str:
    """A parameters file of the reference node: comments for people, then the parameters, as ROS reads them."""
    lines = [f"# {' '.join(line.split())}" for line in heading]
    return "\n".join([*lines, f"{NODE}:", "  ros__parameters:", *_rows(parameters)]) + "\n"


def _rows(parameters: Mapping[str, object]) -> Iterator[str]:
    for name, value in parameters.items():
        yield f"    {name}: {_scalar(value)}"


def _scalar(value: object) -> str:
    """A value in YAML that keeps its type: ROS reads 3 as an integer, and 1e-3 without a point as text."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        mantissa, exponent, power = repr(value).partition("e")
        return f"{mantissa}{'' if '.' in mantissa else '.0'}{exponent}{power}"
    return str(value)
