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
 */
#include "slide.h"

#include <math.h>

double slide_friction(double velocity, double load)
{
    const double mu_plus = 15.0; /* [N] forward kinetic coefficient */
    const double mu_minus = 18.0; /* [N] backward kinetic coefficient */
    const double sigma_plus = 0.0; /* [N s/m] forward viscous coefficient */
    const double sigma_minus = 0.0; /* [N s/m] backward viscous coefficient */
    double normal, force;
    if (isnan(velocity) || isnan(load)) {
        return NAN;
    }
    normal = load;
    if (normal < 0.0) {
        normal = 0.0;
    }
    if (0.0 < velocity) {
        force = normal*mu_plus + sigma_plus*velocity;
    } else if (velocity < 0.0) {
        force = -(normal*mu_minus - velocity*sigma_minus);
    } else {
        force = 0.0;
    }
    return force;
}

double slide_break_away(double direction, double load)
{
    const double mu_plus = 15.0; /* [N] forward kinetic coefficient */
    const double mu_minus = 18.0; /* [N] backward kinetic coefficient */
    double normal, level;
    if (isnan(direction) || isnan(load)) {
        return NAN;
    }
    normal = load;
    if (normal < 0.0) {
        normal = 0.0;
    }
    if (0.0 < direction) {
        level = normal*mu_plus;
    } else {
        level = normal*mu_minus;
    }
    return level;
}

/* Friction in one direction of slip, along which all are counted. */
static double slide_slip(double speed, double direction, double load)
{
    const double mu_plus = 15.0; /* [N] forward kinetic coefficient */
    const double mu_minus = 18.0; /* [N] backward kinetic coefficient */
    const double sigma_plus = 0.0; /* [N s/m] forward viscous coefficient */
    const double sigma_minus = 0.0; /* [N s/m] backward viscous coefficient */
    double normal, force;
    normal = load;
    if (normal < 0.0) {
        normal = 0.0;
    }
    if (0.0 < direction) {
        force = speed*sigma_plus + normal*mu_plus;
    } else {
        force = speed*sigma_minus + normal*mu_minus;
    }
    return force;
}

/* Speed after slip in one direction, along which all are counted. */
static double slide_slide(double speed, double applied, double load, double mass, double period, double direction)
{
    const double mu_plus = 15.0; /* [N] forward kinetic coefficient */
    const double mu_minus = 18.0; /* [N] backward kinetic coefficient */
    const double sigma_plus = 0.0; /* [N s/m] forward viscous coefficient */
    const double sigma_minus = 0.0; /* [N s/m] backward viscous coefficient */
    double normal, force, force_v, pivot, first_v, speed_mid, second_v, speed_end;
    normal = load;
    if (normal < 0.0) {
        normal = 0.0;
    }
    if (0.0 < direction) {
        force = speed*sigma_plus + normal*mu_plus;
        force_v = sigma_plus;
    } else {
        force = speed*sigma_minus + normal*mu_minus;
        force_v = sigma_minus;
    }
    pivot = force_v;
    if (pivot < 0.0) {
        pivot = 0.0;
    }
    pivot = 1.0 + 0.292893219*pivot*period/mass;
    first_v = (applied - force)/(mass*pivot);
    speed_mid = speed + period*first_v;
    if (speed_mid < 0.0) {
        speed_mid = 0.0;
    }
    force = slide_slip(speed_mid, direction, load);
    second_v = ((applied - force)/mass - 2.0*first_v)/pivot;
    speed_end = speed + period*(1.5*first_v + 0.5*second_v);
    return speed_end;
}

/* Direction in which slip begins from rest, 0 if the body sticks. */
static double slide_departure(double applied, double load)
{
    double ahead, back, direction;
    ahead = slide_break_away(1.0, load);
    back = slide_break_away(-1.0, load);
    if (ahead < applied) {
        direction = 1.0;
    } else if (back < -applied) {
        direction = -1.0;
    } else {
        direction = 0.0;
    }
    return direction;
}

slide_step_result slide_step(double applied, double velocity, double load, double mass, double period)
{
    double sense, velocity_end, displacement, share, used, rest, sticks, friction;
    if (isnan(applied) || isnan(velocity) || isnan(load) || !(mass > 0.0) || !(period > 0.0)) {
        const slide_step_result none = {NAN, NAN, NAN, NAN};
        return none;
    }
    if (0.0 < velocity) {
        sense = 1.0;
    } else if (velocity < 0.0) {
        sense = -1.0;
    } else {
        sense = slide_departure(applied, load);
    }
    if (0.0 < (sense*sense)) {
        velocity_end = slide_slide(sense*velocity, sense*applied, load, mass, period, sense);
        velocity_end = sense*velocity_end;
        if (0.0 < sense*velocity_end) {
            displacement = 0.5*period*(velocity + velocity_end);
        } else {
            share = 0.0;
            if (0.0 < sense*velocity) {
                share = velocity/(velocity - velocity_end);
            }
            used = share*period;
            rest = period*(1.0 - share);
            displacement = 0.5*used*velocity;
            sense = slide_departure(applied, load);
            if (0.0 < (sense*sense)) {
                velocity_end = slide_slide(0.0, sense*applied, load, mass, rest, sense);
                velocity_end = sense*velocity_end;
                if (sense*velocity_end < 0.0) {
                    velocity_end = 0.0;
                }
                displacement = displacement + 0.5*rest*velocity_end;
            } else {
                velocity_end = 0.0;
            }
        }
    } else {
        velocity_end = 0.0;
        displacement = 0.0;
    }
    sticks = 0.0;
    if ((sense*sense) < 1.0) {
        sticks = 1.0;
    }
    friction = applied - mass*(velocity_end - velocity)/period;
    const slide_step_result all = {velocity_end, displacement, friction, sticks};
    return all;
}

double slide_compensation(double velocity, double load, double width, double factor)
{
    double force, share, c1;
    if (isnan(velocity) || isnan(load) || isnan(factor) || !(width > 0.0)) {
        return NAN;
    }
    force = slide_friction(velocity, load);
    if (velocity < 0.0) {
        c1 = -velocity;
    } else {
        c1 = velocity;
    }
    share = c1/width;
    if (1.0 < share) {
        share = 1.0;
    }
    if (0.0 < share) {
        force = 0.5*share*force*factor*(3.0 - (share*share));
    } else {
        force = 0.0;
    }
    return force;
}

