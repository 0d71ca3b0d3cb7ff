"""The network: NumPy evaluates what scikit-learn trained, its file holds numbers alone, and it says what is likely."""

from __future__ import annotations

from itertools import chain, combinations
from pathlib import Path

import numpy as np
import pytest

from eha_exam.case import Case
from eha_exam.drawing import draw_case
from eha_exam.errors import ExamError
from eha_exam.measuring import measure, simulate_case
from eha_exam.peers import neural_screen
from eha_exam.peers.__main__ import main
from eha_exam.peers.equations import Signals, signals_of
from eha_exam.peers.neural_screen import (
    CASES,
    HIDDEN,
    LABELS,
    PENALTY,
    ROUNDS,
    SEED,
    UNSUITABLE,
    WEIGHTS,
    Network,
    fit,
    inputs_of,
    load,
    screen,
    targets_of,
    train,
)


@pytest.fixture(scope="module")
def signals() -> Signals:
    case = draw_case("null", 1, 11)
    return signals_of(measure(case, simulate_case(case)), case.nominal)


def examples(count: int = 60) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(0)
    inputs = generator.standard_normal((count, 7)) * [1.0, 5.0, 0.1, 1.0, 1.0, 1.0, 1e3] + 3.0
    return inputs, (generator.random((count, 3)) < 0.4).astype(float)


def of_biases(inputs: int, **probabilities: float) -> Network:
    """A network that says the same of every recording: 1 in a million for what is not stated."""
    shares = np.array([probabilities.get(label.replace(" ", "_"), 1e-6) for label in LABELS])
    none = np.zeros((inputs, 1))
    return Network(
        none[:, 0], none[:, 0] + 1.0, none, np.zeros(1), np.zeros((1, len(LABELS))), np.log(shares / (1.0 - shares))
    )


@pytest.mark.filterwarnings("ignore:Stochastic Optimizer")
def test_numpy_evaluates_the_network_as_scikit_learn_does() -> None:
    network = pytest.importorskip("sklearn.neural_network")
    inputs, targets = examples()
    fitted = fit(inputs, targets)
    model = network.MLPClassifier((HIDDEN,), alpha=PENALTY, max_iter=ROUNDS, random_state=0)
    standardised = (inputs - inputs.mean(axis=0)) / inputs.std(axis=0)
    expected = model.fit(standardised, targets).predict_proba(standardised)
    np.testing.assert_allclose(fitted.probabilities(inputs), expected, atol=1e-9)
    assert np.ptp(expected) > 0.2


def test_weights_are_numbers_in_a_file_and_nothing_is_unpickled(tmp_path: Path) -> None:
    network = of_biases(5, end_stop=0.7)
    network.save(tmp_path / "weights.npz")
    again = load(tmp_path / "weights.npz")
    for name, value in vars(network).items():
        np.testing.assert_array_equal(getattr(again, name), value)
    np.savez(tmp_path / "objects.npz", **{name: np.array([object()]) for name in vars(network)})
    with pytest.raises(ExamError, match=r"objects.npz: is no trained network"):
        load(tmp_path / "objects.npz")
    with pytest.raises(ExamError, match=r"none.npz: is no trained network"):
        load(tmp_path / "none.npz")


