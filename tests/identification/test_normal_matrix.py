"""The banded elimination gives what a dense solution of the same equations gives, and needs no dense matrix for it."""

import numpy as np
import pytest
from made import recorded
from scipy.linalg import LinAlgError

from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.identification.normal_matrix import NormalMatrix
from eha_core.identification.observation import observe
from eha_core.identification.problem import LINK, STATE_PRIOR, Problem, linearise, normal_equations, whole
from eha_core.identification.segments import cut
from eha_core.parameters import nominal_values

UNITS = np.array([1e-5, 1e-3, 1e4, 1e4])
"""Of a state, so that the matrices' entries lie as far apart as they do in a fit."""


def random_matrix(windows: int, parameters: int, seed: int, samples: int = 12) -> NormalMatrix:
    """J^T J of random samples a window and random links between neighbours."""
    generator = np.random.default_rng(seed)
    data = generator.standard_normal((windows, samples, 4)) / UNITS
    effect = generator.standard_normal((windows, samples, parameters)) * np.logspace(-2, 3, parameters)
    links = generator.standard_normal((windows - 1, 4, 4)) / UNITS
    own = np.einsum("wsi,wsj->wij", data, data)
    own[:-1] += np.einsum("wsi,wsj->wij", links, links)
    own[1:] += np.diag(1.0 / UNITS**2)
    return NormalMatrix(
        np.einsum("wsp,wsq->pq", effect, effect),
        np.einsum("wsi,wsp->wip", data, effect),
        own,
        -np.einsum("wsi,s->wis", links, 1.0 / UNITS),
    )


def dense(matrix: NormalMatrix) -> np.ndarray:
    count, (windows, size, _) = len(matrix.parameters), matrix.own.shape
    full = np.zeros((count + windows * size, count + windows * size))
    full[:count, :count] = matrix.parameters
    for window in range(windows):
        here = slice(count + size * window, count + size * (window + 1))
        full[here, here] = matrix.own[window]
        full[here, :count], full[:count, here] = matrix.shared[window], matrix.shared[window].T
        if window + 1 < windows:
            after = slice(here.stop, here.stop + size)
            full[here, after], full[after, here] = matrix.following[window], matrix.following[window].T
    return full


