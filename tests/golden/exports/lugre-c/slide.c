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
 */
#include "slide.h"

#include <math.h>

double slide_friction(double velocity, double z, double load)
{
    const double mu_k = 20.0; /* [N] kinetic coefficient */
    const double mu_s = 28.0; /* [N] static coefficient */
    const double v_s = 0.03; /* [m/s] Stribeck velocity */
    const double sigma_0 = 100000.0; /* [N/m] bristle stiffness */
    const double sigma_1 = 300.0; /* [N s/m] bristle damping */
    const double sigma_2 = 0.0; /* [N s/m] viscous coefficient */
    double normal, force, c1, c2, c3, c4;
    if (isnan(velocity) || isnan(z) || isnan(load)) {
        return NAN;
    }
    normal = load;
    if (normal < 0.0) {
        normal = 0.0;
    }
    if (0.0 < velocity) {
        if (0.0 < 6.0*v_s - velocity) {
            c1 = exp(-(velocity*velocity)/((v_s*v_s)));
        } else {
            c1 = 0.0;
        }
        c2 = z*sigma_0;
        force = sigma_2*velocity + normal*((-c2*velocity/(((-mu_k + mu_s)*c1 + mu_k)) + velocity)*sigma_1 + c2);
    } else if (velocity < 0.0) {
        if (0.0 < 6.0*v_s + velocity) {
            c3 = exp(-(velocity*velocity)/((v_s*v_s)));
        } else {
            c3 = 0.0;
        }
        c4 = z*sigma_0;
        force = sigma_2*velocity + normal*((c4*velocity/(((-mu_k + mu_s)*c3 + mu_k)) + velocity)*sigma_1 + c4);
    } else {
        force = z*normal*sigma_0;
    }
    return force;
}

double slide_rates(double velocity, double z, double load)
{
    const double mu_k = 20.0; /* [N] kinetic coefficient */
    const double mu_s = 28.0; /* [N] static coefficient */
    const double v_s = 0.03; /* [m/s] Stribeck velocity */
    const double sigma_0 = 100000.0; /* [N/m] bristle stiffness */
    double z_rate, c1, c2;
    if (isnan(velocity) || isnan(z) || isnan(load)) {
        return NAN;
    }
    if (0.0 < velocity) {
        if (0.0 < 6.0*v_s - velocity) {
            c1 = exp(-(velocity*velocity)/((v_s*v_s)));
        } else {
            c1 = 0.0;
        }
        z_rate = -z*sigma_0*velocity/(((-mu_k + mu_s)*c1 + mu_k)) + velocity;
    } else if (velocity < 0.0) {
        if (0.0 < 6.0*v_s + velocity) {
            c2 = exp(-(velocity*velocity)/((v_s*v_s)));
        } else {
            c2 = 0.0;
        }
        z_rate = z*sigma_0*velocity/(((-mu_k + mu_s)*c2 + mu_k)) + velocity;
    } else {
        z_rate = 0.0;
    }
    return z_rate;
}

double slide_steady(double velocity, double load)
{
    const double mu_k = 20.0; /* [N] kinetic coefficient */
    const double mu_s = 28.0; /* [N] static coefficient */
    const double v_s = 0.03; /* [m/s] Stribeck velocity */
    const double sigma_2 = 0.0; /* [N s/m] viscous coefficient */
    double normal, force, c1, c2;
    if (isnan(velocity) || isnan(load)) {
        return NAN;
    }
    normal = load;
    if (normal < 0.0) {
        normal = 0.0;
    }
    if (0.0 < velocity) {
        if (0.0 < 6.0*v_s - velocity) {
            c1 = exp(-(velocity*velocity)/((v_s*v_s)));
        } else {
            c1 = 0.0;
        }
        force = sigma_2*velocity + ((-mu_k + mu_s)*c1 + mu_k)*normal;
    } else if (velocity < 0.0) {
        if (0.0 < 6.0*v_s + velocity) {
            c2 = exp(-(velocity*velocity)/((v_s*v_s)));
        } else {
            c2 = 0.0;
        }
        force = sigma_2*velocity - ((-mu_k + mu_s)*c2 + mu_k)*normal;
    } else {
        force = 0.0;
    }
    return force;
}

double slide_break_away(double direction, double load)
{
    const double mu_s = 28.0; /* [N] static coefficient */
    double normal, level;
    if (isnan(direction) || isnan(load)) {
        return NAN;
    }
    normal = load;
    if (normal < 0.0) {
        normal = 0.0;
    }
    level = mu_s*normal;
    return level;
}

