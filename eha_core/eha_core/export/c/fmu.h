/* What FMI 2 and FMI 3 share: an instance, its variables by value reference, and a communication step. */
#ifndef EHA_FMU_H
#define EHA_FMU_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "eha_plant.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { OK, WARNING, DISCARD, ERROR };

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

/* Before the first step a new value changes where the plant rests. */
static inline eha_status unit_rest(unit_state *unit) {
    return unit->running ? EHA_OK : eha_reset(&unit->plant, unit->initial_position);
}

static inline eha_status unit_get(unit_state *unit, const unsigned *references, size_t count, double *values) {
    eha_status status = EHA_OK;
    for (size_t i = 0; i < count && status == EHA_OK; i++) {
        unsigned reference = references[i];
        if (reference < EHA_PARAMETERS) {
            values[i] = eha_get(&unit->plant, reference);
        } else if (reference < VOLTAGE_COMMAND) {
            status = unit_rest(unit);
            values[i] = unit->plant.outputs[reference - EHA_PARAMETERS];
        } else if (reference <= TIME) {
            values[i] = (double[]){unit->voltage, unit->initial_position, unit->time}[reference - VOLTAGE_COMMAND];
        } else {
            status = EHA_OUT_OF_RANGE;
        }
    }
    return status;
}

static inline eha_status unit_set(unit_state *unit, const unsigned *references, size_t count, const double *values) {
    eha_status status = EHA_OK;
    for (size_t i = 0; i < count && status == EHA_OK; i++) {
        if (references[i] < EHA_PARAMETERS)
            status = eha_set(&unit->plant, references[i], values[i]);
        else if (references[i] == VOLTAGE_COMMAND)
            unit->voltage = values[i];
        else if (references[i] == INITIAL_POSITION && !unit->running)
            unit->initial_position = values[i];
        else
            status = EHA_OUT_OF_RANGE;
    }
    return status;
}

/* To the plant's step that is nearest to the end of the communication step: what a step is off does not add up. */
static inline eha_status unit_step(unit_state *unit, double from, double size) {
    double target = rint((from + size - unit->start_time) / EHA_STEP_SIZE);
    if (!(target >= (double)unit->plant.steps && target < 9e15)) return EHA_OUT_OF_RANGE;
    unit->time = from + size;
    return eha_advance(&unit->plant, unit->voltage, (int64_t)target - unit->plant.steps);
}

static inline void *unit_copy(const void *source) {
    void *made = malloc(sizeof(unit_state));
    return made ? memcpy(made, source, sizeof(unit_state)) : made;
}

#endif
