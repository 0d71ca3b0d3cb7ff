"""`diagnose`: the stages in their order, from a recording to a frozen result."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from threadpoolctl import threadpool_limits

from eha_core.diagnosis.balance import balances, least
from eha_core.diagnosis.calibrate import calibrate_but_for_its_end
from eha_core.diagnosis.conclude import conclude
from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.facts import gather
from eha_core.diagnosis.hypotheses import candidates
from eha_core.diagnosis.joint import join
from eha_core.diagnosis.locate import locate
from eha_core.diagnosis.observation import observe, reaching
from eha_core.diagnosis.parallel import side_by_side
from eha_core.diagnosis.result import Diagnosis
from eha_core.diagnosis.sets import with_sets
from eha_core.diagnosis.tournament import compete, from_every_start
from eha_core.diagnosis.unknown import recover
from eha_core.diagnosis.verdict import decide
from eha_core.recording import Recording

Progress = Callable[[str], None]


def examine(recording: Recording, nominal: Mapping[str, float], progress: Progress = lambda _: None) -> Evidence:
    """Run the stages up to the decision. Raises RecordingError where the recording cannot be used."""
    progress("reading and aligning")
    observation, nominal = reaching(observe(recording), nominal)
    progress("calibrating the nominal equations")
    observation, calibration = calibrate_but_for_its_end(observation, nominal)
    facts = gather(observation, calibration.shooting, calibration.fitted)
    models = (calibration.fitted, calibration.nominal)
    alternatives = tuple(balances(observation, calibration.shooting, model) for model in models)
    equations = least(alternatives)
    able = candidates(observation)
    tournament = compete(calibration.problem, calibration.fitted, able, facts, progress)
    calibration, tournament = with_sets(calibration, tournament, able, facts, progress)
    restarted = from_every_start(calibration.problem, tournament, progress)
    if restarted is not tournament:
        calibration, tournament = with_sets(calibration, restarted, able, facts, progress)
    recovery = recover(calibration.problem, tournament, facts, progress)
    decision = decide(calibration, nominal, tournament, recovery)
    location = locate(calibration, tournament.nominal.fit, facts, tournament, equations)
    return Evidence(
        observation, nominal, calibration, facts, equations, alternatives, tournament, recovery, decision, location
    )


def diagnose(recording: Recording, nominal: Mapping[str, float], progress: Progress = lambda _: None) -> Diagnosis:
    """Say whether the nominal plant explains the recording, and what it leaves out if it does not."""
    return diagnose_together([recording], nominal, progress)


def diagnose_together(
    recordings: Sequence[Recording], nominal: Mapping[str, float], progress: Progress = lambda _: None, jobs: int = 2
) -> Diagnosis:
    """The joint verdict on recordings of one rig; the story is told on the one that tells most."""
    # the simulations share the cores; a linear-algebra library that spins threads of its own only takes them away
    with threadpool_limits(1), side_by_side(jobs):
        evidences = [examine(recording, nominal, progress) for recording in recordings]
        joined = join(evidences)
        chosen = next(
            one
            for one, evidence in zip(recordings, evidences, strict=True)
            if evidence.observation is joined.observation
        )
        return conclude(chosen, joined, progress)
