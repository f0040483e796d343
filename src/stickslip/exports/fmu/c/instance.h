/* An instance of the model: what both versions of FMI have in common.
 *
 * The engine is the object code of the solver's kernels (enter_run, enter_play, enter_contacts) and
 * of the model's equations. All of a run is in three vectors, two of real and one of whole numbers,
 * so that the state of an instance is one block of memory without pointers that matter: it is
 * copied, stored and brought back as it is.
 *
 * Without inputs the run goes ahead in steps of its own, and values between are read off its dense
 * output: results do not depend on when the importer asks. With inputs, which are held over each
 * communication step, a step of the run ends where that of the importer does.
 *
 * In model exchange (exchange.h) the importer takes the steps.
 */
#ifndef STICKSLIP_INSTANCE_H
#define STICKSLIP_INSTANCE_H

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum role {
    INDEPENDENT, INPUT, PARAMETER, CONSTANT, STATE, COLUMN, CONTACT_MODE, EVENT_COUNT, DERIVATIVE,
    INDICATOR
};
enum outcome { GOES_ON, HAS_ENDED, HAS_FAILED };
enum level { LEVEL_WARNING = 1, LEVEL_ERROR = 3 };
enum phase { INSTANTIATED, INITIALIZING, STEPPING, IN_EVENT, BETWEEN_EVENTS, TERMINATED };

struct variable {
    const char *name;
    enum role role;
    bool whole;        /* integer, or else real */
    bool tunable;      /* may be set in a run */
    int index;         /* of the input, the place in the vector, the state, column or guard */
    double start;
    double low, high;  /* allowed values */
    bool open;         /* low itself is not allowed */
    int at_least;      /* value reference of another variable that is not larger, or -1 */
    const char *range; /* allowed values in words */
};

struct ending {
    enum outcome outcome;
    const char *words;
};

#include "model.h"

#define ROWS 6
#define EVENT_ROWS (4 * MOST_EVENTS + 4)
#define WIDTH (1 + 3 * N_DRIVES)
#define HELD (N_INPUTS > 0)
#define AT_LEAST_ONE(n) ((n) > 0 ? (n) : 1)

/* Declared as the object code has them: each vector is a place and a length. */
extern void enter_run(double *w, int64_t, int64_t *whole, int64_t, const double *table, int64_t,
                      const double *bounds, int64_t, double t_end, double rtol, double cap,
                      int64_t limit, double *log, int64_t, double *events, int64_t);
extern void enter_play(const double *log, int64_t, int64_t count, const double *times, int64_t,
                       const double *table, int64_t, double *w, int64_t, int64_t *whole, int64_t,
                       double *states, int64_t, double *forces, int64_t, double *rows, int64_t);
extern int64_t enter_exchange(int64_t question, int64_t guard, double t_end, double rtol,
                              double cap, double *w, int64_t, int64_t *whole, int64_t,
                              const double *table, int64_t, const double *log, int64_t,
                              double *events, int64_t);
extern void enter_contacts(void);
extern void equations(int64_t name, int64_t mode, int64_t flags, double t, double *w, int64_t,
                      int64_t at, int64_t to);

/* What is saved and brought back. */
struct core {
    int64_t phase;
    double time;     /* communication point */
    double horizon;  /* time up to which the run may go */
    double tolerance;
    int64_t events_seen, events_counted;
    bool retuned;      /* a parameter was set in the run, and is not in use yet */
    bool exchanges;    /* the importer takes the steps */
    bool has_jumped;   /* inputs or parameters were set in the event at hand */
    bool armed[N_GUARDS]; /* of guards that have been above 0 since the last event */
    double sizes[N_GUARDS]; /* how large guards have been */
    double values[N_VARIABLES];
    double w[SIZE];
    int64_t whole[WHOLES];
    double log[ROWS * ROW_COLUMNS];
    double events[EVENT_ROWS * EVENT_COLUMNS];
    double table[N_INPUTS > 0 ? TABLE_SIZE : 1]; /* own one, since inputs are written to it */
};

struct instance {
    char *name;
    void *environment;
    void (*logger)(void);
    double last_time; /* up to which the last step came */
    bool exchanges;   /* the importer takes the steps */
    bool rates_known, columns_known, guards_known; /* at the time and states of the importer */
    bool has_ended;
    bool has_point;   /* the scratch has been read off at the communication point */
    struct core core;
    double w[SIZE]; /* scratch of what is read off */
    int64_t whole[WHOLES];
};

