/* Model exchange: the importer takes the steps, and modes change at its events.
 *
 * Event indicators are the guards of the run: they are above 0 as long as the modes last. An
 * indicator that was above 0 and is so no more has fallen, and the kernels make what follows from
 * it. A step that is tried then tells what else falls at once. Pieces of the drives are time events.
 */
#ifndef STICKSLIP_EXCHANGE_H
#define STICKSLIP_EXCHANGE_H

#include "instance.h"

#define MOST_FALLS 1000 /* changes at one instant, after which there is no end of them */
#define NEARLY 1e-9 /* share of the time at which a piece of the drives has begun */

/* Put time and inputs where the equations read them. */
static void put_time(struct core *core) {
    core->w[AT_TIME] = core->time;
    for (int i = 0; HELD && i < N_VARIABLES; i++) {
        if (VARIABLES[i].role == INPUT) {
            core->w[FIRST_NUMBER + VARIABLES[i].index - 1] = core->values[i];
        }
    }
}

/* Work out what is asked for at the time and states of the importer. */
static void work_out(struct instance *self, enum role role) {
    struct core *core = &self->core;
    if (core->phase != IN_EVENT && core->phase != BETWEEN_EVENTS) {
        return;
    }
    const bool is_column = role == COLUMN || role == CONTACT_MODE;
    bool *known = role == DERIVATIVE ? &self->rates_known
                : role == INDICATOR ? &self->guards_known : &self->columns_known;
    if (*known || !(is_column || role == DERIVATIVE || role == INDICATOR)) {
        return;
    }
    *known = true;
    put_time(core);
    if (!is_column) {
        take_values(core, role, core->w, core->whole);
        return;
    }
    put_states(core, core->w, AT_POINT);
    ask(core, COLUMNS_AT, 0, 0.0, core->w, core->whole);
    for (int i = 0; i < N_VARIABLES; i++) {
        if (VARIABLES[i].role == COLUMN) {
            core->values[i] = core->w[AT_VALUES + VARIABLES[i].index];
        } else if (VARIABLES[i].role == CONTACT_MODE) {
            core->values[i] = (double)core->whole[AT_MODE];
        }
    }
}

/* Note which guards are above 0, from which they can fall. */
static void arm(struct instance *self, bool anew) {
    struct core *core = &self->core;
    work_out(self, INDICATOR);
    for (int i = 0; i < N_GUARDS; i++) {
        const double value = core->values[FIRST_INDICATOR + i];
        core->armed[i] = value > 0.0 || (core->armed[i] && !anew);
        core->sizes[i] = fmax(core->sizes[i], fabs(value));
    }
}

/* Where the next piece of the drives begins, or the last one ends. */
static double next_piece(const struct core *core) {
    const int64_t next = core->whole[AT_PIECE] + 1;
    if (next < N_PIECES) {
        return table_of(core)[next * WIDTH];
    }
    return core->time < LAST_TIME ? LAST_TIME : HUGE_VAL;
}

static bool is_beyond_drives(struct instance *self) {
    const bool is_beyond = self->core.time > LAST_TIME * (1.0 + NEARLY);
    if (is_beyond) {
        say(self, LEVEL_WARNING, "The drives of this FMU are known up to t = %g s, and no farther:"
            " export the rig with --t-end.", LAST_TIME);
    }
    return is_beyond;
}

/* Begin at the state and with the inputs at hand. */
static bool first_event(struct instance *self) {
    struct core *core = &self->core;
    if (HELD) {
        hold_inputs(core, core->time);
    }
    ask(core, ENTER, 0, core->horizon > core->time ? core->horizon : core->time + DEFAULT_STOP,
        core->w, core->whole);
    core->phase = IN_EVENT;
    core->has_jumped = false;
    forget_values(self);
    ask(core, SHOWN, 0, 0.0, core->w, core->whole);
    for (int i = 0; i < N_STATES; i++) {
        core->values[FIRST_STATE + i] = core->w[AT_POINT + i];
    }
    return true;
}

static bool is_running(const struct core *core) {
    return core->whole[AT_STATUS] == 0;
}

