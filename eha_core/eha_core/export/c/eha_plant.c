/* What `eha_core.plant.simulator.Plant` does around the compiled step, in the same order and arithmetic. */
#include "eha_plant.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "eha_tables.h"

#define COUNT(table) ((int)(sizeof(table) / sizeof *(table)))
enum { CHUNK = 128 }; /* steps that the kernel takes in one call */

_Static_assert(sizeof(void *) == 8, "the kernel is made for addresses of 64 bits");

/* in eha_kernel.ll */
int eha_kernel_advance(void **, void **, double *state, double *memory, double *history, int64_t ring,
                       double *parameters, bool *active, double *propagator, double *voltages, int64_t steps,
                       double step_size, double *row);

/* exp(system) by its series, after halving it until that converges fast. */
static void exponential(double system[4][4], double result[4][4]) {
    double size = 0.0, term[4][4] = {{0}}, next[4][4];
    int halvings = 0;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) size = fmax(size, fabs(system[i][j]));
    for (; size > 0.05; size *= 0.5) halvings++;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) term[i][j] = result[i][j] = i == j;
    for (int order = 1; order <= 12; order++) {
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) {
                next[i][j] = 0.0;
                for (int k = 0; k < 4; k++) next[i][j] += term[i][k] * ldexp(system[k][j], -halvings) / order;
            }
        memcpy(term, next, sizeof term);
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) result[i][j] += term[i][j];
    }
    for (; halvings > 0; halvings--) {
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) {
                next[i][j] = 0.0;
                for (int k = 0; k < 4; k++) next[i][j] += result[i][k] * result[k][j];
            }
        memcpy(result, next, sizeof next);
    }
}

/* Coil and spool over one step: see `eha_core.plant.simulator.propagator`. The spool's rate is taken over its
   frequency, which keeps the matrix balanced. */
static void propagate(const double *values, double *propagator) {
    double frequency = values[VALUE_VALVE_NATURAL_FREQUENCY] * EHA_STEP_SIZE;
    double rate = values[VALUE_COIL_RESISTANCE] / values[VALUE_COIL_INDUCTANCE] * EHA_STEP_SIZE;
    double scale[2] = {1.0, values[VALUE_VALVE_NATURAL_FREQUENCY]}, response[4][4];
    double system[4][4] = {
        {0.0, frequency, 0.0, 0.0},
        {-frequency, -2.0 * values[VALUE_VALVE_DAMPING_RATIO] * frequency, frequency, frequency},
        {0.0, 0.0, 0.0, 0.0},
        {0.0, 0.0, 0.0, -rate},
    };
    double decayed = -expm1(-rate);
    exponential(system, response);
    propagator[0] = 1.0 - decayed;
    propagator[1] = 1.0 / values[VALUE_COIL_RESISTANCE];
    for (int i = 0; i < 2; i++) {
        double constant = response[i][2], fading = response[i][3], *row = propagator + 2 + 4 * i;
        row[0] = response[i][0] * scale[i];
        row[1] = response[i][1] * scale[i] / scale[1];
        row[2] = (fading - (1.0 - decayed) * constant) / decayed * scale[i];
        row[3] = (constant - fading) / decayed * scale[i];
    }
}

static void start_memory(eha_plant *plant, int effect) {
    for (int slot = 0; slot < COUNT(REMEMBERED); slot++)
        if (REMEMBERED[slot].effect == effect)
            plant->memory[slot] = REMEMBERED[slot].state < 0 ? 0.0 : plant->state[REMEMBERED[slot].state];
}

/* Put changed parameters in force. */
static eha_status settle(eha_plant *plant) {
    static const int valve[] = {VALUE_COIL_RESISTANCE, VALUE_COIL_INDUCTANCE, VALUE_VALVE_DAMPING_RATIO,
                                VALUE_VALVE_NATURAL_FREQUENCY};
    double *values = plant->values, *position = &plant->state[STATE_POSITION];
    double stroke = values[VALUE_ACTUATOR_DISPLACEMENT];
    uint8_t before[EHA_EFFECTS];
    bool as_exported = true;
    if (!plant->changed) return EHA_OK;
    if (values[VALUE_SUPPLY_PRESSURE] <= values[VALUE_RETURN_PRESSURE]) return EHA_NO_PLANT;
    for (int i = 0; i < COUNT(valve); i++) as_exported &= values[valve[i]] == START[valve[i]];
    memcpy(plant->propagator, START_PROPAGATOR, sizeof plant->propagator);
    if (!as_exported) propagate(values, plant->propagator);
    memcpy(before, plant->on, sizeof before);
    memset(plant->on, 0, sizeof plant->on);
    for (int i = 0; i < COUNT(SWITCHES); i++)
        plant->on[SWITCHES[i].effect] |= values[SWITCHES[i].value] != SWITCHES[i].neutral;
    for (int effect = 0; effect < EHA_EFFECTS; effect++) {
        double from = values[VALUE_EFFECTS_FROM], until = values[VALUE_EFFECTS_UNTIL];
        if (ACTS[effect].from >= 0) {
            from = fmax(from, values[ACTS[effect].from]);
            until = fmin(until, values[ACTS[effect].until]);
        }
        plant->from[effect] = (int64_t)rint(from / EHA_STEP_SIZE);
        plant->until[effect] = (int64_t)rint(until / EHA_STEP_SIZE);
        if (plant->on[effect] && !before[effect]) start_memory(plant, effect);
    }
    *position = fmin(fmax(*position, -stroke), stroke);
    plant->changed = 0;
    return EHA_OK;
}

