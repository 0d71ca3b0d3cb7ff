"""A sensor's zero that a diagnosis names comes with what corrects it."""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.conclude import zeros_to_correct
from eha_core.diagnosis.result import FittedValue, NamedEffect
from eha_core.recording import Recording, read_recording


def zero_named(effect_id, active=None, **values):
    named = {name: FittedValue(value, 1e-3 * abs(value), "") for name, value in values.items()}
    return NamedEffect(effect_id, "sensor", "", named, 100.0, "", active)


def test_a_named_zero_comes_with_the_topics_line_that_undoes_it(tmp_path):
    time = np.arange(400) / 100.0
    position = 0.03 * np.sin(time)
    table = np.stack([time, position + 0.1, 5e6 + 1e5 * time, 6e6 - 1e5 * time], axis=1)
    path = tmp_path / "rig.csv"
    np.savetxt(path, table, delimiter=",", header="time,position,pressure_a,pressure_b", comments="")
    named = [zero_named("position_sensor_offset", offset=0.1),
             zero_named("pressure_sensor_bias", bias_a=-101325.0, bias_b=0.0)]  # fmt: skip
    lines = list(zeros_to_correct(named, read_recording(path)))
    topics = tmp_path / "topics.yaml"
    topics.write_text(lines[0].split("`")[1] + "\n")
    np.testing.assert_allclose(read_recording(path, topics).channels["position"].values, position, atol=1e-12)
    topics.write_text(lines[1].split("`")[1] + "\n")
    gauge = read_recording(path, topics).channels["pressure_a"].values  # the table was taken as absolute
    np.testing.assert_allclose(gauge, table[:, 2], atol=50.0)
    assert "pressure_b" not in lines[1]


def test_what_is_no_zero_and_a_zero_that_moved_midway_have_no_topics_line():
    recording = Recording.from_arrays(time=np.arange(9.0), position=np.arange(9.0))
    friction = zero_named("coulomb_friction", force=300.0)
    moved = zero_named("position_sensor_offset", (2.0, 5.0), offset=0.1)
    biased = zero_named("pressure_sensor_bias", bias_a=1e5, bias_b=1e5)
    assert not list(zeros_to_correct([friction, moved, biased], recording))
