/* What FMI 2 and FMI 3 share: an instance, its variables by value reference, and a communication step. */
#ifndef EHA_FMU_H
#define EHA_FMU_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "eha_plant.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { OK, WARNING, DISCARD, ERROR, LINE = 160 };

/* value references: parameters, outputs, and then these; as `eha_core.export.model.ExportedModel.variables` */
enum { VOLTAGE_COMMAND = EHA_PARAMETERS + EHA_OUTPUTS, INITIAL_POSITION, TIME };

/* all that an FMU state saves */
typedef struct {
    eha_plant plant;
    double voltage, initial_position, start_time, time;
    int running;
} unit_state;

static inline void unit_start(unit_state *unit) {
    memset(unit, 0, sizeof *unit);
    eha_start(&unit->plant);
}

/* The functions below return what is wrong in one line, or 0. */
static inline const char *complaint(eha_status status) { return status == EHA_OK ? 0 : eha_message(status); }

/* Before the first step a new value changes where the plant rests. */
static inline const char *unit_rest(unit_state *unit) {
    return unit->running ? 0 : complaint(eha_reset(&unit->plant, unit->initial_position));
}

static inline const char *unit_get(unit_state *unit, const unsigned *references, size_t count, double *values) {
    for (size_t i = 0; i < count; i++) {
        unsigned reference = references[i];
        const char *wrong = 0;
        if (reference > TIME) return "there is no variable of this value reference";
        if (reference < EHA_PARAMETERS) {
            values[i] = eha_get(&unit->plant, reference);
        } else if (reference < VOLTAGE_COMMAND) {
            wrong = unit_rest(unit);
            values[i] = unit->plant.outputs[reference - EHA_PARAMETERS];
        } else {
            values[i] = (double[]){unit->voltage, unit->initial_position, unit->time}[reference - VOLTAGE_COMMAND];
        }
        if (wrong) return wrong;
    }
    return 0;
}

/* `line` holds LINE characters for what is wrong. */
static inline const char *unit_set(unit_state *unit, const unsigned *references, size_t count, const double *values,
                                   char *line) {
    for (size_t i = 0; i < count; i++) {
        unsigned reference = references[i];
        if (reference < EHA_PARAMETERS) {
            if (eha_set(&unit->plant, reference, values[i]) == EHA_OK) continue;
            snprintf(line, LINE, "%s = %g is out of range; give a value from its min to its max", eha_name(reference),
                     values[i]);
            return line;
        }
        if (reference == VOLTAGE_COMMAND) unit->voltage = values[i];
        else if (reference == INITIAL_POSITION && !unit->running) unit->initial_position = values[i];
        else return "only the input, parameters and, before the first step, initial_position can be set";
    }
    return 0;
}

/* To the plant's step that is nearest to the end of the communication step: what a step is off does not add up. */
static inline const char *unit_step(unit_state *unit, double from, double size) {
    double target = rint((from + size - unit->start_time) / EHA_STEP_SIZE);
    if (!(target >= (double)unit->plant.steps && target < 9e15)) return "the step ends before the plant's time";
    unit->time = from + size;
    return complaint(eha_advance(&unit->plant, unit->voltage, (int64_t)target - unit->plant.steps));
}

/* An FMU state is the same in both versions of FMI; these return FMI's status. */
static inline int state_read(const void *bytes, void **state) {
    if (!*state) *state = malloc(sizeof(unit_state));
    if (*state) memcpy(*state, bytes, sizeof(unit_state));
    return *state ? OK : ERROR;
}

static inline int state_write(const void *state, size_t size, void *bytes) {
    if (size < sizeof(unit_state)) return ERROR;
    memcpy(bytes, state, sizeof(unit_state));
    return OK;
}

static inline int state_free(void **state) {
    free(*state);
    *state = 0;
    return OK;
}

/* of FMI X, with `STATE` as it spells it in names and the type of its bytes */
#define STATES(X, STATE, DESERIALIZE, BYTE) \
    EXPORT int X##Get##STATE(instance *made, void **state) { return state_read(&made->unit, state); } \
    EXPORT int X##Set##STATE(instance *made, const void *state) { \
        return state_write(state, sizeof made->unit, &made->unit); \
    } \
    EXPORT int X##Free##STATE(instance *made, void **state) { return state_free(state); } \
    EXPORT int X##Serialized##STATE##Size(instance *made, const void *state, size_t *size) { \
        *size = sizeof(unit_state); \
        return OK; \
    } \
    EXPORT int X##Serialize##STATE(instance *made, const void *state, BYTE *bytes, size_t size) { \
        return state_write(state, size, bytes); \
    } \
    EXPORT int X##DESERIALIZE##STATE(instance *made, const BYTE *bytes, size_t size, void **state) { \
        *state = 0; \
        return size == sizeof(unit_state) ? state_read(bytes, state) : ERROR; \
    }

#endif
