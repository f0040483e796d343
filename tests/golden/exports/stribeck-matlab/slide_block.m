function [velocity, displacement, friction, sticks] = slide_block(applied, load, mass, period)
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
%SLIDE_BLOCK  Body with friction, one period at a call.
%  Text of a MATLAB Function block: copy this file into it and give it the sample time `period`.
%    The body begins at rest.
%#codegen
    persistent kept_velocity
    if isempty(kept_velocity)
        kept_velocity = 0;
    end
    [kept_velocity, displacement, friction, sticks] = slide_step(applied, kept_velocity, load, mass, period);
    velocity = kept_velocity;
end

function force = slide_friction(velocity, load)
%SLIDE_FRICTION  Friction force at a velocity; 0 at rest, where it may be any force up to break-
%  away.
%  velocity: slip velocity [m/s]
%  load: normal force; taken as 0 where it is negative [N]
%  returns force: friction force, with the sign of the velocity [N]
%#codegen
    if ~(isscalar(velocity) && isscalar(load))
        each = zeros(size(velocity + load));
        force = arrayfun(@slide_friction, velocity + each, load + each);
        return
    end
    mu_k = 20.0; % [N] kinetic coefficient
    mu_s = 28.0; % [N] static coefficient
    v_s = 0.03; % [m/s] Stribeck velocity
    sigma_2 = 40.0; % [N s/m] viscous coefficient
    if isnan(velocity) || isnan(load)
        force = NaN;
        return
    end
    normal = load;
    if normal < 0.0
        normal = 0.0;
    end
    if 0.0 < velocity
        if 0.0 < 6.0*v_s - velocity
            c1 = exp(-(velocity*velocity)/((v_s*v_s)));
        else
            c1 = 0.0;
        end
        force = sigma_2*velocity + ((-mu_k + mu_s)*c1 + mu_k)*normal;
    elseif velocity < 0.0
        if 0.0 < 6.0*v_s + velocity
            c2 = exp(-(velocity*velocity)/((v_s*v_s)));
        else
            c2 = 0.0;
        end
        force = -(-sigma_2*velocity + ((-mu_k + mu_s)*c2 + mu_k)*normal);
    else
        force = 0.0;
    end
end

function level = slide_break_away(direction, load)
%SLIDE_BREAK_AWAY  Largest friction force at rest.
%  direction: 1 forward, -1 backward [1]
%  load: normal force; taken as 0 where it is negative [N]
%  returns level: break-away friction force [N]
%#codegen
    if ~(isscalar(direction) && isscalar(load))
        each = zeros(size(direction + load));
        level = arrayfun(@slide_break_away, direction + each, load + each);
        return
    end
    mu_s = 28.0; % [N] static coefficient
    if isnan(direction) || isnan(load)
        level = NaN;
        return
    end
    normal = load;
    if normal < 0.0
        normal = 0.0;
    end
    level = mu_s*normal;
end

function force = slide_slip(speed, direction, load)
%SLIDE_SLIP  Friction in one direction of slip, along which all are counted.
%  speed: slip speed in the direction [m/s]
%  direction: 1 forward, -1 backward [1]
%  load: normal force; taken as 0 where it is negative [N]
%  returns force: friction force against the direction [N]
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
    force = (mu_k + (mu_s - mu_k)*c1)*normal + speed*sigma_2;
end

function speed_end = slide_slide(speed, applied, load, mass, period, direction)
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

function direction = slide_departure(applied, load)
%SLIDE_DEPARTURE  Direction in which slip begins from rest, 0 if the body sticks.
%  applied: force on the body without friction, constant over the period [N]
%  load: normal force; taken as 0 where it is negative [N]
%  returns direction: 1 forward, -1 backward, 0 at rest [1]
%#codegen
    ahead = slide_break_away(1.0, load);
    back = slide_break_away(-1.0, load);
    if ahead < applied
        direction = 1.0;
    elseif back < -applied
        direction = -1.0;
    else
        direction = 0.0;
    end
