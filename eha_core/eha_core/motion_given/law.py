"""A law of given motion: a set of terms with their parameters, fitted, and what it says of another motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from scipy.optimize import least_squares, nnls

from eha_core.errors import RecordingError
from eha_core.motion_given.motion import Array, Flags, Indices, Motion, noise_of
from eha_core.motion_given.schedule import MOST_LEVELS, scheduled_terms
from eha_core.motion_given.terms import TERMS, Shape, Term, dry_state, moving_average

BLOCKS = 12
"""Blocks into which a recording is cut, of which every third is held out (assumed; the diagnosis holds out as much)."""

ROWS = 4000
"""Samples that a fit looks at, evenly spread over its recordings; friction's states still see all (assumed)."""

HOLDS = 0.2
"""Share of the force's deviation on held-out blocks that a law may leave (assumed; on a damper whose current is kept a
regression on sign(v), v and x leaves 0.12 to 0.17)."""

STEP = 1e-4
"""Relative step of the derivatives with respect to shapes and sizes."""


@dataclass(frozen=True)
class Value:
    """A parameter with its standard deviation, which allows for residuals that are correlated within a block."""

    value: float
    std: float
    unit: str


@dataclass(frozen=True)
class Law:
    """A fitted law.

    `values`: parameters by term id and name. `share_left`: RMS error over the force's deviation on the held-out blocks,
    fitted on the others. `error` [N]: RMS error over everything, fitted to everything.
    """

    terms: tuple[Term, ...]
    shape: tuple[float, ...]
    sizes: tuple[float, ...]
    share_left: float
    error: float
    values: Mapping[str, Mapping[str, Value]] = field(default_factory=dict)

    @property
    def holds(self) -> bool:
        """Whether the law explains enough of the force to be called its law."""
        return self.share_left <= HOLDS

    @property
    def ids(self) -> tuple[str, ...]:
        """The ids of the terms."""
        return tuple(term.id for term in self.terms)


def ordered(terms: Sequence[Term]) -> tuple[Term, ...]:
    """The terms in the order of the catalogue."""
    places = {term.id: place for place, term in enumerate(TERMS)}
    return tuple(sorted(terms, key=lambda term: places[term.id]))


def shapes_of(terms: Sequence[Term]) -> tuple[Shape, ...]:
    """The shapes of all terms."""
    return tuple(shape for term in terms for shape in term.shapes)


def columns_of(
    terms: Sequence[Term], motion: Motion, shape: Sequence[float] | Array, rows: Indices | None = None
) -> Array:
    """The columns (n, sizes) of the law over one motion, or over the `rows` of it that are wanted.

    They are averaged as the motion's force was; the average is taken as centred.
    """
    own: dict[str, tuple[float, ...]] = {}
    place = 0
    for term in terms:
        own[term.id] = tuple(shape[place : place + len(term.shapes)])
        place += len(term.shapes)
    rubbing = next((term for term in terms if term.kind == "dry friction"), None)
    dry = dry_state(rubbing, motion, own[rubbing.id] if rubbing else ())
    if motion.averaged is None and rows is not None:
        motion, dry = motion.at(rows), dry[rows]
    columns = [column for term in terms for column in term.columns(motion, dry, own[term.id])]
    if motion.averaged is not None:
        columns = [moving_average(column, motion.averaged / motion.step, rows) for column in columns]
    length = len(motion.time) if rows is None else len(rows)
    return np.stack(columns, axis=1) if columns else np.zeros((length, 0))


def predict(law: Law, motion: Motion) -> Array:
    """The force [N] of the law over a motion, whose own force it does not look at.

    Raises:
        RecordingError: the law depends on a schedule that the motion does not have.
    """
    over = next((term.schedule for term in law.terms if term.levels), None)
    if over is not None and motion.schedule is None:
        raise RecordingError(f"{motion.name}: no schedule channel; the law depends on {over}")
    return np.asarray(columns_of(law.terms, motion, law.shape) @ np.array(law.sizes))


