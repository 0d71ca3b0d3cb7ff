"""Sentences about the errors, each written only where the figures support it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.result import ChannelFit, Diagnosis
from eha_core.quantities import quantity
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.wording import channel_title, listed

NOISE_ALONE = 1.1
"""Times the noise below which an error counts as noise: the noise is known within some per cent at best (assumed)."""

WHITE = 3.5
"""Standard deviations that the largest of 19 autocorrelations of white noise exceeds once in a hundred channels."""

VIOLATED = 1.5
"""Mean square of an equation's residual, in units of its noise, above which the equation does not hold (assumed)."""


def judged(diagnosis: Diagnosis) -> Mapping[str, ChannelFit]:
    """The errors on held-out data; on all data where none were held out."""
    return diagnosis.held_out or diagnosis.training


def largest_ratio(diagnosis: Diagnosis) -> float:
    """The largest error of the final model, in units of its channel's noise."""
    return max(_ratios(diagnosis), default=float("nan"))


def _ratios(diagnosis: Diagnosis) -> list[float]:
    """The error of the final model in each channel where it is known, in units of the channel's noise."""
    return [fit.rmse_after / fit.noise for fit in judged(diagnosis).values() if np.isfinite(fit.rmse_after)]


def coloured(diagnosis: Diagnosis) -> list[str]:
    """The channels whose residual is not white."""
    return [name for name, largest in diagnosis.whiteness.items() if largest > WHITE]


def is_noise(diagnosis: Diagnosis) -> bool:
    """Whether the final model's residual is as small as the noise, and white."""
    return largest_ratio(diagnosis) < NOISE_ALONE and not coloured(diagnosis)


def residual_headline(diagnosis: Diagnosis) -> str:
    """The final model's residual, as a headline."""
    ratio = largest_ratio(diagnosis)
    if is_noise(diagnosis):
        return "The residual is noise"
    if not ratio >= NOISE_ALONE:
        return f"The residual is as small as the noise, but not white in {_titles(coloured(diagnosis))}"
    return f"The residual is up to {ratio:.1f} times the noise"


def residual_in_words(diagnosis: Diagnosis) -> str:
    """The size of the final model's residual, and whether it is white; empty where no error is known."""
    ratios = _ratios(diagnosis)
    if not ratios or not diagnosis.whiteness:
        return ""
    least, most = (f"{end:.2f}" for end in (min(ratios), max(ratios)))
    size = f"{least} to {most} times the noise" if least != most else f"{most} times the noise"
    largest = max(diagnosis.whiteness.values())
    colour = f"not white in {_titles(coloured(diagnosis))}" if coloured(diagnosis) else "white"
    return (
        f"{size[:1].upper()}{size[1:]}, and {colour}: largest autocorrelation {largest:.1f} standard deviations (white"
        f" noise stays below {WHITE:g})."
    )


def _titles(names: list[str]) -> str:
    return listed([channel_title(name) for name in names])


def equations_hold(diagnosis: Diagnosis) -> bool:
    """Whether the residual of every equation evaluated with measured channels is noise."""
    residuals = [residual for _, residual in diagnosis.pictures.equations.values() if len(residual)]
    return all(float(np.mean(residual**2)) < VIOLATED for residual in residuals)


def representative_channel(diagnosis: Diagnosis) -> str:
    """The channel whose error represents all: the position, or else the first; empty if its error is not known."""
    fits = judged(diagnosis)
    name = _leading_channel(fits)
    return name if name and np.isfinite(fits[name].rmse_after) else ""


def _leading_channel(fits: Mapping[str, ChannelFit]) -> str:
    """The position, or else the first channel; empty without any."""
    return "position" if "position" in fits else next(iter(fits), "")


def calibration_alone(diagnosis: Diagnosis) -> str:
    """The error of the position, or else of the first channel, before and after calibration; empty if not known."""
    fits = judged(diagnosis)
    name = _leading_channel(fits)
    if not name or not np.isfinite(fits[name].rmse_calibrated):
        return ""
    fit, unit = fits[name], CHANNEL_KINDS[name].unit
    before, after, noise = (quantity(value, unit) for value in (fit.rmse_before, fit.rmse_calibrated, fit.noise))
    title = channel_title(name)
    return f"Calibration alone takes the error of the {title} from {before} to {after} RMS; the noise is {noise}."


def improvement(diagnosis: Diagnosis) -> str:
    """The error of the representative channel without and with the added physics; empty if not known."""
    name = representative_channel(diagnosis)
    if not name:
        return ""
    fit, unit = judged(diagnosis)[name], CHANNEL_KINDS[name].unit
    where = "On held-out data, the" if diagnosis.held_out else "The"
    before, after = quantity(fit.rmse_before, unit), quantity(fit.rmse_after, unit)
    noise = quantity(fit.noise, unit)
    if before == after:
        change = f"is {after}, as before"
    else:
        change = f"{'falls' if fit.rmse_after < fit.rmse_before else 'goes'} from {before} to {after}"
    ending = ": that is its noise" if _at_noise(diagnosis, name, fit) else f"; its noise is {noise}"
    return f"{where} {channel_title(name)}'s RMS error {change}{ending}."


def _at_noise(diagnosis: Diagnosis, name: str, fit: ChannelFit) -> bool:
    close = 1.0 / NOISE_ALONE < fit.rmse_after / fit.noise < NOISE_ALONE
    return close and name not in coloured(diagnosis)


def noise_floor(diagnosis: Diagnosis) -> str:
    """What the estimated noise means: it is a lower limit only if no model is below it."""
    below = [name for name, fit in judged(diagnosis).items() if fit.rmse_after * NOISE_ALONE < fit.noise]
    if not below:
        return "Each channel's noise is estimated from the data themselves; no model can be expected to come closer."
    return (
        "Each channel's noise is estimated from the data themselves, and not taken as less than a good sensor's;"
        f" the final model is closer than that to {_titles(below)}."
    )
