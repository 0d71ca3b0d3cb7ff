"""A pump of fixed displacement with its relief valve; a valve switched by sign connects it to one chamber, the other to
the tank.

Equation: the line between pump and valve holds the oil V_l: V_l / beta P_l' = D |n| - C_p (P_l - P_r)
- G_r max(P_l - P_s, 0) - K_b b sqrt(P_l - P_r) - q. The spool y follows the sign s of the signal by (2):
y'' + 2 xi w y' + w^2 y = w^2 s. With the overlap o the open ports' share is max(|y| - o, 0) / (1 - o), that of the way
from the pump to the tank b = max(1 - |y| / o, 0). Through the ports flow q = K_t share sqrt(P_l - P) into the chamber
at P and K_t share sqrt(P' - P_r) out of the other into the tank. In the middle both are shut, and the pump gives its
oil to the tank, or with K_b = 0 (a closed centre) to the relief valve.
Sign: a valve signal above zero fills chamber A, one below zero chamber B; where no valve signal is given, the sign of
the pump's speed decides.
Validity: a valve with four equal edges; no check valves that let a chamber suck from the tank, or keep oil from flowing
back to the pump.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapters 4 (pump displacement, leakage and relief valve)
and 5 (four-way valves).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED
from eha_core.parameter import Parameter
from eha_core.plant.equations import orifice_root
from eha_core.plant.parts.declaration import Source
from eha_core.plant.scheme import port_flows

PART = Source(
    summary="a pump whose flow a valve switches by sign",
    uses=("return_pressure",),
    parameters=(
        Parameter(
            name="supply_pressure", symbol="P_s", unit="Pa", nominal=2.1e7, lower=1e5, upper=1e8,
            meaning="pressure at which the pump's relief valve opens", source=ASSUMED,
            typical=2.1e7, logarithmic=True,
        ),
        Parameter(
            name="pump_displacement", symbol="D", unit="m^3/rad", nominal=1e-6, lower=1e-9, upper=1e-3,
            meaning="what the pump delivers per radian", source=ASSUMED,
            typical=1e-6, logarithmic=True,
        ),
        Parameter(
            name="pump_leakage", symbol="C_p", unit="m^3/(s Pa)", nominal=1e-13, lower=0.0, upper=1e-7,
            meaning="laminar leakage of the pump", source=ASSUMED,
            typical=1e-13,
        ),
        Parameter(
            name="relief_gain", symbol="G_r", unit="m^3/(s Pa)", nominal=1e-9, lower=1e-13, upper=1e-5,
            meaning="flow of the relief valve past its setting", source=ASSUMED,
            typical=1e-9, logarithmic=True,
        ),
        Parameter(
            name="tank_gain", symbol="K_t", unit="m^(7/2) kg^(-1/2)", nominal=5e-7, lower=1e-10, upper=1e-2,
            meaning="flow of an open port of the valve, from the pump and to the tank alike", source=ASSUMED,
            typical=5e-7, logarithmic=True,
        ),
        Parameter(
            name="switching_frequency", symbol="omega", unit="rad/s", nominal=100.0, lower=5.0, upper=6000.0,
            meaning="natural frequency of the valve's spool",
            source=ASSUMED, typical=100.0, logarithmic=True,
        ),
        Parameter(
            name="switching_damping", symbol="xi", unit="-", nominal=1.0, lower=0.05, upper=20.0,
            meaning="damping ratio of the valve's spool", source=ASSUMED,
            typical=1.0, logarithmic=True,
        ),
        Parameter(
            name="valve_overlap", symbol="o", unit="-", nominal=0.1, lower=0.0, upper=0.9,
            meaning="share of the spool's way on which the ports are still shut",
            source=ASSUMED, typical=0.1,
        ),
        Parameter(
            name="bypass_gain", symbol="K_b", unit="m^(7/2) kg^(-1/2)", nominal=0.0, lower=0.0, upper=1e-2,
            meaning="flow from the pump to the tank in the valve's middle position; 0: a closed centre", source=ASSUMED,
            typical=5e-7,
        ),
        Parameter(
            name="pump_line_volume", symbol="V_l", unit="m^3", nominal=5e-5, lower=1e-7, upper=1.0,
            meaning="oil between pump and valve", source=ASSUMED,
            typical=5e-5, logarithmic=True,
        ),
    ),
    inputs=("pump_speed",),
    optional=("voltage_command",),
    hides=("voltage", "current", "spool_position", "spool_velocity"),
    idle=True,
    switched=("switching_damping", "switching_frequency"),
    line=True,
    held=("relief_gain",),
    spread={
        "pump_displacement": (0.3, 2.0),
        "pump_leakage": (10.0, 0.0),
        "switching_frequency": (1.0, 20.0),
        "switching_damping": (0.7, 10.0),
        "valve_overlap": (2.0, 0.0),
        "bypass_gain": (10.0, 0.0),
        "pump_line_volume": (1.5, 100.0),
    },
)  # fmt: skip


@inlined
def feed(
    spool_position, first, second, line_pressure, supply_pressure, return_pressure, pump_displacement, pump_leakage,
    relief_gain, tank_gain, switching_frequency, switching_damping, valve_overlap, bypass_gain, pump_line_volume,
):  # fmt: skip
    """What the pump gives into its line, how much less it is for each pascal there, and the line's volume."""
    over, above = line_pressure - supply_pressure, line_pressure - return_pressure
    relief = relief_gain if over > 0.0 else 0.0
    lost = pump_leakage
    if bypass_gain > 0.0 and abs(spool_position) < valve_overlap:
        root, slope = orifice_root(above)
        lost += bypass_gain * (1.0 - abs(spool_position) / valve_overlap) * (root / above if above > 1.0 else slope)
    return pump_displacement * abs(first) - lost * above - relief * over, lost + relief, pump_line_volume


@inlined
def contribution(
    opening, gain, conductance, first, second, pressure_a, pressure_b, supply_pressure, return_pressure,
    pump_displacement, pump_leakage, relief_gain, tank_gain, switching_frequency, switching_damping, valve_overlap,
    bypass_gain, pump_line_volume,
):  # fmt: skip
    """The line's pressure at one port, the tank's at the other, through as much of the ports as the spool opens."""
    share = max(abs(opening) - valve_overlap, 0.0) / (1.0 - valve_overlap)
    share = share if opening >= 0.0 else -share
    return port_flows(share, tank_gain, 0.0, pressure_a, pressure_b, supply_pressure, return_pressure)
