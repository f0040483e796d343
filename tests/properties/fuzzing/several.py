"""Random cases with one to six contacts: chains, clutches, brakes, feet, arms, dense matrices.

Laws with and without bristles stand side by side, contacts share laws, coordinates and loads, and
drives push and press.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from random import Random
from typing import Any, ClassVar

import numpy as np
from benchmarks.several.brakes import ClutchTrain, DiscBrake, Lining, Rotor
from tests.properties.fuzzing.cases import (
    Case,
    draw_law,
    draw_shape,
    factor_of_start,
    full_deflection,
)
from tests.properties.fuzzing.drawing import MAKERS as OF_DRIVES
from tests.properties.fuzzing.drawing import Sizes, around, draw_drive, sizes
from tests.support import UNAIDED

from stickslip.friction import FrictionLaw, Laws, assigned, bristle_names
from stickslip.mechanisms import (
    BlockChain,
    Contact,
    MatrixMechanism,
    Mechanism,
    PendulumCart,
    TwoFeet,
    TwoLinkArm,
)
from stickslip.mechanisms.drives import Drive


@dataclass(frozen=True, kw_only=True)
class Dense(MatrixMechanism):
    """Bodies that full matrices of mass, stiffness and damping couple; contacts share some."""

    name: ClassVar[str] = "dense"
    mass: tuple[tuple[float, ...], ...]
    stiffness: tuple[tuple[float, ...], ...]
    damping: tuple[tuple[float, ...], ...]
    slips: tuple[tuple[int, float], ...]
    """Coordinate of each contact, and the slip velocity over the rate of that coordinate."""
    normal_forces: tuple[float, ...]
    pushes: tuple[Drive | None, ...]
    """Force on each coordinate."""
    presses: tuple[Drive | None, ...]
    """What changes the normal force of each contact."""

    @property
    def coordinates(self):
        """Places."""
        return tuple(f"x{i}" for i in range(len(self.mass)))

    @property
    def rates(self):
        """Speeds."""
        return tuple(f"v{i}" for i in range(len(self.mass)))

    @property
    def units(self):
        """Metres."""
        return ("m",) * len(self.mass)

    def mass_matrix(self, q):
        return self.mass

    def potential_energy(self, t, q):
        return 0.5 * _form(self.stiffness, q, q, self.coordinates)

    def forces(self, t, q, q_dot, drives):
        found = {}
        for i, name in enumerate(self.coordinates):
            total = drives.get(f"push-{i}", 0.0)
            for j, other in enumerate(self.coordinates):
                total = total - self.stiffness[i][j] * q[other] - self.damping[i][j] * q_dot[other]
            found[name] = total
        return found

    def contacts(self):
        return tuple(
            Contact(
                slip=f"x{at}" if factor == 1.0 else {f"x{at}": factor}, load=load, name=f"pad-{i}"
            )
            for i, ((at, factor), load) in enumerate(
                zip(self.slips, self.normal_forces, strict=True)
            )
        )

    def loads(self, t, q, q_dot, drives):
        return {
            f"pad-{i}": self.normal_forces[i] + drives[f"press-{i}"]
            for i, press in enumerate(self.presses)
            if press is not None
        }

    def drives(self):
        pushes = {f"push-{i}": drive for i, drive in enumerate(self.pushes)}
        presses = {f"press-{i}": drive for i, drive in enumerate(self.presses)}
        return {name: one for name, one in (pushes | presses).items() if one is not None}


@dataclass(frozen=True, kw_only=True)
class Looped(Dense):
    """Bodies of which pairs rub on each other, and some on the ground: their slips close loops."""

    name: ClassVar[str] = "looped"
    pairs: tuple[tuple[int, int], ...]
    """The two bodies of each contact; the second is -1 for the ground."""

    def contacts(self):
        return tuple(
            Contact(
                slip={f"x{one}": 1.0, f"x{other}": -1.0} if other >= 0 else f"x{one}",
                load=load,
                name=f"pad-{i}",
            )
            for i, ((one, other), load) in enumerate(
                zip(self.pairs, self.normal_forces, strict=True)
            )
        )


def _form(matrix, one, other, names):
    """Return one' A other."""
    total = 0.0
    for i, row in zip(names, matrix, strict=True):
        for j, entry in zip(names, row, strict=True):
            total = total + entry * one[i] * other[j]
    return total


def _drive(rng: Random, force: float, size: Sizes, t_end: float) -> Drive | None:
    count = rng.choice((0, 1, 1, 2))
    drawn = [drive for drive in OF_DRIVES if drive.adds or count < 2]
    kinds = tuple(rng.choice(drawn) for _ in range(count))
    return draw_drive(rng, kinds, force, size.time, t_end)