/* Tells the importer; each version of FMI has its own way. */
static void tell(struct instance *self, enum level level, const char *text);

static void say(struct instance *self, enum level level, const char *format, ...) {
    char text[1024];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    for (char *c = text; *c; c++) {
        if (*c == '%') {
            *c = '/'; /* a logger may take the text for a format */
        }
    }
    tell(self, level, text);
}

static const double *table_of(const struct core *core) {
    return HELD ? core->table : TABLE;
}

static void put_addresses(double *w) {
    int64_t address = (int64_t)(intptr_t)&equations, contacts = (int64_t)(intptr_t)&enter_contacts;
    memcpy(w + AT_ADDRESS, &address, sizeof address);
    memcpy(w + AT_SEVERAL, &contacts, sizeof contacts);
}

/* Write what a run begins with: sizes, parameters, where the equations are. */
static void prepare(const struct core *core, double *w, int64_t *whole) {
    memset(w, 0, SIZE * sizeof *w);
    memcpy(whole, HEADER_NUMBERS, sizeof HEADER_NUMBERS);
    whole[AT_BOOKS] = 1;
    whole[AT_REST_IS_FINAL] = 0; /* what is not told yet may do anything */
    for (int i = 0; i < N_VARIABLES; i++) {
        if (VARIABLES[i].role == PARAMETER || VARIABLES[i].role == CONSTANT) {
            w[VARIABLES[i].index] = core->values[i];
        }
    }
    put_addresses(w);
}

static void forget_values(struct instance *self) {
    self->rates_known = self->columns_known = self->guards_known = false;
}

static void begin(struct instance *self) {
    struct core *core = &self->core;
    memset(core, 0, sizeof *core);
    forget_values(self);
    core->exchanges = self->exchanges;
    core->phase = INSTANTIATED;
    core->horizon = DEFAULT_STOP;
    core->tolerance = TOLERANCE;
    for (int i = 0; i < N_VARIABLES; i++) {
        core->values[i] = VARIABLES[i].start;
    }
    if (HELD) {
        memcpy(core->table, TABLE, sizeof core->table);
    }
    self->last_time = 0.0;
    self->has_ended = self->has_point = false;
}

static struct instance *made(const char *name, const char *token, bool exchanges,
                             void *environment, void (*logger)(void)) {
    struct instance *self = calloc(1, sizeof *self);
    size_t length = name ? strlen(name) : 0;
    if (!self || !(self->name = malloc(length + 1))) {
        free(self);
        return NULL;
    }
    memcpy(self->name, name ? name : "", length + 1);
    self->environment = environment;
    self->logger = logger;
    self->exchanges = exchanges;
    if (!token || strcmp(token, TOKEN) != 0) {
        say(self, LEVEL_ERROR, "The token %s is not that of this FMU, %s: its model description"
            " is another one's.", token ? token : "(none)", TOKEN);
        free(self->name);
        free(self);
        return NULL;
    }
    begin(self);
    return self;
}

static void freed(struct instance *self) {
    if (self) {
        free(self->name);
        free(self);
    }
}

/* --- values */

static const struct variable *variable_of(struct instance *self, uint32_t reference, bool whole) {
    if (reference >= N_VARIABLES || VARIABLES[reference].whole != whole) {
        say(self, LEVEL_ERROR, "No %s variable has the value reference %u.",
            whole ? "integer" : "real", (unsigned)reference);
        return NULL;
    }
    return &VARIABLES[reference];
}

static bool set(struct instance *self, const uint32_t *references, size_t n, const double *values) {
    struct core *core = &self->core;
    for (size_t i = 0; i < n; i++) {
        const struct variable *one = variable_of(self, references[i], false);
        if (!one) {
            return false;
        }
        bool early = one->role == PARAMETER || one->role == STATE;
        if (one->role != INPUT && !early) {
            say(self, LEVEL_ERROR, "%s cannot be set: %s", one->name,
                one->role == CONSTANT ? "the tables or the start of this FMU were made with it;"
                " export the rig with another value." : "it is computed.");
            return false;
        }
        const bool in_run = core->phase == STEPPING || core->phase == IN_EVENT;
        if (early && core->phase > INITIALIZING && !(one->tunable && in_run)) {
            say(self, LEVEL_ERROR, one->tunable
                ? "%s can be set only before the simulation and in events."
                : "%s cannot be set after initialization.", one->name);
            return false;
        }
        if (!isfinite(values[i])) {
            say(self, LEVEL_ERROR, "%s must be %s, got %g.", one->name, one->range, values[i]);
            return false;
        }
        core->values[references[i]] = values[i];
        core->retuned = core->retuned || (early && core->phase > INITIALIZING);
        core->has_jumped = core->has_jumped || core->phase == IN_EVENT;
        forget_values(self);
    }
    return true;
}

