"""A pump of fixed displacement with its relief valve; a valve switched by sign connects it to one chamber, the other to
the tank.

Equation: the pump gives D |n| - C_p (P - P_r) - G_r max(P - P_s, 0) into the chamber at P that the valve connects it
to; out of the other chamber at P' flows K_t sqrt(P' - P_r) into the tank. In the middle position both ports are shut
and the pump idles.
Sign: a valve signal above zero fills chamber A, one below zero chamber B; where no valve signal is given, the sign of
the pump's speed decides.
Validity: a valve that switches fast against the piston's motion and whose open port costs the pump little pressure; no
check valves that let a chamber suck from the tank.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 4 (pump displacement, leakage and relief valve).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED
from eha_core.parameter import Parameter
from eha_core.plant.equations import orifice_root
from eha_core.plant.parts.declaration import Source

PART = Source(
    summary="a pump whose flow a valve switches by sign",
    uses=("return_pressure",),
    parameters=(
        Parameter(
            "supply_pressure", "P_s", "Pa", 2.1e7, 1e5, 1e8, "pressure at which the pump's relief valve opens", ASSUMED,
            typical=2.1e7, logarithmic=True,
        ),
        Parameter(
            "pump_displacement", "D", "m^3/rad", 1e-6, 1e-9, 1e-3, "what the pump delivers per radian", ASSUMED,
            typical=1e-6, logarithmic=True,
        ),
        Parameter(
            "pump_leakage", "C_p", "m^3/(s Pa)", 1e-13, 0.0, 1e-7, "laminar leakage of the pump", ASSUMED,
            typical=1e-13,
        ),
        Parameter(
            "relief_gain", "G_r", "m^3/(s Pa)", 1e-9, 1e-13, 1e-5, "flow of the relief valve past its setting", ASSUMED,
            typical=1e-9, logarithmic=True,
        ),
        Parameter(
            "tank_gain", "K_t", "m^(7/2) kg^(-1/2)", 5e-7, 1e-10, 1e-2, "flow of the open port to the tank", ASSUMED,
            typical=5e-7, logarithmic=True,
        ),
    ),
    inputs=("pump_speed",),
    optional=("voltage_command",),
    hides=("voltage", "current", "spool_position", "spool_velocity"),
    idle=True,
)  # fmt: skip


@inlined
def delivery(delivered, pressure, relief_pressure, return_pressure, leakage, relief_gain):
    """What reaches the connected chamber, and how much less it is for each pascal there."""
    over = pressure - relief_pressure
    flow = delivered - leakage * (pressure - return_pressure)
    if over > 0.0:
        return flow - relief_gain * over, leakage + relief_gain
    return flow, leakage


@inlined
def contribution(
    opening, gain, conductance, first, second, pressure_a, pressure_b, supply_pressure, return_pressure,
    pump_displacement, pump_leakage, relief_gain, tank_gain,
):  # fmt: skip
    """The pump into one chamber, the other into the tank."""
    delivered = pump_displacement * abs(first)
    if second > 0.0:
        flow_a, fall_a = delivery(delivered, pressure_a, supply_pressure, return_pressure, pump_leakage, relief_gain)
        root, slope = orifice_root(pressure_b - return_pressure)
        return flow_a, tank_gain * root, fall_a, tank_gain * slope, flow_a, tank_gain * root
    if second < 0.0:
        flow_b, fall_b = delivery(delivered, pressure_b, supply_pressure, return_pressure, pump_leakage, relief_gain)
        root, slope = orifice_root(pressure_a - return_pressure)
        return -tank_gain * root, -flow_b, tank_gain * slope, fall_b, flow_b, tank_gain * root
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
