"""Every result crosses processes, and comes back as it was."""

import inspect
import pickle
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    EventDriven,
    FixedStep,
    Measurement,
    SpringBlock,
    TowedBlock,
    TwoFeet,
    check,
    engine,
    ensemble,
    fit,
    identify,
    load_measurement,
    load_rig,
    plan,
    select,
    simulate,
)
from stickslip.data import LawEstimates, guess_data
from stickslip.engine import Final, Sensitivity
from stickslip.engine.solver import Output
from stickslip.friction import RateState
from stickslip.identify.kinds import fit_rate_state, simulate_velocity_steps
from stickslip.mechanisms.drives import Sampled, Sine
from stickslip.show.display import Tabular
from stickslip.study import presliding_loop
from stickslip.study.control import closed_loop, limit_cycle
from stickslip.study.sweep import average_velocity, band_of, basins

pytestmark = pytest.mark.slow

PLAIN = EventDriven(tier="python")
BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25)
AXIS = Axis(inertia=5.0)
DRIVEN = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=1.0))
TRAVEL = Measurement(travel=0.20, uncertainty=0.005)
T = np.arange(300) / 150
TABLE = Measurement(velocity=np.linspace(0.1, 1.0, 8), friction=2.0 + np.linspace(0.1, 1.0, 8) ** 2)
FEET = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15, stiffness=50.0)


def series(seed=0):
    force = 40 * np.sin(2 * np.pi * T) + 15 * np.sin(5 * T)
    axis = Axis(inertia=5.0, drive=Sampled(times=T, values=force))
    law = CoulombViscous(kinetic_coefficient=10.0, viscous_coefficient=30.0)
    run = simulate(axis, law, t_end=float(T[-1]), solver=PLAIN)
    noise = np.random.default_rng(seed).normal(0.0, 1e-5, T.size)
    return Measurement(time=T, position=run.at(T)["x"] + noise, force=force, name=f"run {seed}")


def steered():
    return closed_loop(
        Axis(inertia=1.0), LAW, lambda _t, seen: 10.0 * (0.1 - seen["x"]), period=0.01, t_end=0.1,
        solver=PLAIN,
    )  # fmt: skip


def pulled():
    block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    return simulate(block, law, t_end=80.0, solver=PLAIN)


def steps():
    law = RateState(
        reference_coefficient=0.6, direct_effect=0.010, evolution_effect=0.014,
        critical_distance=1e-5, reference_velocity=1e-6,
    )  # fmt: skip
    t = np.arange(0.0, 60.0, 0.2)
    knots, places = (0.0, 20.0, 40.0, 60.0), (0.0, 2e-5, 2.2e-4, 2.4e-4)
    run = simulate_velocity_steps(law, stiffness=2e3, time=knots, pull=places, at=t)
    noise = np.random.default_rng(0).normal(0.0, 3e-4, t.size)
    return Measurement(
        time=t, pull=np.interp(t, knots, places), friction=run.coefficient + noise, load=1.0
    )


SLIDER = TowedBlock(mass=1e-3, stiffness=500.0, speed=1e-6, load=1.0)
FREE = {"vary": ["friction.*", "mechanism.stiffness"]}
LEVELS = {"kinetic_coefficient": np.array([0.2, 0.3])}


MADE = {
    "rig": load_rig,
    "measurement": series,
    "run": lambda: simulate(BLOCK, LAW, t_end=1.0, solver=PLAIN),
    "compiled run": lambda: simulate(BLOCK, LAW, t_end=1.0, solver=EventDriven(tier="compiled")),
    "run with fixed steps": lambda: simulate(BLOCK, LAW, t_end=0.2, solver=FixedStep(dt=0.01)),
    "run of several contacts": lambda: simulate(FEET, LAW, t_end=0.2, solver=PLAIN),
    "run of one of several": lambda: simulate(FEET, LAW, t_end=0.2, solver=PLAIN).contact("rear"),
    "certificate": lambda: simulate(BLOCK, LAW, t_end=0.2, solver=PLAIN).certificate,
    "event": lambda: simulate(BLOCK, LAW, t_end=1.0, solver=PLAIN).events[0],
    "status": lambda: simulate(BLOCK, LAW, t_end=0.2, solver=PLAIN).status,
    "ensemble": lambda: ensemble(
        BLOCK, LAW, LEVELS, t_end=0.3, outputs={"end": Final("x")}, solver=PLAIN
    ),
    "output": lambda: Sensitivity("x", "friction.kinetic_coefficient"),
    "closed loop": steered,
    "limit cycle": lambda: limit_cycle(pulled()),
    "loop": lambda: presliding_loop(
        Dahl(kinetic_coefficient=0.25, bristle_stiffness=1e4), 1e-3, load=10.0
    ),
    "travel fit": lambda: fit(BLOCK, Coulomb, TRAVEL),
    "estimate": lambda: fit(BLOCK, Coulomb, TRAVEL).estimates[0],
    "travel verdict": lambda: select(BLOCK, ["coulomb", "viscous"], TRAVEL),
    "law fit": lambda: fit(AXIS, CoulombViscous, series()),
    "band verdict": lambda: select(AXIS, None, TABLE),
    "prediction band": lambda: select(AXIS, None, TABLE).band([0.1, 0.5]),
    "foreseen": lambda: select(AXIS, None, TABLE).predict(
        replace(TABLE, friction=np.asarray(TABLE.friction) + 0.01)
    ),
    "checks": lambda: check(series()),
    "finding": lambda: check(series()).findings[0],
    "settings": lambda: load_rig().reading,
}
"""How one of each kind of result is made."""