/* Bristle states at the end of an implicit step with a velocity. */
static double slide_settle(double velocity, double z, double load, double period)
{
    const double mu_k = 20.0; /* [N] kinetic coefficient */
    const double mu_s = 28.0; /* [N] static coefficient */
    const double v_s = 0.03; /* [m/s] Stribeck velocity */
    const double sigma_0 = 100000.0; /* [N/m] bristle stiffness */
    double rate, drop, z_end, c1, c2, c3, c4;
    (void)load;
    if (0.0 < velocity) {
        if (0.0 < 6.0*v_s - velocity) {
            c1 = exp(-(velocity*velocity)/((v_s*v_s)));
        } else {
            c1 = 0.0;
        }
        c2 = sigma_0*velocity/(((-mu_k + mu_s)*c1 + mu_k));
        rate = -z*c2 + velocity;
        drop = c2;
    } else if (velocity < 0.0) {
        if (0.0 < 6.0*v_s + velocity) {
            c3 = exp(-(velocity*velocity)/((v_s*v_s)));
        } else {
            c3 = 0.0;
        }
        c4 = sigma_0*velocity/(((-mu_k + mu_s)*c3 + mu_k));
        rate = z*c4 + velocity;
        drop = -c4;
    } else {
        rate = 0.0;
        drop = 0.0;
    }
    if (drop < 0.0) {
        drop = 0.0;
    }
    z_end = z + rate*period/((1.0 + drop*period));
    return z_end;
}

/* Velocity and bristle states after an implicit Euler step. */
typedef struct {
    double velocity_end; /* slip velocity at the end [m/s] */
    double z_end; /* bristle state at the end [m] */
} slide_implicit_result;
static slide_implicit_result slide_implicit(double velocity, double z, double applied, double load, double mass, double period)
{
    double velocity_end, z_end, force, miss, low, miss_low, shift, scale, tried, miss_tried, c1;
    velocity_end = velocity;
    z_end = slide_settle(velocity_end, z, load, period);
    force = slide_friction(velocity_end, z_end, load);
    miss = velocity_end - velocity - period*(applied - force)/mass;
    low = velocity;
    miss_low = miss;
    shift = -miss;
    velocity_end = velocity + shift;
    for (int turn = 0; turn < 40; turn++) {
        z_end = slide_settle(velocity_end, z, load, period);
        force = slide_friction(velocity_end, z_end, load);
        miss = velocity_end - velocity - period*(applied - force)/mass;
        if (0.0 < miss*miss_low) {
            low = velocity_end;
            miss_low = miss;
            shift = 2.0*shift;
            velocity_end = velocity_end + shift;
        } else {
            break;
        }
    }
    z_end = slide_settle(velocity_end, z, load, period);
    force = slide_friction(velocity_end, z_end, load);
    miss = velocity_end - velocity - period*(applied - force)/mass;
    c1 = velocity_end - low;
    scale = 1e-26*(c1*c1);
    tried = velocity_end;
    miss_tried = miss;
    for (int turn = 0; turn < 60; turn++) {
        if (miss_tried*miss_low < 0.0) {
            velocity_end = (low*miss_tried - tried*miss_low)/(miss_tried - miss_low);
            z_end = slide_settle(velocity_end, z, load, period);
            force = slide_friction(velocity_end, z_end, load);
            miss = velocity_end - velocity - period*(applied - force)/mass;
            if (miss*miss_tried < 0.0) {
                low = tried;
                miss_low = miss_tried;
            } else {
                miss_low = 0.5*miss_low;
            }
            tried = velocity_end;
            miss_tried = miss;
            if ((miss*miss) < scale) {
                break;
            }
        } else {
            break;
        }
    }
    const slide_implicit_result all = {velocity_end, z_end};
    return all;
}

/* Velocity and bristle states after a period. */
typedef struct {
    double velocity_end; /* slip velocity at the end [m/s] */
    double z_end; /* bristle state at the end [m] */
} slide_slide_result;
static slide_slide_result slide_slide(double velocity, double z, double applied, double load, double mass, double period)
{
    double velocity_end, z_end;
    {
        const slide_implicit_result result = slide_implicit(velocity, z, applied, load, mass, 0.292893219*period);
        velocity_end = result.velocity_end;
        z_end = result.z_end;
    }
    velocity_end = velocity + 2.41421356*(velocity_end - velocity);
    z_end = z + 2.41421356*(z_end - z);
    {
        const slide_implicit_result result = slide_implicit(velocity_end, z_end, applied, load, mass, 0.292893219*period);
        velocity_end = result.velocity_end;
        z_end = result.z_end;
    }
    const slide_slide_result all = {velocity_end, z_end};
    return all;
}

slide_step_result slide_step(double applied, double velocity, double z, double load, double mass, double period)
{
    double velocity_end, z_end, displacement, sticks, friction;
    if (isnan(applied) || isnan(velocity) || isnan(z) || isnan(load) || !(mass > 0.0) || !(period > 0.0)) {
        const slide_step_result none = {NAN, NAN, NAN, NAN, NAN};
        return none;
    }
    {
        const slide_slide_result result = slide_slide(velocity, z, applied, load, mass, period);
        velocity_end = result.velocity_end;
        z_end = result.z_end;
    }
    displacement = 0.5*period*(velocity + velocity_end);
    sticks = 0.0;
    friction = applied - mass*(velocity_end - velocity)/period;
    const slide_step_result all = {velocity_end, z_end, displacement, friction, sticks};
    return all;
}

double slide_compensation(double velocity, double load, double width, double factor)
{
    double force, share, c1;
    if (isnan(velocity) || isnan(load) || isnan(factor) || !(width > 0.0)) {
        return NAN;
    }
    force = slide_steady(velocity, load);
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

