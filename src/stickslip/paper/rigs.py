"""The rigs of the paper, its block and its cart: numbers, motions, stick-slip, rules for rest."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Any, Self

import numpy as np

from stickslip import friction
from stickslip.data import Rig
from stickslip.engine.simulation import simulate
from stickslip.engine.solver import EventDriven, FixedStep
from stickslip.engine.trajectory import Trajectory
from stickslip.identify import Criteria, criteria_of
from stickslip.mechanisms import PendulumCart, Prescribed, SpringBlock, TowedBlock
from stickslip.mechanisms.drives import Pulse, ThreePhase
from stickslip.study.sweep import DrivenCycle, cycles_in

# The numbers of the paper's rig: Table I, and what is assumed where it prints nothing.


@dataclass(frozen=True, kw_only=True)
class PaperValues:
    """Rig and coefficients in the paper's own terms: forces, not levels."""

    rig: SpringBlock
    """The block, as the rig file gives it."""
    measured: float
    """Measured travel [m]."""
    uncertainty: float
    """Of that travel [m]: half a digit where it is rounded, else standard; 0 if not stated."""
    rounded: bool
    """Whether the uncertainty is that of rounding."""
    mu_k: float
    """Kinetic coefficient."""
    mu_s: float
    """Static coefficient."""
    viscous: float
    """Viscous coefficient [N s/m]; assumed."""
    stribeck_velocity: float
    """[m/s]; assumed."""
    stiffness: float
    """Of the bristles [N/m]; assumed."""
    damping: float
    """Of the bristles [N s/m]; assumed."""

    @property
    def load(self) -> float:
        """Weight of the block [N]."""
        return self.rig.mass * self.rig.gravity

    @property
    def force(self) -> float:
        """Force of the compressed spring [N]."""
        return self.rig.stiffness * self.rig.compression

    @classmethod
    def of(cls, rig: Rig) -> Self:
        """Read the values off the rig of the paper."""
        mechanism, viscous, lugre = rig.mechanism, rig.laws["coulomb-viscous"], rig.laws["lugre"]
        assert isinstance(mechanism, SpringBlock)
        assert isinstance(viscous, friction.CoulombViscous)
        assert isinstance(lugre, friction.LuGre)
        assert rig.measurement is not None
        first = rig.measurement.records()[0]
        load = mechanism.mass * mechanism.gravity
        return cls(
            rig=mechanism,
            measured=float(first.travel or 0.0),
            uncertainty=first.usual_uncertainty("travel"),
            rounded=first.uncertainty_kind == "rounding",
            mu_k=lugre.kinetic_coefficient,
            mu_s=lugre.static_coefficient,
            viscous=viscous.viscous_coefficient,
            stribeck_velocity=lugre.stribeck_velocity,
            stiffness=lugre.bristle_stiffness * load,
            damping=lugre.bristle_damping * load,
        )


# Two readings of how the rig sets the block in motion, and a control.

PUSH_DURATION = 0.1
"""The paper: "applied time 0.1 s"."""


@dataclass(frozen=True, kw_only=True)
class Excitation:
    """One reading and what a law makes of it."""

    key: str
    """A, B or C."""
    title: str
    """Words that name the reading."""
    text: str
    """What the reading assumes, in one sentence."""
    mechanism: SpringBlock
    """The block in that reading."""
    run: Trajectory
    """The trajectory."""
    criteria: Criteria
    """The paper's criteria of that run."""
    closed_form: float | None
    """Travel of Coulomb friction by formula [m], where there is one."""


def rigs(rig: SpringBlock) -> dict[str, tuple[str, str, SpringBlock]]:
    """Return title, description and mechanism of the three readings of a released spring."""
    force = rig.stiffness * rig.compression
    drive = Pulse(level=force, duration=PUSH_DURATION)
    push = SpringBlock(mass=rig.mass, gravity=rig.gravity, drive=drive)
    released = f"Compressed {rig.compression:g} m; the block leaves it at its natural length."
    fixed = "A control, not in the paper: as B, but the block stays fastened."
    return {
        "A": ("Push", f"{force:g} N for {PUSH_DURATION:g} s, then coasting.", push),
        "B": ("Released spring", released, replace(rig, attached=False)),
        "C": ("Fixed spring", fixed, replace(rig, attached=True)),
    }


