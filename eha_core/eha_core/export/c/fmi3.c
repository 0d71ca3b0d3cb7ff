/* FMI 3.0 for co-simulation. What a plant of real variables alone has no use for answers with an error. */
#include <stdbool.h>

#include "fmu.h"

typedef void log_message(void *environment, int status, const char *category, const char *message);

typedef struct {
    unit_state unit;
    log_message *log;
    void *environment;
    char line[LINE];
} instance;

static int answer(instance *made, const char *wrong) {
    if (!wrong) return OK;
    if (made->log) made->log(made->environment, ERROR, "logStatusError", wrong);
    return ERROR;
}

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }
EXPORT int fmi3SetDebugLogging(instance *made, bool on, size_t count, const char *const *categories) { return OK; }

EXPORT instance *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                             bool logging, bool with_events, bool early_return,
                                             const unsigned *intermediate, size_t intermediates, void *environment,
                                             log_message *log, void *intermediate_update) {
    instance *made;
    if (!token || strcmp(token, FMU_TOKEN) || !(made = calloc(1, sizeof *made))) return 0;
    made->log = log;
    made->environment = environment;
    unit_start(&made->unit);
    return made;
}

EXPORT void *fmi3InstantiateModelExchange() { return 0; }
EXPORT void *fmi3InstantiateScheduledExecution() { return 0; }

EXPORT void fmi3FreeInstance(instance *made) { free(made); }

EXPORT int fmi3EnterInitializationMode(instance *made, bool with_tolerance, double tolerance, double start,
                                       bool with_stop, double stop) {
    made->unit.start_time = made->unit.time = start;
    return OK;
}

EXPORT int fmi3ExitInitializationMode(instance *made) {
    const char *wrong = unit_rest(&made->unit);
    made->unit.running = !wrong;
    return answer(made, wrong);
}

EXPORT int fmi3Terminate(instance *made) { return OK; }

EXPORT int fmi3Reset(instance *made) {
    unit_start(&made->unit);
    return OK;
}

EXPORT int fmi3GetFloat64(instance *made, const unsigned *references, size_t count, double *values, size_t size) {
    return size < count ? ERROR : answer(made, unit_get(&made->unit, references, count, values));
}

EXPORT int fmi3SetFloat64(instance *made, const unsigned *references, size_t count, const double *values,
                          size_t size) {
    return size < count ? ERROR : answer(made, unit_set(&made->unit, references, count, values, made->line));
}

EXPORT int fmi3DoStep(instance *made, double from, double size, bool no_earlier_state, bool *event, bool *terminate,
                      bool *early_return, double *reached) {
    *event = *terminate = *early_return = false;
    *reached = from + size;
    return answer(made, unit_step(&made->unit, from, size));
}

STATES(fmi3, FMUState, Deserialize, unsigned char)

/* there are no variables of these types, and a request for none of them is granted */
#define OTHER_TYPE(NAME) \
    EXPORT int fmi3Get##NAME(instance *made, const unsigned *references, size_t count) { return count ? ERROR : OK; } \
    EXPORT int fmi3Set##NAME(instance *made, const unsigned *references, size_t count) { return count ? ERROR : OK; }
OTHER_TYPE(Float32)
OTHER_TYPE(Int8)
OTHER_TYPE(UInt8)
OTHER_TYPE(Int16)
OTHER_TYPE(UInt16)
OTHER_TYPE(Int32)
OTHER_TYPE(UInt32)
OTHER_TYPE(Int64)
OTHER_TYPE(UInt64)
OTHER_TYPE(Boolean)
OTHER_TYPE(String)
OTHER_TYPE(Binary)
OTHER_TYPE(Clock)

#define UNSUPPORTED(NAME) \
    EXPORT int fmi3##NAME() { return ERROR; }
UNSUPPORTED(EnterEventMode)
UNSUPPORTED(EnterStepMode)
UNSUPPORTED(EnterConfigurationMode)
UNSUPPORTED(ExitConfigurationMode)
UNSUPPORTED(EnterContinuousTimeMode)
UNSUPPORTED(GetNumberOfVariableDependencies)
UNSUPPORTED(GetVariableDependencies)
UNSUPPORTED(GetDirectionalDerivative)
UNSUPPORTED(GetAdjointDerivative)
UNSUPPORTED(GetIntervalDecimal)
UNSUPPORTED(GetIntervalFraction)
UNSUPPORTED(GetShiftDecimal)
UNSUPPORTED(GetShiftFraction)
UNSUPPORTED(SetIntervalDecimal)
UNSUPPORTED(SetIntervalFraction)
UNSUPPORTED(SetShiftDecimal)
UNSUPPORTED(SetShiftFraction)
UNSUPPORTED(EvaluateDiscreteStates)
UNSUPPORTED(UpdateDiscreteStates)
UNSUPPORTED(CompletedIntegratorStep)
UNSUPPORTED(SetTime)
UNSUPPORTED(SetContinuousStates)
UNSUPPORTED(GetContinuousStateDerivatives)
UNSUPPORTED(GetEventIndicators)
UNSUPPORTED(GetContinuousStates)
UNSUPPORTED(GetNominalsOfContinuousStates)
UNSUPPORTED(GetNumberOfEventIndicators)
UNSUPPORTED(GetNumberOfContinuousStates)
UNSUPPORTED(GetOutputDerivatives)
UNSUPPORTED(ActivateModelPartition)