/* Make all that happens at an instant. */
static enum outcome updated(struct instance *self, bool *changed) {
    struct core *core = &self->core;
    double before[N_STATES];
    *changed = false;
    if (core->phase != IN_EVENT) {
        say(self, LEVEL_ERROR, "Discrete states are updated in event mode.");
        return HAS_FAILED;
    }
    memcpy(before, core->values + FIRST_STATE, sizeof before);
    int64_t fallen = -1;
    work_out(self, INDICATOR);
    for (int i = 0; i < N_GUARDS && fallen < 0; i++) {
        if (core->armed[i] && !(core->values[FIRST_INDICATOR + i] > 0.0)) {
            fallen = i;
        }
    }
    put_time(core);
    if (core->retuned && !retuned(self)) {
        return HAS_FAILED;
    }
    const double start = next_piece(core);
    const bool begins = start <= core->time + NEARLY * fabs(core->time);
    if (begins) {
        core->w[AT_TIME] = fmax(core->time, start);
    }
    put_states(core, core->w, AT_Y);
    ask(core, PLACE, 0, 0.0, core->w, core->whole);
    forget(core);
    if (is_running(core) && fallen >= 0) {
        ask(core, FALLEN, fallen, 0.0, core->w, core->whole);
    }
    forget(core);
    if (is_running(core) && (begins || core->has_jumped)) {
        if (HELD) {
            hold_inputs(core, core->w[AT_TIME]);
        }
        ask(core, JUMP, 0, 0.0, core->w, core->whole);
    }
    core->has_jumped = false;
    const double end = fmax(core->horizon, core->w[AT_TIME] + 1e-3 * DEFAULT_STOP);
    for (int i = 0; is_running(core); i++) {
        forget(core);
        if (!ask(core, LOOK, 0, end, core->w, core->whole)) {
            break;
        }
        if (i == MOST_FALLS) {
            say(self, LEVEL_ERROR, "t = %.9g s: modes change without end at one instant.",
                core->time);
            return HAS_FAILED;
        }
    }
    forget(core);
    ask(core, SHOWN, 0, 0.0, core->w, core->whole);
    for (int i = 0; i < N_STATES; i++) {
        core->values[FIRST_STATE + i] = core->w[AT_POINT + i];
        *changed = *changed || core->w[AT_POINT + i] != before[i];
        if (!isfinite(core->w[AT_POINT + i])) {
            say(self, LEVEL_ERROR, "t = %.9g s: the state diverged; it is no longer finite.",
                core->time);
            return HAS_FAILED;
        }
    }
    for (int i = 0; i < N_VARIABLES; i++) {
        if (VARIABLES[i].role == EVENT_COUNT) {
            core->values[i] = (double)core->events_counted;
        }
    }
    forget_values(self);
    arm(self, true);
    const struct ending ending = ending_of(core->whole[AT_STATUS]);
    if (ending.outcome != GOES_ON) {
        say(self, ending.outcome == HAS_FAILED ? LEVEL_ERROR : LEVEL_WARNING, "t = %.9g s: %s",
            core->time, ending.words);
    }
    return ending.outcome;
}

/* Note a step of the importer; tell whether it has passed a fall, shown by an indicator or not. */
static bool completed(struct instance *self) {
    struct core *core = &self->core;
    bool found = false;
    put_time(core);
    put_states(core, core->w, AT_Y);
    ask(core, PLACE, 0, 0.0, core->w, core->whole);
    ask(core, NOTE, 0, 0.0, core->w, core->whole);
    forget_values(self);
    work_out(self, INDICATOR);
    for (int i = 0; i < N_GUARDS; i++) {
        if (core->values[FIRST_INDICATOR + i] < -NEARLY * core->sizes[i]) {
            core->armed[i] = found = true;
        }
    }
    arm(self, false);
    return found;
}

static bool in_phase(struct instance *self, enum phase phase, const char *what) {
    if (self->core.phase != (int64_t)phase) {
        say(self, LEVEL_ERROR, "%s cannot be done now: the phase of the simulation is another one.",
            what);
    }
    return self->core.phase == (int64_t)phase;
}

static bool event_entered(struct instance *self) {
    if (!in_phase(self, BETWEEN_EVENTS, "To enter event mode")) {
        return false;
    }
    self->core.phase = IN_EVENT;
    self->core.has_jumped = HELD; /* inputs may have jumped just before */
    return true;
}

static bool continuous_entered(struct instance *self) {
    if (!in_phase(self, IN_EVENT, "To enter continuous-time mode")) {
        return false;
    }
    self->core.phase = BETWEEN_EVENTS;
    return true;
}

static bool time_set(struct instance *self, double t) {
    if (!isfinite(t)) {
        say(self, LEVEL_ERROR, "The time must be a finite number, got %g.", t);
        return false;
    }
    if (t != self->core.time) {
        self->core.time = t;
        forget_values(self);
    }
    return true;
}

static bool fits_count(struct instance *self, size_t n, size_t wanted, const char *what) {
    if (n != wanted) {
        say(self, LEVEL_ERROR, "There are %zu %s, not %zu.", wanted, what, n);
    }
    return n == wanted;
}

