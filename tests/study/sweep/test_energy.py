"""Energy balances of runs, sweeps and orbits."""

import json
import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from tests.commands import commands
from tests.support import SHOWN, example_of, informed

from stickslip import Axis, Capsule, Coulomb, simulate
from stickslip.data import rig_toml
from stickslip.engine.solver import EventDriven
from stickslip.errors import InputError
from stickslip.friction import LAWS
from stickslip.mechanisms import DCMotor, SoftStop, Torque
from stickslip.mechanisms.drives import Feedback, Relay, Sine
from stickslip.study.energy import has_electric_motor
from stickslip.study.sweep import (
    Campaign,
    Case,
    Levels,
    average_velocity,
    campaign,
    energy_balance,
    orbit_diagram,
    periodic_orbit,
)

RUBS = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)
FREQUENCY = "mechanism.drive.drive.frequency"
CAPSULE = Capsule(
    capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03,
    drive=Torque(drive=Sine(amplitude=0.2, frequency=13.0)), upper_stop=2e-3, restitution=0.6,
)  # fmt: skip
SOFT = replace(
    CAPSULE, upper_stop=None, upper_soft_stop=SoftStop(place=2e-3, stiffness=3000.0, damping=0.1)
)
HELD = Axis(
    inertia=1.0, stiffness=50.0,
    drive=Sine(amplitude=3.0, frequency=1.3) + Feedback(state="v", gain=-0.4, reference=0.1)
    + Relay(state="x", above=-1.0, below=1.0, level=0.01),
)  # fmt: skip
RIGS = {name: rig for name, rig in SHOWN.items() if not has_electric_motor(rig)}


@pytest.mark.parametrize(
    "rig", [*RIGS.values(), CAPSULE, SOFT, HELD], ids=[*RIGS, "hard", "soft", "fed"]
)
def test_the_balance_of_every_mechanism_closes(rig):
    run = simulate(rig, RUBS, t_end=1.0, throw=False)
    found, certificate = energy_balance(rig, run), run.certificate
    assert found.mismatch < 1e-9
    size = max(np.abs(found.energy).max(), np.abs(found.drive).max(), found.positive[-1], 1e-12)
    # the books of the run are other quadratures, made while it was integrated
    supplied = found.drive[-1] - found.dampers[-1]
    assert abs(supplied - certificate.work_supplied) < 1e-9 * size
    rubbed = sum(work[-1] for work in found.friction.values())
    assert abs(rubbed - certificate.work_friction) < 1e-9 * size
    assert abs(found.stops[-1] - certificate.work_stops) < 1e-9 * size


@pytest.mark.parametrize("kind", LAWS.values(), ids=LAWS)
def test_the_balance_of_every_law_closes(kind):
    law = example_of(kind)
    rig = informed(SOFT, law)
    run = simulate(rig, law, t_end=0.3, solver=EventDriven(tier="python"), throw=False)
    # works of laws with bristles are as exact as their steps
    assert energy_balance(rig, run).mismatch < (1e-7 if law.states else 1e-9)


def test_a_driven_oscillator_has_the_works_of_its_closed_form():
    force, omega, c, k = 2.0, 2.0 * math.pi * 1.5, 0.5, 100.0
    axis = Axis(
        inertia=1.0, stiffness=k, damping=c, load=0.0,
        drive=Sine(amplitude=force, frequency=1.5),
    )  # fmt: skip
    period = 1.0 / 1.5
    amplitude = force / math.hypot(k - omega**2, c * omega)
    begin = force / complex(k - omega**2, c * omega)
    run = simulate(
        axis, Coulomb(kinetic_coefficient=0.0), t_end=period,
        y0={"x": begin.imag, "v": omega * begin.real},
    )  # fmt: skip
    found = energy_balance(axis, run).works
    work = math.pi * c * omega * amplitude**2
    assert math.isclose(found["drive"], work, rel_tol=1e-9)
    assert math.isclose(found["dampers"], work, rel_tol=1e-9)
    assert found["friction"] == found["stops"] == 0.0


def test_positive_work_is_that_of_the_power_where_it_is_positive():
    run = simulate(SOFT, RUBS, t_end=0.5)
    seen = run.at(np.linspace(0.0, 0.5, 200_001))
    power = 0.2 * np.sin(2.0 * math.pi * 13.0 * seen.t) * seen["xi_dot"]
    assert power.min() < -0.1 * power.max()
    expected = np.trapezoid(np.maximum(power, 0.0), seen.t)
    assert energy_balance(SOFT, run).positive[-1] == pytest.approx(expected, rel=1e-8)


