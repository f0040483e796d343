"""Recompute what others published: the page "Capsule robots in the literature".

``python capsule_literature.py`` prints all rows; cells are parted by ``# %%``.
"""

# %% Rows
import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    DirectionDependent,
    LuGre,
    Mechanism,
    PendulumCart,
    SpringBlock,
    Stribeck,
    TowedBlock,
    TwoMassCapsule,
    Viscous,
    ensemble,
    simulate,
)
from stickslip.engine import Status
from stickslip.engine.solver import Samples
from stickslip.friction import law as compose
from stickslip.mechanisms import Contact, InnerMass, Prescribed, Torque
from stickslip.mechanisms.drives import (
    DelayedFeedback,
    Drive,
    Pulse,
    Rotation,
    Sine,
    SineSwing,
    Square,
    ThreePhase,
)
from stickslip.quantities import Quantity
from stickslip.study.sweep import continue_orbit, periodic_orbit

GRAVITY = 9.81
rows = []


def row(source, kind, quantity, theirs, ours, values="ours"):
    error = abs(ours / theirs - 1.0) if theirs else abs(ours)
    rows.append((source, values, kind, quantity, theirs, ours, error))


def mean_speed(mechanism, law, period, settle=40, cycles=20, **start):
    run = simulate(mechanism, law, t_end=(settle + cycles + 0.5) * period, y0=start)
    first, last = run.at([settle * period, (settle + cycles) * period])["x"]
    return (last - first) / (cycles * period)


# %% A block on a spring, 20 % off
law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
push = SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1))
spring = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
for what, theirs, block in (
    ("travel after the push, m", 0.16, push),
    ("measured travel, m", 0.20, spring),
):
    ours = simulate(block, law, t_end=5.0)["x"][-1]
    row("the source paper", "printed", what, theirs, ours, "theirs")


# %% Forced vibration with dry friction
def forced(b, r, **start):
    axis = Axis(inertia=1.0, stiffness=1.0, drive=Sine(amplitude=1.0, frequency=b / math.tau))
    return periodic_orbit(axis, Coulomb(kinetic_coefficient=r), start=start)


def largest(orbit):
    turns = [event.t for event in orbit.events if event.reason == "reversal"]
    return abs(orbit.run().at(turns)["x"]).max()


def den_hartog(b):
    return 1.0 / (1.0 - b * b), math.sin(math.pi / b) / (b * (1.0 + math.cos(math.pi / b)))


for b, r in ((0.8, 0.2), (0.8, 0.6), (1.2, 0.4), (1.5, 0.6)):
    V, U = den_hartog(b)
    known = math.sqrt(V * V - (r * U) ** 2)
    row("Den Hartog 1931", "formula", f"amplitude, b = {b}, r = {r}", known, largest(forced(b, r)))
for b in (0.6, 0.8, 1.2):
    V, U = den_hartog(b)
    known = abs(V) / math.hypot(U, 1.0 / b**2)
    low, high = 0.9 * known, 1.1 * known
    while high - low > 1e-7 * known:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if forced(b, middle).sticking[""] else (middle, high)
    row("Den Hartog 1931", "derived", f"r from which it stops, b = {b}", known, middle)
V, U = den_hartog(0.4)
rests = forced(0.4, 0.9 * V / math.hypot(U, 6.25)).sticking[""]
print(f"b = 0.4, at nine tenths of that r: sticks {rests:.0%} of the time")
sizes = [largest(forced(0.5, 0.1, x=x)) for x in (0.0, -1.0)]
print("b = 0.5, r = 0.1, from two places: amplitudes", *(f"{size:.3f}" for size in sizes))