eha_status eha_start(eha_plant *plant) {
    memset(plant, 0, sizeof *plant);
    memcpy(plant->values, START, sizeof START);
    plant->changed = 1;
    return eha_reset(plant, 0.0);
}

eha_status eha_reset(eha_plant *plant, double initial_position) {
    double *values = plant->values, *state = plant->state, *outputs = plant->outputs;
    double supply = values[VALUE_SUPPLY_PRESSURE], back = values[VALUE_RETURN_PRESSURE], total = supply + back;
    double area_a = values[VALUE_PISTON_AREA], area_b = values[VALUE_PISTON_AREA_B];
    double pressure_a = 0.5 * total, pressure_b = 0.5 * total;
    eha_status status = settle(plant);
    if (status != EHA_OK) return status;
    if (!(fabs(initial_position) <= values[VALUE_ACTUATOR_DISPLACEMENT])) return EHA_OUTSIDE_STROKE;
    if (BALANCED) {
        pressure_a = (area_b * total + values[VALUE_SPRING_STIFFNESS] * initial_position) / (area_a + area_b);
        pressure_b = total - pressure_a;
    }
    memset(state, 0, sizeof plant->state);
    memset(plant->history, 0, sizeof plant->history);
    memset(outputs, 0, sizeof plant->outputs);
    state[STATE_SUPPLY_PRESSURE] = outputs[EHA_OUTPUT_SUPPLY_PRESSURE] = supply;
    state[STATE_RETURN_PRESSURE] = outputs[EHA_OUTPUT_RETURN_PRESSURE] = back;
    state[STATE_POSITION] = outputs[EHA_OUTPUT_POSITION] = outputs[EHA_OUTPUT_MEASURED_POSITION] = initial_position;
    state[STATE_PRESSURE_A] = outputs[EHA_OUTPUT_PRESSURE_A] = outputs[EHA_OUTPUT_MEASURED_PRESSURE_A] = pressure_a;
    state[STATE_PRESSURE_B] = outputs[EHA_OUTPUT_PRESSURE_B] = outputs[EHA_OUTPUT_MEASURED_PRESSURE_B] = pressure_b;
    outputs[EHA_OUTPUT_INTERNAL_LEAKAGE] = values[VALUE_INTERNAL_LEAKAGE];
    for (int effect = 0; effect < EHA_EFFECTS; effect++) start_memory(plant, effect);
    plant->steps = 0;
    return EHA_OK;
}

eha_status eha_set(eha_plant *plant, int parameter, double value) {
    if (parameter < 0 || parameter >= EHA_PARAMETERS) return EHA_OUT_OF_RANGE;
    if (!(value >= PARAMETERS[parameter].lower && value <= PARAMETERS[parameter].upper)) return EHA_OUT_OF_RANGE;
    for (int i = 0; i < PARAMETERS[parameter].count; i++)
        plant->values[PLACES[PARAMETERS[parameter].first + i]] = value;
    plant->changed = 1;
    return EHA_OK;
}

double eha_get(const eha_plant *plant, int parameter) {
    if (parameter < 0 || parameter >= EHA_PARAMETERS) return NAN;
    return plant->values[PLACES[PARAMETERS[parameter].first]];
}

const char *eha_name(int parameter) { return parameter < 0 || parameter >= EHA_PARAMETERS ? "" : NAMES[parameter]; }

eha_status eha_advance(eha_plant *plant, double voltage, int64_t steps) {
    double voltages[CHUNK];
    bool active[EHA_EFFECTS];
    void *nothing = 0, *error = 0;
    int64_t end = plant->steps + steps;
    eha_status status = settle(plant);
    if (status != EHA_OK) return status;
    if (!isfinite(voltage)) return EHA_NOT_FINITE;
    for (int i = 0; i < CHUNK; i++) voltages[i] = voltage;
    plant->state[STATE_TIME] = plant->steps * EHA_STEP_SIZE;
    while (plant->steps < end) {
        int64_t now = plant->steps, stop = end - now > CHUNK ? now + CHUNK : end;
        for (int effect = 0; effect < EHA_EFFECTS; effect++) {
            int64_t from = plant->from[effect], until = plant->until[effect];
            bool ever = plant->on[effect] && from < until;
            active[effect] = ever && from <= now && now < until;
            if (ever && from == now && now > 0) start_memory(plant, effect);
            if (ever && from > now && from < stop) stop = from;
            if (ever && until > now && until < stop) stop = until;
        }
        if (eha_kernel_advance(&nothing, &error, plant->state, plant->memory, plant->history, EHA_HISTORY,
                               plant->values, active, plant->propagator, voltages, stop - now, EHA_STEP_SIZE,
                               plant->outputs))
            return EHA_NO_MEMORY;
        plant->steps = stop;
    }
    return EHA_OK;
}

const char *eha_message(eha_status status) {
    static const char *const messages[] = {
        "no error",
        "a parameter is beyond its bounds, or there is none of that number",
        "supply_pressure must exceed return_pressure; change both together",
        "initial_position is outside the stroke; give at most actuator_displacement",
        "voltage_command is not finite; give volts",
        "no memory was left",
    };
    return messages[status];
}
