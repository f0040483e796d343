"""Ensembles: the runs that `simulate` makes, whatever executes them."""

import tracemalloc
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from threading import active_count

import numpy as np
import pytest
from tests.support import example_of

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    EventDriven,
    FixedStep,
    LuGre,
    Pendulum,
    PendulumCart,
    SpringBlock,
    TanhCoulomb,
    TowedBlock,
    TwoLinkArm,
    ensemble,
    simulate,
)
from stickslip.engine import EventCount, EventTimes, Final, Max, Mean, Samples, Sensitivity, Status
from stickslip.engine.solver import ensembles
from stickslip.errors import InputError
from stickslip.friction import LAWS, PRINTED_FORMS
from stickslip.mechanisms import Prescribed, given_inputs
from stickslip.mechanisms.drives import Pulse, Sine, ThreePhase
from stickslip.quantities import vary
from stickslip.study.testing import ORDINARY

PYTHON, COMPILED = EventDriven(tier="python"), EventDriven(tier="compiled")
DECAY = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
SWING = SpringBlock(mass=1.0, stiffness=100.0, compression=0.3, attached=True)
LAW = Coulomb(kinetic_coefficient=0.25)
DRIVEN = Axis(
    inertia=1.0,
    drive=Pulse(level=4.0, duration=0.3, start=0.1)
    + Pulse(level=-3.0, duration=0.2, start=0.5)
    + Sine(amplitude=2.0, frequency=1.5),
    stiffness=2.0,
)
FIRST, SECOND, WAVE = (f"mechanism.drive.parts.{part}" for part in ("0.parts.0", "0.parts.1", "1"))
FRICTION = Coulomb(kinetic_coefficient=0.8, static_coefficient=1.0)
MU = "kinetic_coefficient"
MUS = np.linspace(0.1, 0.5, 23)


class Serial(Executor):
    """Executes at once, in the thread that submits."""

    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        future.set_result(fn(*args, **kwargs))
        return future


def single(rig, law, columns, row, *, t_end, y0=None, solver=PYTHON):
    """Run one row of an ensemble alone."""
    own = {path: float(v[row] if np.ndim(v) else v) for path, v in columns.items()}
    prefixes = ("mechanism", "friction", "initial")
    parts = [{p: v for p, v in own.items() if p.startswith(f"{prefix}.")} for prefix in prefixes]
    start = dict(y0 or {}) | {p.partition(".")[2]: v for p, v in parts[2].items()}
    rig, law = vary(rig, "mechanism", parts[0]), vary(law, "friction", parts[1])
    return simulate(rig, law, t_end=t_end, y0=start, solver=solver, throw=False)


def assert_row_is_run(runs, row, run, states):
    """Compare one row with a run, bit for bit."""
    assert runs.status[row] is run.status
    for state in states:
        # a run given up at an event ends with the state after it, and its series just before
        off = 0.0 if run.status.complete else 1e-13 * np.abs(run[state]).max()
        assert abs(runs[state][row] - run[state][-1]) <= off
    found = [getattr(runs, n)[row] for n in ("energy_error", "guard_violation", "event_residual")]
    known = run.certificate
    assert found == [known.energy_error, known.guard_violation, known.event_residual]
    assert runs.steps[row] == known.steps
    assert runs.certified[row] == known.certified


