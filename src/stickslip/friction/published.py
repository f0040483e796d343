"""The friction equations of the source paper as printed, runnable, each with what is wrong in it.

They are evaluated literally, as a block diagram would: `stickslip.FixedStep` runs them. The
corrected law that each one stands for is its `corrected`. Formulas are in the paper's symbols.
Where its typesetting leaves a choice, the docstring says how it is read here. The paper writes (1)
to (4) as forces on the body and (5) to (10) as resistances; `PrintedForm.force` is a resistance
in all of them. (2) and (11) are right as printed, so there is nothing to run.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import exp
from types import MappingProxyType
from typing import Annotated, ClassVar, final

import numpy as np
from typing_extensions import override

from stickslip.friction import Coulomb, CoulombViscous, Dahl, LuGre, Stribeck, Viscous
from stickslip.friction.base import FrictionLaw
from stickslip.friction.registry import law
from stickslip.maths import sign
from stickslip.quantities import Given, Parametrised, Quantity

# Environments of capsules in a body, as compositions of parts, with what is known of each.
#
# The normal force that a bowel adds by its hoop stress is no part of a law: it is
# `Capsule.squeeze`. Values stand here only where a source states them.


@dataclass(frozen=True, kw_only=True)
class Tissue:
    """An environment: the composition of its friction, and where that comes from.

    Examples
    --------
    >>> wet = TISSUES["wet"]
    >>> wet.ranges["kinetic_coefficient"]
    (0.0004, 0.018)
    >>> wet.law.passivity.condition
    'always'
    """

    composition: str
    """Sum of parts."""
    meaning: str
    """What it stands for, in one sentence."""
    sources: tuple[str, ...]
    """Keys of the bibliography."""
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Least and largest values that the first source measured."""

    @property
    def law(self) -> type[FrictionLaw]:
        """The class of its laws, which has the condition under which these are passive."""
        return law(self.composition)

    def sample(self, count: int = 20, *, seed: int = 0, **values: Given) -> list[FrictionLaw]:
        """Return laws drawn over what was measured, each value in a range as likely.

        `values` are parameters that all of them have: those without a range have to be given, or
        a `ParameterError` names them.

        Examples
        --------
        >>> laws = TISSUES["wet"].sample(50)
        >>> 0.0004 <= min(one.kinetic_coefficient for one in laws) < 0.002
        True
        """
        draw = np.random.default_rng(seed).uniform
        rows = ({name: draw(*ends) for name, ends in self.ranges.items()} for _ in range(count))
        return [self.law(**(row | values)) for row in rows]


TISSUES: Mapping[str, Tissue] = MappingProxyType(
    {
        "wet": Tissue(
            composition="level",
            meaning="The inside of a small bowel, pig, against steel, polycarbonate and silicone.",
            sources=("lyle2013",),
            ranges={"kinetic_coefficient": (0.0004, 0.018)},
        ),
        "directed": Tissue(
            composition="both_ways(level)",
            meaning="Dry friction that differs by direction, as under hooks or bristles.",
            sources=("fang2012",),
        ),
        "mucus": Tissue(
            composition="level + power",
            meaning="Dry friction and a film of mucus that thins as it is sheared.",
            sources=("woo2011",),
        ),
        "intestine": Tissue(
            composition="level + logarithmic + viscous",
            meaning="Friction under the squeeze of a bowel, which grows with the speed, and drag.",
            sources=("sledsonbowel2013", "woo2011", "guo2020"),
            ranges={"kinetic_coefficient": (0.007, 0.054)},
        ),
        "folds": Tissue(
            composition="(level + logarithmic) * ripple[position] + viscous",
            meaning="The same, with folds across the way that come back at equal distances.",
            sources=("guo2020",),
        ),
        "peristalsis": Tissue(
            composition="level + weight[pressure] + viscous",
            meaning="A bowel that contracts: dry friction that grows with the pressure, and drag.",
            sources=("woo2011",),
        ),
        "five elements": Tissue(
            composition="relaxing[2](level) + viscous",
            meaning="Tissue that the contact stretches, with two springs that relax, and drag.",
            sources=("kim2006",),
        ),
    }
)
"""Environments by name."""


# The friction equations of the source paper as printed, runnable, each with what is wrong in it.

Mu = Annotated[float, Quantity("mu_k", low=0)]
MuStatic = Annotated[float, Quantity("mu_s", low=0, at_least="kinetic_coefficient")]
Sigma0 = Annotated[float, Quantity("sigma_0", "N/m", above=0)]
Sigma1 = Annotated[float, Quantity("sigma_1", "N s/m", low=0)]
Sigma2 = Annotated[float, Quantity("sigma_2", "N s/m", low=0)]
Vs = Annotated[float, Quantity("v_s", "m/s", above=0)]