def excitations(
    rig: SpringBlock, law: friction.FrictionLaw, *, measured: float, t_end: float
) -> tuple[Excitation, ...]:
    """Run a law in the three readings of the rig.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
    >>> [f"{e.criteria.travel:.4f}" for e in excitations(rig, law, measured=0.2, t_end=10.0)]
    ['0.1539', '0.2039', '0.0981']
    """
    result = []
    for key, (title, text, mechanism) in rigs(rig).items():
        run = simulate(mechanism, law, t_end=t_end)
        result.append(
            Excitation(
                key=key,
                title=title,
                text=text,
                mechanism=mechanism,
                run=run,
                criteria=criteria_of(run, mechanism, measured),
                closed_form=_closed_form(key, rig, law),
            )
        )
    return tuple(result)


def _closed_form(key: str, rig: SpringBlock, law: friction.FrictionLaw) -> float | None:
    """Return the travel of Coulomb friction: A by momentum, B by energy.

    A holds if the push starts the block, B if the block gets as far as to leave the spring.
    """
    mu_k = getattr(law, "kinetic_coefficient", None)
    if law.name != "coulomb" or mu_k is None:
        return None
    f = mu_k * rig.mass * rig.gravity
    force = rig.stiffness * rig.compression
    held = law.break_away(rig.mass * rig.gravity)
    if f == 0.0 or held >= force:
        return None
    if key == "A":
        return float((force - f) * PUSH_DURATION**2 * force / (2.0 * rig.mass * f))
    energy = 0.5 * force * rig.compression
    if key == "B" and f * rig.compression < energy:
        return float(energy / f)
    return None


# Stick-slip, the first phenomenon of the paper (its III.B.1), on the block of Table I.

SPEED = 0.02
"""Of the far end of the spring [m/s]; ours: the paper gives no numbers for its example."""
PERIODS = 4.5
"""How long the block is pulled, after its first break-away."""


@dataclass(frozen=True, kw_only=True)
class StickSlip:
    """The block of Table I, pulled slowly by its spring."""

    mechanism: TowedBlock
    """The block with the spring that pulls it."""
    run: Trajectory
    """The trajectory."""
    stick_time: float
    """Of a period, from the run [s]."""
    slip_time: float
    """Of a period, from the run [s]."""
    stick_formula: float
    """2 D / V with D = (F_s - F_c) / k [s]."""
    slip_formula: float
    """(2 / w)(pi - atan(w D / V)) with w = sqrt(k / m) [s]."""


def stick_slip(values: PaperValues) -> StickSlip:
    """Pull the block of Table I through its spring, and time a period of stick-slip.

    Examples
    --------
    >>> from stickslip import load_rig
    >>> from stickslip.paper import PaperValues, stick_slip
    >>> found = stick_slip(PaperValues.of(load_rig()))
    >>> abs(found.slip_time - found.slip_formula) < 1e-9
    True
    """
    rig = values.rig
    towed = TowedBlock(mass=rig.mass, stiffness=rig.stiffness, speed=SPEED, gravity=rig.gravity)
    law = friction.Coulomb(kinetic_coefficient=values.mu_k, static_coefficient=values.mu_s)
    surplus = (values.mu_s - values.mu_k) * values.load / rig.stiffness
    w = math.sqrt(rig.stiffness / rig.mass)
    stick = 2.0 * surplus / SPEED
    slip = (2.0 / w) * (math.pi - math.atan(w * surplus / SPEED))
    first = values.mu_s * values.load / (rig.stiffness * SPEED)
    run = simulate(towed, law, t_end=first + PERIODS * (stick + slip))
    starts = [event.t for event in run.events if event.from_mode == 0]
    stops = [event.t for event in run.events if event.to_mode == 0]
    return StickSlip(
        mechanism=towed,
        run=run,
        stick_time=starts[2] - stops[1],
        slip_time=stops[1] - starts[1],
        stick_formula=stick,
        slip_formula=slip,
    )


# The pendulum-driven cart of the paper's Figs 2 and 11, as printed and as it is.
#
# The paper prints neither the masses nor the length nor the swing of its cart; those here are ours.

CYCLES = 5
"""Of the swing, in every run."""
STEP = 0.01
"""Of the runs as block diagrams [s]."""
KINETIC = 0.2
"""Coefficient of the runs that are compared with the printed equations."""
SAMPLES = 20_000
"""Times at which forces of a run are evaluated."""
SURPLUS = (0.0, 0.5, 1.0, 1.5)
"""Break-away levels that are tried, as shares of the step from the kinetic level to the static."""
ALONE = 0.4
"""That step over the kinetic level, where the static level is not known to be higher."""
SWING = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
CART = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=SWING))


