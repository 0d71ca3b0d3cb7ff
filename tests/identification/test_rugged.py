"""Where friction sticks the objective is rugged; a fit above the noise looks for its way over wider steps."""

from dataclasses import replace

from made import recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.search.candidates import with_effects
from eha_core.effects import effects
from eha_core.identification import fit as fitting
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

LAWS = [effect for effect in effects() if effect.id in ("constant_load", "stribeck_friction")]
PLANTED = {
    "constant_load.force": 300.0, "stribeck_friction.force": 400.0, "stribeck_friction.static_force": 580.0,
    "stribeck_friction.stribeck_velocity": 0.03,
}  # fmt: skip
GUESSES = ((250.0, 380.0, 0.04), (100.0, 200.0, 0.1), (800.0, 900.0, 0.02))
"""N, N, m/s: sliding, static, and the speed over which one falls to the other."""


def test_a_fit_that_rests_between_two_kinks_is_led_on_to_the_noise(monkeypatch):
    calibration = calibrate([observe(recorded(PLANTED, duration=6.0))], NominalModel(nominal_values()), 2e-4)
    noise = [one.noise for one in calibration.shorter[0].samplings]  # what a model that is far off leaves seems noisier
    problem = replace(calibration.problem, shooting=fitting.with_noise(calibration.problem.shooting, noise))

    def rests_at(sliding: float, static: float, speed: float) -> float:
        guess = dict(zip(PLANTED, (200.0, sliding, static, speed), strict=True))
        values = {**nominal_values(), **guess}
        found = fitting.fit(problem, values, with_effects(calibration.fitted.free, LAWS, values), iterations=60)
        return found.data / found.count

    led = [rests_at(*guess) for guess in GUESSES]
    monkeypatch.setattr(fitting, "WIDER", ())
    stuck = [rests_at(*guess) for guess in GUESSES]
    assert min(led) < fitting.NOISE < 4.0 < min(stuck)
    assert all(there <= here for there, here in zip(led, stuck, strict=True))