# %% A mass on a belt: to rest, or into stick-slip
law = Stribeck(
    kinetic_coefficient=0.5, static_coefficient=1.0, stribeck_velocity=0.5, fading_exponent=1.0
)
places, speeds = (
    grid.ravel()
    for grid in np.meshgrid(np.linspace(-1.95, 1.95, 40), np.linspace(0.025, 1.975, 40))
)
late = np.linspace(400.0, 500.0, 401)
known = {1.25: (0.08, 0.006), 1.5: (0.304, 0.0065), 1.7: (0.5085, 0.011), 1.85: (1.0, 0.0)}
for speed, (share, spread) in known.items():
    belt = TowedBlock(mass=1.0, stiffness=1.0, damping=0.1, speed=speed, load=1.0)
    starts = {"initial.x": -places, "initial.v": speed - speeds}
    runs = ensemble(belt, law, starts, t_end=500.0, outputs={"v": Samples("v", late.tolist())})
    still = float(np.mean(abs(speed - runs["v"]).max(axis=1) < 0.2))  # as in features_friction.m
    row("bSTAB 2021", "printed", f"share that rests, belt at {speed}", share, still, "theirs")
    print(f"    standard error of bSTAB {spread}")

# %% When a machine begins to stick
law = Stribeck(
    kinetic_coefficient=2.0,
    static_coefficient=6.0,
    stribeck_velocity=0.1,
    fading_exponent=1.0,
    viscous_coefficient=0.2,
)
known = math.log(10.0 * 4.0 / (5.746 + 0.2)) / 10.0
t = np.linspace(0.0, 20.0, 20001)
low, high = 0.1, 0.3
while high - low > 1e-8 * known:
    middle = 0.5 * (low + high)
    machine = TowedBlock(mass=0.538, stiffness=6957.0, damping=5.746, speed=middle, load=1.0)
    level = 2.0 + 4.0 * math.exp(-10.0 * middle) + 0.2 * middle
    run = simulate(machine, law, t_end=20.0, y0={"x": -level / 6957.0, "v": middle + 1e-6})
    off = abs(run.at(t)["v"] - middle)
    low, high = (middle, high) if off[-2000:].max() > off[:2000].max() else (low, middle)
row("Veraszto, Stepan 2017", "formula", "speed below which it sticks, m/s", known, middle, "theirs")

# %% Stick-slip on a belt with bristles, and without
belt = TowedBlock(mass=1.0, stiffness=1.0, speed=0.2, load=10.0)
fading = {"kinetic_coefficient": 1e-9, "static_coefficient": 0.1, "stribeck_velocity": 1.0 / 3.0}
bristles = compose("lugre(level + hyperbolic)")(
    **fading, bristle_stiffness=10.0, bristle_damping=2.0
)
place, velocity, bristle = 1.043656607367126, 0.081148750297240, -0.007831711872955
start = {"x": -place, "v": 0.2 - velocity, "z": -bristle}  # seen from the belt
run = simulate(belt, bristles, t_end=12.0, y0=start)
low, high = 10.9, 11.1  # the velocity falls through its value at the start
for _ in range(60):
    middle = 0.5 * (low + high)
    low, high = (middle, high) if 0.2 - run.at([middle])["v"][0] > velocity else (low, middle)
turn = run.at([low])
for quantity, theirs, ours in (
    ("place after a turn, LuGre, m", place, 0.2 * low - turn["x"][0]),
    ("bristle after a turn, LuGre, m", bristle, -turn["z"][0]),
):
    row("Leine", "printed", quantity, theirs, ours, "theirs")
run = simulate(belt, compose("level + hyperbolic")(**fading), t_end=30.0, y0={"v": 0.2})
t = np.linspace(13.0, 30.0, 170001)
largest_place = (0.2 * t - run.at(t)["x"]).max()
row("Leine", "printed", "largest place, no bristles, m", 1.135, largest_place, "theirs")
stops = [event.t for event in run.events if event.reason == "stop"]
print(f"turn with bristles {low:.5f} s, without {stops[-1] - stops[-2]:.5f} s")


