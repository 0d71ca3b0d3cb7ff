"""The words in column names of loggers, in English, German, French and Spanish, and their meanings.

Words are in small ASCII letters: `ae` for a German umlaut, no accents.
"""

from __future__ import annotations


def _of(**words: str) -> dict[str, str]:
    return {word: meaning for meaning, several in words.items() for word in several.split()}


def _all(words: str) -> frozenset[str]:
    return frozenset(words.split())


QUANTITIES = _of(
    time="time timestamp stamp zeit zeitstempel uhrzeit clock epoch date datum datetime temps tiempo elapsed seconds"
    " second sekunden xvalue tout",
    pressure="pressure press pres prs pressures druck druecke pression presion pressione fluidpressure chamberpressure",
    position="position pos posn stroke displacement disp displ weg hub laser lvdt extension travel posicion course"
    " hubweg kolbenweg elongation lage",
    velocity="velocity vel speed geschwindigkeit geschw vitesse velocidad xdot xd",
    force="force kraft effort forza fuerza loadcell kraftmessdose fx",
    flow="flow flowrate volumenstrom durchfluss debit caudal",
    voltage="voltage volt volts spannung stellspannung steuerspannung tension uvalve ucmd",
    current="current strom courant corriente amps amperage",
    spool="spool schieber tiroir xv",
    command="cmd cmds command commands ctrl control ansteuerung stellgroesse stellsignal duty pwm",
    angle="angle winkel theta phi angulo alpha rotation",
    torque="torque drehmoment couple",
    turning="rpm drehzahl turns",
    other="temp temperature temperatur acc accel acceleration beschleunigung power leistung level fuellstand humidity"
    " viscosity vibration status state mode error err fehler alarm flag enable enabled",
)
LETTERS = {
    "t": "time", "p": "pressure", "x": "position", "v": "velocity", "f": "force", "q": "flow", "u": "voltage",
    "i": "current", "n": "turning",
}  # fmt: skip
"""Symbols; a word takes precedence over them."""
OBJECTS = _of(
    valve="valve ventil valves servo servovalve servoventil proportional solenoid coil spule magnet vanne valvula prop",
    cylinder="cylinder zylinder zyl cyl actuator aktor ram jack verin cilindro piston kolben",
    pump="pump pumpe pumps pompe motor",
    supply="supply versorgung battery batterie sys system source netz feed speise",
    tank="tank return ruecklauf reservoir drain sump",
)
SIDES = _of(
    a="a 1 head headside cap capend blind blindend bore boden bodenseite kolbenseite kolbenseitig bottom",
    b="b 2 rod rodside rodend annulus ring ringseite stange stangenseite kolbenstange stangenseitig gap",
    supply="s 0",
)
WANTED = _all(
    "ref reference des desired target set setpoint soll sollwert demand demanded consigne goal planned wanted"
)
"""Words of set points, which are not measurements."""
DENIED = _all(
    "err error fehler abweichung deviation diff difference delta dp max min limit limits alarm status flag enable sim"
    " simulated model modelled est estimated predicted temp temperature temperatur pilot accumulator speicher"
)
"""Words of derived quantities, and of other parts than the cylinder."""
MEASURED = _all("position velocity force pressure flow angle torque")
"""Measured quantities, whose command is a set point."""
REFERENCES = _of(
    absolute="abs absolute absolut absolutdruck", gauge="gauge rel relative relativ ueberdruck relativdruck"
)
"""Words of a pressure's reference."""
FILLERS = _all(
    "main plot data value sensor measured meas messwert ist istwert actual act fbk feedback signal sig ch chan"
    " channel ai"
    " ain analog in input io out output hyd hydraulic rig run test log gvl plc global var st model root chamber"
    " kammer"
    " side seite port line axis ax axial exp no nr raw filt filtered filter the of at on daq dev device mod module"
    " group"
    " untitled ave avg average mean mittel mittelwert rms abs rel gauge absolute interface interfaces controller"
    " lbl y z d r lr fl l j joint states oel oil"
)
"""Words without a meaning for the measured quantity."""
FIRST = _all(
    "up extend extending a 1 out open plus pos positive forward fwd heben ausfahren auf raise lift vor right rechts"
)
SECOND = _all(
    "down retract retracting b 2 in close closed minus neg negative backward back bwd rev reverse senken einfahren ab"
    " lower zurueck left links"
)
"""Words of a valve's two one-sided commands; the first moves the piston out."""
INDEX = _all(
    "sample samples index idx nr no num number count counter row rows point points scan record lfd nummer seq"
    " sequence n k"
    " i line zeile messpunkt tick ticks"
)
"""Words of columns that count rows."""
TANK_LETTERS, SUPPLY_LETTERS = _all("t r"), _all("p s 0")
"""Letters after a pressure: `pT` and `pP` are those of the tank and the pump."""
NUMBERED = _all(
    "ai ain ch chan channel analog input in group plot sensor sig signal dev mod module slot card"
    " cyl cylinder zyl zylinder actuator aktor axis achse ram jack rig valve ventil pump pumpe motor joint"
)
"""Words after which a number only counts."""
PAIRS = _all("loadcell xdot xvalue xv flowrate headside rodside rodend capend blindend")
"""Words that are also written as two, such as `load cell`."""
EVERY = (QUANTITIES, LETTERS, OBJECTS, SIDES, WANTED, REFERENCES, FILLERS, FIRST, SECOND)
"""All known words."""
COMPOUNDED = (QUANTITIES, OBJECTS, SIDES)
"""The second words of compounds such as `kolbendruck`."""
STEMS = (*COMPOUNDED, WANTED, DENIED)
"""The first words of compounds."""