def _chain(rng: Random, size: Sizes, t_end: float) -> Mechanism:
    speed = size.draw(rng, "m/s", 1.5) * rng.choice((-1.0, 1.0))
    return BlockChain(
        blocks=rng.randint(2, 6),
        mass=size.draw(rng, "kg"),
        coupling=rng.choice((0.0, 1.0, 1.0, 1.0)) * size.draw(rng, "N/m", 1.5),
        stiffness=rng.choice((0.0, 1.0, 1.0)) * size.draw(rng, "N/m", 1.5),
        damping=rng.choice((0.0, 0.0, 1.0)) * size.draw(rng, "N s/m"),
        speed=rng.choice((None, 0.0, speed, speed)),
        load=size.load,
    )


def _lining(rng: Random, size: Sizes, t_end: float) -> Lining:
    return Lining(
        radius=10.0 ** rng.uniform(-2.0, 0.0),
        load=rng.choice((0.0, 1.0, 1.0)) * around(rng, size.load, 0.5, 0.5),
        press=_drive(rng, size.load, size, t_end),
    )


def _inertia(rng: Random, size: Sizes) -> float:
    return 0.01 * size.draw(rng, "kg", 1.0)


def _clutches(rng: Random, size: Sizes, t_end: float) -> Mechanism:
    count = rng.randint(2, 6)
    return ClutchTrain(
        rotors=tuple(
            Rotor(
                inertia=_inertia(rng, size),
                damping=rng.choice((0.0, 0.0, 0.01)) * size.draw(rng, "N s/m"),
                torque=_drive(rng, 0.1 * size.force, size, t_end),
            )
            for _ in range(count)
        ),
        clutches=tuple(_lining(rng, size, t_end) for _ in range(count - 1)),
        brake=rng.choice((None, _lining(rng, size, t_end))),
    )


def _brake(rng: Random, size: Sizes, t_end: float) -> Mechanism:
    return DiscBrake(
        inertia=_inertia(rng, size),
        pads=tuple(_lining(rng, size, t_end) for _ in range(rng.randint(1, 6))),
        stiffness=rng.choice((0.0, 0.01)) * size.draw(rng, "N/m", 1.5),
        damping=rng.choice((0.0, 0.01)) * size.draw(rng, "N s/m"),
        drive=_drive(rng, 0.1 * size.force, size, t_end),
    )


def _feet(rng: Random, size: Sizes, t_end: float) -> Mechanism:
    return TwoFeet(
        mass=size.mass,
        front=10.0 ** rng.uniform(-2.0, 1.0),
        rear=10.0 ** rng.uniform(-2.0, 1.0),
        height=rng.choice((0.0, 1.0)) * 10.0 ** rng.uniform(-3.0, -0.5),
        stiffness=rng.choice((0.0, 1.0, 1.0)) * size.draw(rng, "N/m"),
        damping=rng.choice((0.0, 1.0)) * size.draw(rng, "N s/m"),
        drive=_drive(rng, size.level * 9.81 * size.mass, size, t_end),
    )


def _arm(rng: Random, size: Sizes, t_end: float) -> Mechanism:
    upper, lower = (10.0 ** rng.uniform(-2.0, 0.5) for _ in range(2))
    m1, m2 = size.draw(rng, "kg"), size.draw(rng, "kg")
    return TwoLinkArm(
        upper_mass=m1,
        upper_length=upper,
        upper_centre=rng.choice((-0.5, 0.5, 1.0)) * upper,
        upper_inertia=m1 * upper * upper,
        lower_mass=m2,
        lower_centre=lower,
        lower_inertia=m2 * lower * lower * rng.choice((1.0, 1.2)),
        rotor_inertia=rng.choice((0.0, 1e-3)) * m1,
        gear_ratio=rng.choice((1.0, 6.0, 100.0)),
        shoulder_drive=_drive(rng, size.level, size, t_end),
        elbow_drive=_drive(rng, size.level, size, t_end),
        gravity=rng.choice((0.0, 9.81, 9.81)),
    )


def _cart(rng: Random, size: Sizes, t_end: float) -> Mechanism:
    length = 10.0 ** rng.uniform(-2.0, 0.5)
    return PendulumCart(
        cart_mass=size.draw(rng, "kg"),
        ball_mass=size.draw(rng, "kg"),
        length=length,
        pivot_load=size.load * length,
        pivot_stiffness=rng.choice((0.0, 1.0)) * size.draw(rng, "N/m") * length**2,
        pivot_damping=rng.choice((0.0, 0.0, 1.0)) * size.draw(rng, "N s/m") * length**2,
    )


def _positive(dice: np.random.Generator, n: int, spread: float) -> np.ndarray:
    """Return a symmetric positive semidefinite matrix whose rows differ by powers of ten."""
    root = dice.normal(size=(n, dice.integers(1, n + 1))) * 10.0 ** dice.uniform(0, spread, (n, 1))
    return root @ root.T


def _rows(matrix: np.ndarray) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(map(float, row)) for row in 0.5 * (matrix + matrix.T))


