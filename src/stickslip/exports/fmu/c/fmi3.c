/* FMI 3.0, for co-simulation and model exchange. */
#include "calls.h"

typedef int fmi3Status; /* OK, warning, discard, error, fatal */
typedef struct instance *fmi3Instance;
typedef uint32_t fmi3ValueReference;
typedef const char *fmi3String;
typedef void (*fmi3Logger)(void *, fmi3Status, fmi3String, fmi3String);

enum { OK, WARNING, DISCARD, ERROR };

static void tell(struct instance *self, enum level level, const char *text) {
    if (self->logger) {
        ((fmi3Logger)self->logger)(self->environment, (fmi3Status)level,
                                   level == LEVEL_ERROR ? "logStatusError" : "logStatusWarning",
                                   text);
    }
}

static fmi3Status unknown(fmi3Instance c, const char *what) {
    say(c, LEVEL_ERROR, "This FMU has no %s.", what);
    return ERROR;
}

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, bool on, size_t n, const fmi3String categories[]) {
    (void)c, (void)on, (void)n, (void)categories; /* there is nothing to debug */
    return OK;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                         bool visible, bool logging, bool event_mode,
                                         bool early_return,
                                         const fmi3ValueReference intermediate[], size_t n,
                                         void *environment, fmi3Logger logger, void *update) {
    (void)resources, (void)visible, (void)logging, (void)event_mode, (void)early_return;
    (void)intermediate, (void)n, (void)update;
    return made(name, token, false, environment, (void (*)(void))logger);
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                          bool visible, bool logging, void *environment,
                                          fmi3Logger logger) {
    (void)resources, (void)visible, (void)logging;
    return made(name, token, true, environment, (void (*)(void))logger);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token,
                                               fmi3String resources, bool visible, bool logging,
                                               void *environment, fmi3Logger logger, void *clock,
                                               void *lock, void *unlock) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment;
    (void)logger, (void)clock, (void)lock, (void)unlock;
    return NULL;
}