end

function [velocity_end, displacement, friction, sticks] = slide_step(applied, velocity, load, mass, period)
%SLIDE_STEP  Motion over one period of a body under a constant force and friction.
%  applied: force on the body without friction, constant over the period [N]
%  velocity: slip velocity at the start; 0 at rest [m/s]
%  load: normal force; taken as 0 where it is negative [N]
%  mass: mass of the body, above 0 [kg]
%  period: length of the step, above 0 [s]
%  returns velocity_end: slip velocity at the end; exactly 0 at rest [m/s]
%  returns displacement: displacement in the period [m]
%  returns friction: mean friction force in the period [N]
%  returns sticks: 1 if the body rests at the end, else 0 [1]
%#codegen
    if ~(isscalar(applied) && isscalar(velocity) && isscalar(load) && isscalar(mass) && isscalar(period))
        each = zeros(size(applied + velocity + load + mass + period));
        [velocity_end, displacement, friction, sticks] = arrayfun(@slide_step, applied + each, velocity + each, load + each, mass + each, period + each);
        return
    end
    if isnan(applied) || isnan(velocity) || isnan(load) || ~(mass > 0) || ~(period > 0)
        velocity_end = NaN;
        displacement = NaN;
        friction = NaN;
        sticks = NaN;
        return
    end
    if 0.0 < velocity
        sense = 1.0;
    elseif velocity < 0.0
        sense = -1.0;
    else
        sense = slide_departure(applied, load);
    end
    if 0.0 < (sense*sense)
        velocity_end = slide_slide(sense*velocity, sense*applied, load, mass, period, sense);
        velocity_end = sense*velocity_end;
        if 0.0 < sense*velocity_end
            displacement = 0.5*period*(velocity + velocity_end);
        else
            share = 0.0;
            if 0.0 < sense*velocity
                share = velocity/(velocity - velocity_end);
            end
            used = share*period;
            rest = period*(1.0 - share);
            displacement = 0.5*used*velocity;
            sense = slide_departure(applied, load);
            if 0.0 < (sense*sense)
                velocity_end = slide_slide(0.0, sense*applied, load, mass, rest, sense);
                velocity_end = sense*velocity_end;
                if sense*velocity_end < 0.0
                    velocity_end = 0.0;
                end
                displacement = displacement + 0.5*rest*velocity_end;
            else
                velocity_end = 0.0;
            end
        end
    else
        velocity_end = 0.0;
        displacement = 0.0;
    end
    sticks = 0.0;
    if (sense*sense) < 1.0
        sticks = 1.0;
    end
    friction = applied - mass*(velocity_end - velocity)/period;
end

function force = slide_compensation(velocity, load, width, factor)
%SLIDE_COMPENSATION  Force that compensates friction, faded to 0 below a speed.
%  velocity: measured or desired velocity [m/s]
%  load: normal force; taken as 0 where it is negative [N]
%  width: speed below which the force fades to 0, above 0 [m/s]
%  factor: share of friction that is compensated, 1 for all of it [1]
%  returns force: force to add to that of the controller [N]
%#codegen
    if ~(isscalar(velocity) && isscalar(load) && isscalar(width) && isscalar(factor))
        each = zeros(size(velocity + load + width + factor));
        force = arrayfun(@slide_compensation, velocity + each, load + each, width + each, factor + each);
        return
    end
    if isnan(velocity) || isnan(load) || isnan(factor) || ~(width > 0)
        force = NaN;
        return
    end
    force = slide_friction(velocity, load);
    if velocity < 0.0
        c1 = -velocity;
    else
        c1 = velocity;
    end
    share = c1/width;
    if 1.0 < share
        share = 1.0;
    end
    if 0.0 < share
        force = 0.5*share*force*factor*(3.0 - (share*share));
    else
        force = 0.0;
    end
end

