/* The voltage that moves a diagnosed actuator along a motion: friction, overlap, null offset, leakage and the valve's
   characteristic compensated for. C99, needs math.h alone; no allocation, no global state.

   SI units. The position is from mid stroke; positive motion extends. Pressures are above the return line's reference.
   Limit the voltage to what the drive takes. */
#ifndef EHA_CONTROLLER_H
#define EHA_CONTROLLER_H

#ifdef __cplusplus
extern "C" {
#endif

/* The supply pressure that was exported [Pa], for where none is measured. */
extern const double eha_supply_pressure;

/* Volts that hold a motion when pressures, spool and coil have settled.
   position [m], velocity [m/s], acceleration [m/s^2], supply_pressure [Pa] */
double eha_voltage(double position, double velocity, double acceleration, double supply_pressure);

/* What eha_follow remembers of the motion. */
typedef struct {
    int started; /* 0 before the first call */
    double velocity, force, spool;
} eha_motion;

/* Volts for a motion that is given sample by sample, with the lags of oil, spool, coil and command; accelerations and
   rates are backward differences. Start with `eha_motion motion = {0};`.
   position [m], velocity [m/s], period: time since the last call, above 0 [s], supply_pressure [Pa] */
double eha_follow(eha_motion *motion, double position, double velocity, double period, double supply_pressure);

/* Viscous and dry friction against a velocity [m/s], smooth about zero [N]. */
double eha_friction(double velocity);

/* What the pressures have to exert, A_p P1 - A_b P2 [N]: position [m], velocity [m/s], acceleration [m/s^2]. */
double eha_force(double position, double velocity, double acceleration);

/* Chamber pressures in steady motion [Pa]: velocity [m/s], force [N], supply_pressure [Pa]. */
void eha_pressures(double velocity, double force, double supply_pressure, double *pressure_a, double *pressure_b);

/* Flow into port A and out of port B [m^3/s]: velocity [m/s], force [N], force_rate [N/s], supply_pressure [Pa]. */
void eha_flows(double velocity, double force, double force_rate, double supply_pressure, double *flow_a,
               double *flow_b);

/* The valve's inverse: spool position [A-equivalent], whose settled voltage is the coil's resistance times it, for
   flow_a into port A and flow_b out of port B [m^3/s] under a pressure force [N] at supply_pressure [Pa]. */
double eha_spool(double flow_a, double flow_b, double force, double supply_pressure);

#ifdef __cplusplus
}
#endif
#endif