void fmi3FreeInstance(fmi3Instance c) { freed(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, bool has_tolerance, double tolerance,
                                       double start, bool has_stop, double stop) {
    return entered(c, start, has_stop, stop, has_tolerance, tolerance) ? OK : ERROR;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { return initialized(c) ? OK : ERROR; }

fmi3Status fmi3Terminate(fmi3Instance c) {
    c->core.phase = TERMINATED;
    return OK;
}

fmi3Status fmi3Reset(fmi3Instance c) {
    begin(c);
    return OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, double from, double size, bool keeps_no_state,
                      bool *needs_event, bool *terminates, bool *early, double *last_time) {
    (void)keeps_no_state;
    enum outcome outcome = stepped(c, from, size);
    *needs_event = *early = false;
    *terminates = outcome == HAS_ENDED;
    *last_time = c->last_time;
    return outcome == HAS_FAILED ? ERROR : OK;
}

static bool fits(fmi3Instance c, size_t n, size_t values) {
    if (n != values) {
        say(c, LEVEL_ERROR, "All variables are scalars: %zu of them have %zu values, got %zu.", n, n,
            values);
    }
    return n == values;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, double v[],
                          size_t values) {
    return fits(c, n, values) && got(c, vr, n, v) ? OK : ERROR;
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const double v[],
                          size_t values) {
    return fits(c, n, values) && set(c, vr, n, v) ? OK : ERROR;
}
fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference vr[], size_t n, int32_t v[],
                        size_t values) {
    return fits(c, n, values) && got_whole(c, vr, n, v) ? OK : ERROR;
}

/* Types of which there are no variables. */
#define NO_GETTER(NAME, TYPE)                                                                       \
    fmi3Status fmi3Get##NAME(fmi3Instance c, const fmi3ValueReference vr[], size_t n, TYPE v[],    \
                             size_t values) {                                                      \
        (void)vr, (void)v, (void)values;                                                           \
        return n ? unknown(c, #NAME " variables") : OK;                                            \
    }
#define NO_SETTER(NAME, TYPE)                                                                       \
    fmi3Status fmi3Set##NAME(fmi3Instance c, const fmi3ValueReference vr[], size_t n,              \
                             const TYPE v[], size_t values) {                                      \
        (void)vr, (void)v, (void)values;                                                           \
        return n ? unknown(c, #NAME " variables that can be set") : OK;                            \
    }
NO_GETTER(Float32, float)
NO_SETTER(Float32, float)
NO_GETTER(Int8, int8_t)
NO_SETTER(Int8, int8_t)
NO_GETTER(UInt8, uint8_t)
NO_SETTER(UInt8, uint8_t)
NO_GETTER(Int16, int16_t)
NO_SETTER(Int16, int16_t)
NO_GETTER(UInt16, uint16_t)
NO_SETTER(UInt16, uint16_t)
NO_SETTER(Int32, int32_t)
NO_GETTER(UInt32, uint32_t)
NO_SETTER(UInt32, uint32_t)
NO_GETTER(Int64, int64_t)
NO_SETTER(Int64, int64_t)
NO_GETTER(UInt64, uint64_t)
NO_SETTER(UInt64, uint64_t)
NO_GETTER(Boolean, bool)
NO_SETTER(Boolean, bool)
NO_GETTER(String, fmi3String)
NO_SETTER(String, fmi3String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, size_t sizes[],
                         const uint8_t *v[], size_t values) {
    (void)vr, (void)sizes, (void)v, (void)values;
    return n ? unknown(c, "binary variables") : OK;
}
fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                         const size_t sizes[], const uint8_t *const v[], size_t values) {
    (void)vr, (void)sizes, (void)v, (void)values;
    return n ? unknown(c, "binary variables") : OK;
}
fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, bool v[]) {
    (void)vr, (void)v;
    return n ? unknown(c, "clocks") : OK;
}
fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const bool v[]) {
    (void)vr, (void)v;
    return n ? unknown(c, "clocks") : OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance c, void **state) {
    struct core *found = saved(c, *state);
    if (!found) {
        return ERROR;
    }
    *state = found;
    return OK;
}
fmi3Status fmi3SetFMUState(fmi3Instance c, void *state) {
    if (!state) {
        return unknown(c, "state to be brought back");
    }
    return brought_back(c, state) ? OK : ERROR;
}
fmi3Status fmi3FreeFMUState(fmi3Instance c, void **state) {
    (void)c;
    free(*state);
    *state = NULL;
    return OK;
}
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, void *state, size_t *size) {
    (void)c, (void)state;
    *size = stored_size();
    return OK;
}
fmi3Status fmi3SerializeFMUState(fmi3Instance c, void *state, uint8_t bytes[], size_t size) {
    if (size < stored_size()) {
        say(c, LEVEL_ERROR, "There is no room for the serialized state.");
        return ERROR;
    }
    stored(state, bytes);
    return OK;
}
fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const uint8_t bytes[], size_t size,
                                   void **state) {
    struct core *found = restored(c, bytes, size);
    if (!found) {
        return ERROR;
    }
    free(*state);
    *state = found;
    return OK;
}

fmi3Status fmi3EnterEventMode(fmi3Instance c) { return event_entered(c) ? OK : ERROR; }

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, bool *again, bool *terminates, bool *nominals,
                                    bool *changed, bool *has_next, double *next) {
    const enum outcome outcome = updated(c, changed);
    const double start = next_piece(&c->core);
    *again = *nominals = false;
    *terminates = outcome != GOES_ON;
    *has_next = isfinite(start);
    *next = *has_next ? start : 0.0;
    return outcome == HAS_FAILED ? ERROR : OK;
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c) {
    return continuous_entered(c) ? OK : ERROR;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, bool keeps_no_state, bool *event,
                                       bool *terminates) {
    (void)keeps_no_state;
    *event = *terminates = false;
    if (!in_phase(c, BETWEEN_EVENTS, "To complete a step")) {
        return ERROR;
    }
    *event = completed(c);
    *terminates = is_beyond_drives(c);
    return OK;
}