# %% A microactuator at its stop
@dataclass(frozen=True, kw_only=True)
class Microactuator(Mechanism):
    """A body of mass 5 with a mass 1 on a spring 1 inside: voltage, signal."""

    name: ClassVar[str] = "microactuator"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "xi")
    rates: ClassVar[tuple[str, ...]] = ("v", "xi_dot")
    units: ClassVar[tuple[str, ...]] = ("m", "m")
    voltage: Annotated[float, Quantity("V", low=0)]
    signal: Drive

    def kinetic_energy(self, q, q_dot):
        inner = q_dot["x"] + q_dot["xi"]
        return 2.5 * q_dot["x"] * q_dot["x"] + 0.5 * inner * inner

    def potential_energy(self, t, q):
        return 0.5 * q["xi"] * q["xi"]

    def forces(self, t, q, q_dot, drives):
        pull = self.voltage**2 * drives["signal"] ** 2 / (1.0 - q["xi"]) ** 2
        return {"xi": pull - 0.04 * q_dot["xi"]}

    def contacts(self):
        return (Contact(slip="x", load=1.0),)

    def drives(self):
        return {"signal": self.signal}


phase, rate = -0.0095526, 0.9189
actuator = Microactuator(
    voltage=0.58762, signal=Sine(amplitude=1.0, frequency=rate / math.tau, phase=phase)
)
law = Coulomb(kinetic_coefficient=5.0 * 3.1784)
orbit = periodic_orbit(actuator, law, start={"xi": 0.5}, settle=0)
turn = orbit.run().at([(0.5 * math.pi - phase) / rate])
for quantity, theirs, ours in (
    ("place at the stop", 0.5, orbit.start["xi"]),
    ("place at the largest voltage", 0.25073, turn["xi"][0]),
    ("rate at the largest voltage", 0.0043073, turn["xi_dot"][0]),
):
    row("Dankowicz, Schilder 2013", "printed", quantity, theirs, ours, "theirs")
print(f"largest multiplier {max(abs(orbit.multipliers)):.3f}")


# %% A body against a hard stop
def impacting(rate, stop, phase):
    signal = Sine(amplitude=1.0, frequency=rate / math.tau, phase=phase + 0.5 * math.pi)
    return Axis(inertia=1.0, stiffness=1.0, upper_stop=stop, restitution=0.8, drive=signal)


def impact(orbit):
    """Return when the body meets the stop, and its velocity after that."""
    (time,) = (event.t for event in orbit.events if event.reason == "hits stop")
    return time, orbit.run().at([time])["v"][0]


law = Viscous(viscous_coefficient=0.1)
orbit = periodic_orbit(impacting(1.0, 1.0, -math.pi), law, settle=200)
time, velocity = impact(orbit)
for quantity, theirs, ours in (
    ("place at the phase -pi", -0.98, orbit.start["x"]),
    ("velocity at the phase -pi", -0.29, orbit.start["v"]),
    ("phase of the impact", 0.076, time - math.pi),
    ("velocity after the impact", -1.36, velocity),
):
    row("Dankowicz, Schilder 2013", "printed", quantity, theirs, ours, "theirs")


# %% A body against a hard stop
def dux(rate, r=0.8):
    """Return velocity into the stop over its place, and that at the doubling."""
    gamma, c, s = 1.0 / (1.0 - rate**2), math.cos(math.tau / rate), math.sin(math.tau / rate)
    p, q = s * (1.0 + r) / (1.0 - c), (1.0 - r) / rate
    b = 4.0 * r * c - 2.0 * (1.0 + r * r) + (rate**2 - 1.0) * p * p * (1.0 - c)
    under = b * b + ((1 + r) * rate * s) ** 2 * (rate**2 * (p * p + q * q) - 2.0 * b / (1.0 - c))
    doubled = abs(2.0 * (1.0 + r) * s * rate**2 * gamma) / math.sqrt(under)

    def into(place):
        root = math.sqrt(gamma**2 * (p * p + q * q) - (place * q) ** 2)
        return 2.0 * (root - p * place) / (p * p + q * q)

    return into, doubled


free = Viscous(viscous_coefficient=0.0)
for rate, place in ((2.2, 0.15), (2.5, 0.0)):
    into, doubled = dux(rate)
    orbit = periodic_orbit(impacting(rate, place, 0.0), free, start={"x": place - 0.3}, settle=300)
    what = f"velocity into the stop, omega = {rate}"
    row("Dux 1992", "formula", what, into(place), -impact(orbit)[1] / 0.8)
    branch = continue_orbit(orbit, "upper_stop", (place, place + 0.1))
    (found,) = (event.value for event in branch.events if event.kind == "period doubling")
    row("Dux 1992", "formula", f"velocity at doubling, omega = {rate}", doubled, into(found))
    print(f"    the period doubles with the stop at {found:.6f}")

