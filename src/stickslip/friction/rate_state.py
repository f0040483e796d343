"""Friction that depends on the logarithm of the slip speed, and on a state that remembers slip."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Final, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.errors import ParameterError
from stickslip.quantities import Parametrised, Quantity

Array: TypeAlias = NDArray[np.float64]
Evolution: TypeAlias = Literal["ageing", "slip", "prz", "nagata", "none"]

EVOLUTIONS: Final[Mapping[Evolution, str]] = MappingProxyType(
    {
        "ageing": r"1 - \frac{V \theta}{D_c}",
        "slip": r"-\frac{V \theta}{D_c} \ln\frac{V \theta}{D_c}",
        "prz": r"1 - \left(\frac{V \theta}{2 D_c}\right)^2",
        "nagata": r"1 - \frac{V \theta}{D_c} - \frac{c}{b} \theta \dot\mu",
        "none": "",
    }
)
"""The rate of the state in LaTeX by how it follows."""
TITLES: Final = {"ageing": "ageing", "slip": "slip", "prz": "Perrin-Rice-Zheng", "nagata": "Nagata"}
"""Names of the evolution laws in running text."""
NAMES: Final = {"ageing": "", "slip": "-slip", "prz": "-prz", "nagata": "-nagata"}
"""What they add to the name of a form."""
ONE_STATE: Final = (
    "reference_coefficient",
    "direct_effect",
    "evolution_effect",
    "critical_distance",
)
SECOND: Final = ("second_evolution_effect", "second_critical_distance")
STRESS: Final = "stress_effect"


class RateStateForm(NamedTuple):
    """A form of the law that fits and selections know by a name."""

    title: str
    """Name in running text."""
    evolution: Evolution
    """How the state follows."""
    fit_order: tuple[str, ...]
    """Parameters that are fitted."""

    @property
    def second(self) -> bool:
        """Whether it has a second state."""
        return SECOND[0] in self.fit_order

    @property
    def words(self) -> str:
        """Name within a sentence."""
        if self.evolution == "none":
            return (
                "friction logarithmic in speed"
                if len(self.fit_order) > 1
                else ("a constant coefficient")
            )
        states = "two states and " if self.second else ""
        return f"rate-and-state friction with {states}the {TITLES[self.evolution]} law"

    def contains(self, other: "RateStateForm") -> bool:
        """Whether another form is this one at some values of its parameters.

        Nagata's law is the ageing law without an effect of stress.
        """
        follows = {"none", self.evolution, *(("ageing",) if self.evolution == "nagata" else ())}
        return other.evolution in follows and set(other.fit_order) < set(self.fit_order)


def _evolving(evolution: Evolution, *, second: bool) -> RateStateForm:
    stress = (STRESS,) if evolution == "nagata" else ()
    states, more = ("two states", SECOND) if second else ("state", ())
    return RateStateForm(
        f"Rate and {states} ({TITLES[evolution]})", evolution, (*ONE_STATE, *more, *stress)
    )


def _name(evolution: Evolution, *, second: bool) -> str:
    return f"rate-and-{'two-states' if second else 'state'}{NAMES[evolution]}"


RATE_STATE_FORMS: Final[Mapping[str, RateStateForm]] = MappingProxyType(
    {
        "constant-coefficient": RateStateForm("Constant coefficient", "none", ONE_STATE[:1]),
        "logarithmic": RateStateForm("Logarithmic in speed", "none", ONE_STATE[:2]),
    }
    | {
        _name(evolution, second=second): _evolving(evolution, second=second)
        for second in (False, True)
        for evolution in EVOLUTIONS
        if evolution != "none"
    }
)
"""Forms of the law by name, the simplest first."""


@dataclass(frozen=True, kw_only=True)
class RateState(Parametrised):
    r"""Friction that depends on the slip speed and on a state that remembers past slip.

    mu = mu_0 + a ln(V / V_0) + b ln(V_0 theta / D_c), where theta follows

    - the ageing law (Dieterich), d theta/dt = 1 - V theta / D_c,
    - the slip law (Ruina), d theta/dt = -(V theta / D_c) ln(V theta / D_c),
    - the law of Perrin, Rice and Zheng, d theta/dt = 1 - (V theta / (2 D_c))^2, where 2 D_c
      stands for D_c in the coefficient, or
    - the law of Nagata, d theta/dt = 1 - V theta / D_c - (c / b) theta d mu/dt.

    A second state adds b_2 ln(V_0 theta_2 / D_2), with the same evolution law; what stress takes
    away is then shared by both, c / (b + b_2) each. Without evolution, mu = mu_0 + a ln(V / V_0),
    where a may have either sign; a = 0 is a constant coefficient.

    The regularised form, mu = a arcsinh((V / (2 V_0)) exp((mu_0 + b ln(V_0 theta / D_c)) / a)), is
    0 at rest and may reverse: in the evolution laws V and mu are then their sizes. While
    mu is many times a, as in all forward sliding, both forms agree to exp(-2 mu / a).

    It is not a `FrictionLaw`: the slope of the coefficient at rest is exp(mu_0 / a) times a / (2
    V_0), which the event-driven solver cannot resolve; `simulate_velocity_steps` runs it.

    Examples
    --------
    >>> law = RateState(
    ...     reference_coefficient=0.6,
    ...     direct_effect=0.005,
    ...     evolution_effect=0.01,
    ...     critical_distance=1e-5,
    ...     reference_velocity=1e-6,
    ... )
    >>> round(float(law.steady(1e-5)), 8), round(law.critical_stiffness, 9)
    (0.58848707, 500.0)
    """

    reference_coefficient: Annotated[float, Quantity("mu_0")]
    """Steady friction coefficient at the reference velocity."""
    direct_effect: Annotated[float, Quantity("a")]
    """What a jump of ln V adds at once; above 0 unless there is no evolution."""
    evolution_effect: Annotated[float, Quantity("b")] = 0.0
    """What it takes away again as the contacts are renewed."""
    critical_distance: Annotated[float, Quantity("D_c", "m", above=0)] | None = None
    """Slip over which contacts are renewed; None without evolution."""
    second_evolution_effect: Annotated[float, Quantity("b_2")] = 0.0
    """The evolution effect of a second state; may be negative."""
    second_critical_distance: Annotated[float, Quantity("D_2", "m", above=0)] | None = None
    """The critical distance of a second state; None without one."""
    stress_effect: Annotated[float, Quantity("c", low=0)] = 0.0
    """What a rise of the coefficient takes off the state at once, in Nagata's law."""
    reference_velocity: Annotated[float, Quantity("V_0", "m/s", above=0)]
    """Speed at which the reference coefficient holds."""
    evolution: Evolution = "ageing"
    """How states follow: ``"ageing"``, ``"slip"``, ``"prz"``, ``"nagata"`` or, where there is no
    state, ``"none"``."""
    regularised: bool = False
    """Whether the speed stands in an arcsinh, which has a value at rest and backwards, and not in a
    logarithm."""

    def __post_init__(self) -> None:
        """Check the parameters, and that they are those of the evolution."""
        super().__post_init__()
        if self.evolution not in EVOLUTIONS:
            raise ParameterError(
                "RateState.evolution must be 'ageing', 'slip', 'prz' or 'nagata', or 'none' without"
                f" a state, got {self.evolution!r}."
            )
        if self.evolution == "none":
            if self.evolution_effect != 0.0 or self.critical_distance is not None:
                raise ParameterError(
                    "RateState.evolution is 'none', which has neither evolution_effect (b) nor"
                    f" critical_distance (D_c): leave them out, got b = {self.evolution_effect:g}"
                    f" and D_c = {self.critical_distance}."
                )
            if self.second_critical_distance is not None:
                raise ParameterError(
                    "RateState.evolution is 'none', which has no second_critical_distance (D_2):"
                    f" leave it out, got {self.second_critical_distance:g} m."
                )
        elif self.critical_distance is None:
            raise ParameterError(
                "RateState.critical_distance (D_c) must be above 0 m, got none; evolution='none'"
                " does without it."
            )
        if not self.direct_effect > 0.0 and (self.evolution != "none" or self.regularised):
            raise ParameterError(
                f"RateState.direct_effect (a) must be above 0, got {self.direct_effect:g};"
                " evolution='none' takes either sign where it is not regularised."
            )
        if self.second_evolution_effect and self.second_critical_distance is None:
            raise ParameterError(
                "RateState.second_critical_distance (D_2) must be above 0 m where there is a"
                f" second_evolution_effect (b_2), here {self.second_evolution_effect:g}; got none."
            )
        if self.stress_effect and self.evolution != "nagata":
            raise ParameterError(
                "RateState.stress_effect (c) is a parameter of evolution='nagata': leave it out,"
                f" got {self.stress_effect:g} with {self.evolution!r}."
            )
        if self.stress_effect and not self.evolved > 0.0:
            raise ParameterError(
                "RateState.evolution_effect (b, with b_2) must be above 0 where there is a"
                f" stress_effect (c), which it divides; got {self.evolved:g}."
            )

    @property
    def name(self) -> str:
        """Key of the form of the law, as in `RATE_STATE_FORMS`."""
        if self.evolution == "none":
            return "logarithmic" if self.direct_effect else "constant-coefficient"
        return _name(self.evolution, second=self.second_critical_distance is not None)

    @property
    def title(self) -> str:
        """Name in running text."""
        return RATE_STATE_FORMS[self.name].title

    @property
    def sources(self) -> tuple[str, ...]:
        """Keys of the references."""
        own = {"prz": ("perrin1995",), "nagata": ("nagata2012",)}.get(self.evolution, ())
        regularised = ("lapusta2000",) if self.regularised else ()
        return ("dieterich1979", "ruina1983", "marone1998", *own, *regularised)

    @property
    def formula(self) -> str:
        """The law in LaTeX."""
        if self.name == "constant-coefficient" and not self.regularised:
            return r"\mu = \mu_0"
        second = self.second_critical_distance is not None
        length = "2 D_{}" if self.evolution == "prz" else "D_{}"
        index = {"c": r"b \ln\frac{V_0 \theta}", "2": r"b_2 \ln\frac{V_0 \theta_2}"}
        states = "".join(
            f" + {effect}{{{length.format(place)}}}"
            for place, effect in index.items()
            if self.evolution != "none" and (place == "c" or second)
        )
        if self.regularised:
            level = rf"\frac{{\mu_0{states}}}{{a}}"
            mu = rf"\mu = a \operatorname{{arsinh}}\left(\frac{{V}}{{2 V_0}} e^{{{level}}}\right)"
        else:
            mu = rf"\mu = \mu_0 + a \ln\frac{{V}}{{V_0}}{states}"
        if self.evolution == "none":
            return mu
        rate = EVOLUTIONS[self.evolution]
        if not second:
            return rf"{mu}, \qquad \dot\theta = {rate}"
        rate = rate.replace(r"\frac{c}{b}", r"\frac{c}{b + b_2}")
        other = rate.replace(r"\theta", r"\theta_2").replace("D_c", "D_2")
        return rf"{mu}, \qquad \dot\theta = {rate}, \qquad \dot\theta_2 = {other}"

    @property
    def states(self) -> tuple[tuple[float, float], ...]:
        """The evolution effect and the critical distance [m] of each state."""
        both = (
            (self.evolution_effect, self.critical_distance),
            (self.second_evolution_effect, self.second_critical_distance),
        )
        return tuple((b, distance) for b, distance in both if distance is not None)

    @property
    def evolved(self) -> float:
        """The evolution effects of all states together: b, or b + b_2."""
        return self.evolution_effect + self.second_evolution_effect

    @property
    def rate(self) -> float:
        """Lasting change of the coefficient by the logarithm of speed, a - b or a - b - b_2."""
        return self.direct_effect - self.evolved

    @property
    def critical_stiffness(self) -> float:
        """Stiffness [1/m] below which steady sliding is not stable; may be negative.

        It is (b - a) / D_c with one state, divided by 1 + c in Nagata's law, and the larger root of
        a quadratic with two. It is a change of the coefficient with position: times the load, it is
        in N/m. Without evolution it is infinite where friction falls with speed, and else minus
        infinity, as with two states where any stiffness is enough.
        """
        if self.critical_distance is None:
            return math.inf if self.direct_effect < 0.0 else -math.inf
        a, b, D, c = (
            self.direct_effect,
            self.evolution_effect,
            self.critical_distance,
            self.stress_effect,
        )
        if self.second_critical_distance is None:
            return (b - a) / D / (1.0 + c) if c else (b - a) / D
        b_2, D_2 = self.second_evolution_effect, self.second_critical_distance
        share = c / self.evolved if c else 0.0
        # the cubic of small deviations, with p for the rate over the speed:
        # a D D_2 p^3 + (p2 + k q2) p^2 + (p1 + k q1) p + k; Hurwitz: the middle two > a D D_2 k
        p_2, q_2 = a * (D + D_2) - b * D_2 - b_2 * D, (1.0 + c) * D * D_2
        p_1, q_1 = a - b - b_2, D + D_2 + share * (b * D + b_2 * D_2)
        square, linear, constant = q_1 * q_2, p_1 * q_2 + p_2 * q_1 - a * D * D_2, p_1 * p_2
        under = linear**2 - 4.0 * square * constant
        return (-linear + math.sqrt(under)) / (2.0 * square) if under >= 0.0 else -math.inf

    def steady(self, velocity: ArrayLike) -> Array:
        """Return the coefficient after long sliding at velocities [m/s].

        They must be above 0, or of either sign in the regularised form, which is 0 at rest.

        Examples
        --------
        >>> numbers = dict(
        ...     reference_coefficient=0.6,
        ...     direct_effect=0.01,
        ...     evolution_effect=0.01,
        ...     critical_distance=1e-5,
        ...     reference_velocity=1e-6,
        ... )
        >>> RateState(**numbers).steady([1e-6, 1e-3])
        array([0.6, 0.6])
        >>> RateState(**numbers, regularised=True).steady([-1e-6, 0.0, 1e-3])
        array([-0.6,  0. ,  0.6])
        """
        mu_0, V_0 = self.reference_coefficient, self.reference_velocity
        V = np.asarray(velocity, dtype=float)
        if not self.regularised:
            return mu_0 + self.rate * np.log(V / V_0)
        a = self.direct_effect
        with np.errstate(divide="ignore"):
            log = np.log(np.abs(V) / V_0)
        moving = np.where(V == 0.0, 0.0, log)  # the sign of 0 makes it 0 at rest
        # arsinh(e^x / 2) = x + ln((1 + sqrt(1 + 4 e^-2x)) / 2), without overflow where x is large
        x = (mu_0 + self.rate * moving) / a
        large = x + np.log1p(np.sqrt(1.0 + 4.0 * np.exp(-2.0 * np.maximum(x, 0.0)))) - math.log(2.0)
        small = np.arcsinh(0.5 * np.exp(np.minimum(x, 0.0)))
        return np.asarray(np.sign(V) * a * np.where(x > 0.0, large, small))