static bool are_allowed(struct instance *self) {
    const double *values = self->core.values;
    for (int i = 0; i < N_VARIABLES; i++) {
        const struct variable *one = &VARIABLES[i];
        bool inside = values[i] >= one->low && values[i] <= one->high;
        if (one->open && !(values[i] > one->low)) {
            inside = false;
        }
        if (one->role == PARAMETER && !inside) {
            say(self, LEVEL_ERROR, "%s must be %s, got %.17g.", one->name, one->range, values[i]);
            return false;
        }
        if (one->at_least >= 0 && values[i] < values[one->at_least]) {
            say(self, LEVEL_ERROR, "%s must be at least %s, got %.17g and %.17g.", one->name,
                VARIABLES[one->at_least].name, values[i], values[one->at_least]);
            return false;
        }
    }
    return true;
}

/* --- the run */

static struct ending ending_of(int64_t status) {
    return ENDINGS[status >= 0 && status < N_ENDINGS ? status : N_ENDINGS - 1];
}

/* Count the events that have happened up to a time. */
static void count_events(struct core *core, double until) {
    while (core->events_seen < core->whole[AT_EVENTS] &&
           core->events[core->events_seen * EVENT_COLUMNS] <= until) {
        /* a guard below 0 is a change of mode; some switches of equations are no events */
        const int64_t guard = (int64_t)core->events[core->events_seen * EVENT_COLUMNS + 3];
        core->events_counted += guard < 0 || IS_EVENT[guard];
        core->events_seen++;
    }
}

/* Keep the last row of steps and of events only: memory does not grow. */
static void forget(struct core *core) {
    int64_t *whole = core->whole;
    count_events(core, HUGE_VAL);
    if (whole[AT_STEPS] > 1) {
        memmove(core->log, core->log + (whole[AT_STEPS] - 1) * ROW_COLUMNS,
                ROW_COLUMNS * sizeof *core->log);
        whole[AT_STEPS] = 1;
    }
    if (whole[AT_EVENTS] > 1) {
        memmove(core->events, core->events + (whole[AT_EVENTS] - 1) * EVENT_COLUMNS,
                EVENT_COLUMNS * sizeof *core->events);
        core->events_seen = whole[AT_EVENTS] = 1;
    }
}

/* Take one step, and what happens at its end. */
static void step(struct core *core) {
    static const double bounds[AT_LEAST_ONE(N_PIECES * N_DRIVES * 2)]; /* of no rest that is final */
    const double cap = STEP_CAP;
    do {
        forget(core);
        enter_run(core->w, SIZE, core->whole, WHOLES, table_of(core), TABLE_SIZE, bounds,
                  AT_LEAST_ONE(N_PIECES * N_DRIVES * 2), core->horizon, core->tolerance, cap,
                  core->whole[AT_STEPS] + 1, core->log, ROWS * ROW_COLUMNS, core->events,
                  EVENT_ROWS * EVENT_COLUMNS);
    } while (core->whole[AT_STATUS] == STATUS_FULL);
}

/* Ask the kernels at the time and states in the vectors of a run. */
static int64_t ask(struct core *core, enum question question, int64_t guard, double t_end, double *w,
                   int64_t *whole) {
    return enter_exchange(question, guard, t_end, core->tolerance, STEP_CAP, w, SIZE, whole, WHOLES,
                          table_of(core), TABLE_SIZE, core->log, ROWS * ROW_COLUMNS, core->events,
                          EVENT_ROWS * EVENT_COLUMNS);
}

/* Write the states that were told, or read off, to a place in the vector of a run. */
static void put_states(const struct core *core, double *w, int64_t at) {
    for (int i = 0; i < N_STATES; i++) {
        w[at + i] = core->values[FIRST_STATE + i];
    }
}

/* Work out derivatives or guards at states, and take the results over. */
static void take_values(struct core *core, enum role role, double *w, int64_t *whole) {
    const bool guards = role == INDICATOR;
    put_states(core, w, AT_POINT);
    ask(core, guards ? GUARDS_AT : RATES_AT, 0, 0.0, w, whole);
    for (int i = 0; i < N_VARIABLES; i++) {
        if (VARIABLES[i].role == role) {
            core->values[i] = w[(guards ? AT_SAMPLED : AT_STAGES) + VARIABLES[i].index];
        }
    }
}

