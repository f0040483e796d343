package Slide "Friction law of the package stickslip"
  // Stribeck friction (stribeck), exported by stickslip <version>.
  // Source: slide.toml, SHA-256
  //   <hash>
  // Law (LaTeX): F = \left[\mu_k + (\mu_s - \mu_k) e^{-|v/v_s|^n}\right] N \operatorname{sgn} v
  //   + \sigma_2 v, \quad |F| \le \mu_b N \text{ at rest}, \quad \mu_b \ge \mu_s
  // Parameters in SI units:
  //   mu_k = 20.0 [N] (kinetic coefficient)
  //   mu_s = 28.0 [N] (static coefficient)
  //   v_s = 0.03 [m/s] (Stribeck velocity)
  //   sigma_2 = 40.0 [N s/m] (viscous coefficient)
  // Levels are forces in N, because no normal force was known: the load is 1.

    function friction "Friction force at a velocity; 0 at rest, where it may be any force up to break-away."
        input Real velocity(unit="m/s") "slip velocity";
        input Real load(unit="N") "normal force; taken as 0 where it is negative";
        output Real force(unit="N") "friction force, with the sign of the velocity";
    protected
        constant Real mu_k(unit="N") = 20.0 "kinetic coefficient";
        constant Real mu_s(unit="N") = 28.0 "static coefficient";
        constant Real v_s(unit="m/s") = 0.03 "Stribeck velocity";
        constant Real sigma_2(unit="N.s/m") = 40.0 "viscous coefficient";
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
            force := -(-sigma_2*velocity + ((-mu_k + mu_s)*c2 + mu_k)*normal);
        else
            force := 0.0;
        end if;
    end friction;

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

    function slip "Friction in one direction of slip, along which all are counted."
        input Real speed(unit="m/s") "slip speed in the direction";
        input Real direction "1 forward, -1 backward";
        input Real load(unit="N") "normal force; taken as 0 where it is negative";
        output Real force(unit="N") "friction force against the direction";
    protected
        constant Real mu_k(unit="N") = 20.0 "kinetic coefficient";
        constant Real mu_s(unit="N") = 28.0 "static coefficient";
        constant Real v_s(unit="m/s") = 0.03 "Stribeck velocity";
        constant Real sigma_2(unit="N.s/m") = 40.0 "viscous coefficient";
        Real normal;
        Real c1;
    algorithm
        normal := load;
        if normal < 0.0 then
            normal := 0.0;
        end if;
        if 0.0 < -speed + 6.0*v_s then
            c1 := exp(-(speed*speed)/((v_s*v_s)));
        else
            c1 := 0.0;
        end if;
        force := (mu_k + (mu_s - mu_k)*c1)*normal + speed*sigma_2;
    end slip;

    function slide "Speed after slip in one direction, along which all are counted."
        input Real speed(unit="m/s") "slip speed in the direction";
        input Real applied(unit="N") "force on the body without friction, constant over the period";
        input Real load(unit="N") "normal force; taken as 0 where it is negative";
        input Real mass(unit="kg") "mass of the body, above 0";
        input Real period(unit="s") "length of the step, above 0";
        input Real direction "1 forward, -1 backward";
        output Real speed_end(unit="m/s") "slip speed at the end";
    protected
        constant Real mu_k(unit="N") = 20.0 "kinetic coefficient";
        constant Real mu_s(unit="N") = 28.0 "static coefficient";
        constant Real v_s(unit="m/s") = 0.03 "Stribeck velocity";
        constant Real sigma_2(unit="N.s/m") = 40.0 "viscous coefficient";
        Real normal;
        Real force;
        Real force_v;
        Real pivot;
        Real first_v;
        Real speed_mid;
        Real second_v;
        Real c1;
        Real c2;
        Real c3;
        Real c4;
    algorithm
        normal := load;
        if normal < 0.0 then
            normal := 0.0;
        end if;
        if 0.0 < -speed + 6.0*v_s then
            c1 := exp(-(speed*speed)/((v_s*v_s)));
        else
            c1 := 0.0;
        end if;
        if 0.0 < -speed + 6.0*v_s then
            c3 := 1.0/((v_s*v_s));
            c2 := -2.0*exp(-c3*(speed*speed))*c3*speed;
        else
            c2 := 0.0;
        end if;
        c4 := mu_s - mu_k;
        force := normal*(mu_k + c4*c1) + speed*sigma_2;
        force_v := c4*c2*normal + sigma_2;
        pivot := force_v;
        if pivot < 0.0 then
            pivot := 0.0;
        end if;
        pivot := 1.0 + 0.292893219*pivot*period/mass;
        first_v := (applied - force)/(mass*pivot);
        speed_mid := speed + period*first_v;
        if speed_mid < 0.0 then
            speed_mid := 0.0;
        end if;
        force := slip(speed_mid, direction, load);
        second_v := ((applied - force)/mass - 2.0*first_v)/pivot;
        speed_end := speed + period*(1.5*first_v + 0.5*second_v);
    end slide;

    function departure "Direction in which slip begins from rest, 0 if the body sticks."
        input Real applied(unit="N") "force on the body without friction, constant over the period";
        input Real load(unit="N") "normal force; taken as 0 where it is negative";
        output Real direction "1 forward, -1 backward, 0 at rest";
    protected
        Real ahead;
        Real back;
    algorithm
        ahead := break_away(1.0, load);
        back := break_away(-1.0, load);
        if ahead < applied then
            direction := 1.0;
        elseif back < -applied then
            direction := -1.0;
        else
            direction := 0.0;
        end if;
    end departure;

    function step "Motion over one period of a body under a constant force and friction."
        input Real applied(unit="N") "force on the body without friction, constant over the period";
        input Real velocity(unit="m/s") "slip velocity at the start; 0 at rest";
        input Real load(unit="N") "normal force; taken as 0 where it is negative";
        input Real mass(unit="kg") "mass of the body, above 0";
        input Real period(unit="s") "length of the step, above 0";
        output Real velocity_end(unit="m/s") "slip velocity at the end; exactly 0 at rest";
        output Real displacement(unit="m") "displacement in the period";
        output Real friction(unit="N") "mean friction force in the period";
        output Real sticks "1 if the body rests at the end, else 0";
    protected
        Real sense;
        Real share;
        Real used;
        Real rest;
    algorithm
        assert(mass > 0.0, "mass must be above 0 kg");
        assert(period > 0.0, "period must be above 0 s");
        if 0.0 < velocity then
            sense := 1.0;
        elseif velocity < 0.0 then
            sense := -1.0;
        else
            sense := departure(applied, load);
        end if;
        if 0.0 < (sense*sense) then
            velocity_end := slide(sense*velocity, sense*applied, load, mass, period, sense);
            velocity_end := sense*velocity_end;
            if 0.0 < sense*velocity_end then
                displacement := 0.5*period*(velocity + velocity_end);
            else
                share := 0.0;
                if 0.0 < sense*velocity then
                    share := velocity/(velocity - velocity_end);
                end if;
                used := share*period;
                rest := period*(1.0 - share);
                displacement := 0.5*used*velocity;
                sense := departure(applied, load);
                if 0.0 < (sense*sense) then
                    velocity_end := slide(0.0, sense*applied, load, mass, rest, sense);
                    velocity_end := sense*velocity_end;
                    if sense*velocity_end < 0.0 then
                        velocity_end := 0.0;
                    end if;
                    displacement := displacement + 0.5*rest*velocity_end;
                else
                    velocity_end := 0.0;
                end if;
            end if;
        else
            velocity_end := 0.0;
            displacement := 0.0;
        end if;
        sticks := 0.0;
        if (sense*sense) < 1.0 then
            sticks := 1.0;
        end if;
        friction := applied - mass*(velocity_end - velocity)/period;
    end step;

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
        force := friction(velocity, load);
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
        Real force(unit="N") "friction force";
        Real along "friction force along the direction of slip";
        Real sense "1 or -1: the direction of slip, the last one at rest";
        Integer direction(start=if v_start > 0.0 then 1 else if v_start < 0.0 then -1 else 0,
            fixed=true) "1 forward, -1 backward, 0 at rest";
    equation
        der(x) = v;
        mass*der(v) = if direction == 0 then 0.0 else applied - force;
        force = if direction == 0 then applied else direction*along;
        sense = if direction < 0 then -1.0 else 1.0;
        along = slip(direction*v, sense, load);
        when pre(direction) == 0 and applied > break_away(1.0, load) then
            direction = 1;
        elsewhen pre(direction) == 0 and -applied > break_away(-1.0, load) then
            direction = -1;
        elsewhen pre(direction) == 1 and v < 0.0 then
            direction = if -applied > break_away(-1.0, load) then -1 else 0;
            reinit(v, 0.0);
        elsewhen pre(direction) == -1 and v > 0.0 then
            direction = if applied > break_away(1.0, load) then 1 else 0;
            reinit(v, 0.0);
        end when;
    end Body;
end Slide;

