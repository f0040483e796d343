function [velocity_end, displacement, friction, sticks] = slide_step(applied, velocity, load, mass, period)
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

