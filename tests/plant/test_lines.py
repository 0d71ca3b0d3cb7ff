"""Supply and return line: what they give and take is what flows through the ports that are open."""

import numpy as np
import pytest

from eha_core.parameters import changed, nominal_values
from eha_core.plant import Plant

RESISTANCE = 2e10
SLOW = {"supply_pressure_droop.resistance": RESISTANCE, "supply_pressure_droop.time_constant": 1e-3}


def settled(parameters: dict[str, float], voltage: float):
    """The last row of a quarter second under a steady voltage, which leaves the lines at rest."""
    return Plant(changed(nominal_values(), {**SLOW, **parameters}), 1e-4).run(np.full(2500, voltage))


@pytest.mark.parametrize("offset", [-3e-4, 3e-4])
def test_with_the_valve_off_its_null_the_open_port_draws_whichever_side_the_spool_is_on(offset: float) -> None:
    """The spool stands a little to the other side of null than the opening, which the offset decides."""
    rows = settled({"valve_null_offset.offset": offset}, -0.2 * offset * nominal_values()["coil_resistance"])
    assert np.sign(rows.spool_position[-1]) == -np.sign(offset)
    drawn = rows.flow_a[-1] if offset > 0.0 else -rows.flow_b[-1]
    assert drawn > 0.0
    assert 2.1e7 - rows.supply_pressure[-1] == pytest.approx(RESISTANCE * drawn, rel=1e-3)


def test_leakage_at_null_is_drawn_from_the_supply_though_it_feeds_neither_chamber() -> None:
    """At rest with both chambers at half the supply, each port passes conductance times half of it to the return."""
    leaking = {"valve_null_leakage.conductance": 2e-12, "valve_null_leakage.width": 1e-3}
    rows = settled(leaking, 0.0)
    supply = rows.supply_pressure[-1]
    assert rows.pressure_a[-1] == pytest.approx(0.5 * supply, rel=1e-3)
    assert 2.1e7 - supply == pytest.approx(RESISTANCE * 2.0 * 2e-12 * 0.5 * supply, rel=1e-3)