@dataclass(frozen=True, kw_only=True)
class CartRun:
    """What the cart does in some cycles of the swing."""

    key: str
    """Name by which figures and tables find the run."""
    title: str
    """Words that name the run in figures and tables."""
    law: friction.FrictionLaw | friction.PrintedForm
    """The law or the printed equation that was run."""
    run: Trajectory
    """The trajectory."""
    cycles: tuple[DrivenCycle, ...]
    """Travel of each cycle of the swing."""

    @property
    def travels(self) -> tuple[float, ...]:
        """Of each cycle [m]."""
        return tuple(cycle.travel for cycle in self.cycles)

    @property
    def returns(self) -> tuple[float, ...]:
        """Way against the direction in which the paper drives the cart, of each cycle [m]."""
        return tuple(cycle.backward for cycle in self.cycles)

    @property
    def least_velocities(self) -> tuple[float, ...]:
        """Of each cycle [m/s]."""
        return tuple(cycle.least_velocity for cycle in self.cycles)

    @property
    def least_normal_force(self) -> float:
        """Of all cycles [N]."""
        return min(cycle.least_normal_force for cycle in self.cycles)

    @cached_property
    def largest_friction(self) -> tuple[float, ...]:
        """Largest friction over the normal force in each cycle."""
        first, last = self.run.span
        times = np.union1d(np.linspace(first, last, SAMPLES), self.run.t)
        seen = self.run.at(times)
        shares = np.abs(seen["friction"]) / seen["normal_force"]
        ends = np.linspace(first, last, len(self.cycles) + 1)
        return tuple(
            float(shares[(begin <= times) & (times <= end)].max()) for begin, end in pairwise(ends)
        )

    @property
    def travel(self) -> float:
        """All travel [m]."""
        return math.fsum(self.travels)

    @property
    def mean_return(self) -> float:
        """Back-slip in a cycle, the mean of all [m]."""
        return math.fsum(self.returns) / len(self.returns)

    @property
    def least_velocity(self) -> float:
        """Lowest velocity [m/s]."""
        return min(self.least_velocities)

    def to_dict(self) -> Mapping[str, Any]:
        """Return the numbers, ready for JSON."""
        return {
            "run": self.key,
            "law": self.law.name,
            "travel": self.travel,
            "travel_by_cycle": list(self.travels),
            "back_slip_by_cycle": list(self.returns),
            "mean_back_slip": self.mean_return,
            "least_velocity": self.least_velocity,
            "least_velocity_by_cycle": list(self.least_velocities),
            "least_normal_force": self.least_normal_force,
            "largest_friction_by_cycle": list(self.largest_friction),
        }


@dataclass(frozen=True, kw_only=True)
class Share:
    """One cause of backward motion: what it adds where it is taken into a run."""

    key: str
    """``misprint``, ``no-stick-rule``, ``step`` or ``friction``."""
    least_velocity: float
    """What it adds to the lowest velocity [m/s]."""
    mean_return: float
    """What it adds to the back-slip in a cycle [m]."""