def solved(full: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The dense answer, of the matrix scaled to a unit diagonal."""
    scale = np.sqrt(np.diag(full))
    return (np.linalg.solve(full / np.outer(scale, scale), (right.T / scale).T).T / scale).T


def relative(found: np.ndarray, expected: np.ndarray, full: np.ndarray) -> float:
    """The difference in the matrix' own units, over the answer's size in them."""
    scale = np.sqrt(np.diag(full))
    return float(np.linalg.norm((found - expected).T * scale) / np.linalg.norm(expected.T * scale))


@pytest.mark.parametrize(("windows", "parameters"), [(1, 3), (2, 1), (7, 17), (60, 5), (9, 0)])
@pytest.mark.parametrize("damping", [0.0, 1e-6, 3.0])
def test_the_damped_system_is_solved_as_a_dense_one(windows, parameters, damping):
    matrix = random_matrix(windows, parameters, seed=windows)
    full = dense(matrix)
    right = np.random.default_rng(1).standard_normal((len(full), 3)) * np.sqrt(np.diag(full))[:, None]
    raised = full + damping * np.diag(np.diag(full))
    system = matrix.eliminate(damping)
    assert relative(system.solve(right), solved(raised, right), full) < 1e-9
    assert relative(system.solve(right[:, 1]), solved(raised, right[:, 1]), full) < 1e-9
    np.testing.assert_allclose(system.energy(right), right.T @ solved(raised, right), rtol=1e-9)


def test_parameters_that_are_held_stay_and_the_rest_adapts():
    matrix = random_matrix(8, 6, seed=3)
    full, held = dense(matrix), np.array([False, True, False, False, True, False])
    right = np.random.default_rng(2).standard_normal(len(full)) * np.sqrt(np.diag(full))
    at = np.array([9.0, 0.3, 9.0, 9.0, -0.01, 9.0])
    found = matrix.eliminate().solve(right, held, at)
    rest = np.concatenate([~held, np.ones(32, dtype=np.bool_)])
    expected = np.concatenate([at, np.zeros(32)])
    known = right[rest] - full[np.ix_(rest, ~rest)] @ expected[~rest]
    expected[rest] = solved(full[np.ix_(rest, rest)], known)
    assert np.array_equal(found[:6][held], at[held])
    assert relative(found, expected, full) < 1e-9


def test_with_every_parameter_held_the_states_alone_adapt():
    matrix = random_matrix(5, 2, seed=4)
    full, at = dense(matrix), np.array([1.0, -2.0])
    right = np.random.default_rng(3).standard_normal(22) * np.sqrt(np.diag(full))
    found = matrix.eliminate().solve(right, np.array([True, True]), at)
    assert np.allclose(full[2:] @ found, right[2:], rtol=0.0, atol=1e-9 * np.max(np.abs(right)))


def test_diagonal_product_and_covariance_are_the_dense_matrix_own():
    matrix = random_matrix(9, 5, seed=5)
    full = dense(matrix)
    vector = np.random.default_rng(4).standard_normal(len(full)) / np.sqrt(np.diag(full))
    assert np.array_equal(matrix.diagonal(), np.diag(full))
    assert np.allclose(matrix.times(vector), full @ vector, rtol=0.0, atol=1e-12 * np.max(np.abs(full @ vector)))
    expected = solved(full, np.eye(len(full)))[:, :5]
    assert relative(matrix.covariance(), expected, full) < 1e-9


def _jacobian(problem: Problem, free, linear) -> np.ndarray:
    """Row by row: every sample, every link, every prior."""
    windows, size, count = problem.shooting.windows, problem.shooting.free_states, len(free)
    rows = []
    for by_parameter, by_state, window in zip(linear.by_parameter, linear.by_state, linear.window, strict=True):
        row = np.zeros(count + 4 * windows)
        row[:count] = by_parameter
        row[count + 4 * window : count + 4 * window + size] = by_state
        rows.append(row)
    for window in problem.links():
        for state in range(size):
            row = np.zeros(count + 4 * windows)
            row[:count] = linear.ends_by_parameter[window, state]
            row[count + 4 * window : count + 4 * window + size] = linear.ends_by_state[window, state]
            row[count + 4 * (window + 1) + state] = -1.0
            rows.append(row / LINK[state])
    trust = np.concatenate([[one.prior_deviation for one in free], np.tile(STATE_PRIOR, windows)])
    return np.concatenate([np.array(rows), np.diag(1.0 / trust)])


@pytest.mark.parametrize("channels", [("position", "pressure_a", "pressure_b"), ("position",)])
def test_the_equations_of_a_recording_are_those_of_its_jacobian(channels):
    """With a window out of use, and where no pressure was measured."""
    values = nominal_values()
    observation = observe(recorded({"moving_mass": 11.5}, duration=6.0, channels=("voltage_command", *channels)))
    shooting = cut(observation, values)
    problem = Problem(shooting, np.array([0, 1, 3, 4]))
    free = free_nominal_parameters(values, "voltage", 0.0)
    q = np.full(len(free), 0.01)
    states = shooting.initial_states + 0.1 * LINK
    linear = linearise(problem, values, free, q, states)
    matrix, gradient = normal_equations(problem, free, q, states, linear)
    jacobian = _jacobian(problem, free, linear)
    links = problem.links()
    gaps = (linear.ends[links] - states[links + 1]) / LINK
    trust = np.concatenate([[one.prior_deviation for one in free], np.tile(STATE_PRIOR, shooting.windows)])
    offsets = np.concatenate([q, (states - shooting.initial_states).ravel()]) / trust
    full = jacobian.T @ jacobian
    scale = np.sqrt(np.diag(full))
    pull = jacobian.T @ np.concatenate([linear.residual, -gaps.ravel(), -offsets])
    assert np.allclose(dense(matrix) / np.outer(scale, scale), full / np.outer(scale, scale), rtol=0.0, atol=1e-12)
    assert np.allclose(gradient / scale, pull / scale, rtol=0.0, atol=1e-9 * np.max(np.abs(pull / scale)))
    raised = full + 1e-6 * np.diag(scale**2)
    assert relative(matrix.eliminate(1e-6).solve(gradient), solved(raised, pull), full) < 1e-9
    inverse = matrix.covariance() * np.outer(scale, scale[: len(free)])
    left = (full / np.outer(scale, scale)) @ inverse - np.eye(len(full), len(free))
    assert np.linalg.norm(left) < 1e-12 * np.linalg.norm(inverse)
    window_out_of_use = slice(len(free) + 8, len(free) + 12)
    assert np.array_equal(matrix.covariance()[window_out_of_use], np.zeros((4, len(free))))
    assert whole(shooting).links().size == shooting.windows - 1  # so that a window was indeed left out


def test_what_is_not_positive_definite_is_refused():
    matrix = random_matrix(4, 2, seed=6)
    indefinite = NormalMatrix(matrix.parameters, matrix.shared, matrix.own, 40.0 * matrix.following)
    with pytest.raises(LinAlgError):
        indefinite.eliminate()
    unknown = NormalMatrix(matrix.parameters, matrix.shared, matrix.own * np.nan, matrix.following)
    with pytest.raises(ValueError, match="infs or NaNs"):
        unknown.eliminate()
    assert np.all(np.isnan(unknown.covariance()))


def test_two_parameters_with_one_effect_share_the_variance():
    """No step without damping, and the pseudo-inverse splits between the two what one alone would have."""
    one = random_matrix(6, 1, seed=7)
    twice = NormalMatrix(np.tile(one.parameters, (2, 2)), np.tile(one.shared, (1, 1, 2)), one.own, one.following)
    alone = one.covariance()[0, 0]
    assert np.allclose(twice.covariance()[:2], np.full((2, 2), alone / 4.0), rtol=1e-9)


def test_states_that_rounding_makes_indefinite_do_not_stop_the_covariance():
    matrix = random_matrix(3, 2, seed=8)
    own = matrix.own.copy()
    own[0] = np.diag(np.diag(own[0]))
    own[0, 0, 1] = own[0, 1, 0] = (1.0 + 1e-15) * np.sqrt(own[0, 0, 0] * own[0, 1, 1])
    cut_off = NormalMatrix(matrix.parameters, 0.0 * matrix.shared, own, 0.0 * matrix.following)
    with pytest.raises(LinAlgError):
        cut_off.eliminate()
    expected = solved(matrix.parameters, np.eye(2))
    assert relative(cut_off.covariance()[:2], expected, matrix.parameters) < 1e-9


def test_an_hour_of_windows_is_solved_without_a_dense_matrix():
    """Twenty thousand windows: a dense matrix would need 51 GB."""
    matrix = random_matrix(20_000, 3, seed=9, samples=6)
    right = np.random.default_rng(5).standard_normal(80_003) * np.sqrt(matrix.diagonal())
    found = matrix.eliminate().solve(right)
    left = (right - matrix.times(found)) / np.sqrt(matrix.diagonal())
    assert np.linalg.norm(left) < 1e-9 * np.linalg.norm(right / np.sqrt(matrix.diagonal()))
