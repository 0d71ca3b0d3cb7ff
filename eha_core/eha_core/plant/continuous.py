"""The nominal plant in continuous time, for other integrators and for analysis: its derivative."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eha_core.effects import effects
from eha_core.errors import ParameterError
from eha_core.parameters import NOMINAL, changed, nominal_values
from eha_core.plant.equations import rates
from eha_core.plant.state import State

ONLY_IN_THE_STEP = "atmospheric_pressure"
"""The nominal parameter that equations (1) to (10) do not contain: the step boils the oil at zero absolute pressure."""


def derivatives(state: State | Sequence[float], voltage: float, parameters: Mapping[str, float] | None = None) -> State:
    """The time derivative of the state by the nominal equations (1) to (10): each field in its unit per second.

    The equations hold between the stroke's ends and have none of the catalogue's effects. The current's saturation is
    in them: at I_sat it rises no further.

    Args:
        state: a `State`, or its seven numbers in that order.
        voltage: at the coil [V].
        parameters: what differs from the nominal parameters, by name, in SI units.

    Raises ParameterError for a state beyond the stroke, parameters that make no plant, or an effect switched on.

    >>> derivatives(State(0.0, 0.0, 0.0, 0.0, 0.0, 1.05e7, 1.05e7), voltage=0.59).current
    1.0
    """
    return nominal_rates(State(*state), voltage, nominal_equations(parameters))


def nominal_equations(parameters: Mapping[str, float] | None) -> dict[str, float]:
    """The parameters of equations (1) to (10), checked; ParameterError as `derivatives` says."""
    values = changed(nominal_values(), parameters or {})
    acting = [effect.id for effect in effects() if effect.is_active(values)]
    if acting:
        raise ParameterError(f"{acting[0]} is switched on, and equations (1) to (10) have no effects; leave it out")
    return {row.name: values[row.name] for row in NOMINAL if row.name != ONLY_IN_THE_STEP}


def nominal_rates(state: State, voltage: float, values: Mapping[str, float]) -> State:
    """`derivatives` with the parameters that `nominal_equations` gives."""
    stroke = values["actuator_displacement"]
    if not abs(state.position) <= stroke:
        raise ParameterError(
            f"position = {state.position:g} m is outside the stroke of +-{stroke:g} m, where the equations end; "
            "`Plant` simulates the ends"
        )
    return State(*rates(*state, voltage, **values))
