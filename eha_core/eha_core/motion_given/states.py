"""Friction laws with a state of their own, driven by the measured motion; compiled."""

from __future__ import annotations

from math import copysign, exp, sqrt

import numpy as np

from eha_core.compiled import compiled


@compiled
def bouc_wen(velocity, step, distance, speed):  # type: ignore[no-untyped-def]
    """Bouc-Wen's state between -1 and 1, of friction that creeps: z' = |v| (v / sqrt(v^2 + speed^2) - z) / distance.

    Without creep (speed 0) it is Bouc and Wen's law z' = A v - beta |v| |z|^(n-1) z - gamma v |z|^n with n = 1 and
    beta = A, gamma = 0, A = 1 / distance: friction that turns over within the distance after a reversal.
    """
    found = np.empty(len(velocity))
    # what came before is not known: a rig that is moving has been moving before
    state = velocity[0] / sqrt(velocity[0] * velocity[0] + speed * speed)
    found[0] = state
    for index in range(1, len(velocity)):
        mean = 0.5 * (velocity[index - 1] + velocity[index])
        level = mean / sqrt(mean * mean + speed * speed)
        state = level + (state - level) * exp(-abs(mean) * step / distance)
        found[index] = state
    return found


@compiled
def direction(velocity, moving):  # type: ignore[no-untyped-def]
    """-1 or 1 by the direction of motion; where it is not certain, in proportion to the speed."""
    found = np.empty(len(velocity))
    for index in range(len(velocity)):
        size = abs(velocity[index])
        found[index] = copysign(1.0, velocity[index]) if size > moving else velocity[index] / moving
    return found