/* Hold the inputs in all pieces of the drives that begin up to a time. */
static void hold_inputs(struct core *core, double until) {
    for (int i = 0; i < N_VARIABLES; i++) {
        if (VARIABLES[i].role != INPUT) {
            continue;
        }
        for (int64_t row = core->whole[AT_PIECE]; row < N_PIECES; row++) {
            if (row > core->whole[AT_PIECE] && core->table[row * WIDTH] > until) {
                break;
            }
            core->table[row * WIDTH + VARIABLES[i].index] = core->values[i];
        }
    }
}

/* Run on until a step covers a time; held inputs end the step there. */
static enum outcome run_to(struct core *core, double t, bool held) {
    for (int64_t steps = 0;; steps++) {
        struct ending ending = ending_of(core->whole[AT_STATUS]);
        if (ending.outcome != GOES_ON) {
            return core->w[AT_TIME] < t ? ending.outcome : GOES_ON;
        }
        if (core->whole[AT_STATUS] == STATUS_END_TIME && core->w[AT_TIME] >= core->horizon) {
            if (core->horizon >= t) {
                return GOES_ON;
            }
            core->horizon = held ? t : fmin(core->horizon + DEFAULT_STOP, LAST_TIME);
        } else if (core->w[AT_TIME] > t && core->whole[AT_STEPS] > 0) {
            return GOES_ON;
        }
        if (steps >= MOST_STEPS) {
            core->whole[AT_STATUS] = N_ENDINGS - 1;
            continue;
        }
        step(core);
    }
}

/* Read states, forces and modes off the last row at a time. */
static bool read_off(struct instance *self, struct core *core, double t) {
    double states[AT_LEAST_ONE(N_STATES)], columns[AT_LEAST_ONE(N_COLUMNS)], row;
    const double *last = core->log + (core->whole[AT_STEPS] - 1) * ROW_COLUMNS;
    bool finite = true;
    prepare(core, self->w, self->whole);
    enter_play(last, ROW_COLUMNS, 1, &t, 1, table_of(core), TABLE_SIZE, self->w, SIZE, self->whole,
               WHOLES, states, N_STATES, columns, N_COLUMNS, &row, 1);
    count_events(core, t);
    for (int i = 0; i < N_VARIABLES; i++) {
        const struct variable *one = &VARIABLES[i];
        if (one->role == STATE) {
            core->values[i] = states[one->index];
            finite = finite && isfinite(states[one->index]);
        } else if (one->role == COLUMN) {
            core->values[i] = columns[one->index];
        } else if (one->role == CONTACT_MODE) {
            core->values[i] = last[3];
        } else if (one->role == EVENT_COUNT) {
            core->values[i] = (double)core->events_counted;
        }
    }
    self->w[AT_TIME] = t;
    self->has_point = true;
    take_values(core, DERIVATIVE, self->w, self->whole);
    take_values(core, INDICATOR, self->w, self->whole);
    return finite;
}

/* Put a start onto its stop where it is beyond it by rounding; refuse it farther beyond. */
static bool within_stops(struct instance *self) {
    struct core *core = &self->core;
    const int64_t at = AT_Y, to = AT_VALUES;
    if (N_STOPS > 0 && AT_CONSTANTS > 0) {
        equations(CONSTANTS_OF, 0, 0, 0.0, core->w, SIZE, 0, AT_CONSTANTS);
    }
    if (N_STOPS > 0) {
        equations(WALLS_OF, 0, 0, core->w[AT_TIME], core->w, SIZE, at, to);
    }
    for (int i = 0; i < N_STOPS; i++) {
        const int64_t coordinate = core->whole[FIRST_TABLE + 2 * i];
        const double side = (double)core->whole[FIRST_TABLE + 2 * i + 1];
        const double stop = core->w[to + i * WALL_COLUMNS], place = core->w[at + coordinate];
        if (side * (place - stop) > 1e-12 * fmax(fabs(place), fabs(stop))) {
            int state = 0;
            while (VARIABLES[state].role != STATE || VARIABLES[state].index != coordinate) {
                state++;
            }
            say(self, LEVEL_ERROR, "%s begins at %.9g, beyond its %s stop at %.9g.",
                VARIABLES[state].name, place, side > 0 ? "upper" : "lower", stop);
            return false;
        }
        if (side * (place - stop) > 0) {
            core->w[at + coordinate] = stop;
        }
    }
    return true;
}