# %% A grazing orbit under delayed feedback
damping, force, omega, gain = 0.01, 0.9 * 0.8**2 / 1.26, 0.8, 0.12


def amplitude(delay):
    """Return the amplitude of the linear oscillator, whose stop is at 1."""
    fed = 1j * omega * gain * (1.0 - np.exp(-1j * omega * delay))
    return force / abs(1.0 - omega**2 + 2j * damping * omega + fed)


touches = brentq(lambda delay: amplitude(delay) - 1.0, 3.8, 5.0)
push = Sine(amplitude=force, frequency=omega / math.tau, phase=0.5 * math.pi)
fed = push + DelayedFeedback(state="v", gain=gain, delay=touches)
oscillator = Axis(inertia=1.0, stiffness=1.0, damping=2.0 * damping, load=0.0, drive=fed)
run = simulate(oscillator, Coulomb(kinetic_coefficient=0.0), t_end=36.0 * math.tau / omega)
largest_place = run.at(np.linspace(35.0, 36.0, 2001) * math.tau / omega)["x"].max()
row("PWSDDE-cont", "formula", "largest place, delay 4.7008", 1.0, largest_place, "theirs")

# %% The quickest two-body crawler
p, mu, L = 0.2, 0.2, 0.02
law, slow = Coulomb(kinetic_coefficient=mu), mu * GRAVITY / p


def crawler(w):
    stroke = ThreePhase(amplitude=0.5 * L, fast=w, slow=slow, first="slow")
    body = Capsule(capsule_mass=1.0 - p, inner_mass=p, drive=Prescribed(profile=stroke))
    return periodic_orbit(body, law).mean_velocity["x"]


w = 50.0
rate = math.sqrt(2.0 * L / (1.0 / slow + 1.0 / w))
back = 2.0 * rate / w
v = (p * w - mu * GRAVITY) * back
closed = (v * back / 2.0 + v * v / (4.0 * mu * GRAVITY)) / (2.0 * rate / slow + back)
row("Chernousko 2002", "derived", "mean speed, w = 50 m/s^2, m/s", closed, crawler(w))
limit = math.sqrt(p * L * mu * GRAVITY / 2.0)
row("Chernousko 2002", "derived", "mean speed, w = 1e8 m/s^2, m/s", limit, crawler(1e8))

# %% When a vibration moves the body at all
M, m, A = 0.8, 0.2, 0.02
for forward, backward in ((0.2, 0.2), (0.1, 0.3)):
    law = DirectionDependent(
        forward_kinetic_coefficient=forward, backward_kinetic_coefficient=backward
    )
    known = math.sqrt((M + m) * GRAVITY * min(forward, backward) / (m * A)) / math.tau
    low, high = 0.5 * known, 2.0 * known
    while high - low > 1e-9 * known:
        middle = 0.5 * (low + high)
        swing = Prescribed(profile=SineSwing(amplitude=A, frequency=middle))
        run = simulate(Capsule(capsule_mass=M, inner_mass=m, drive=swing), law, t_end=3.0 / middle)
        low, high = (low, middle) if np.ptp(run["x"]) > 0.0 else (middle, high)
    what = f"least frequency, {forward}, {backward}, Hz"
    row("Fang and Xu 2012", "formula", what, known, middle)

# %% A film of oil carries nobody
stroke = ThreePhase(amplitude=0.02, fast=50.0, slow=9.81, first="slow")
body = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
speed = mean_speed(body, Viscous(viscous_coefficient=2.0), float(stroke.period), settle=200)
row("Moscow Univ. Mech. Bull.", "theorem", "mean speed on a viscous film, m/s", 0.0, speed)
speed = mean_speed(body, Coulomb(kinetic_coefficient=0.2), float(stroke.period))
print(f"the same stroke with Coulomb friction: {1e3 * speed:.1f} mm/s")


