function force = slide_friction(velocity, load)
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