/* Take parameters over that were set in a run; the state stays as it is. */
static bool retuned(struct instance *self) {
    struct core *core = &self->core;
    if (!are_allowed(self)) {
        return false;
    }
    if (ending_of(core->whole[AT_STATUS]).outcome != GOES_ON && core->w[AT_TIME] <= core->time) {
        return true; /* no parameter brings back a run that has ended */
    }
    const bool has_begun = core->whole[AT_STATUS] != 0 || core->whole[AT_STEPS] > 0;
    if (!core->exchanges && has_begun) {
        if (core->w[AT_TIME] > core->time) { /* the last step went ahead with the old ones */
            ask(core, CUT, 0, core->time, core->w, core->whole);
            core->whole[AT_EVENTS] = core->events_seen;
        }
        ask(core, SHOWN, 0, 0.0, core->w, core->whole);
        memcpy(core->w + AT_Y, core->w + AT_POINT, N_STATES * sizeof(double));
        core->whole[AT_STATUS] = STATUS_END_TIME;
    } else if (core->exchanges) {
        put_states(core, core->w, AT_Y);
    }
    for (int i = 0; i < N_VARIABLES; i++) {
        if (VARIABLES[i].role == PARAMETER) {
            core->w[VARIABLES[i].index] = core->values[i];
        }
    }
    if (!within_stops(self)) {
        return false;
    }
    if (core->exchanges || has_begun) {
        ask(core, RETUNE, 0, 0.0, core->w, core->whole);
    }
    core->retuned = false;
    return true;
}

static bool entered(struct instance *self, double start, bool has_stop, double stop, bool has_tolerance,
                    double tolerance) {
    struct core *core = &self->core;
    if (core->phase != INSTANTIATED) {
        say(self, LEVEL_ERROR, "Initialization is entered once, after the FMU was instantiated.");
        return false;
    }
    if (!isfinite(start) || (has_stop && !(stop >= start))) {
        say(self, LEVEL_ERROR, "The start time %g must be finite and not after the stop time %g.",
            start, stop);
        return false;
    }
    if (has_stop && stop > LAST_TIME * (1.0 + 1e-9)) {
        say(self, LEVEL_ERROR, "The drives of this FMU are known up to t = %g s, and the simulation"
            " is to end at %g s: export the rig with --t-end.", LAST_TIME, stop);
        return false;
    }
    core->time = self->last_time = start;
    core->horizon = has_stop && stop > start ? fmin(stop, LAST_TIME) : fmin(start + DEFAULT_STOP, LAST_TIME);
    if (has_tolerance && tolerance > 0.0 && tolerance < STORED_TOLERANCE) { /* finer is asked for */
        core->tolerance = fmax(fmin(tolerance, TOLERANCE), LEAST_TOLERANCE); /* never coarser */
    }
    core->phase = INITIALIZING;
    return true;
}

/* --- the whole state */

static struct core *saved(struct instance *self, struct core *place) {
    if (!place && !(place = malloc(sizeof *place))) {
        say(self, LEVEL_ERROR, "There is not enough memory.");
        return NULL;
    }
    memcpy(place, &self->core, sizeof *place);
    return place;
}

static bool brought_back(struct instance *self, const struct core *state) {
    if (state->exchanges != self->exchanges) {
        say(self, LEVEL_ERROR, "The state is one of co-simulation and the instance one of model"
            " exchange, or the other way round.");
        return false;
    }
    memcpy(&self->core, state, sizeof *state);
    forget_values(self);
    put_addresses(self->core.w); /* those of this process */
    self->last_time = state->time;
    self->has_ended = self->has_point = false;
    return true;
}

static size_t stored_size(void) {
    return strlen(TOKEN) + sizeof(struct core);
}

static void stored(const struct core *state, unsigned char *bytes) {
    memcpy(bytes, TOKEN, strlen(TOKEN));
    memcpy(bytes + strlen(TOKEN), state, sizeof *state);
}

static struct core *restored(struct instance *self, const unsigned char *bytes, size_t size) {
    struct core *state;
    if (size != stored_size() || memcmp(bytes, TOKEN, strlen(TOKEN)) != 0) {
        say(self, LEVEL_ERROR, "The serialized state is not one of this FMU.");
        return NULL;
    }
    if (!(state = malloc(sizeof *state))) {
        say(self, LEVEL_ERROR, "There is not enough memory.");
        return NULL;
    }
    memcpy(state, bytes + strlen(TOKEN), sizeof *state);
    return state;
}

#endif