# %% Even vibration goes a limited way
def limited_way(frequency, mu):
    start = 0.2 * 0.01 * math.tau * frequency  # what the body has when the mass is at rest
    swing = Prescribed(profile=SineSwing(amplitude=0.01, frequency=frequency))
    driven = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=swing)
    cycles = math.ceil(12.0 * frequency * start / (mu * GRAVITY))
    law = Coulomb(kinetic_coefficient=mu)
    run = simulate(driven, law, t_end=(cycles + 0.5) / frequency, y0={"v": start})
    return run.at(cycles / frequency)["x"][0]


way = limited_way(40.0, 0.02)
faster, rougher = limited_way(80.0, 0.02) / way, limited_way(40.0, 0.04) / way
row("Provatidis 2013", "formula", "way at twice the speed, over way", 4.0, faster)
row("Provatidis 2013", "formula", "way at twice the friction, over way", 0.5, rougher)

# %% One periodic motion, whatever the start
turn = Rotation(rate=45.0)
body = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.02, pendulum=Prescribed(profile=turn))
law = Coulomb(kinetic_coefficient=0.2)
speeds = [mean_speed(body, law, math.tau / 45.0, v=v) for v in (-1.0, -0.1, 0.0, 0.3, 2.0)]
print("mean speeds, m/s:", *(f"{speed:.7f}" for speed in speeds))
row("Bardin and Panev 2018", "theorem", "spread over starts, m/s", 0.0, np.ptp(speeds))

# %% Small friction, by averaging
share, largest = 0.1 * 0.02 * 45.0**2 / (0.6 * GRAVITY), 0.1 * 0.02 * 45.0 / 0.6
s = share / math.sqrt(1.0 + share**2)
for _ in range(60):  # Newton's method
    c = math.sqrt(1.0 - s * s)
    s -= (math.asin(s) - share * c) * c / (1.0 + share * s)
light = periodic_orbit(body, Coulomb(kinetic_coefficient=0.001), settle=6000)
ours = light.mean_velocity["x"]
row("Bolotnik and others 2006", "derived", "mean speed, mu = .001, m/s", s * largest, ours)


# %% Small friction, by averaging
def crossed(mu):
    along, up = (Prescribed(profile=SineSwing(amplitude=a, frequency=8.0)) for a in (0.01, 0.005))
    robot = TwoMassCapsule(
        capsule_mass=0.6,
        first=InnerMass(mass=0.2, drive=along),
        second=InnerMass(mass=0.2, angle=0.5 * math.pi, drive=up),
    )
    orbit = periodic_orbit(robot, Coulomb(kinetic_coefficient=mu), settle=int(30.0 / mu))
    return orbit.mean_velocity["x"]


slow, quick = crossed(0.005), crossed(0.01)
print(f"{1e3 * slow:.4f} mm/s at mu = 0.005, {1e3 * quick:.4f} mm/s at mu = 0.01")
row("Axioms 14 (2025) 694", "derived", "speed, friction doubled, over speed", 2.0, quick / slow)

# %% Up a slope with an unbalanced rotor
BODY, ROTOR, ARM = 0.5, 0.1, 0.02
law = DirectionDependent(forward_kinetic_coefficient=0.1, backward_kinetic_coefficient=0.4)


def rotor(rate, slope):
    motor = Prescribed(profile=Rotation(rate=rate, start=math.pi))
    return PendulumCart(
        cart_mass=BODY, ball_mass=ROTOR, length=ARM, pendulum=motor, incline=math.radians(slope)
    )


for slope in (0.0, 20.0):
    known = math.sqrt((BODY + ROTOR) * GRAVITY * math.cos(math.radians(slope)) / (ROTOR * ARM))
    low, high = 0.5 * known, 2.0 * known
    while high - low > 1e-9 * known:
        middle = 0.5 * (low + high)
        run = simulate(rotor(middle, slope), law, t_end=3 * math.tau / middle, throw=False)
        low, high = (middle, high) if run.status is Status.END_TIME else (low, middle)
    row("extrica 24917 (2025)", "derived", f"lift-off at {slope:.0f} degrees, rad/s", known, middle)
