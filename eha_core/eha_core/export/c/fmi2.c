/* FMI 2.0 for co-simulation. What a plant of real variables alone has no use for answers with an error. */
#include "fmu.h"

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} callbacks;

typedef struct {
    unit_state unit;
    callbacks functions;
    char name[LINE], line[LINE];
} instance;

static int answer(instance *made, const char *wrong) {
    if (!wrong) return OK;
    if (made->functions.logger)
        made->functions.logger(made->functions.environment, made->name, ERROR, "logStatusError", "%s", wrong);
    return ERROR;
}

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT int fmi2SetDebugLogging(instance *made, int on, size_t count, const char *const *categories) { return OK; }

EXPORT instance *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                                 const callbacks *functions, int visible, int logging) {
    instance *made;
    if (type != 1 || !guid || strcmp(guid, FMU_TOKEN) || !(made = calloc(1, sizeof *made))) return 0;
    if (functions) made->functions = *functions;
    snprintf(made->name, LINE, "%s", name ? name : "");
    unit_start(&made->unit);
    return made;
}

EXPORT void fmi2FreeInstance(instance *made) { free(made); }

EXPORT int fmi2SetupExperiment(instance *made, int with_tolerance, double tolerance, double start, int with_stop,
                               double stop) {
    made->unit.start_time = made->unit.time = start;
    return OK;
}

EXPORT int fmi2EnterInitializationMode(instance *made) { return OK; }

EXPORT int fmi2ExitInitializationMode(instance *made) {
    const char *wrong = unit_rest(&made->unit);
    made->unit.running = !wrong;
    return answer(made, wrong);
}

EXPORT int fmi2Terminate(instance *made) { return OK; }

EXPORT int fmi2Reset(instance *made) {
    unit_start(&made->unit);
    return OK;
}

EXPORT int fmi2GetReal(instance *made, const unsigned *references, size_t count, double *values) {
    return answer(made, unit_get(&made->unit, references, count, values));
}

EXPORT int fmi2SetReal(instance *made, const unsigned *references, size_t count, const double *values) {
    return answer(made, unit_set(&made->unit, references, count, values, made->line));
}

EXPORT int fmi2DoStep(instance *made, double from, double size, int no_earlier_state) {
    return answer(made, unit_step(&made->unit, from, size));
}

STATES(fmi2, FMUstate, DeSerialize, char)

/* there are no variables of these types, and a request for none of them is granted */
#define OTHER_TYPE(NAME) \
    EXPORT int fmi2Get##NAME(instance *made, const unsigned *references, size_t count, void *values) { \
        return count ? ERROR : OK; \
    } \
    EXPORT int fmi2Set##NAME(instance *made, const unsigned *references, size_t count, const void *values) { \
        return count ? ERROR : OK; \
    }
OTHER_TYPE(Integer)
OTHER_TYPE(Boolean)
OTHER_TYPE(String)

#define UNSUPPORTED(NAME) \
    EXPORT int fmi2##NAME() { return ERROR; }
UNSUPPORTED(GetDirectionalDerivative)
UNSUPPORTED(SetRealInputDerivatives)
UNSUPPORTED(GetRealOutputDerivatives)
UNSUPPORTED(CancelStep)
UNSUPPORTED(GetStatus)
UNSUPPORTED(GetRealStatus)
UNSUPPORTED(GetIntegerStatus)
UNSUPPORTED(GetBooleanStatus)
UNSUPPORTED(GetStringStatus)