fmi3Status fmi3SetTime(fmi3Instance c, double t) { return time_set(c, t) ? OK : ERROR; }
fmi3Status fmi3SetContinuousStates(fmi3Instance c, const double x[], size_t n) {
    return states_set(c, x, n) ? OK : ERROR;
}
fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, double x[], size_t n) {
    return rates_got(c, x, n) ? OK : ERROR;
}
fmi3Status fmi3GetEventIndicators(fmi3Instance c, double z[], size_t n) {
    return indicators_got(c, z, n) ? OK : ERROR;
}
fmi3Status fmi3GetContinuousStates(fmi3Instance c, double x[], size_t n) {
    return states_got(c, x, n) ? OK : ERROR;
}
fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, double x[], size_t n) {
    return nominals_got(c, x, n) ? OK : ERROR;
}
fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n) {
    (void)c;
    *n = N_GUARDS;
    return OK;
}
fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n) {
    (void)c;
    *n = N_STATES;
    return OK;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknowns[],
                                        size_t n, const fmi3ValueReference knowns[], size_t m,
                                        const double seed[], size_t seeds, double derivative[],
                                        size_t derivatives) {
    return fits_count(c, seeds, m, "seeds") && fits_count(c, derivatives, n, "derivatives") &&
                   directional(c, unknowns, n, knowns, m, seed, derivative)
               ? OK
               : ERROR;
}

/* What the model description does not promise. */
#define NO(NAME, TAKEN)                                                                             \
    fmi3Status fmi3##NAME TAKEN { return unknown(c, "function fmi3" #NAME); }
NO(EnterConfigurationMode, (fmi3Instance c))
NO(ExitConfigurationMode, (fmi3Instance c))
NO(EnterStepMode, (fmi3Instance c))
NO(EvaluateDiscreteStates, (fmi3Instance c))
NO(GetNumberOfVariableDependencies, (fmi3Instance c, fmi3ValueReference a, size_t *b))
NO(GetVariableDependencies, (fmi3Instance c, fmi3ValueReference a, size_t b[],
                             fmi3ValueReference d[], size_t e[], int f[], size_t g))
NO(GetAdjointDerivative,
   (fmi3Instance c, const fmi3ValueReference a[], size_t b, const fmi3ValueReference d[], size_t e,
    const double f[], size_t g, double h[], size_t i))
NO(GetOutputDerivatives, (fmi3Instance c, const fmi3ValueReference a[], size_t b, const int32_t d[],
                          double e[], size_t f))
NO(GetIntervalDecimal,
   (fmi3Instance c, const fmi3ValueReference a[], size_t b, double d[], int e[]))
NO(GetIntervalFraction, (fmi3Instance c, const fmi3ValueReference a[], size_t b, uint64_t d[],
                         uint64_t e[], int f[]))
NO(GetShiftDecimal, (fmi3Instance c, const fmi3ValueReference a[], size_t b, double d[]))
NO(GetShiftFraction,
   (fmi3Instance c, const fmi3ValueReference a[], size_t b, uint64_t d[], uint64_t e[]))
NO(SetIntervalDecimal, (fmi3Instance c, const fmi3ValueReference a[], size_t b, const double d[]))
NO(SetIntervalFraction, (fmi3Instance c, const fmi3ValueReference a[], size_t b,
                         const uint64_t d[], const uint64_t e[]))
NO(SetShiftDecimal, (fmi3Instance c, const fmi3ValueReference a[], size_t b, const double d[]))
NO(SetShiftFraction, (fmi3Instance c, const fmi3ValueReference a[], size_t b, const uint64_t d[],
                      const uint64_t e[]))
NO(ActivateModelPartition, (fmi3Instance c, fmi3ValueReference a, double b))
