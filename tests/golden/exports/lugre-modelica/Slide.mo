package Slide "Friction law of the package stickslip"
  // LuGre friction (lugre), exported by stickslip <version>.
  // Source: slide.toml, SHA-256
  //   <hash>
  // Law (LaTeX): F = (\sigma_0 z + \sigma_1 \dot z) N + \sigma_2 |v|^p \operatorname{sgn} v,
  //   \quad \dot z = v - \frac{\sigma_0 |v|}{g} z, \quad g = \mu_k + (\mu_s - \mu_k)
  //   e^{-|v/v_s|^n}
  // Parameters in SI units:
  //   mu_k = 20.0 [N] (kinetic coefficient)
  //   mu_s = 28.0 [N] (static coefficient)
  //   v_s = 0.03 [m/s] (Stribeck velocity)
  //   sigma_0 = 100000.0 [N/m] (bristle stiffness)
  //   sigma_1 = 300.0 [N s/m] (bristle damping)
  //   sigma_2 = 0.0 [N s/m] (viscous coefficient)
  // Levels are forces in N, because no normal force was known: the load is 1.

    function friction "Friction force at a velocity and a bristle state."
        input Real velocity(unit="m/s") "slip velocity";
        input Real z(unit="m") "bristle state";
        input Real load(unit="N") "normal force; taken as 0 where it is negative";
        output Real force(unit="N") "friction force, with the sign of the velocity";
    protected
        constant Real mu_k(unit="N") = 20.0 "kinetic coefficient";
        constant Real mu_s(unit="N") = 28.0 "static coefficient";
        constant Real v_s(unit="m/s") = 0.03 "Stribeck velocity";
        constant Real sigma_0(unit="N/m") = 100000.0 "bristle stiffness";
        constant Real sigma_1(unit="N.s/m") = 300.0 "bristle damping";
        constant Real sigma_2(unit="N.s/m") = 0.0 "viscous coefficient";
        Real normal;
        Real c1;
        Real c2;
        Real c3;
        Real c4;
    algorithm
        normal := load;
        if normal < 0.0 then
            normal := 0.0;
        end if;
        if 0.0 < velocity then
            if 0.0 < 6.0*v_s - velocity then
                c1 := exp(-(velocity*velocity)/((v_s*v_s)));
            else
                c1 := 0.0;
            end if;
            c2 := z*sigma_0;
            force := sigma_2*velocity + normal*((-c2*velocity/(((-mu_k + mu_s)*c1 + mu_k)) + velocity)*sigma_1 + c2);
        elseif velocity < 0.0 then
            if 0.0 < 6.0*v_s + velocity then
                c3 := exp(-(velocity*velocity)/((v_s*v_s)));
            else
                c3 := 0.0;
            end if;
            c4 := z*sigma_0;
            force := sigma_2*velocity + normal*((c4*velocity/(((-mu_k + mu_s)*c3 + mu_k)) + velocity)*sigma_1 + c4);
        else
            force := z*normal*sigma_0;
        end if;
    end friction;

    function rates "Time derivatives of the bristle states."
        input Real velocity(unit="m/s") "slip velocity";
        input Real z(unit="m") "bristle state";
        input Real load(unit="N") "normal force; taken as 0 where it is negative";
        output Real z_rate(unit="m/s") "time derivative of a bristle state";
    protected
        constant Real mu_k(unit="N") = 20.0 "kinetic coefficient";
        constant Real mu_s(unit="N") = 28.0 "static coefficient";
        constant Real v_s(unit="m/s") = 0.03 "Stribeck velocity";
        constant Real sigma_0(unit="N/m") = 100000.0 "bristle stiffness";
        Real c1;
        Real c2;
    algorithm
        if 0.0 < velocity then
            if 0.0 < 6.0*v_s - velocity then
                c1 := exp(-(velocity*velocity)/((v_s*v_s)));
            else
                c1 := 0.0;
            end if;
            z_rate := -z*sigma_0*velocity/(((-mu_k + mu_s)*c1 + mu_k)) + velocity;
        elseif velocity < 0.0 then
            if 0.0 < 6.0*v_s + velocity then
                c2 := exp(-(velocity*velocity)/((v_s*v_s)));
            else
                c2 := 0.0;
            end if;
            z_rate := z*sigma_0*velocity/(((-mu_k + mu_s)*c2 + mu_k)) + velocity;
        else
            z_rate := 0.0;
        end if;
    end rates;

    function steady "Friction force after long sliding at a constant velocity."
        input Real velocity(unit="m/s") "slip velocity";
        input Real load(unit="N") "normal force; taken as 0 where it is negative";
        output Real force(unit="N") "friction force, with the sign of the velocity";
    protected
        constant Real mu_k(unit="N") = 20.0 "kinetic coefficient";
        constant Real mu_s(unit="N") = 28.0 "static coefficient";
        constant Real v_s(unit="m/s") = 0.03 "Stribeck velocity";
        constant Real sigma_2(unit="N.s/m") = 0.0 "viscous coefficient";
        Real normal;
        Real c1;
        Real c2;
    algorithm
        normal := load;
        if normal < 0.0 then
            normal := 0.0;
        end if;
        if 0.0 < velocity then
            if 0.0 < 6.0*v_s - velocity then
                c1 := exp(-(velocity*velocity)/((v_s*v_s)));
            else
                c1 := 0.0;
            end if;
            force := sigma_2*velocity + ((-mu_k + mu_s)*c1 + mu_k)*normal;
        elseif velocity < 0.0 then
            if 0.0 < 6.0*v_s + velocity then
                c2 := exp(-(velocity*velocity)/((v_s*v_s)));
            else
                c2 := 0.0;
            end if;
            force := sigma_2*velocity - ((-mu_k + mu_s)*c2 + mu_k)*normal;
        else
            force := 0.0;
        end if;
    end steady;

    function break_away "Largest friction force at rest."
        input Real direction "1 forward, -1 backward";
        input Real load(unit="N") "normal force; taken as 0 where it is negative";
        output Real level(unit="N") "break-away friction force";
    protected
        constant Real mu_s(unit="N") = 28.0 "static coefficient";
        Real normal;
    algorithm
        normal := load;
        if normal < 0.0 then
            normal := 0.0;
        end if;
        level := mu_s*normal;
    end break_away;

    function compensation "Force that compensates friction, faded to 0 below a speed."
        input Real velocity(unit="m/s") "measured or desired velocity";
        input Real load(unit="N") "normal force; taken as 0 where it is negative";
        input Real width(unit="m/s") "speed below which the force fades to 0, above 0";
        input Real factor(unit="1") "share of friction that is compensated, 1 for all of it";
        output Real force(unit="N") "force to add to that of the controller";
    protected
        Real share;
        Real c1;
    algorithm
        assert(width > 0.0, "width must be above 0 m/s");
        force := steady(velocity, load);
        if velocity < 0.0 then
            c1 := -velocity;
        else
            c1 := velocity;
        end if;
        share := c1/width;
        if 1.0 < share then
            share := 1.0;
        end if;
        if 0.0 < share then
            force := 0.5*share*force*factor*(3.0 - (share*share));
        else
            force := 0.0;
        end if;
    end compensation;

    model Body "Body under an applied force and friction, which sticks and slips"
        parameter Real mass(unit="kg") = 1.0 "mass of the body";
        parameter Real v_start(unit="m/s") = 0.0 "velocity at the start";
        input Real applied(unit="N") "force on the body but friction";
        input Real load(unit="N") "normal force";
        Real x(unit="m", start=0.0, fixed=true) "displacement";
        Real v(unit="m/s", start=v_start, fixed=true) "slip velocity";
        Real z(unit="m", start=0.0, fixed=true) "bristle state";
        Real force(unit="N") "friction force";
        Real z_rate "time derivative of a bristle state";
    equation
        der(x) = v;
        mass*der(v) = applied - force;
        force = friction(v, z, load);
        z_rate = rates(v, z, load);
        der(z) = z_rate;
    end Body;
end Slide;

