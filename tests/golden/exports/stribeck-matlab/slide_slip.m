function force = slide_slip(speed, direction, load)
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

