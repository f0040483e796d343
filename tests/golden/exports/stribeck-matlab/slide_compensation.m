function force = slide_compensation(velocity, load, width, factor)
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