def _dense(rng: Random, size: Sizes, t_end: float) -> Mechanism:
    dice = np.random.default_rng(rng.randrange(2**32))
    n = rng.randint(1, 6)
    contacts = rng.randint(1, 6)
    spread = rng.choice((0.0, 0.5, 1.5))
    mass = _positive(dice, n, spread)
    mass += rng.choice((1.0, 1e-3)) * np.trace(mass) / n * np.eye(n)
    quiet = (0.0, 0.1, 1.0)
    return Dense(
        mass=_rows(size.mass * mass),
        stiffness=_rows(rng.choice(quiet) * size.stiffness * _positive(dice, n, spread)),
        damping=_rows(rng.choice(quiet) * 0.1 * size.mass / size.time * _positive(dice, n, 0.0)),
        slips=tuple(
            (rng.randrange(n), rng.choice((1.0, 1.0, 0.3, -1.0, -2.5))) for _ in range(contacts)
        ),
        normal_forces=tuple(around(rng, size.load, 0.5, 0.5) for _ in range(contacts)),
        pushes=tuple(_drive(rng, size.force, size, t_end) for _ in range(n)),
        presses=tuple(
            _drive(rng, size.load, size, t_end) if rng.random() < 0.3 else None
            for _ in range(contacts)
        ),
    )


MAKERS: Mapping[str, Callable[[Random, Sizes, float], Any]] = {
    "chain": _chain,
    "clutches": _clutches,
    "brake": _brake,
    "feet": _feet,
    "arm": _arm,
    "cart": _cart,
    "dense": _dense,
}
"""What draws a mechanism, by its kind."""


def _looped(rng: Random, size: Sizes, t_end: float) -> Mechanism:
    n = rng.randint(2, 4)
    chain = [(i, i + 1) for i in range(n - 1)]
    others = [(i, j) for i in range(n) for j in (*range(i + 2, n), -1)]
    pairs = chain + rng.sample(others, rng.randint(1, min(3, len(others))))
    free = _dense(rng, size, t_end)
    while len(free.mass) < n:
        free = _dense(rng, size, t_end)
    part = {
        name: tuple(row[:n] for row in getattr(free, name)[:n])
        for name in ("mass", "stiffness", "damping")
    }
    return Looped(
        **part,
        slips=(),
        pairs=tuple(pairs),
        normal_forces=tuple(around(rng, size.load, 0.5, 0.5) for _ in pairs),
        pushes=free.pushes[:n],
        presses=tuple(
            _drive(rng, size.load, size, t_end) if rng.random() < 0.2 else None for _ in pairs
        ),
    )


LOOPS: Mapping[str, Callable[[Random, Sizes, float], Any]] = {"looped": _looped}
"""What draws a mechanism whose contacts close loops, by its kind."""


def _laws(rng: Random, names: tuple[str, ...], size: Sizes) -> FrictionLaw | Laws:
    def law() -> FrictionLaw:
        kind = rng.choice(list(UNAIDED.values()))
        shape = draw_shape(rng, kind)
        flags = {**shape.flags, "static_switch": False}  # for one contact only
        return draw_law(rng, replace(shape, flags=flags), size)

    if rng.random() < 0.2:
        return law()
    found = {name: None if rng.random() < 0.1 else law() for name in names}
    if not any(found.values()):
        found[rng.choice(names)] = law()
    return assigned(names, found)


def _start(rng: Random, case: Case, size: Sizes) -> dict[str, float]:
    """Return an initial state: rest, tiny, usual or large."""
    factor = factor_of_start(rng)
    start: dict[str, float] = {}
    mechanism = case.mechanism
    if factor:
        for name, rate, unit in zip(
            mechanism.coordinates, mechanism.rates, mechanism.units, strict=True
        ):
            span = size.length if unit == "m" else min(size.length, 1.0)
            start[name] = rng.choice((0.0, rng.uniform(-1, 1) * factor * span))
            start[rate] = rng.choice((0.0, 1.0, 1.0)) * rng.uniform(-1, 1) * factor
            start[rate] *= span / size.time
    for name in bristle_names(case.contact_names, case.law):
        law = case.laws[name.partition(":")[2] or case.contact_names[0]]
        if factor:
            start[name] = full_deflection(law) * rng.choice((0.0, 1.0, -1.0, rng.uniform(-1, 1)))
    return start


def draw_joints(
    rng: Random, makers: Mapping[str, Callable[[Random, Sizes, float], Any]] = MAKERS
) -> Case:
    """Return a case with one to six contacts."""
    size = sizes(rng)
    t_end = min(max(around(rng, 10.0 * size.time, 1.0, 0.7), 1e-4), 1e4)
    mechanism = makers[rng.choice(list(makers))](rng, size, t_end)
    names = tuple(contact.name for contact in mechanism.contacts())
    case = Case(mechanism=mechanism, law=_laws(rng, names, size), t_end=t_end, y0={})
    return Case(mechanism=mechanism, law=case.law, t_end=t_end, y0=_start(rng, case, size))