@dataclass(frozen=True, kw_only=True)
class CartStudy:
    """The paper's two figures of the cart."""

    cart: PendulumCart
    """The cart with its pendulum."""
    runs: tuple[CartRun, ...]
    """Fig. 2: as printed, corrected in fixed steps, exactly."""
    table_1: tuple[CartRun, ...]
    """The scheme of Fig. 2, (1) and (2) in fixed steps, at the levels of Table I; and exactly."""
    given: bool
    """Whether the cart is not the one that is assumed here."""
    break_away: tuple[CartRun, ...]
    """The exact cart with the kinetic level of Table I and break-away levels around its static one,
    and with bristles, whose break-away falls with the rate of the force."""
    choices: tuple[CartRun, ...]
    """Fig. 11: the law that `select` names for the rig, if it names one, and the paper's choice."""

    @property
    def swing(self) -> ThreePhase:
        """The prescribed swing of the pendulum."""
        return swing_of(self.cart)

    @property
    def weight(self) -> float:
        """Weight of cart and ball [N]."""
        return (self.cart.cart_mass + self.cart.ball_mass) * self.cart.gravity

    @property
    def period(self) -> float:
        """Duration of a cycle [s]."""
        return float(self.swing.period)

    def run(self, key: str) -> CartRun:
        """Return a run of Fig. 2 or 11."""
        return next(o for o in (*self.runs, *self.table_1, *self.choices) if o.key == key)

    @cached_property
    def shares(self) -> tuple[Share, ...]:
        """What the backward motion of equations (3) and (4) is made of; its parts sum up to it."""
        printed, free, held, exact = (
            self.run(key) for key in ("printed-4", "fixed", "fixed-held", "exact")
        )
        causes = (("misprint", printed, free), ("no-stick-rule", free, held), ("step", held, exact))
        differences = [
            Share(
                key=key,
                least_velocity=with_it.least_velocity - without.least_velocity,
                mean_return=with_it.mean_return - without.mean_return,
            )
            for key, with_it, without in causes
        ]
        real = exact.least_velocity, exact.mean_return
        return (*differences, Share(key="friction", least_velocity=real[0], mean_return=real[1]))

    def to_dict(self) -> Mapping[str, Any]:
        """Return the study as plain numbers and strings, ready for JSON."""
        return {
            "cart_mass": self.cart.cart_mass,
            "ball_mass": self.cart.ball_mass,
            "length": self.cart.length,
            "swing": {
                "amplitude": self.swing.amplitude,
                "fast": self.swing.fast,
                "slow": self.swing.slow,
                "period": self.period,
            },
            "cycles": CYCLES,
            "step": STEP,
            "kinetic_coefficient": KINETIC,
            "figure_2": [run.to_dict() for run in self.runs],
            "levels_of_table_1": [run.to_dict() for run in self.table_1],
            "break_away": [run.to_dict() for run in self.break_away],
            "backward_motion": [
                {
                    "cause": share.key,
                    "least_velocity": share.least_velocity,
                    "mean_back_slip": share.mean_return,
                }
                for share in self.shares
            ],
            "figure_11": [choice.to_dict() for choice in self.choices],
        }


def study_cart(
    chosen: friction.FrictionLaw | None,
    theirs: friction.FrictionLaw,
    *,
    levels: tuple[float, float] = (0.25, 0.35),
    bristles: friction.FrictionLaw | None = None,
    cart: PendulumCart = CART,
) -> CartStudy:
    """Drive the cart with the printed equations, in fixed steps and exactly; then with two laws.

    Examples
    --------
    >>> from stickslip import Coulomb, CoulombViscous
    >>> study = study_cart(
    ...     Coulomb(kinetic_coefficient=0.25),
    ...     CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.5),
    ... )
    >>> [f"{one.travel:.2f}" for one in study.runs if one.key in ("printed-4", "exact")]
    ['-12.67', '0.28']
    """
    level = {"kinetic_coefficient": KINETIC}
    law = friction.Coulomb(**level)
    printed = FixedStep(dt=STEP, stick_rule=False)
    free = replace(printed, break_away="zero")
    held = FixedStep(dt=STEP, stick_rule=True)
    exact = EventDriven()
    weight = (cart.cart_mass + cart.ball_mass) * cart.gravity
    ran = partial(_run, cart)
    signed = friction.PrintedCartDynamics(kinetic_coefficient=KINETIC, weight=weight)
    plain = friction.PrintedCoulomb
    at_table_1 = friction.Coulomb(kinetic_coefficient=levels[0], static_coefficient=levels[1])
    return CartStudy(
        cart=cart,
        given=cart != CART,
        runs=(
            ran("printed-4", "(3), (4) as printed", signed, printed),
            ran("unsigned-4", "(4) with the μ of (1)", replace(signed, signed=False), printed),
            ran("printed-1", "(1), (2) as printed", plain(**level), printed),
            ran("fixed", "corrected, no stick rule", law, free),
            ran("fixed-held", "corrected, stick rule", law, held),
            ran("exact", "exact", law, exact),
        ),
        table_1=(
            ran("table-1", "(1), (2), Table I", plain(kinetic_coefficient=levels[0]), printed),
            ran("table-1-exact", "exact, Table I", at_table_1, exact),
        ),
        break_away=_break_away(cart, levels, bristles),
        choices=(
            *(() if chosen is None else (ran("selected", chosen.title, chosen, exact),)),
            ran("paper", theirs.title, theirs, exact),
        ),
    )


