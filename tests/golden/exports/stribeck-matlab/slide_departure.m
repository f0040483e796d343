function direction = slide_departure(applied, load)
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

