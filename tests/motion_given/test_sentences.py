"""What is certain, what remains and what to record next follow from the law and from the motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from benches import TIME, motion, recording, velocity
from measured import needs_dampers, raw, raw_at_5_hz

from eha_core.motion_given import Motion, diagnose_motion, find_law, fit_law, motion_of
from eha_core.motion_given.recorded import possible_timing
from eha_core.motion_given.sentences import Sentences, sentences_of
from eha_core.recording import Recording

V = velocity(TIME)
FORCE = 150.0 * np.sign(V) + 900.0 * V


def sentences(*motions: Motion) -> Sentences:
    return sentences_of(motions, find_law(motions), ["these parts"])


def sine(frequency: float) -> Motion:
    angle = 2.0 * np.pi * frequency
    speed = 0.02 * angle * np.cos(angle * TIME)
    noise = np.random.default_rng(6).standard_normal(len(TIME))
    force = 200.0 * np.sign(speed) + 500.0 * speed + 2.0 * noise
    return motion_of(Recording.from_arrays(time=TIME, position=0.02 * np.sin(angle * TIME), force=force))


def test_a_residual_that_is_noise_is_called_so() -> None:
    said = sentences_of([motion(900.0 * V)], fit_law([motion(900.0 * V)], ["viscous_friction"]), ["viscous"])
    assert said.certain.startswith("Motion given, the force is explained but for")
    assert said.remains.endswith("is noise")


def test_recordings_that_no_law_holds_for_are_not_explained_with_certainty() -> None:
    said = sentences(motion(FORCE), motion(6.0 * FORCE))
    assert said.certain.startswith("Motion given, no law was found that holds for all recordings; the best leaves")
    assert said.next_recording.startswith("Record what was changed between the recordings")


def test_one_frequency_of_a_sine_asks_for_another_and_other_motions_do_not() -> None:
    assert sentences(sine(0.7)).next_recording.startswith("Record another frequency")
    assert not sentences(sine(0.7), sine(1.6)).next_recording.startswith("Record another frequency")
    assert not sentences(motion(FORCE)).next_recording.startswith("Record another frequency")


def test_no_law_says_how_much_the_force_varies() -> None:
    found = diagnose_motion([recording(np.zeros_like(TIME), noise=5.0)])
    assert found.sentences.certain.startswith("Motion given, no term explains the force, which varies by 4.997 N")
    assert found.diagnosis.summary == str(found.sentences)


@needs_dampers
def test_raw_recordings_of_two_currents_have_no_certain_law_without_the_current_and_one_with_it() -> None:
    motions = [replace(one, schedule=None) for one in (raw(0), raw(4))]
    said = sentences(*motions)
    assert "no law was found that holds for all recordings" in said.certain
    assert possible_timing(motions, find_law(motions)) == []
    ids = ("viscous_friction", "bouc_wen_friction")
    assert fit_law([raw(0), raw(4)], ids, ids).share_left < 0.12


@needs_dampers
def test_the_head_of_the_file_at_5_hz_is_not_explained_with_certainty() -> None:
    assert "no law was found that holds; the best leaves 25" in sentences(raw_at_5_hz()).certain
