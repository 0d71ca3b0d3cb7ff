/* The electro-hydraulic servo actuator of `eha_core.plant.Plant` in C: one struct, no other state, no Python.

   SI units; pressures are above the return line's reference. Parameters and outputs are numbered in eha_model.h. One
   plant is advanced by one thread at a time; several plants are independent of each other. */
#ifndef EHA_PLANT_H
#define EHA_PLANT_H

#include <stdint.h>

#include "eha_model.h"

typedef enum {
    EHA_OK,
    EHA_OUT_OF_RANGE,   /* a value is not finite or beyond its parameter's bounds, or there is no such parameter */
    EHA_NO_PLANT,       /* the supply's pressure does not exceed the return line's */
    EHA_OUTSIDE_STROKE, /* the initial position is outside the stroke */
    EHA_NOT_FINITE,     /* the voltage is not finite */
    EHA_NO_MEMORY
} eha_status;

typedef struct {
    double outputs[EHA_OUTPUTS]; /* after the last step: outputs[EHA_OUTPUT_POSITION] */
    int64_t steps;               /* since the last reset */
    /* the rest is the plant's own */
    double values[EHA_VALUES], propagator[EHA_DYNAMICS];
    double state[EHA_STATES], memory[EHA_MEMORY], history[EHA_HISTORY];
    int64_t from[EHA_EFFECTS], until[EHA_EFFECTS];
    uint8_t on[EHA_EFFECTS];
    int changed;
} eha_plant;

#ifdef __cplusplus
extern "C" {
#endif

/* Fill a plant with the exported values, at rest at mid stroke and at time zero. */
eha_status eha_start(eha_plant *plant);

/* Back to rest at a position [m] and to time zero, with the parameters in force. */
eha_status eha_reset(eha_plant *plant, double initial_position);

/* Change a parameter, which acts from the next step on. */
eha_status eha_set(eha_plant *plant, int parameter, double value);

/* The value of a parameter; not a number where there is none of that number. */
double eha_get(const eha_plant *plant, int parameter);

/* Its name; "" where there is none of that number. */
const char *eha_name(int parameter);

/* Hold a voltage [V] for that many steps of EHA_STEP_SIZE. */
eha_status eha_advance(eha_plant *plant, double voltage, int64_t steps);

/* One line that says what a status means. */
const char *eha_message(eha_status status);

#ifdef __cplusplus
}
#endif
#endif