NO_LIMIT = (
    "at rest friction equals the resultant force without limit, so a body at rest never starts"
)
LIMIT = "at rest $F_x$, up to $mu_s$ $N$"


def _switched(sliding: str) -> str:
    """Return the LaTeX of (6) to (10): a force that slides, and F_x at rest."""
    return (
        rf"F_f = \begin{{cases}} {sliding} & (\dot x \neq 0) \\"
        r" F_x & (\dot x = 0) \end{cases}"
    )


@dataclass(frozen=True, kw_only=True)
class RightEquation:
    """A published equation that is right as printed."""

    name: ClassVar[None] = None
    defect: ClassVar[str] = ""
    cure: ClassVar[str] = ""
    corrected: ClassVar[None] = None

    equation: str
    """Number in the paper."""
    title: str
    """What the paper calls it."""
    formula: str
    """The equation as printed, in LaTeX."""
    right: str
    """For what it is right, in words."""


@dataclass(frozen=True, kw_only=True)
class PrintedForm(Parametrised, ABC):
    """A published equation, kept with its defect."""

    name: ClassVar[str]
    title: ClassVar[str]
    """What the paper calls it."""
    equation: ClassVar[str]
    """Number in the paper."""
    formula: ClassVar[str]
    """The equation as printed, in LaTeX."""
    defect: ClassVar[str]
    """What is wrong or missing, in words."""
    cure: ClassVar[str]
    """The corrected form, in words or symbols."""
    right: ClassVar[str] = ""
    """What the equation has right where its neighbours err, in words."""
    corrected: ClassVar[type[FrictionLaw]]
    states: ClassVar[tuple[str, ...]] = ()

    @abstractmethod
    def force(
        self, velocity: float, load: float, states: tuple[float, ...], applied: float
    ) -> float:
        """Return the friction force [N] that the printed equation gives."""

    @abstractmethod
    def rates(self, velocity: float, load: float, states: tuple[float, ...]) -> tuple[float, ...]:
        """Return the rates of the bristle states, empty where there are none."""


@dataclass(frozen=True, kw_only=True)
class _Memoryless(PrintedForm, ABC):
    @final
    @override
    def rates(self, velocity: float, load: float, states: tuple[float, ...]) -> tuple[float, ...]:
        return ()


@dataclass(frozen=True, kw_only=True)
class _Switched(PrintedForm, ABC):
    """(6) to (10): a force times sgn v, which at rest is the applied force without limit."""

    @final
    @override
    def force(
        self, velocity: float, load: float, states: tuple[float, ...], applied: float
    ) -> float:
        if velocity == 0:  # as printed: whatever it is, and without a limit
            return applied
        return float(self.unsigned(velocity, load, states) * sign(velocity))

    @abstractmethod
    def unsigned(self, velocity: float, load: float, states: tuple[float, ...]) -> float:
        """Return what sgn v multiplies [N]."""


@dataclass(frozen=True, kw_only=True)
class PrintedCoulomb(_Memoryless):
    """Eq. (1), of the paper's reference [6]: sgn(0) = 0, so nothing is held at rest."""

    name = "printed-1"
    title = "Coulomb, of [6]"
    equation = "(1)"
    formula = r"F_f = -\mu N \operatorname{sgn}(\dot x), \quad N = M g + F_y"
    defect = (
        "no stiction: with sgn 0 = 0 there is no friction at rest, so a cart that should stick"
        " creeps, at a rate set by the time step"
    )
    cure = "the same, with stick while the required force is at most $mu_s$ $N$"
    corrected = Coulomb

    kinetic_coefficient: Mu
    """Friction force of sliding over the normal force."""

    @override
    def force(
        self, velocity: float, load: float, states: tuple[float, ...], applied: float
    ) -> float:
        return float(self.kinetic_coefficient * load * sign(velocity))


CART_DYNAMICS = RightEquation(
    equation="(2)",
    title="dynamic model with (1), of [6]",
    formula=(
        r"(M+m) \ddot x"
        r" \quad {} - m l \ddot\theta (\mu \sin\theta \operatorname{sgn} \dot x + \cos\theta)"
        r" \quad {} + m l \dot\theta^2 (\sin\theta - \mu \cos\theta \operatorname{sgn} \dot x)"
        r" \quad {} + \mu (M+m) g \operatorname{sgn} \dot x = 0"
    ),
    right="it follows from (1) and the equation of the pendulum, while the cart slides",
)


