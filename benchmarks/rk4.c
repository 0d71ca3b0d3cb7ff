/* The nominal actuator by classical RK4 at a fixed step: equations (1) to (10), a voltage held over each step.
   The state is current, spool position and velocity, piston position and velocity, pressures A and B. */
#include <math.h>

enum { CURRENT, SPOOL, SPOOL_RATE, POSITION, VELOCITY, PRESSURE_A, PRESSURE_B, STATES };

static const double coil_resistance = 100.0, coil_inductance = 0.59, saturation_current = 0.02;
static const double damping_ratio = 0.48, natural_frequency = 543.0, valve_gain = 2.38e-5;
static const double bulk_modulus = 1.4e9, supply_pressure = 2.1e7, return_pressure = 0.0;
static const double spring_stiffness = 10.0, half_stroke = 0.1, area = 645e-6, mass = 9.0, damping = 2000.0;
static const double internal_leakage = 1e-12, external_leakage = 0.0, line_volume = 1e-5;

static inline double signed_root(double difference) {
    return copysign(sqrt(fabs(difference)), difference);
}

static inline void derivative(const double *restrict s, double voltage, double *restrict rate) {
    double flow_a, flow_b;
    if (s[SPOOL] >= 0.0) {
        flow_a = valve_gain * s[SPOOL] * signed_root(supply_pressure - s[PRESSURE_A]);
        flow_b = valve_gain * s[SPOOL] * signed_root(s[PRESSURE_B] - return_pressure);
    } else {
        flow_a = valve_gain * s[SPOOL] * signed_root(s[PRESSURE_A] - return_pressure);
        flow_b = valve_gain * s[SPOOL] * signed_root(supply_pressure - s[PRESSURE_B]);
    }
    const double past_the_seal = internal_leakage * (s[PRESSURE_A] - s[PRESSURE_B]);
    const double swept = area * s[VELOCITY];
    rate[CURRENT] = (voltage - coil_resistance * s[CURRENT]) / coil_inductance;
    rate[SPOOL] = s[SPOOL_RATE];
    rate[SPOOL_RATE] = natural_frequency * natural_frequency * (s[CURRENT] - s[SPOOL])
                       - 2.0 * damping_ratio * natural_frequency * s[SPOOL_RATE];
    rate[POSITION] = s[VELOCITY];
    rate[VELOCITY] = (area * (s[PRESSURE_A] - s[PRESSURE_B]) - damping * s[VELOCITY]
                      - spring_stiffness * s[POSITION]) / mass;
    rate[PRESSURE_A] = bulk_modulus / (line_volume + area * (half_stroke + s[POSITION]))
                       * (flow_a - past_the_seal - external_leakage * s[PRESSURE_A] - swept);
    rate[PRESSURE_B] = bulk_modulus / (line_volume + area * (half_stroke - s[POSITION]))
                       * (swept - flow_b + past_the_seal - external_leakage * s[PRESSURE_B]);
}

/* Take one step for each of `count` voltages, from rest, and keep the state after every `every`-th in `rows`. */
void simulate(const double *voltages, long count, double step, long every, double *rows) {
    double s[STATES] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.5 * supply_pressure, 0.5 * supply_pressure};
    double k1[STATES], k2[STATES], k3[STATES], k4[STATES], probe[STATES];
    for (long i = 0; i < count; i++) {
        derivative(s, voltages[i], k1);
        for (int j = 0; j < STATES; j++) probe[j] = s[j] + 0.5 * step * k1[j];
        derivative(probe, voltages[i], k2);
        for (int j = 0; j < STATES; j++) probe[j] = s[j] + 0.5 * step * k2[j];
        derivative(probe, voltages[i], k3);
        for (int j = 0; j < STATES; j++) probe[j] = s[j] + step * k3[j];
        derivative(probe, voltages[i], k4);
        for (int j = 0; j < STATES; j++) s[j] += step / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j]);
        s[CURRENT] = fmin(fmax(s[CURRENT], -saturation_current), saturation_current);
        if ((i + 1) % every == 0)
            for (int j = 0; j < STATES; j++) rows[(i + 1) / every * STATES - STATES + j] = s[j];
    }
}
