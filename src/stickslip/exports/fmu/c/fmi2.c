/* FMI 2.0, for co-simulation and model exchange. */
#include "calls.h"

typedef int fmi2Status; /* OK, warning, discard, error, fatal, pending */
typedef struct instance *fmi2Component;
typedef const char *fmi2String;
typedef unsigned int fmi2ValueReference;
typedef void (*fmi2Logger)(void *, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
typedef struct {
    fmi2Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, fmi2Status);
    void *environment;
} fmi2CallbackFunctions;

enum { OK, WARNING, DISCARD, ERROR };
enum { MODEL_EXCHANGE = 0, CO_SIMULATION = 1 };
enum { LAST_SUCCESSFUL_TIME = 2, IS_TERMINATED = 3 };

static void tell(struct instance *self, enum level level, const char *text) {
    if (self->logger) {
        ((fmi2Logger)self->logger)(self->environment, self->name, (fmi2Status)level,
                                   level == LEVEL_ERROR ? "logStatusError" : "logStatusWarning",
                                   text);
    }
}

static fmi2Status unknown(fmi2Component c, const char *what) {
    say(c, LEVEL_ERROR, "This FMU has no %s.", what);
    return ERROR;
}

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, int on, size_t n, const fmi2String categories[]) {
    (void)c, (void)on, (void)n, (void)categories; /* there is nothing to debug */
    return OK;
}

fmi2Component fmi2Instantiate(fmi2String name, int type, fmi2String token, fmi2String resources,
                              const fmi2CallbackFunctions *functions, int visible, int logging) {
    (void)resources, (void)visible, (void)logging;
    if (type != CO_SIMULATION && type != MODEL_EXCHANGE) {
        return NULL;
    }
    return made(name, token, type == MODEL_EXCHANGE, functions ? functions->environment : NULL,
                functions ? (void (*)(void))functions->logger : NULL);
}

void fmi2FreeInstance(fmi2Component c) { freed(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, int has_tolerance, double tolerance, double start,
                               int has_stop, double stop) {
    if (!entered(c, start, has_stop, stop, has_tolerance, tolerance)) {
        return ERROR;
    }
    c->core.phase = INSTANTIATED; /* until initialization is entered */
    return OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    if (c->core.phase != INSTANTIATED) {
        say(c, LEVEL_ERROR, "Initialization is entered once, after the experiment was set up.");
        return ERROR;
    }
    c->core.phase = INITIALIZING;
    return OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return initialized(c) ? OK : ERROR; }

fmi2Status fmi2Terminate(fmi2Component c) {
    c->core.phase = TERMINATED;
    return OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    begin(c);
    return OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, double v[]) {
    return got(c, vr, n, v) ? OK : ERROR;
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, int v[]) {
    return got_whole(c, vr, n, v) ? OK : ERROR;
}
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, int v[]) {
    (void)vr, (void)v;
    return n ? unknown(c, "Boolean variables") : OK;
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String v[]) {
    (void)vr, (void)v;
    return n ? unknown(c, "string variables") : OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const double v[]) {
    return set(c, vr, n, v) ? OK : ERROR;
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, const int v[]) {
    (void)vr, (void)v;
    return n ? unknown(c, "integer variables that can be set") : OK;
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, const int v[]) {
    (void)vr, (void)v;
    return n ? unknown(c, "Boolean variables") : OK;
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                         const fmi2String v[]) {
    (void)vr, (void)v;
    return n ? unknown(c, "string variables") : OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, void **state) {
    struct core *found = saved(c, *state);
    if (!found) {
        return ERROR;
    }
    *state = found;
    return OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component c, void *state) {
    if (!state) {
        return unknown(c, "state to be brought back");
    }
    return brought_back(c, state) ? OK : ERROR;
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, void **state) {
    (void)c;
    free(*state);
    *state = NULL;
    return OK;
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, void *state, size_t *size) {
    (void)c, (void)state;
    *size = stored_size();
    return OK;
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, void *state, char bytes[], size_t size) {
    if (size < stored_size()) {
        say(c, LEVEL_ERROR, "There is no room for the serialized state.");
        return ERROR;
    }
    stored(state, (unsigned char *)bytes);
    return OK;
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const char bytes[], size_t size, void **state) {
    struct core *found = restored(c, (const unsigned char *)bytes, size);
    if (!found) {
        return ERROR;
    }
    free(*state);
    *state = found;
    return OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[],
                                        size_t n, const fmi2ValueReference knowns[], size_t m,
                                        const double seed[], double derivative[]) {
    return directional(c, unknowns, n, knowns, m, seed, derivative) ? OK : ERROR;
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const int order[], const double v[]) {
    (void)vr, (void)order, (void)v;
    return n ? unknown(c, "derivatives of inputs: they are held") : OK;
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const int order[], double v[]) {
    (void)vr, (void)order, (void)v;
    return n ? unknown(c, "derivatives of outputs") : OK;
}