climb = {slope: mean_speed(rotor(45.0, slope), law, math.tau / 45.0) for slope in range(0, 21, 4)}
print("mean speed, mm/s:", *(f"{slope} deg {1e3 * v:.1f}" for slope, v in climb.items()), sep="  ")


# %% A pendulum on a vibrating pipe
def pipe(frequency, acceleration, damping):
    return PendulumCart(
        cart_mass=0.5,
        ball_mass=0.05,
        length=0.1,
        pivot_damping=damping,
        ground=Sine(amplitude=acceleration, frequency=frequency),
    )


def settled(mechanism, law, frequency, cycles, **start):
    """Return time, angle and speed over the last 100 cycles."""
    run = simulate(mechanism, law, t_end=(cycles + 0.5) / frequency, y0=start)
    t = np.linspace((cycles - 100) / frequency, cycles / frequency, 20001)
    last = run.at(t)
    return t, last["theta"], frequency * (last["x"][-1] - last["x"][0]) / 100.0


uneven = compose("both_ways(viscous)")(
    forward_viscous_coefficient=0.2, backward_viscous_coefficient=1.0
)
frequency = 2.0 * math.sqrt(GRAVITY / 0.1) / math.tau
for name, law in {"uneven": uneven, "even": Viscous(viscous_coefficient=0.6)}.items():
    start = {"theta": math.pi + 0.3}
    t, angle, speed = settled(pipe(frequency, 2.0, 1e-4), law, frequency, 400, **start)
    print(f"{name} damping: {1e3 * speed:.4f} mm/s")
    if law is uneven:
        rises = t[1:][(angle[:-1] < math.pi) & (angle[1:] >= math.pi)]
        ratio = frequency * np.diff(rises).mean()
row("Zigelman and others 2026", "printed", "cycles of the ground, oscillating", 2.0, ratio)
start = {"theta": 4.5, "omega": -math.tau * 2.6}
t, angle, speed = settled(pipe(2.6, 5.0, 2e-5), uneven, 2.6, 900, **start)
print(f"turning: {1e3 * speed:.1f} mm/s")
turns = abs(angle[-1] - angle[0]) / math.tau
row("Zigelman and others 2026", "printed", "cycles of the ground, turning", 1.0, 100.0 / turns)

# %% The direction of a vibro-impact capsule
given = {"alpha": 1.6, "beta": 15.0, "delta": 0.02, "xi": 0.05, "omega": 0.6, "coefficient": 0.3}
law, period = Coulomb(kinetic_coefficient=0.3), math.tau / 0.6
starts = ({}, {"xi": -2.0}, {"xi": -1.0, "xi_dot": 2.0}, {"xi": -0.5, "xi_dot": -1.5})
ratios = np.arange(1.0, 6.01, 0.25)


def progression(gamma, law, settle=300, **start):
    capsule = Capsule.dimensionless(gamma=gamma, **given)
    return period * mean_speed(capsule, law, period, settle, **start)


figure, axes = plt.subplots(figsize=(6, 3.5))
for gamma in ratios:
    moved = [progression(gamma, law, **start) for start in starts]
    axes.plot([gamma] * len(starts), moved, "C0o", ms=3)
    print(f"{gamma:.2f}:", *sorted({f"{way:+.3f}" for way in moved}, key=float))
print(f"2.25, from rest, after 100 periods only: {progression(2.25, law, settle=100):+.3f}")
axes.axhline(0.0, lw=0.5, color="0.5")
axes.set(xlabel=r"mass ratio $\gamma$", ylabel="progression per period")

# %% The direction of a vibro-impact capsule
level = {"kinetic_coefficient": 0.3}
fading = {**level, "static_coefficient": 0.4, "stribeck_velocity": 0.1}
kinds = {
    "Coulomb": Coulomb(**level),
    "viscous": Viscous(viscous_coefficient=1.0),
    "Stribeck": Stribeck(**fading, viscous_coefficient=0.05),
    "LuGre": LuGre(**fading, viscous_coefficient=0.05, bristle_stiffness=10.0, bristle_damping=0.1),
}
figure, axes = plt.subplots(figsize=(6, 3.5))
for name, kind in kinds.items():
    moved = [progression(gamma, kind) for gamma in ratios]
    axes.plot(ratios, moved, "o-", ms=3, lw=0.8, label=name)