def assert_same(one, other):
    """Compare two ensembles, bit for bit."""
    assert one.outputs.keys() == other.outputs.keys()
    for name in one.outputs:
        np.testing.assert_array_equal(one[name], other[name])
    assert one.status.tolist() == other.status.tolist()
    for name in ("certified", "energy_error", "guard_violation", "event_residual", "steps"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


CASES = {
    "laws": (DECAY, LAW, {"friction.kinetic_coefficient": np.array([0.1, 0.25, 0.7, 2.0])}, 1.0),
    "rig": (
        SWING,
        LAW,
        {"mechanism.mass": np.array([0.5, 1.0, 4.0]), "mechanism.compression": [0.3, -0.3, 0.0]},
        2.0,
    ),
    "starts": (
        DRIVEN,
        FRICTION,
        {"initial.x": np.array([0.0, 1.0, -1.0]), "initial.v": np.array([0.5, 0.0, -0.5])},
        1.5,
    ),
    "drives, in another order in each row": (
        DRIVEN,
        FRICTION,
        {
            f"{FIRST}.start": np.array([0.1, 0.5, 0.9, 0.5]),
            f"{SECOND}.start": np.array([0.5, 0.2, 0.9, 0.5]),
            f"{FIRST}.duration": np.array([0.3, 0.0, 0.4, 0.2]),
            f"{SECOND}.level": np.array([-3.0, 5.0, 3.0, 4.0]),
        },
        1.5,
    ),
    "a sine, and a number for all": (
        DRIVEN,
        FRICTION,
        {
            f"{WAVE}.frequency": np.array([0.5, 1.0, 7.0]),
            f"{WAVE}.phase": np.array([0.0, 1.0, -1.0]),
            f"{WAVE}.amplitude": 3.0,
            "friction.kinetic_coefficient": 0.3,
        },
        1.5,
    ),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_every_row_is_the_run_that_simulate_makes(case):
    rig, law, columns, t_end = case
    runs = ensemble(rig, law, columns, t_end=t_end, solver=PYTHON)
    for row in range(len(runs)):
        run = single(rig, law, columns, row, t_end=t_end)
        assert_row_is_run(runs, row, run, ("x", "v"))


@pytest.mark.parametrize("name", LAWS)
def test_every_law_runs_in_ensembles(name):
    law = example_of(LAWS[name])
    bare = TowedBlock(mass=1.0, stiffness=50.0, speed=0.2)
    rig = given_inputs(bare, {name: ORDINARY[name] for name in law.inputs})
    columns = {"mechanism.speed": np.array([0.2, -0.1, 0.2])}
    start = {"v": 0.1}
    runs = ensemble(rig, law, columns, t_end=0.15, y0=start, solver=PYTHON)
    states = ("x", "v", *law.states)
    for row in range(3):
        assert_row_is_run(runs, row, single(rig, law, columns, row, t_end=0.15, y0=start), states)
    assert runs["x"][0] == runs["x"][2]


def test_rows_that_fail_say_how_and_do_not_disturb_the_others():
    solver = EventDriven(tier="python", max_steps=6)
    columns = {"initial.x": np.array([0.02, 9.0, 0.03, 5.0, 0.02])}
    rig = SpringBlock(mass=1.0, stiffness=100.0, attached=True)
    runs = ensemble(rig, LAW, columns, t_end=20.0, solver=solver)
    assert Status.STEP_LIMIT in runs.status
    assert Status.AT_REST in runs.status
    for row in range(5):
        run = single(rig, LAW, columns, row, t_end=20.0, solver=solver)
        assert_row_is_run(runs, row, run, ("x", "v"))
    assert runs.steps[1] == 6


# Executors, chunks, progress, cancelling.


@pytest.fixture(scope="module")
def known():
    """Return an ensemble to compare with."""
    return ensemble(SWING, LAW, {MU: MUS}, t_end=2.0, solver=PYTHON)


def test_threads_of_the_compiled_tier_change_nothing(monkeypatch):
    columns = {MU: MUS, "initial.x": 0.01}
    runs = ensemble(DECAY, LAW, columns, t_end=2.0, solver=PYTHON)
    monkeypatch.setattr(ensembles, "MOST_ROWS", 3)
    with ThreadPoolExecutor(5) as pool:
        assert_same(ensemble(DECAY, LAW, columns, t_end=2.0, executor=pool), runs)


def test_any_executor_will_do(known, monkeypatch):
    monkeypatch.setattr(ensembles, "MOST_ROWS", 5)
    assert_same(ensemble(SWING, LAW, {MU: MUS}, t_end=2.0, solver=PYTHON, executor=Serial()), known)


def test_progress_counts_up_to_all_runs(monkeypatch):
    monkeypatch.setattr(ensembles, "MOST_ROWS", 4)
    seen = []
    ensemble(SWING, LAW, {MU: MUS}, t_end=1.0, solver=PYTHON, progress=lambda *c: seen.append(c))
    done = [count for count, _ in seen]
    assert {total for _, total in seen} == {23}
    assert done == sorted(set(done))
    assert len(done) == 6
    assert done[-1] == 23


@pytest.mark.parametrize("executor", [None, Serial()], ids=["threads", "serial"])
def test_what_is_cancelled_is_told_and_has_no_numbers(known, monkeypatch, executor):
    monkeypatch.setattr(ensembles, "MOST_ROWS", 1)
    threads = active_count()
    runs = ensemble(
        SWING, LAW, {MU: MUS}, t_end=2.0, solver=PYTHON, executor=executor,
        progress=lambda done, _: done < 3,
    )  # fmt: skip
    cancelled = np.array([status is Status.CANCELLED for status in runs.status])
    assert 3 <= (~cancelled).sum() < 23
    for name in ("x", "v"):
        assert np.isnan(runs[name][cancelled]).all()
        np.testing.assert_array_equal(runs[name][~cancelled], known[name][~cancelled])
    assert not runs.certified[cancelled].any()
    assert np.isnan(runs.energy_error[cancelled]).all()
    assert not runs.steps[cancelled].any()
    assert active_count() == threads


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError])
def test_what_progress_raises_passes_through_and_leaves_no_threads(monkeypatch, error):
    monkeypatch.setattr(ensembles, "MOST_ROWS", 1)
    threads = active_count()

    def stop(done, count):
        raise error

    with pytest.raises(error):
        ensemble(SWING, LAW, {MU: MUS}, t_end=2.0, solver=PYTHON, progress=stop)
    assert active_count() == threads