def _break_away(
    cart: PendulumCart, levels: tuple[float, float], bristles: friction.FrictionLaw | None
) -> tuple[CartRun, ...]:
    """Vary the break-away level, at the kinetic levels of Table I and of Fig. 2."""
    (mu_k, mu_s), exact = levels, EventDriven()
    step = mu_s - mu_k or ALONE * mu_k
    laws = [
        friction.Coulomb(kinetic_coefficient=kinetic, static_coefficient=kinetic + share * step)
        for kinetic in (mu_k, KINETIC)
        for share in SURPLUS
    ]
    titles = [
        f"$mu_k$ = {law.kinetic_coefficient:.3g}, $mu_s$ = {law.break_away(1.0):.3g}"
        for law in laws
    ]
    runs = [
        _run(cart, f"break-away-{index}", title, law, exact)
        for index, (law, title) in enumerate(zip(laws, titles, strict=True))
    ]
    if bristles is not None:
        runs.append(_run(cart, "break-away-bristles", bristles.title, bristles, exact))
    return tuple(runs)


def swing_of(cart: PendulumCart) -> ThreePhase:
    """Return the swing that the pendulum of a cart is told."""
    assert isinstance(cart.pendulum, Prescribed)
    assert isinstance(cart.pendulum.profile, ThreePhase)
    return cart.pendulum.profile


def _run(
    cart: PendulumCart,
    key: str,
    title: str,
    law: friction.FrictionLaw | friction.PrintedForm,
    solver: EventDriven | FixedStep,
) -> CartRun:
    """Drive the cart for all cycles."""
    period = float(swing_of(cart).period)
    run = simulate(cart, law, t_end=CYCLES * period, solver=solver)
    return CartRun(key=key, title=title, law=law, run=run, cycles=cycles_in(run, cart, period))


# How a block diagram finds rest: the zero-velocity band of the paper's [18] beside others.

REST_RULES: tuple[tuple[float, bool, float], ...] = (
    (0.01, False, 0.0),
    (0.01, False, 0.001),
    (0.01, False, 0.03),
    (0.01, True, 0.0),
    (0.001, False, 0.0),
    (0.001, False, 0.001),
    (0.001, False, 0.003),
    (0.001, True, 0.0),
)
"""Step [s], whether a change of sign holds the body, half width of the band [m/s]."""
REST_SECONDS = 1.0
"""How long the block is followed; exactly, it stops in half of that."""


@dataclass(frozen=True, kw_only=True)
class RestRule:
    """A rule for rest, and what block and cart do with it; Coulomb friction in each."""

    dt: float | None
    """Step [s]; None where events are located."""
    stick_rule: bool
    """Whether a change of sign holds the body, exactly or within a step."""
    band: float
    """Half width of the zero-velocity band [m/s]."""
    block: Criteria
    """What the released block does."""
    reversals: int
    """Sign changes of its velocity."""
    rests: bool
    """Whether the block is at rest at the end."""
    cart_travel: float
    """Of the cart in all cycles, at the levels of the rig [m]."""
    cart_back_slip: float
    """Of the cart in a cycle, the mean of all [m]."""


def rest_rules(values: PaperValues, cart: PendulumCart = CART) -> tuple[RestRule, ...]:
    """Run the released block and the cart exactly, and in steps with each rule.

    The band is that of Karnopp (1985), the paper's reference [18]: a body slower than it is held
    while the force needed is within break-away. A step changes the velocity by ``F_c dt / m``, and
    can jump over a narrower band. With a rule, friction begins at F_s; without one, sgn 0 = 0.

    Examples
    --------
    >>> from stickslip import load_rig
    >>> from stickslip.paper import PaperValues, rest_rules
    >>> [rule.reversals for rule in rest_rules(PaperValues.of(load_rig()))][:4]
    [0, 50, 49, 0]
    """
    period = float(swing_of(cart).period)
    law = friction.Coulomb(kinetic_coefficient=values.mu_k, static_coefficient=values.mu_s)
    result = []
    for dt, stick_rule, band in ((None, True, 0.0), *REST_RULES):
        solver = None
        if dt is not None:
            solver = FixedStep(
                dt=dt,
                stick_rule=stick_rule,
                zero_velocity_band=band,
                break_away="static" if stick_rule or band else "zero",
            )
        block = simulate(values.rig, law, t_end=REST_SECONDS, solver=solver)
        driven = simulate(cart, law, t_end=CYCLES * period, solver=solver)
        cycles = cycles_in(driven, cart, period)
        signs = np.sign(block["v"])[block["v"] != 0.0]
        result.append(
            RestRule(
                dt=dt,
                stick_rule=stick_rule,
                band=band,
                block=criteria_of(block, values.rig),
                reversals=int(np.count_nonzero(np.diff(signs))),
                rests=bool(block["v"][-1] == 0.0),
                cart_travel=sum(cycle.travel for cycle in cycles),
                cart_back_slip=sum(cycle.backward for cycle in cycles) / len(cycles),
            )
        )
    return tuple(result)
