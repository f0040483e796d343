/*
 * LuGre friction (lugre), exported by stickslip <version>.
 * Source: slide.toml, SHA-256 <hash>
 * Law (LaTeX): F = (\sigma_0 z + \sigma_1 \dot z) N + \sigma_2 |v|^p \operatorname{sgn} v,
 *   \quad \dot z = v - \frac{\sigma_0 |v|}{g} z, \quad g = \mu_k + (\mu_s - \mu_k)
 *   e^{-|v/v_s|^n}
 * Parameters in SI units:
 *   mu_k = 20.0 [N] (kinetic coefficient)
 *   mu_s = 28.0 [N] (static coefficient)
 *   v_s = 0.03 [m/s] (Stribeck velocity)
 *   sigma_0 = 100000.0 [N/m] (bristle stiffness)
 *   sigma_1 = 300.0 [N s/m] (bristle damping)
 *   sigma_2 = 0.0 [N s/m] (viscous coefficient)
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
 * Friction force at a velocity and a bristle state.
 *   velocity: slip velocity [m/s]
 *   z: bristle state [m]
 *   load: normal force; taken as 0 where it is negative [N]
 *   returns: friction force, with the sign of the velocity [N]
 */
double slide_friction(double velocity, double z, double load);

/*
 * Time derivatives of the bristle states.
 *   velocity: slip velocity [m/s]
 *   z: bristle state [m]
 *   load: normal force; taken as 0 where it is negative [N]
 *   returns: time derivative of a bristle state [m/s]
 */
double slide_rates(double velocity, double z, double load);

/*
 * Friction force after long sliding at a constant velocity.
 *   velocity: slip velocity [m/s]
 *   load: normal force; taken as 0 where it is negative [N]
 *   returns: friction force, with the sign of the velocity [N]
 */
double slide_steady(double velocity, double load);

/*
 * Largest friction force at rest.
 *   direction: 1 forward, -1 backward
 *   load: normal force; taken as 0 where it is negative [N]
 *   returns: break-away friction force [N]
 */
double slide_break_away(double direction, double load);

typedef struct {
    double velocity_end; /* slip velocity at the end; exactly 0 at rest [m/s] */
    double z_end; /* bristle state at the end [m] */
    double displacement; /* displacement in the period [m] */
    double friction; /* mean friction force in the period [N] */
    double sticks; /* 0: bristles carry friction at rest */
} slide_step_result;
/*
 * Motion over one period of a body under a constant force and friction.
 *   applied: force on the body without friction, constant over the period [N]
 *   velocity: slip velocity at the start; 0 at rest [m/s]
 *   z: bristle state [m]
 *   load: normal force; taken as 0 where it is negative [N]
 *   mass: mass of the body, above 0 [kg]
 *   period: length of the step, above 0 [s]
 */
slide_step_result slide_step(double applied, double velocity, double z, double load, double mass, double period);

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