axes.set(xlabel=r"mass ratio $\gamma$", ylabel="progression per period")
axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))

# %% A measured capsule with a spring
periods = [
    30,
    35,
    40,
    45,
    50,
    55,
    60,
    65,
    70,
    75,
    80,
    85,
    90,
    95,
    100,
    105,
    110,
    115,
    135,
    155,
    175,
    200,
]
measured = [
    1.00,
    1.14,
    2.00,
    4.89,
    5.70,
    5.64,
    5.83,
    7.38,
    7.14,
    0.13,
    -4.38,
    -15.53,
    -18.89,
    -25.26,
    -31.50,
    -32.14,
    -24.09,
    -28.26,
    -26.67,
    -20.32,
    -12.00,
    -8.75,
]  # mm/s


def coil(period, damping):
    pull = Square(high=1.25, low=0.0, period=1e-3 * period, duty=0.3)
    robot = Capsule(
        capsule_mass=0.193,
        inner_mass=0.074,
        stiffness=256.23,
        damping=damping,
        drive=Torque(drive=pull),
    )
    law = Coulomb(kinetic_coefficient=0.71 / (0.267 * GRAVITY))
    return -1e3 * mean_speed(robot, law, 1e-3 * period)


figure, axes = plt.subplots(figsize=(6, 3.5))
axes.plot(periods, measured, "ko", ms=4, label="measured")
steps = np.arange(30.0, 201.0, 2.5)
models = {c: np.array([coil(period, c) for period in steps]) for c in (0.0, 1.0)}
axes.plot(steps, models[0.0], ":", color="0.6", label="constants of the repository")
axes.plot(steps, models[1.0], "-", label="with a damper of 1 N s/m")
axes.axhline(0.0, lw=0.5, color="0.5")
axes.set(xlabel="period, ms", ylabel="mean speed, mm/s", ylim=(-60.0, 25.0))
axes.legend(loc="lower left")


# %% A measured capsule with a spring
def turning(x, y):
    """Return where a curve first falls through 0."""
    i = next(i for i in range(len(y) - 1) if y[i] > 0.0 >= y[i + 1])
    return x[i] + (x[i + 1] - x[i]) * y[i] / (y[i] - y[i + 1])


known = turning(periods, measured)
print("period, measured, constants given, with a damper; ms and mm/s")
points = {c: np.array([coil(period, c) for period in periods]) for c in models}
for period, speed, given_speed, damped in zip(periods, measured, *points.values(), strict=True):
    print(f"{period:4} {speed:8.2f} {given_speed:8.2f} {damped:8.2f}")
for c, name in ((0.0, "constants given"), (1.0, "with a damper")):
    whose = "ours" if c else "theirs"
    for quantity, theirs, ours in (
        ("period of turning, ms", known, turning(steps, models[c])),
        ("speed at 60 ms, mm/s", measured[periods.index(60)], points[c][periods.index(60)]),
        ("speed at 100 ms, mm/s", measured[periods.index(100)], points[c][periods.index(100)]),
    ):
        row("mpc_rl_capsubot", "measured", quantity, theirs, ours, whose)
    off = math.sqrt(np.mean((points[c] - measured) ** 2))
    right = np.sum(np.sign(points[c]) == np.sign(measured))
    print(f"{name}: rms error {off:.1f} mm/s, sign right at {right} of {len(periods)} periods")

# %% All rows
form = "{:24} {:6} {:9} {:36} {:>10} {:>10} {:>8}"
print(form.format("source", "values", "kind", "quantity", "theirs", "here", "error"))
for *words, theirs, ours, error in rows:
    print(form.format(*words, f"{theirs:.5g}", f"{ours:.5g}", f"{error:.1e}"))
