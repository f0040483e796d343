function level = slide_break_away(direction, load)
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