@dataclass(frozen=True, kw_only=True)
class PrintedImprovedCoulomb(_Memoryless):
    """Eq. (3), of the paper's reference [7]: the coefficient and the force carry the sign of v."""

    name = "printed-3"
    title = "improved friction model of [7]"
    equation = "(3)"
    formula = (
        r"F_f = -\mu N \operatorname{sgn}(\dot x), \quad N = M g + F_y, \quad"
        r" \mu = \begin{cases} \operatorname{sign}(F_x) \mu_k & (\dot x = 0) \\"
        r" \operatorname{sign}(\dot x) \mu_k & (\dot x \neq 0) \end{cases}"
    )
    defect = (
        "the sign of the velocity enters twice and cancels: friction accelerates a cart that moves"
        " backwards; at rest sgn 0 = 0 removes it, whatever $mu$ is"
    )
    cure = "$mu_k$ $N$ sgn $v$, with stick while the required force is at most $mu_s$ $N$"
    corrected = Coulomb

    kinetic_coefficient: Mu
    """Friction force of sliding over the normal force; the form gives it a sign."""

    @override
    def force(
        self, velocity: float, load: float, states: tuple[float, ...], applied: float
    ) -> float:
        # As printed: mu has the sign of v, by which it is multiplied again.
        mu = self.kinetic_coefficient * sign(velocity if velocity != 0 else applied)
        return float(mu * load * sign(velocity))


@dataclass(frozen=True, kw_only=True)
class PrintedCartDynamics(_Memoryless):
    """Friction as the cart's equation of motion (4) has it, with the coefficient of (3).

    In (4) the weight is multiplied by mu sgn v and what the pendulum adds to the normal force by mu
    alone, mu having a sign already. So the weight is a parameter here, apart from the load.
    """

    name = "printed-4"
    title = "dynamic model with (3), of [7]"
    equation = "(4)"
    formula = (
        r"(M+m) \ddot x - m l \ddot\theta (\mu \sin\theta + \cos\theta)"
        r" \quad {} + m l \dot\theta^2 (\sin\theta - \mu \cos\theta)"
        r" \quad {} + \mu (M+m) g \operatorname{sgn} \dot x = 0"
    )
    defect = (
        "with $mu$ of (3), the sign enters the pendulum terms once and the weight term twice: the"
        " friction due to the weight accelerates a cart that moves backwards"
    )
    cure = "(2), with the stick rule"
    corrected = Coulomb

    kinetic_coefficient: Mu
    """Friction force of sliding over the normal force."""
    weight: Annotated[float, Quantity("W", "N", above=0)]
    """Weight of cart and ball, (M + m) g."""
    signed: bool = True
    """Whether mu has the sign that (3) gives it; if not, it is the plain coefficient of (1)."""

    @override
    def force(
        self, velocity: float, load: float, states: tuple[float, ...], applied: float
    ) -> float:
        mu = self.kinetic_coefficient
        if self.signed:
            mu *= sign(velocity if velocity != 0 else applied)
        # As printed: what the pendulum adds to the normal force by mu, the weight by mu sgn v.
        return float(mu * (load - self.weight) + mu * self.weight * sign(velocity))


@dataclass(frozen=True, kw_only=True)
class PrintedStribeck(_Memoryless):
    """Eq. (5): the exponent has no absolute value and F(v) no sign; its rule for rest is right."""

    name = "printed-5"
    title = "Stribeck"
    equation = "(5)"
    formula = (
        r"F = \begin{cases} F(v) & (\dot x \neq 0) \\ F_e = F_x &"
        r" (\dot x = 0 \; \& \; |F_e| < |F_s|) \\"
        r" F_s \operatorname{sgn}(F_e) & (\text{otherwise}) \end{cases} \quad"
        r" F_v = F_c + (F_s - F_c) e^{-\frac{\dot x}{\dot x_s}} + \mu \dot x"
    )
    defect = (
        "moving backwards, $F_v$ grows without limit (the exponent lacks |·|) and has the wrong"
        " sign (sgn $v$ is missing); the force of sliding is $F$($v$) in the cases and $F_v$ below"
        " them"
    )
    cure = "[$F_c$ + ($F_s$ − $F_c$) exp(−|$v$/$v_s$|^{n})] sgn $v$ + $sigma_2$ $v$"
    right = "the rule for rest with its limit $F_s$; it is the only correct one in the paper"
    corrected = Stribeck

    kinetic_coefficient: Mu
    """F_c over the normal force."""
    static_coefficient: MuStatic
    """F_s over the normal force."""
    stribeck_velocity: Vs
    """Speed at which the static part fades."""
    viscous_coefficient: Sigma2 = 0.0
    """Viscous force over the velocity."""
    signed: bool = False
    """Whether the dry part is multiplied by sgn v, which (5) lacks; the exponent stays as it is."""

    @override
    def force(
        self, velocity: float, load: float, states: tuple[float, ...], applied: float
    ) -> float:
        f_c, f_s = self.kinetic_coefficient * load, self.static_coefficient * load
        if velocity == 0:
            return applied if abs(applied) < f_s else float(f_s * sign(applied))
        v_s, sigma_2 = self.stribeck_velocity, self.viscous_coefficient
        # As printed: without |.| the exponent grows without limit for backward motion.
        dry = f_c + (f_s - f_c) * exp(-velocity / v_s)
        return float(dry * (sign(velocity) if self.signed else 1)) + sigma_2 * velocity