def test_memory_grows_by_the_results_and_not_by_the_runs():
    def peak(count):
        mus = np.linspace(0.1, 0.5, count)
        tracemalloc.start()
        ensemble(DECAY, LAW, {MU: mus}, t_end=1.0, outputs=["x"], executor=Serial())
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    peak(8)  # compiles
    few, many = peak(8_192), peak(65_536)
    # column given and kept, its copy, output, status, 5 numbers of evidence, and views of them
    assert many - few <= 250 * (65_536 - 8_192)


# What is refused, and how results look.

REFUSED = {
    "an unknown path": ({"friction.kinetic_coeficient": [1.0]}, r"Did you mean 'friction\.kinetic"),
    "a shared last name": ({"level": [1.0]}, r"parts\.0\.parts\.0\.level, .*1\.level"),
    "an unknown state": ({"initial.w": [1.0]}, "unknown parameter 'initial.w'"),
    "nothing": ({}, "at least one array.*none"),
    "numbers only": ({MU: 0.2}, "at least one array"),
    "two lengths": ({MU: [0.1, 0.2], "initial.x": [1.0]}, f"equal length.*{MU} 2, initial.x 1"),
    "no numbers": ({MU: []}, "empty"),
    "NaN": ({MU: [0.1, np.nan]}, "finite.* nan in run 1"),
    "infinity": ({"initial.x": [0.1, 0.2, -np.inf]}, "finite.* -inf in run 2"),
    "a number out of range": ({MU: [0.1, -0.5, 0.2]}, r"mu_k.* at least 0, got -0\.5"),
    "a wrong order in one row": (
        {MU: [0.1, 0.9, 0.2], "static_coefficient": [0.2, 0.3, 0.4]},
        r"run 1: .*static_coefficient.*at least kinetic_coefficient = 0\.9, got 0\.3",
    ),
    "a wrong order with what does not vary": ({MU: [0.9, 1.5]}, r"run 1: .*= 1\.5, got 1"),
    "a table": ({MU: [[0.1, 0.2]]}, r"array \(n,\), got one of \(1, 2\)"),
    "words": ({MU: ["high"]}, "array of numbers, got"),
    "an object": ({MU: object()}, "array of numbers, got"),
    "complex numbers": ({MU: [1j]}, "array of numbers, got"),
}


@pytest.mark.parametrize("case", REFUSED.values(), ids=REFUSED)
def test_parameters_that_cannot_be_used_are_refused_with_the_reason(case):
    columns, words = case
    with pytest.raises(InputError, match=words):
        ensemble(DRIVEN, FRICTION, columns, t_end=1.0, solver=PYTHON)


OUTPUTS = {
    "a word": ("x", "sequence of names or a mapping, got 'x'"),
    "an unknown state": (["y"], "unknown state in outputs 'y'"),
    "what is no output": ({"x": "x"}, r"outputs\['x'\] must be Final"),
    "an unknown reason": ({"t": EventTimes("stopp")}, "reason of events 'stopp'.*'stop'"),
    "no events": ({"t": EventTimes("stop", count=0)}, "other than 0"),
    "a contact of one": ({"t": EventTimes("stop", contact="pad")}, "one contact: leave contact"),
    "a time beyond the end": ({"x": Samples("x", [0.5, 1.5])}, r"Samples\.times.*t_end = 1 s"),
    "a start beyond the end": ({"x": Max("x", since=2.0)}, r"Max\.since.*t_end = 1 s"),
    "too many cycles": ({"x": Mean("x", last=2.0)}, r"Mean\.last.*t_end = 1 s"),
    "no cycles": ({"x": Mean("x", last=0.0)}, "above 0 s"),
    "other lengths": ({"x": Mean("x", last=[0.5] * 3)}, "'x' has 3 numbers for 2 runs"),
    "a time that is none": ({"x": Samples("x", [np.nan])}, r"Samples\.times"),
}


@pytest.mark.parametrize("case", OUTPUTS.values(), ids=OUTPUTS)
def test_outputs_that_cannot_be_kept_are_refused_with_the_reason(case):
    outputs, words = case
    with pytest.raises(InputError, match=words):
        ensemble(DECAY, LAW, {MU: [0.1, 0.2]}, t_end=1.0, outputs=outputs, solver=PYTHON)


