function speed_end = slide_slide(speed, applied, load, mass, period, direction)
% Stribeck friction (stribeck), exported by stickslip <version>.
% Source: slide.toml, SHA-256 <hash>
% Law (LaTeX): F = \left[\mu_k + (\mu_s - \mu_k) e^{-|v/v_s|^n}\right] N \operatorname{sgn} v +
%   \sigma_2 v, \quad |F| \le \mu_b N \text{ at rest}, \quad \mu_b \ge \mu_s
% Parameters in SI units:
%   mu_k = 20.0 [N] (kinetic coefficient)
%   mu_s = 28.0 [N] (static coefficient)
%   v_s = 0.03 [m/s] (Stribeck velocity)
%   sigma_2 = 40.0 [N s/m] (viscous coefficient)
% Levels are forces in N, because no normal force was known: the load is 1.
%SLIDE_SLIDE  Speed after slip in one direction, along which all are counted.
%  speed: slip speed in the direction [m/s]
%  applied: force on the body without friction, constant over the period [N]
%  load: normal force; taken as 0 where it is negative [N]
%  mass: mass of the body, above 0 [kg]
%  period: length of the step, above 0 [s]
%  direction: 1 forward, -1 backward [1]
%  returns speed_end: slip speed at the end [m/s]
%#codegen
    mu_k = 20.0; % [N] kinetic coefficient
    mu_s = 28.0; % [N] static coefficient
    v_s = 0.03; % [m/s] Stribeck velocity
    sigma_2 = 40.0; % [N s/m] viscous coefficient
    normal = load;
    if normal < 0.0
        normal = 0.0;
    end
    if 0.0 < -speed + 6.0*v_s
        c1 = exp(-(speed*speed)/((v_s*v_s)));
    else
        c1 = 0.0;
    end
    if 0.0 < -speed + 6.0*v_s
        c3 = 1.0/((v_s*v_s));
        c2 = -2.0*exp(-c3*(speed*speed))*c3*speed;
    else
        c2 = 0.0;
    end
    c4 = mu_s - mu_k;
    force = normal*(mu_k + c4*c1) + speed*sigma_2;
    force_v = c4*c2*normal + sigma_2;
    pivot = force_v;
    if pivot < 0.0
        pivot = 0.0;
    end
    pivot = 1.0 + 0.292893219*pivot*period/mass;
    first_v = (applied - force)/(mass*pivot);
    speed_mid = speed + period*first_v;
    if speed_mid < 0.0
        speed_mid = 0.0;
    end
    force = slide_slip(speed_mid, direction, load);
    second_v = ((applied - force)/mass - 2.0*first_v)/pivot;
    speed_end = speed + period*(1.5*first_v + 0.5*second_v);
end