@dataclass(frozen=True, kw_only=True)
class PrintedDahl(_Switched):
    """Eq. (6): the bristle force is multiplied by sgn v; at rest it equals the applied force."""

    name = "printed-6"
    title = "Dahl"
    equation = "(6)"
    formula = r"\frac{dz}{dt} = \dot x - \sigma_0 \frac{|\dot x|}{F_c} Z, \quad " + _switched(
        r"F_d = \sigma_0 Z \operatorname{sgn}(\dot x)"
    )
    defect = (
        f"$Z$ already has a sign: for backward motion, sgn reverses the bristle force; {NO_LIMIT}"
    )
    cure = "$F$ = $sigma_0$ $z$, at rest too, which ends at $F_c$"
    corrected = Dahl
    states = ("z",)

    kinetic_coefficient: Mu
    """F_c over the normal force."""
    bristle_stiffness: Sigma0
    """Force of the bristles over their deflection."""

    @override
    def unsigned(self, velocity: float, load: float, states: tuple[float, ...]) -> float:
        return self.bristle_stiffness * states[0]

    @override
    def rates(self, velocity: float, load: float, states: tuple[float, ...]) -> tuple[float, ...]:
        (z,) = states
        f_c = self.kinetic_coefficient * load
        return (velocity - self.bristle_stiffness * abs(velocity) * z / f_c,)


@dataclass(frozen=True, kw_only=True)
class PrintedCoulombSwitch(_Switched, _Memoryless):
    """Eq. (7): Coulomb with the static switch; at rest friction equals the applied force."""

    name = "printed-7"
    title = "Coulomb"
    equation = "(7)"
    formula = _switched(r"F_c = \mu N \operatorname{sgn}(\dot x)")
    defect = (
        f"{NO_LIMIT}; $F_c$ denotes the force with its sgn here, and its magnitude in (5), (6), (9)"
        " and (10)"
    )
    cure = f"$mu_k$ $N$ sgn $v$; {LIMIT}"
    corrected = Coulomb

    kinetic_coefficient: Mu
    """Friction force of sliding over the normal force."""

    @override
    def unsigned(self, velocity: float, load: float, states: tuple[float, ...]) -> float:
        return self.kinetic_coefficient * load


@dataclass(frozen=True, kw_only=True)
class PrintedViscousSwitch(_Switched, _Memoryless):
    """Eq. (8): purely viscous, multiplied by sgn v; at rest it equals the applied force."""

    name = "printed-8"
    title = "viscous"
    equation = "(8)"
    formula = _switched(r"F_v = \mu_v \dot x \operatorname{sgn}(\dot x)")
    defect = (
        f"one sgn too many: it accelerates a body that moves backwards; {NO_LIMIT}; the legend"
        " explains $mu_v$ twice, the second time where $F_x$ is meant"
    )
    cure = "$sigma_2$ $v$"
    corrected = Viscous

    viscous_coefficient: Sigma2
    """Viscous force over the velocity."""

    @override
    def unsigned(self, velocity: float, load: float, states: tuple[float, ...]) -> float:
        return self.viscous_coefficient * velocity


