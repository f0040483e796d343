/*
 * Direction-dependent friction (direction-dependent), exported by stickslip <version>.
 * Source: slide.toml, SHA-256 <hash>
 * Law (LaTeX): F = \begin{cases} \mu_+ N + \sigma_+ v & v > 0 \\ -\mu_- N + \sigma_- v & v < 0
 *   \end{cases}
 * Parameters in SI units:
 *   mu_plus = 15.0 [N] (forward kinetic coefficient)
 *   mu_minus = 18.0 [N] (backward kinetic coefficient)
 *   sigma_plus = 0.0 [N s/m] (forward viscous coefficient)
 *   sigma_minus = 0.0 [N s/m] (backward viscous coefficient)
 * Levels are forces in N, because no normal force was known: the load is 1.
 * Functions have no memory and no side effects. Where an argument is not a number, or one that
 *   must be above 0 is not, the results are NaN. Compile without -ffast-math, which ignores
 *   NaN.
 */
#ifndef SLIDE_H
#define SLIDE_H

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Friction force at a velocity; 0 at rest, where it may be any force up to break-away.
 *   velocity: slip velocity [m/s]
 *   load: normal force; taken as 0 where it is negative [N]
 *   returns: friction force, with the sign of the velocity [N]
 */
double slide_friction(double velocity, double load);

/*
 * Largest friction force at rest.
 *   direction: 1 forward, -1 backward
 *   load: normal force; taken as 0 where it is negative [N]
 *   returns: break-away friction force [N]
 */
double slide_break_away(double direction, double load);

typedef struct {
    double velocity_end; /* slip velocity at the end; exactly 0 at rest [m/s] */
    double displacement; /* displacement in the period [m] */
    double friction; /* mean friction force in the period [N] */
    double sticks; /* 1 if the body rests at the end, else 0 */
} slide_step_result;
/*
 * Motion over one period of a body under a constant force and friction.
 *   applied: force on the body without friction, constant over the period [N]
 *   velocity: slip velocity at the start; 0 at rest [m/s]
 *   load: normal force; taken as 0 where it is negative [N]
 *   mass: mass of the body, above 0 [kg]
 *   period: length of the step, above 0 [s]
 */
slide_step_result slide_step(double applied, double velocity, double load, double mass, double period);

/*
 * Force that compensates friction, faded to 0 below a speed.
 *   velocity: measured or desired velocity [m/s]
 *   load: normal force; taken as 0 where it is negative [N]
 *   width: speed below which the force fades to 0, above 0 [m/s]
 *   factor: share of friction that is compensated, 1 for all of it [1]
 *   returns: force to add to that of the controller [N]
 */
double slide_compensation(double velocity, double load, double width, double factor);

#ifdef __cplusplus
}
#endif

#endif /* SLIDE_H */