def test_powers_of_a_sweep_an_orbit_and_a_diagram_are_the_same():
    values = [12.9, 13.0]
    swept = average_velocity(CAPSULE, RUBS, {FREQUENCY: values}, settle=300, energy=True)
    orbit = periodic_orbit(CAPSULE, RUBS, settle=300)
    of_orbit = orbit.energy()
    assert of_orbit.mismatch < 1e-9
    taken = sum(of_orbit.works.values()) - of_orbit.works["drive"]
    assert math.isclose(taken, of_orbit.works["drive"], rel_tol=1e-8)  # all that a cycle puts in
    found = of_orbit.columns()
    for name, value in found.items():
        assert math.isclose(swept.energies[name][1], value, rel_tol=1e-6, abs_tol=1e-12), name
    assert {*found} <= {*swept.to_dataframe().columns}
    diagram = orbit_diagram(
        CAPSULE, RUBS, FREQUENCY, (12.9, 13.1), values=3, starts=1, settle=300, cycles=1
    )
    table = diagram.to_dataframe(energy=True)
    nearest = table.iloc[(table[FREQUENCY] - 13.0).abs().argmin()]
    for name, value in found.items():
        assert math.isclose(nearest[name], value, rel_tol=0.05, abs_tol=1e-9), name


def test_runs_of_a_campaign_have_the_columns_of_their_balances(tmp_path):
    values = [0.15, 0.2]
    found = campaign(
        CAPSULE, RUBS, {"drive.drive.amplitude": values}, t_end=1.0, folder=tmp_path / "runs",
        outputs=["x"], energy=True,
    )  # fmt: skip
    table = found.to_dataframe()
    for row, amplitude in enumerate(values):
        rig = replace(CAPSULE, drive=Torque(drive=Sine(amplitude=amplitude, frequency=13.0)))
        run = simulate(rig, RUBS, t_end=1.0)
        balance = energy_balance(rig, run)
        assert balance.mismatch < 1e-9
        for name, value in balance.columns().items():
            assert math.isclose(table[name][row], value, rel_tol=1e-9), name
    assert found.units["power drive"] == "W"
    assert found.units["energy per travel"] == "J/m"


def test_the_command_writes_works_beside_the_run(tmp_path, capsys):
    rig = tmp_path / "rig.toml"
    rig.write_text(rig_toml(CAPSULE, RUBS, title="hard", t_end=1.0))
    output = tmp_path / "run.csv"
    simulated = commands(capsys, "simulate", "--energy", "--samples", "5")
    code, out, _ = simulated(rig, "-o", output, "--json")
    assert code == 0
    told = json.loads(out)["energy"]
    table = pd.read_csv(output)
    balance = energy_balance(CAPSULE, simulate(CAPSULE, RUBS, t_end=1.0), until=0.5)
    assert math.isclose(table["work drive [J]"][2], balance.works["drive"], rel_tol=1e-9)
    for name, work in told["works"].items():
        assert math.isclose(table[f"work {name} [J]"].iloc[-1], work, rel_tol=1e-12), name
    assert told["mismatch"] < 1e-9
    assert told["unit"] == "J/m"
    left = table["energy [J]"].iloc[-1] - table["energy [J]"][0]
    taken = sum(told["works"].values()) - told["works"]["drive"]
    assert math.isclose(told["works"]["drive"] - taken, left, rel_tol=1e-9)


def test_what_cannot_be_balanced_is_refused():
    run = simulate(CAPSULE, RUBS, t_end=0.5)
    with pytest.raises(InputError, match=r"since and until must lie within the run, 0 to 0\.5 s"):
        energy_balance(CAPSULE, run, since=0.4, until=0.6)
    motor = DCMotor(resistance=1.0, torque_constant=0.1, drive=Sine(amplitude=5.0, frequency=1.0))
    axis = Axis(inertia=1e-3, drive=motor)
    with pytest.raises(InputError, match="electric motor"):
        energy_balance(axis, simulate(axis, RUBS, t_end=0.1))
    none = {"runs": 0}

    def count(*_):
        none["runs"] += 1
        return True

    with pytest.raises(InputError, match="electric motor"):
        average_velocity(axis, RUBS, {"inertia": [1e-3]}, energy=True, progress=count)
    assert none["runs"] == 0
    levels = {"inertia": Levels(values=(1e-3, 2e-3))}
    case = Case(mechanism=axis, law=RUBS, t_end=0.1)
    with pytest.raises(InputError, match="electric motor"):
        Campaign(cases=(case,), factors=levels, energy=True).run("unwritten")
