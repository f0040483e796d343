/* What importers call in both kinds of FMU: values, the end of initialization, and steps. */
#ifndef STICKSLIP_CALLS_H
#define STICKSLIP_CALLS_H

#include "exchange.h"

static bool got(struct instance *self, const uint32_t *references, size_t n, double *values) {
    for (size_t i = 0; i < n; i++) {
        const struct variable *one = variable_of(self, references[i], false);
        if (!one) {
            return false;
        }
        work_out(self, one->role);
        values[i] = one->role == INDEPENDENT ? self->core.time : self->core.values[references[i]];
    }
    return true;
}

static bool got_whole(struct instance *self, const uint32_t *references, size_t n, int32_t *values) {
    for (size_t i = 0; i < n; i++) {
        const struct variable *one = variable_of(self, references[i], true);
        if (!one) {
            return false;
        }
        work_out(self, one->role);
        values[i] = (int32_t)self->core.values[references[i]];
    }
    return true;
}

static bool initialized(struct instance *self) {
    struct core *core = &self->core;
    if (core->phase != INITIALIZING) {
        say(self, LEVEL_ERROR, "Initialization is left once, after it was entered.");
        return false;
    }
    if (!are_allowed(self)) {
        return false;
    }
    prepare(core, core->w, core->whole);
    core->w[AT_TIME] = core->time;
    for (int i = 0; i < N_VARIABLES; i++) {
        if (VARIABLES[i].role == STATE) {
            core->w[AT_Y + VARIABLES[i].index] = core->values[i];
        }
    }
    if (!within_stops(self)) {
        return false;
    }
    if (core->exchanges) {
        return first_event(self);
    }
    struct core *first = core;
    if (HELD) { /* later inputs are not known: look ahead in a copy */
        first = malloc(sizeof *first);
        if (!first) {
            say(self, LEVEL_ERROR, "There is not enough memory.");
            return false;
        }
        memcpy(first, core, sizeof *first);
        hold_inputs(first, first->horizon);
    }
    run_to(first, core->time, false);
    bool finite = read_off(self, first, core->time);
    if (HELD) {
        memcpy(core->values, first->values, sizeof core->values);
        free(first);
        core->horizon = core->time;
    }
    if (!finite) {
        say(self, LEVEL_ERROR, "The start gives no finite state.");
        return false;
    }
    core->phase = STEPPING;
    return true;
}

/* Go on from one communication point to the next. */
static enum outcome stepped(struct instance *self, double from, double size) {
    struct core *core = &self->core;
    const bool is_last = isfinite(LAST_TIME) && fabs(from + size - LAST_TIME) <= 1e-9 * LAST_TIME;
    const double t = is_last ? LAST_TIME : from + size;
    if (core->phase != STEPPING) {
        say(self, LEVEL_ERROR, "A step needs an FMU that is initialized and not terminated.");
        return HAS_FAILED;
    }
    if (!(size >= 0.0) || !isfinite(t) || fabs(from - core->time) > 1e-9 * fmax(fabs(t), size)) {
        say(self, LEVEL_ERROR, "A step of %g s from t = %.17g s does not follow t = %.17g s.", size,
            from, core->time);
        return HAS_FAILED;
    }
    if (t > LAST_TIME) {
        say(self, LEVEL_ERROR, "The drives of this FMU are known up to t = %g s, and the step ends"
            " at %g s: export the rig with --t-end.", LAST_TIME, t);
        return HAS_FAILED;
    }
    if (HELD && t <= core->time) {
        return GOES_ON;
    }
    if (core->retuned && !retuned(self)) {
        return HAS_FAILED;
    }
    if (HELD) {
        hold_inputs(core, t);
        if (core->whole[AT_STATUS] == 0) {
            core->horizon = t; /* of the first step */
        }
    }
    enum outcome outcome = run_to(core, t, HELD);
    double reached = outcome == GOES_ON ? t : core->w[AT_TIME];
    if (!read_off(self, core, reached)) {
        say(self, LEVEL_ERROR, "t = %.9g s: the state diverged; it is no longer finite.", reached);
        return HAS_FAILED;
    }
    core->time = self->last_time = reached;
    if (outcome != GOES_ON) {
        say(self, outcome == HAS_FAILED ? LEVEL_ERROR : LEVEL_WARNING, "t = %.9g s: %s", reached,
            ending_of(core->whole[AT_STATUS]).words);
        self->has_ended = true;
    }
    return outcome;
}

#endif