def blocks_of(motion: Motion, most: int = ROWS) -> tuple[Indices, Indices]:
    """The samples of a motion that are looked at, `most` at most, and to which block each belongs."""
    rows: Indices = np.flatnonzero(motion.used).astype(np.int64)
    rows = rows[:: max(1, len(rows) // most)]
    return rows, (BLOCKS * np.arange(len(rows), dtype=np.int64)) // len(rows)


@dataclass(frozen=True)
class Regression:
    """Several motions of one rig, cut to what a fit looks at."""

    motions: tuple[Motion, ...]
    rows: tuple[Indices, ...]
    force: Array
    block: Indices
    held_out: Flags

    @classmethod
    def of(cls, motions: Sequence[Motion]) -> Regression:
        """The regression of recordings of one rig."""
        cuts = [blocks_of(motion, ROWS // len(motions)) for motion in motions]
        block = np.concatenate([BLOCKS * index + own for index, (_, own) in enumerate(cuts)])
        force = np.concatenate([motion.force[rows] for motion, (rows, _) in zip(motions, cuts, strict=True)])
        return cls(tuple(motions), tuple(rows for rows, _ in cuts), force, block, block % 3 == 1)

    def columns(self, terms: Sequence[Term], shape: Sequence[float] | Array) -> Array:
        """The columns of a law over what is looked at."""
        pairs = zip(self.motions, self.rows, strict=True)
        return np.concatenate([columns_of(terms, motion, shape, rows) for motion, rows in pairs])

    @property
    def fastest(self) -> float:
        """The largest speed [m/s]."""
        return max(float(np.max(np.abs(motion.velocity))) for motion in self.motions)

    @property
    def noise(self) -> float | None:
        """The noise of the force [N]; None where a recording's is not known."""
        return noise_of(self.motions)


def solve(columns: Array, force: Array) -> Array:
    """Least squares, whatever the columns' units."""
    length = np.sqrt(np.sum(columns**2, axis=0))
    length = np.where(length > 0.0, length, 1.0)
    return np.asarray(np.linalg.lstsq(columns / length, force, rcond=None)[0] / length)


def solve_for(terms: Sequence[Term], columns: Array, force: Array) -> Array:
    """Least squares in which no friction, spring or mass comes out negative."""
    sizes = solve(columns, force)
    signed = np.array([term.signed for term in terms for _ in term.sizes], dtype=bool)
    if not np.any(sizes[~signed] < 0.0):
        return sizes
    length = np.sqrt(np.sum(columns**2, axis=0)) + 1e-300
    both_ways = np.concatenate([columns / length, -(columns / length)[:, signed]], axis=1)
    found = nnls(both_ways, force)[0]
    sizes = found[: len(length)]
    sizes[signed] -= found[len(length) :]
    return np.asarray(sizes / length)


def _bounds(shapes: Sequence[Shape], fastest: float) -> tuple[Array, Array]:
    scale = np.array([fastest if shape.by_speed else 1.0 for shape in shapes])
    return (np.log(scale * [shape.lower for shape in shapes]), np.log(scale * [shape.upper for shape in shapes]))


def _starts(terms: Sequence[Term], known: Law | None, fastest: float) -> Iterator[Array]:
    """Initial guesses: what a simpler law has found, and every combination of what is new."""
    found: dict[tuple[str, str], float] = {}
    if known is not None:
        pairs = ((term.id, shape.name) for term in known.terms for shape in term.shapes)
        found = dict(zip(pairs, known.shape, strict=True))
    choices = []
    for term in terms:
        for shape in term.shapes:
            scale = fastest if shape.by_speed else 1.0
            old = found.get((term.id, shape.name))
            choices.append([old] if old is not None else [scale * start for start in shape.starts])
    for combination in product(*choices):
        yield np.log(np.array(combination))


def search_shape(regression: Regression, terms: Sequence[Term], rows: Flags, known: Law | None = None) -> Array:
    """The shapes that explain most of those rows, from every start."""
    shapes = shapes_of(terms)
    if not shapes:
        return np.empty(0)
    force = regression.force[rows]

    def residual(logarithms: Array) -> Array:
        columns = regression.columns(terms, np.exp(logarithms))[rows]
        return np.asarray((columns @ solve_for(terms, columns, force) - force) / np.sqrt(force @ force))

    low, high = _bounds(shapes, regression.fastest)
    fits = []
    for start in _starts(terms, known, regression.fastest):
        inside = np.clip(start, low + 1e-6, high - 1e-6)
        fits.append(least_squares(residual, inside, bounds=(low, high), diff_step=STEP, xtol=1e-4, ftol=1e-5))
    return np.asarray(np.exp(min(fits, key=lambda fit: fit.cost).x))


def at_work(terms: Sequence[Term], sizes: Array) -> bool:
    """Whether every size is there.

    One that depends on the schedule may be zero at some of its values. Dry friction may all be the pressure's, and then
    has only its shape.
    """
    pressed = any(term.kind == "friction under pressure" for term in terms)
    place = 0
    for term in terms:
        own = sizes[place : place + len(term.sizes)] != 0.0
        place += len(term.sizes)
        there = own.any() if term.levels else own.all()
        if len(own) and not there and not (pressed and term.kind == "dry friction"):
            return False
    return True


def held_out_errors(regression: Regression, terms: Sequence[Term], shape: Sequence[float] | Array) -> Array:
    """The mean squared error [N^2] of each held-out block, with the sizes fitted to the others; infinite where a
    friction, spring or mass would have to be negative."""
    columns = regression.columns(terms, shape)
    sizes = solve_for(terms, columns[~regression.held_out], regression.force[~regression.held_out])
    blocks = np.unique(regression.block[regression.held_out])
    if not at_work(terms, sizes):
        return np.full(len(blocks), np.inf)
    square = (columns @ sizes - regression.force) ** 2
    return np.array([np.mean(square[regression.block == block]) for block in blocks])


def fit_law(motions: Sequence[Motion], ids: Sequence[str], scheduled: Sequence[str] = ()) -> Law:
    """Fit the law of those terms to recordings of one rig.

    Args:
        motions: the recordings.
        ids: terms, by id.
        scheduled: those of them whose sizes are a function of the schedule, which all recordings must have.
    """
    over = [term for term in scheduled_terms(motions, MOST_LEVELS) if term.id in scheduled]
    terms = ordered([*over, *(term for term in TERMS if term.id in ids and term.id not in scheduled)])
    return finish(Regression.of(motions), terms)


def finish(regression: Regression, terms: Sequence[Term], known: Law | None = None) -> Law:
    """The law of a set of terms, fitted to all that is looked at, with its parameters' deviations."""
    training = ~regression.held_out
    shape = search_shape(regression, terms, training, known)
    errors = held_out_errors(regression, terms, shape)
    share_left = float(np.sqrt(np.mean(errors)) / np.std(regression.force[regression.held_out]))
    start = Law(tuple(terms), tuple(shape), (), share_left, 0.0)
    shape = search_shape(regression, terms, np.ones_like(training), start)
    columns = regression.columns(terms, shape)
    sizes = solve_for(terms, columns, regression.force)
    residual = columns @ sizes - regression.force
    deviations = _deviations(regression, terms, shape, sizes, residual) if terms else np.empty(0)
    return Law(
        tuple(terms), tuple(shape.tolist()), tuple(sizes.tolist()), share_left,
        float(np.sqrt(np.mean(residual**2))), _values(terms, shape, sizes, deviations),
    )  # fmt: skip


def _deviations(regression: Regression, terms: Sequence[Term], shape: Array, sizes: Array, residual: Array) -> Array:
    """Standard deviations of shapes and sizes: a sandwich over blocks, within which residuals may be correlated."""
    slopes = [regression.columns(terms, shape)] if len(sizes) else []
    for place in range(len(shape)):
        moved = shape.copy()
        moved[place] *= 1.0 + STEP
        change = (regression.columns(terms, moved) - regression.columns(terms, shape)) @ sizes
        slopes.insert(place, (change / (shape[place] * STEP))[:, None])
    jacobian = np.concatenate(slopes, axis=1)
    length = np.sqrt(np.sum(jacobian**2, axis=0)) + 1e-300
    scaled = jacobian / length
    inverse = np.linalg.pinv(scaled.T @ scaled, hermitian=True)
    blocks = np.unique(regression.block)
    pushes = np.stack([scaled[regression.block == b].T @ residual[regression.block == b] for b in blocks])
    few = len(blocks) / max(1, len(blocks) - len(length))
    covariance = few * inverse @ (pushes.T @ pushes) @ inverse
    return np.asarray(np.sqrt(np.maximum(np.diag(covariance), 0.0)) / length)


def _values(terms: Sequence[Term], shape: Array, sizes: Array, deviations: Array) -> dict[str, dict[str, Value]]:
    found: dict[str, dict[str, Value]] = {}
    shape_place, size_place = 0, len(shape)
    for term in terms:
        own = {}
        for name, unit in term.sizes:
            own[name] = Value(float(sizes[size_place - len(shape)]), float(deviations[size_place]), unit)
            size_place += 1
        for searched in term.shapes:
            own[searched.name] = Value(float(shape[shape_place]), float(deviations[shape_place]), searched.unit)
            shape_place += 1
        found[term.id] = own
    return found