static bool states_set(struct instance *self, const double *values, size_t n) {
    if (!in_phase(self, BETWEEN_EVENTS, "To set continuous states")
        || !fits_count(self, n, N_STATES, "continuous states")) {
        return false;
    }
    memcpy(self->core.values + FIRST_STATE, values, N_STATES * sizeof *values);
    forget_values(self);
    return true;
}

static bool states_got(struct instance *self, double *values, size_t n) {
    if (!fits_count(self, n, N_STATES, "continuous states")) {
        return false;
    }
    memcpy(values, self->core.values + FIRST_STATE, N_STATES * sizeof *values);
    return true;
}

static bool rates_got(struct instance *self, double *values, size_t n) {
    if (!fits_count(self, n, N_STATES, "derivatives")) {
        return false;
    }
    work_out(self, DERIVATIVE);
    memcpy(values, self->core.values + FIRST_DERIVATIVE, N_STATES * sizeof *values);
    return true;
}

static bool indicators_got(struct instance *self, double *values, size_t n) {
    if (!fits_count(self, n, N_GUARDS, "event indicators")) {
        return false;
    }
    work_out(self, INDICATOR);
    memcpy(values, self->core.values + FIRST_INDICATOR, N_GUARDS * sizeof *values);
    return true;
}

static bool nominals_got(struct instance *self, double *values, size_t n) {
    if (!fits_count(self, n, N_STATES, "continuous states")) {
        return false;
    }
    memcpy(values, NOMINALS, N_STATES * sizeof *values);
    return true;
}

/* --- directional derivatives, in the modes at hand
 *
 * How rates change with states is exact: the Jacobian of the modes. All else is found by central
 * differences, extrapolated to steps of 0 (Ridders, Adv. Eng. Software 4, 1982). Rates of what is
 * held have no effect, whatever they are set to.
 */

#define LEVELS 12
#define ROUNDED 1e-15 /* of a value that is worked out */
/* Size of an input at least, in its SI unit. Inputs have no nominal value, and one at 0 tells nothing
 * of its size; most enter the accelerations linearly, so that any distance will do. */
#define SIZE_OF_INPUT 1.0
#define WIDEST 0.1 /* first difference over the size of what is varied */
#define NARROWER 3.0

struct line {
    double states[N_STATES], inputs[AT_LEAST_ONE(N_INPUTS)];
    double along_states[N_STATES], along_inputs[AT_LEAST_ONE(N_INPUTS)];
};

/* The numbers of the inputs in the vector of a run, in their order. */
static int input_places(int places[AT_LEAST_ONE(N_INPUTS)]) {
    int n = 0;
    for (int i = 0; i < N_VARIABLES; i++) {
        if (VARIABLES[i].role == INPUT) {
            places[n++] = FIRST_NUMBER + VARIABLES[i].index - 1;
        }
    }
    return n;
}

/* Work one unknown out at a distance along the line. */
static double value_along(struct instance *self, const struct line *line,
                          const struct variable *unknown, double distance) {
    int places[AT_LEAST_ONE(N_INPUTS)];
    const int n = input_places(places);
    double *w = self->w;
    for (int i = 0; i < n; i++) {
        w[places[i]] = line->inputs[i] + distance * line->along_inputs[i];
    }
    for (int i = 0; i < N_STATES; i++) {
        w[AT_POINT + i] = line->states[i] + distance * line->along_states[i];
    }
    const enum role role = unknown->role;
    const enum question question = role == DERIVATIVE ? RATES_AT
                                 : role == INDICATOR ? GUARDS_AT : COLUMNS_AT;
    ask(&self->core, question, 0, 0.0, w, self->whole);
    for (int i = 0; i < n; i++) {
        w[places[i]] = line->inputs[i];
    }
    const int at = role == DERIVATIVE ? AT_STAGES : role == INDICATOR ? AT_SAMPLED : AT_VALUES;
    return w[at + unknown->index];
}