fmi2Status fmi2DoStep(fmi2Component c, double from, double size, int keeps_no_state) {
    (void)keeps_no_state;
    switch (stepped(c, from, size)) {
    case GOES_ON: return OK;
    case HAS_ENDED: return DISCARD;
    default: return ERROR;
    }
}
fmi2Status fmi2CancelStep(fmi2Component c) { return unknown(c, "step to cancel"); }

fmi2Status fmi2GetStatus(fmi2Component c, int kind, fmi2Status *value) {
    (void)kind, (void)value;
    return unknown(c, "step that is pending");
}
fmi2Status fmi2GetRealStatus(fmi2Component c, int kind, double *value) {
    if (kind != LAST_SUCCESSFUL_TIME) {
        return unknown(c, "status of this kind");
    }
    *value = c->last_time;
    return OK;
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, int kind, int *value) {
    (void)kind, (void)value;
    return unknown(c, "integer status");
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, int kind, int *value) {
    if (kind != IS_TERMINATED) {
        return unknown(c, "status of this kind");
    }
    *value = c->has_ended;
    return OK;
}
fmi2Status fmi2GetStringStatus(fmi2Component c, int kind, fmi2String *value) {
    (void)kind, (void)value;
    return unknown(c, "status in words");
}

typedef struct {
    int newDiscreteStatesNeeded;
    int terminateSimulation;
    int nominalsOfContinuousStatesChanged;
    int valuesOfContinuousStatesChanged;
    int nextEventTimeDefined;
    double nextEventTime;
} fmi2EventInfo;

fmi2Status fmi2EnterEventMode(fmi2Component c) { return event_entered(c) ? OK : ERROR; }

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
    bool changed;
    const enum outcome outcome = updated(c, &changed);
    const double next = next_piece(&c->core);
    *info = (fmi2EventInfo){0, outcome != GOES_ON, 0, changed, isfinite(next), next};
    if (!isfinite(next)) {
        info->nextEventTime = 0.0;
    }
    return outcome == HAS_FAILED ? ERROR : OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
    return continuous_entered(c) ? OK : ERROR;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, int keeps_no_state, int *event,
                                       int *terminates) {
    (void)keeps_no_state;
    *terminates = 0;
    *event = 0;
    if (!in_phase(c, BETWEEN_EVENTS, "To complete a step")) {
        return ERROR;
    }
    *event = completed(c);
    *terminates = is_beyond_drives(c);
    return OK;
}

fmi2Status fmi2SetTime(fmi2Component c, double t) { return time_set(c, t) ? OK : ERROR; }
fmi2Status fmi2SetContinuousStates(fmi2Component c, const double x[], size_t n) {
    return states_set(c, x, n) ? OK : ERROR;
}
fmi2Status fmi2GetDerivatives(fmi2Component c, double x[], size_t n) {
    return rates_got(c, x, n) ? OK : ERROR;
}
fmi2Status fmi2GetEventIndicators(fmi2Component c, double z[], size_t n) {
    return indicators_got(c, z, n) ? OK : ERROR;
}
fmi2Status fmi2GetContinuousStates(fmi2Component c, double x[], size_t n) {
    return states_got(c, x, n) ? OK : ERROR;
}
fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, double x[], size_t n) {
    return nominals_got(c, x, n) ? OK : ERROR;
}