def test_training_is_a_command_that_writes_the_weights(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("eha_exam.peers.__main__.recorded", lambda cases, seed: (cases, seed))
    monkeypatch.setattr("eha_exam.peers.__main__.train", lambda asked: of_biases(sum(asked)))
    for words, inputs in ((["--cases", "4", "--seed", "7"], 11), ([], CASES + SEED)):
        assert main(["train", str(tmp_path / "weights.npz"), *words]) == 0
        assert load(tmp_path / "weights.npz").mean.shape == (inputs,)


def test_the_weights_that_come_with_the_exam_fit_its_inputs_and_are_small(signals: Signals) -> None:
    shares = load().probabilities(inputs_of(signals)[None])
    assert shares.shape == (1, len(LABELS))
    assert np.all((shares > 0.0) & (shares < 1.0))
    assert WEIGHTS.stat().st_size < 200_000


@pytest.mark.parametrize(
    ("shares", "verdict", "named", "alternatives"),
    [
        ({}, "parameters", [], []),
        ({"end_stop": 0.9}, "missing_physics", ["end_stop"], []),
        ({"end_stop": 0.9, "command_delay": 0.8}, "missing_physics", ["command_delay", "end_stop"], []),
        ({"unknown_force": 0.9, "end_stop": 0.1}, "unknown_physics", [], []),
        (
            {"command_delay": 0.6, "coulomb_friction": 0.52, "end_stop": 0.55},
            "ambiguous",
            ["command_delay", "coulomb_friction", "end_stop"],
            [["command_delay", "end_stop"], ["command_delay", "coulomb_friction"]],
        ),
    ],
    ids=str,
)
def test_it_states_one_set_where_that_is_sure_and_else_the_most_probable(
    signals: Signals, shares: dict[str, float], verdict: str, named: list[str], alternatives: list[list[str]]
) -> None:
    answer = screen(signals, of_biases(len(inputs_of(signals)), **shares))
    assert answer["verdict"] == verdict
    assert [effect["id"] for effect in answer["effects"]] == named
    assert [effect["probability"] for effect in answer["effects"]] == pytest.approx([shares[name] for name in named])
    assert [option["effects"] for option in answer["alternatives"]] == alternatives
    assert answer["unknown"] == ({"site": "force"} if verdict == "unknown_physics" else None)


def test_sets_are_ordered_as_all_sets_are() -> None:
    generator = np.random.default_rng(3)
    probability = dict(zip("abcdefg", generator.random(7).tolist(), strict=True))
    every = chain.from_iterable(combinations(probability, size) for size in range(8))
    chances = {names: np.prod([p if name in names else 1.0 - p for name, p in probability.items()]) for names in every}
    assert sum(chances.values()) == pytest.approx(1.0)
    best = sorted(chances.items(), key=lambda pair: -pair[1])[:3]
    for (names, chance), (expected, share) in zip(neural_screen._sets(probability), best, strict=False):
        assert (names, pytest.approx(chance)) == (expected, share)


def test_what_is_learnt_is_what_is_concealed() -> None:
    case = draw_case("named_and_unknown", 0, 11)
    assert {label for label, one in zip(LABELS, targets_of(case), strict=True) if one} == {
        "unknown " + ("chamber" if name == "relief_leakage" else "force") if name in neural_screen.OUTSIDE else name
        for name in case.effect_ids
    }
    assert not targets_of(draw_case("null", 0, 11)).any()


def test_training_is_of_suitable_cases_and_the_same_each_time(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("sklearn")
    drawn: list[Case] = []

    def brief(tier: str, number: int, seed: int) -> Case:
        drawn.append(draw_case(tier, number, seed))
        return drawn[-1]

    monkeypatch.setattr(neural_screen, "draw_case", brief)
    monkeypatch.setattr(neural_screen, "simulate_case", lambda case: {})
    monkeypatch.setattr(neural_screen, "measure", lambda case, truth: {})
    assert len(list(neural_screen.recorded(60, 11))) == 60
    tiers = {case.tier for case in drawn}
    assert len(drawn) == len({case.seed for case in drawn}) == 60
    assert not tiers & set(UNSUITABLE) and {"single", "rig", "null"} <= tiers
    inputs, targets = examples()
    np.testing.assert_array_equal(fit(inputs, targets).first, fit(inputs, targets).first)


def test_it_learns_to_tell_a_spring_from_nothing_missing() -> None:
    """Eight rigs with a strong hardening spring and eight without, of which one each is not learnt from."""
    pytest.importorskip("sklearn")
    made = []
    for number in range(8):
        for spring in (True, False):
            case = draw_case("null", number, 11)
            size = 0.3 * case.setting.force / case.amplitude**3
            effects = (("hardening_spring", {"coefficient": size}),) if spring else ()
            case = Case(**{**vars(case), "effects": effects, "duration": 6.0, "rate": 500.0, "shape": "multisine"})
            made.append((case, measure(case, simulate_case(case))))
    network = train(made[2:])
    shares = [network.probabilities(inputs_of(signals_of(arrays, case.nominal))[None])[0] for case, arrays in made[:2]]
    place = LABELS.index("hardening_spring")
    assert shares[0][place] > 0.7 > 0.3 > shares[1][place]
    assert max(np.delete(shares[0], place)) < 0.3