@dataclass(frozen=True, kw_only=True)
class PrintedLuGre(_Switched):
    """Eq. (9): all three parts multiplied by sgn v; at rest it equals the applied force.

    The exponent cannot be read with certainty: two minus signs, and alpha beside the fraction. It
    is taken as -|v / v_s|^alpha, which no other equation of the paper contradicts. The paper
    numbers the sigmas 1 to 3; they are named here as everywhere else.
    """

    name = "printed-9"
    title = "LuGre"
    equation = "(9)"
    formula = (
        r"\frac{dz}{dt} = \dot x - \frac{\sigma_1 |\dot x|}{F_v} Z, \quad"
        r" F_v = F_c + (F_s - F_c) e^{-\frac{-(\dot x)}{v_s} \alpha}, \quad "
        + _switched(
            r"F_v = (\sigma_1 Z + \sigma_2 \frac{dz}{dt} + \sigma_3 \dot x)"
            r" \operatorname{sgn}(\dot x)"
        )
    )
    defect = (
        "for backward motion, sgn reverses all three parts, which then accelerate the body; $F_v$"
        " denotes two quantities; the exponent is ambiguous (two minus signs, $alpha$ beside the"
        f" fraction); {NO_LIMIT}"
    )
    cure = (
        "$F$ = $sigma_0$ $z$ + $sigma_1$ $z$′ + $sigma_2$ $v$, at rest too, with"
        " exp(−|$v$/$v_s$|^{n}); the $sigma_1$, $sigma_2$, $sigma_3$ of (9) are $sigma_0$,"
        " $sigma_1$, $sigma_2$ here"
    )
    corrected = LuGre
    states = ("z",)

    kinetic_coefficient: Mu
    """F_c over the normal force."""
    static_coefficient: MuStatic
    """F_s over the normal force."""
    stribeck_velocity: Vs
    """Speed at which the static part fades."""
    bristle_stiffness: Sigma0
    """Force of the bristles over their deflection; the paper's sigma_1."""
    bristle_damping: Sigma1
    """Force of the bristles over the rate of their deflection; the paper's sigma_2."""
    viscous_coefficient: Sigma2 = 0.0
    """Viscous force over the velocity; the paper's sigma_3."""
    exponent: Annotated[float, Quantity("alpha", above=0)] = 2.0
    """Exponent of the Stribeck curve."""

    @override
    def unsigned(self, velocity: float, load: float, states: tuple[float, ...]) -> float:
        (z,) = states
        (z_dot,) = self.rates(velocity, load, states)
        total = self.bristle_stiffness * z + self.bristle_damping * z_dot
        return total + self.viscous_coefficient * velocity

    @override
    def rates(self, velocity: float, load: float, states: tuple[float, ...]) -> tuple[float, ...]:
        (z,) = states
        f_c, f_s = self.kinetic_coefficient * load, self.static_coefficient * load
        fading = exp(-(abs(velocity / self.stribeck_velocity) ** self.exponent))
        g = f_c + (f_s - f_c) * fading
        return (velocity - self.bristle_stiffness * abs(velocity) * z / g,)


@dataclass(frozen=True, kw_only=True)
class PrintedCoulombViscousSwitch(_Switched, _Memoryless):
    """Eq. (10): the viscous part is multiplied by sgn v; no limit at rest."""

    name = "printed-10"
    title = "Coulomb + viscous"
    equation = "(10)"
    formula = _switched(r"F_c \operatorname{sgn}(\dot x) + \mu \dot x \operatorname{sgn}(\dot x)")
    defect = (
        "the viscous part has one sgn too many and accelerates a body that moves backwards;"
        f" {NO_LIMIT}; with $F_c$ of (7), which has its sgn, the dry part is $mu$ $N$ sgn² $v$,"
        " even in $v$, and would accelerate that body too: $F_c$ is taken here as $mu$ $N$"
    )
    cure = f"$F_c$ sgn $v$ + $sigma_2$ $v$; {LIMIT}"
    corrected = CoulombViscous

    kinetic_coefficient: Mu
    """F_c over the normal force."""
    viscous_coefficient: Sigma2
    """Viscous force over the velocity."""

    @override
    def unsigned(self, velocity: float, load: float, states: tuple[float, ...]) -> float:
        return self.kinetic_coefficient * load + self.viscous_coefficient * velocity


ENERGY = RightEquation(
    equation="(11)",
    title="energy equation",
    formula=r"\tfrac12 k x^2 = \mu m g s",
    right="for a block that leaves its spring; $x$ is the compression",
)

PRINTED_EQUATIONS: tuple[type[PrintedForm] | RightEquation, ...] = (
    PrintedCoulomb,
    CART_DYNAMICS,
    PrintedImprovedCoulomb,
    PrintedCartDynamics,
    PrintedStribeck,
    PrintedDahl,
    PrintedCoulombSwitch,
    PrintedViscousSwitch,
    PrintedLuGre,
    PrintedCoulombViscousSwitch,
    ENERGY,
)
"""The equations (1) to (11) of the paper, in its order."""

PRINTED_FORMS: Mapping[str, type[PrintedForm]] = MappingProxyType(
    {form.name: form for form in PRINTED_EQUATIONS if not isinstance(form, RightEquation)}
)
"""Those that err or leave something out, by name: they run as printed."""