def test_solvers_and_laws_without_exact_events_are_refused():
    with pytest.raises(InputError, match=r"solver must be an EventDriven"):
        ensemble(DECAY, LAW, {MU: MUS}, t_end=1.0, solver=FixedStep(dt=0.1))
    printed = PRINTED_FORMS["printed-1"](kinetic_coefficient=0.2)
    with pytest.raises(InputError, match="EventDriven only, which cannot solve"):
        ensemble(DECAY, printed, {MU: MUS}, t_end=1.0)


def test_numbers_of_a_motion_profile_vary_without_a_sensitivity_asked_for():
    swings = [ThreePhase(amplitude=a, fast=120.0, slow=30.0) for a in (0.5, 0.7)]
    carts = [
        PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing))
        for swing in swings
    ]
    law = Coulomb(kinetic_coefficient=0.2)
    runs = ensemble(carts[0], law, {"amplitude": np.array([0.5, 0.7])}, t_end=0.5)
    single = [simulate(cart, law, t_end=0.5)["x"][-1] for cart in carts]
    np.testing.assert_allclose(runs["x"], single, rtol=1e-12)


def test_rows_have_their_own_sines_of_an_incline():
    """What parameters alone decide is worked out once for each run."""
    rig = SpringBlock(mass=1.0, stiffness=40.0, compression=0.2)
    inclines = np.array([-0.3, 0.0, 0.3])
    law = Coulomb(kinetic_coefficient=0.1)
    runs = ensemble(rig, law, {"mechanism.incline": inclines}, t_end=2.0)
    for angle, x in zip(inclines, runs["x"], strict=True):
        alone = simulate(
            vary(rig, "mechanism", {"mechanism.incline": float(angle)}), law, t_end=2.0
        )
        assert x == alone["x"][-1]
    assert len(set(runs["x"])) == 3


def test_parameters_of_friction_about_an_axis_have_units_of_torques():
    law = CoulombViscous(kinetic_coefficient=0.1, viscous_coefficient=0.1)
    slope = Sensitivity("theta", "viscous_coefficient")
    varied = {"viscous_coefficient": [0.1, 0.2]}
    runs = ensemble(Pendulum(mass=1.0, length=1.0), law, varied, t_end=0.1, outputs={"s": slope})
    assert runs.units["friction.viscous_coefficient"] == "N m s/rad"
    assert runs.units["s"] == "rad/(N m s/rad)"
    arm = TwoLinkArm(
        upper_mass=1.0, upper_length=0.5, upper_centre=0.2, upper_inertia=0.1,
        lower_mass=0.5, lower_centre=0.2, lower_inertia=0.1,
    )  # fmt: skip
    varied = {"friction.elbow.viscous_coefficient": [0.1, 0.2]}
    slope = Sensitivity("elbow", "mechanism.gravity")
    runs = ensemble(arm, {"shoulder": law, "elbow": law}, varied, t_end=0.01, outputs={"s": slope})
    assert runs.units["friction.elbow.viscous_coefficient"] == "N m s/rad"


def test_outputs_and_parameters_have_their_units():
    law = example_of(LuGre)
    cart = PendulumCart(cart_mass=1.0, ball_mass=0.2, length=0.3)
    varied = {
        "mechanism.length": [0.3, 0.4],
        "initial.theta": [0.1, 0.1],
        "viscous_coefficient": [0.1, 0.1],
    }
    kept = {
        "swing": Max("theta"),
        "rate": Samples("omega", [0.1, 0.2]),
        "bent": Final("z"),
        "stops": EventTimes("stop"),
        "count": EventCount("stop"),
    }
    runs = ensemble(cart, law, varied, t_end=0.3, outputs=kept)
    assert runs.units == {
        "mechanism.length": "m",
        "initial.theta": "rad",
        "friction.viscous_coefficient": "N s/m",
        "swing": "rad",
        "rate": "rad/s",
        "bent": "m",
        "stops": "s",
        "count": "1",
    }


@pytest.mark.parametrize("tier", ["python", "compiled"])
def test_what_falls_without_friction_is_certified_though_its_energies_cancel(tier):
    block = SpringBlock(mass=2.04, stiffness=0.073, incline=1.49)
    free = TanhCoulomb(kinetic_coefficient=0.0, smoothing_velocity=10.0, viscous_coefficient=0.0)
    solver, masses = EventDriven(tier=tier), {"mechanism.mass": np.array([0.5, 2.04, 7.0])}
    runs = ensemble(block, free, masses, t_end=25.5, solver=solver)
    for row in range(3):
        run = single(block, free, masses, row, t_end=25.5, solver=solver)
        assert not run.certificate.problems
        assert run.certificate.energy_error < 1e-12
        assert abs(run.certificate.energy_end) < 1e-12 * run["v"][-1] ** 2
        assert_row_is_run(runs, row, run, ("x", "v"))