static double extrapolated(struct instance *self, const struct line *line,
                           const struct variable *unknown) {
    double widest = HUGE_VAL, rows[LEVELS][LEVELS], best, least = HUGE_VAL;
    for (int i = 0; i < N_STATES; i++) {
        if (line->along_states[i] != 0.0) {
            widest = fmin(widest, fmax(fabs(line->states[i]), NOMINALS[i])
                                      / fabs(line->along_states[i]));
        }
    }
    for (int i = 0; i < N_INPUTS; i++) {
        if (line->along_inputs[i] != 0.0) {
            widest = fmin(widest, fmax(fabs(line->inputs[i]), SIZE_OF_INPUT)
                                      / fabs(line->along_inputs[i]));
        }
    }
    if (isinf(widest)) {
        return 0.0; /* nothing is varied */
    }
    double plain[LEVELS], h = WIDEST * widest, rounding = 0.0;
    int levels = 0;
    for (int level = 0; level < LEVELS; level++, h /= NARROWER) {
        const double ahead = value_along(self, line, unknown, h);
        const double back = value_along(self, line, unknown, -h);
        const double slope = (ahead - back) / (2.0 * h);
        if (isfinite(slope)) { /* or else the equations do not reach so far */
            plain[levels++] = slope;
            rounding = ROUNDED * (fabs(ahead) + fabs(back)) / h;
        }
    }
    if (levels < 2) {
        return NAN;
    }
    /* wide differences of what is even, or flat, may agree with each other and be wrong */
    const double narrow = plain[levels - 1];
    const double apart = 2.0 * (fabs(narrow - plain[levels - 2]) + rounding);
    best = narrow;
    for (int i = 0; i < levels; i++) {
        rows[i][0] = plain[i];
        double factor = NARROWER * NARROWER;
        for (int j = 1; j <= i; j++, factor *= NARROWER * NARROWER) {
            rows[i][j] = (rows[i][j - 1] * factor - rows[i - 1][j - 1]) / (factor - 1.0);
            const double error = fmax(fabs(rows[i][j] - rows[i][j - 1]),
                                      fabs(rows[i][j] - rows[i - 1][j - 1]));
            if (error < least && fabs(rows[i][j] - narrow) <= apart) {
                least = error;
                best = rows[i][j];
            }
        }
    }
    return best;
}

/* Put the vector of the run at the present instant into the scratch. */
static bool has_point(struct instance *self) {
    struct core *core = &self->core;
    if (core->phase == IN_EVENT || core->phase == BETWEEN_EVENTS) {
        put_time(core);
        memcpy(self->w, core->w, sizeof self->w);
        memcpy(self->whole, core->whole, sizeof self->whole);
        return true;
    }
    if (core->phase == STEPPING && !self->has_point && core->whole[AT_STEPS] > 0) {
        read_off(self, core, core->time);
    }
    if (core->phase != STEPPING || !self->has_point) {
        say(self, LEVEL_ERROR, core->phase == STEPPING
            ? "The state that was brought back has taken no step: directional derivatives are known"
              " after the first one."
            : core->phase == TERMINATED
            ? "The simulation was terminated: directional derivatives are known before its end only."
            : "Directional derivatives are known from the end of initialization on.");
        return false;
    }
    return true;
}

static bool directional(struct instance *self, const uint32_t *unknowns, size_t n,
                        const uint32_t *knowns, size_t m, const double *seed, double *found) {
    struct line line, of_inputs;
    int places[AT_LEAST_ONE(N_INPUTS)];
    memset(&line, 0, sizeof line);
    if (!has_point(self)) {
        return false;
    }
    memcpy(line.states, self->core.values + FIRST_STATE, sizeof line.states);
    const int inputs = input_places(places);
    for (int i = 0; i < inputs; i++) {
        line.inputs[i] = self->w[places[i]];
    }
    for (size_t k = 0; k < m; k++) {
        const struct variable *known = variable_of(self, knowns[k], false);
        if (!known) {
            return false; /* with a message */
        }
        if (known->role != STATE && known->role != INPUT) {
            say(self, LEVEL_ERROR, "%s is neither a state nor an input; directional derivatives are"
                " known along these only.", known->name);
            return false;
        }
        if (known->role == STATE) {
            line.along_states[known->index] += seed[k];
            continue;
        }
        for (int i = 0; i < inputs; i++) {
            if (places[i] == FIRST_NUMBER + known->index - 1) {
                line.along_inputs[i] += seed[k];
            }
        }
    }
    of_inputs = line;
    memset(of_inputs.along_states, 0, sizeof of_inputs.along_states);
    double rates[N_STATES];
    memcpy(self->w + AT_POINT, line.states, sizeof line.states);
    memcpy(self->w + AT_DRIFT, line.along_states, sizeof line.along_states);
    ask(&self->core, ALONG, 0, 0.0, self->w, self->whole);
    memcpy(rates, self->w + AT_STAGES, sizeof rates);
    for (size_t k = 0; k < n; k++) {
        const struct variable *unknown = variable_of(self, unknowns[k], false);
        if (!unknown) {
            return false; /* with a message */
        }
        switch (unknown->role) {
        case STATE:
            found[k] = line.along_states[unknown->index];
            break;
        case DERIVATIVE:
            found[k] = rates[unknown->index] + extrapolated(self, &of_inputs, unknown);
            break;
        case COLUMN:
        case INDICATOR:
            found[k] = extrapolated(self, &line, unknown);
            break;
        default:
            say(self, LEVEL_ERROR, "%s has no directional derivative.", unknown->name);
            return false;
        }
    }
    return true;
}

#endif