SLOW = {
    "plan of readings": lambda: plan(AXIS, None, TABLE, readings=3),
    "band": lambda: band_of(
        BLOCK, LAW, LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.24, 0.26)}),
        t_end=1.0, count=20,
    ),
    "map": lambda: average_velocity(
        DRIVEN, Coulomb(kinetic_coefficient=0.5), {"frequency": [1.0, 1.2]}, cycles=2, settle=2
    ),
    "basins": lambda: basins(
        DRIVEN, Coulomb(kinetic_coefficient=0.5), {"x": [-1.0, 1.0], "v": [-1.0, 1.0]}, settle=20
    ),
    "velocity steps": lambda: fit_rate_state(SLIDER, "rate-and-state", steps(), **FREE),
    "run of a verdict": lambda: select(AXIS, ["coulomb-viscous"], series()).certificate,
    "verdict on velocity steps": lambda: select(
        SLIDER, ["rate-and-state", "rate-and-state-slip"], steps(), **FREE
    ),
}  # fmt: skip
"""Those that take seconds."""

NUMBERS_ONLY = {
    "rig", "certificate", "prediction band", "event", "status", "output", "limit cycle",
    "estimate", "finding",
    "settings",
}  # fmt: skip
"""Kinds without rows."""

ELSEWHERE = {"JointVerdict"}
"""Results whose parts are those of others here, and that take minutes."""
PARTS = {"Criteria", "FixedStepRow", "Interval", "LawCandidate"}
"""What a verdict is made of."""


def text(result):
    """Return what tells two results apart: tables, documents, or all their numbers in words."""
    if isinstance(result, pd.DataFrame):
        return result.to_csv()
    for name in ("to_dataframe", "to_dict"):
        if hasattr(result, name):
            return text(getattr(result, name)())
    return repr(result)


def survives(result):
    again = pickle.loads(pickle.dumps(result))
    assert type(again) is type(result)
    assert text(again) == text(result)


@pytest.fixture(scope="module")
def made():
    """One result of each kind."""
    return {kind: make() for kind, make in MADE.items()}


@pytest.mark.parametrize("kind", MADE)
def test_a_result_comes_back_from_a_pickle_as_it_was(kind, made):
    survives(made[kind])


@pytest.mark.slow  # of parts that the others have as well
@pytest.mark.parametrize("kind", SLOW)
def test_a_result_that_takes_long_comes_back_too(kind):
    survives(SLOW[kind]())


def test_every_public_result_is_in_a_table(made):
    kinds = {one.__name__ for result in made.values() for one in type(result).__mro__}
    slow = {"FurtherPlan", "Plan", "RunCertificate", "SimulatedFit", "SimulatedVerdict"}
    results = {"Checks", "Finding"}
    for door in (engine, identify):
        for name in door.__all__:
            value = getattr(door, name)
            if inspect.isclass(value) and not issubclass(value, Output):
                results.add(name)
    assert results - kinds - slow - ELSEWHERE - PARTS == set()


OTHER = """
import hashlib, pickle, sys
from tests.test_pickling import text
found = pickle.load(sys.stdin.buffer)
run = found.pop("compiled run")
print({kind: hashlib.sha256(text(one).encode()).hexdigest() for kind, one in found.items()})
print(repr(float(run.at(0.123)["x"][0])), repr(float(run.at(0.3).sensitivity("x", "mass")[0])))
"""


@pytest.mark.slow
def test_results_mean_the_same_in_another_process(made):
    import hashlib

    found = {kind: one for kind, one in made.items() if kind != "closed loop"}
    done = subprocess.run(
        [sys.executable, "-c", OTHER], input=pickle.dumps(found), capture_output=True, check=False
    )
    assert done.returncode == 0, done.stderr.decode()
    table, numbers = done.stdout.decode().splitlines()
    run = found.pop("compiled run")
    own = {kind: hashlib.sha256(text(one).encode()).hexdigest() for kind, one in found.items()}
    assert eval(table) == own  # a dict of hashes that this test printed
    x, slope = run.at(0.123)["x"][0], run.at(0.3).sensitivity("x", "mass")[0]
    # plain Python there, machine code here: the same bits
    assert numbers == f"{float(x)!r} {float(slope)!r}"


def test_what_was_measured_is_read_back_from_its_table(made):
    record = made["measurement"]
    again = load_measurement(record.to_dataframe())
    for name in ("time", *record.quantities()):
        np.testing.assert_array_equal(getattr(again, name), getattr(record, name))
    trials = Measurement(trials=(series(0), series(1)))
    both = load_measurement(trials.to_dataframe())
    assert len(both.trials) == 2
    np.testing.assert_array_equal(both.trials[1].force, trials.trials[1].force)
    assert list(TRAVEL.to_dataframe().columns) == ["travel [m]"]


def test_a_guess_comes_back_too(tmp_path, made):
    file = tmp_path / "a.csv"
    made["measurement"].to_dataframe().to_csv(file, index=False)
    survives(guess_data(file))


@pytest.mark.parametrize("kind", MADE)
def test_results_with_rows_are_tables_in_pandas_and_xarray(kind, made, tmp_path):
    if not hasattr(made[kind], "to_dataframe"):
        assert kind in NUMBERS_ONLY
        return
    table, data = made[kind].to_dataframe(), made[kind].to_xarray()
    assert isinstance(table, pd.DataFrame)
    assert len(table) > 0
    (length,) = {data.sizes[dimension] for dimension in data.dims}
    assert length == len(table)
    if isinstance(made[kind], Tabular):
        bare = {str(name).partition(" [")[0] for name in table}
        assert {str(name) for name in data.variables} - {"row"} == bare
    file = tmp_path / "saved.nc"
    data.to_netcdf(file, engine="scipy")  # no column has objects that cannot be saved
    assert file.exists()
