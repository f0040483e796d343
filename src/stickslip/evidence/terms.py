"""Kinds of terms of the force balance: the column of each, its sign, and how usual it is.

A kind is added by one entry of `TERMS`. What acts through the contact is multiplied by the state of
the bristle, so that memory combines with every such term.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.evidence.bristles import SIGN, Shape, free_load
from stickslip.evidence.motion import derivative
from stickslip.evidence.part import Part
from stickslip.formatting import number

Array = NDArray[np.float64]
Contact = Literal["none", "odd", "even", "own", "rate"]
"""How a column acts: beside the contact, times the state of the bristle, times its size, times the
state of a bristle of its own, whose shape the term's parameters are, or times the state's rate."""

LEVELS = ("level", "load")
"""A constant level and one in proportion to the load: of all else that acts through the contact,
laws say that it grows with a load that is measured."""
DAMPING = 0.05
"""Damping of the resonance of a flexible coupling."""


@final
@dataclass(frozen=True)
class Term:
    """One term of a structure: a kind with its nonlinear parameters."""

    kind: str
    """A key of `TERMS`."""
    par: tuple[float, ...] = ()
    """Nonlinear parameters, in SI units."""
    channel: str = ""
    """Name of the joint; `*` for all."""
    what: str = ""
    """Name of the covariate or of the known column."""

    @override
    def __str__(self) -> str:
        """Return the name with parameters."""
        values = f"({', '.join(number(one) for one in self.par)})" if self.par else ""
        name = TERMS[self.kind].name + values + (f" {self.what}" if self.what else "")
        return f"{self.channel}: {name}" if self.channel not in ("", "*") else name


@final
@dataclass(frozen=True, kw_only=True)
class Kind:
    """What a term of one kind is."""

    name: str
    """Name for users."""
    column: Callable[[Part, Term], Array]
    """The column or columns (n,) or (n, d) along a part, before the state multiplies them."""
    contact: Contact = "none"
    """How the column acts."""
    filtered: bool = False
    """Whether the column is in the band already."""
    rank: int = 1
    """How unusual the kind is: of what is not told apart the least ranks are named."""
    positive: bool = False
    """Whether physics asks for coefficients that are not negative."""
    fault: bool = False
    """Whether the term says that the rig or the measurement is at fault."""
    wave: bool = False
    """Whether it is a wave along the way. Its frequency is the best of some hundred, one of which
    fits what other terms leave: it has to earn the margins of a fault."""
    even: bool = False
    """Whether it acts alike in both directions: half the difference between directions."""
    limits: tuple[float, float] | None = None
    """Coefficients that are possible, where physics fixes the scale."""
    columns: tuple[str, ...] = ()
    """Names of the columns, where there are several."""
    par: tuple[str, ...] = ()
    """Names of the nonlinear parameters."""
    fixed: tuple[int, ...] = ()
    """Which of the nonlinear parameters stay on their grid."""


def column_of(part: Part, term: Term, shape: Shape) -> tuple[Array, Array | None]:
    """Return the columns (n, d) of a term in the band, and what multiplies the state in them."""
    kind = TERMS[term.kind]
    made = kind.column(part, term)
    made = made if made.ndim == 2 else made[:, None]
    column, multiplier = made, None
    if "load" in part.covariates and kind.contact != "none" and term.kind not in LEVELS:
        made = made * (part.covariates["load"] / part.references["load"])[:, None]
    if kind.contact != "none":
        state = part.state(term.par if kind.contact == "own" else shape)
        if kind.contact == "rate":
            column, multiplier = derivative(state, part.h)[:, None] * made, None
        else:
            state = np.abs(state) if kind.contact == "even" else state
            column, multiplier = state[:, None] * made, made
    if not kind.filtered and part.filter is not None:
        column = part.filter.passed(column)
    return column, multiplier


def _ones(part: Part, term: Term) -> Array:
    return np.ones_like(part.q)


def _known(part: Part, term: Term) -> Array:
    return part.extra[term.what]


def _acceleration(part: Part, term: Term) -> Array:
    return part.a


def _position(part: Part, term: Term) -> Array:
    return part.q - part.centre


def _velocity(part: Part, term: Term) -> Array:
    return part.v


def _speed(part: Part, term: Term) -> Array:
    return np.abs(part.v)


def _power(part: Part, term: Term) -> Array:
    return np.sign(part.v) * _speed_power(part, term)


def _speed_power(part: Part, term: Term) -> Array:
    found: Array = np.abs(part.v) ** term.par[0]
    return found


def _power_covariate(part: Part, term: Term) -> Array:
    return _power(part, term) * _covariate(part, term)


def _drag(part: Part, term: Term) -> Array:
    return part.v * np.abs(part.v)


def _decay(part: Part, term: Term) -> Array:
    v_s, delta = term.par
    return np.exp(-((np.abs(part.v) / v_s) ** delta))


def _decay_covariate(part: Part, term: Term) -> Array:
    return _decay(part, term) * _covariate(part, term)


def _load(part: Part, term: Term) -> Array:
    return part.covariates[term.what]


def _covariate(part: Part, term: Term) -> Array:
    return part.covariates[term.what] - part.references[term.what]


def _size(part: Part, term: Term) -> Array:
    return np.abs(part.covariates[term.what])


def _square(part: Part, term: Term) -> Array:
    return part.covariates[term.what] ** 2


def _viscous_covariate(part: Part, term: Term) -> Array:
    return part.v * _covariate(part, term)


def _ripple(part: Part, term: Term) -> Array:
    phase = term.par[0] * (part.q - part.centre)
    return np.column_stack([np.sin(phase), np.cos(phase)])


def _imbalance(part: Part, term: Term) -> Array:
    return _ripple(part, term) * part.v[:, None] ** 2


def _clock(part: Part, term: Term) -> Array:
    return part.clock


def _viscous_clock(part: Part, term: Term) -> Array:
    return part.clock * part.v


def _hum(part: Part, term: Term) -> Array:
    phase = 2.0 * math.pi * term.par[0] * part.since
    return np.column_stack([np.sin(phase), np.cos(phase)])


def _excess(part: Part, term: Term) -> Array:
    """Return what the recorded force has beyond a limit, which an amplifier does not deliver."""
    return np.sign(part.raw) * np.maximum(np.abs(part.raw) - term.par[0], 0.0)


def _missing_in_gap(part: Part, term: Term) -> Array:
    """Return inertia and level where less than the gap was travelled since the last reversal."""
    inside = 1.0 * (np.abs(part.state((0.5 * term.par[0], 0.0))) < 1.0 - 1e-9)
    columns: Array = np.column_stack([np.gradient(part.v, part.h), part.state(SIGN)])
    return inside[:, None] * columns


def _free_load(part: Part, term: Term) -> Array:
    return _beside_the_known(part, free_load(part.q, part.v, part.h, *term.par))


def _resonant(part: Part, term: Term) -> Array:
    """Return the acceleration of an inertia behind a coupling of a resonance [Hz]."""
    n = len(part.q)
    pad = min(n // 4, int(2.0 / part.h))
    a = np.pad(part.a, pad, mode="reflect")
    f = np.fft.rfftfreq(len(a), part.h) / term.par[0]
    response = np.fft.rfft(a) / (1.0 - f**2 + 2j * DAMPING * f)
    return _beside_the_known(part, np.fft.irfft(response, len(a))[pad : pad + n])


def _beside_the_known(part: Part, a: Array) -> Array:
    """Return the acceleration of a share of an inertia; relative to all of it if that is known."""
    return a if part.mass is None else a - part.a


def _no_column(part: Part, term: Term) -> Array:
    return np.zeros((len(part.q), 0))


TERMS: dict[str, Kind] = {
    "known": Kind(name="known", column=_known, filtered=True),
    "inertia": Kind(name="inertia", column=_acceleration, filtered=True, rank=0, positive=True),
    "mass": Kind(name="error of the mass", column=_acceleration, filtered=True, rank=3, fault=True),
    "level": Kind(name="level", column=_ones, contact="odd", rank=0, positive=True),
    "offset": Kind(
        name="offset or direction-dependent level", column=_ones, filtered=True, even=True
    ),
    "level_dir": Kind(name="level, per direction", column=_ones, contact="even", even=True),
    "viscous": Kind(name="viscous", column=_velocity, rank=0, positive=True),
    "viscous_dir": Kind(name="viscous, per direction", column=_speed, rank=2, even=True),
    "power": Kind(name="viscous power", column=_power, rank=2, positive=True, par=("exponent",)),
    "power_dir": Kind(
        name="viscous power, per direction",
        column=_speed_power,
        rank=3,
        even=True,
        par=("exponent",),
    ),
    "quadratic": Kind(name="drag", column=_drag, rank=2, positive=True),
    "stribeck": Kind(
        name="Stribeck step",
        column=_decay,
        contact="odd",
        rank=2,
        positive=True,
        par=("Stribeck velocity", "exponent"),
        fixed=(1,),
    ),
    "stribeck_dir": Kind(
        name="Stribeck step, per direction",
        column=_decay,
        contact="even",
        rank=3,
        even=True,
        par=("Stribeck velocity", "exponent"),
        fixed=(1,),
    ),
    "stribeck_cov": Kind(
        name="Stribeck step in",
        column=_decay_covariate,
        contact="odd",
        rank=3,
        par=("Stribeck velocity", "exponent"),
    ),
    "second": Kind(
        name="second memory",
        column=_ones,
        contact="own",
        rank=3,
        positive=True,
        par=("length", "exponent"),
    ),
    "damping": Kind(
        name="damping of the bristle", column=_ones, contact="rate", rank=1, positive=True
    ),
    "load": Kind(name="level in load", column=_load, contact="odd", rank=-1, positive=True),
    "temperature": Kind(name="level in", column=_covariate, contact="odd"),
    "weight": Kind(name="level in", column=_size, contact="odd", rank=3, positive=True),
    "motor_weight": Kind(name="level in", column=_size, contact="odd", rank=4, positive=True),
    "weight2": Kind(
        name="level in the square of", column=_square, contact="odd", rank=4, positive=True
    ),
    "viscous_cov": Kind(name="viscous in", column=_viscous_covariate, rank=3),
    "power_cov": Kind(name="viscous power in", column=_power_covariate, rank=3, par=("exponent",)),
    "level_ripple": Kind(
        name="level ripple",
        column=_ripple,
        contact="odd",
        rank=3,
        wave=True,
        columns=("sin", "cos"),
        par=("wave number",),
    ),
    "ripple": Kind(
        name="ripple",
        column=_ripple,
        rank=3,
        wave=True,
        columns=("sin", "cos"),
        par=("wave number",),
    ),
    "imbalance": Kind(
        name="imbalance",
        column=_imbalance,
        rank=4,
        wave=True,
        columns=("sin", "cos"),
        par=("wave number",),
    ),
    "level_slope": Kind(name="level along the way", column=_position, contact="odd", rank=3),
    "spring": Kind(name="spring", column=_position, rank=2, fault=True),
    "drift": Kind(name="level drifts", column=_clock, contact="odd", rank=3, fault=True),
    "offset_drift": Kind(name="offset drifts", column=_clock, rank=3, fault=True),
    "viscous_drift": Kind(name="viscosity drifts", column=_viscous_clock, rank=3, fault=True),
    "hum": Kind(
        name="ripple in time",
        column=_hum,
        rank=4,
        fault=True,
        columns=("sin", "cos"),
        par=("frequency",),
    ),
    "saturation": Kind(
        name="saturation",
        column=_excess,
        rank=4,
        positive=True,
        fault=True,
        limits=(0.85, 1.15),
        par=("limit",),
    ),
    "backlash": Kind(
        name="backlash",
        column=_missing_in_gap,
        rank=4,
        fault=True,
        columns=("inertia", "level"),
        par=("gap",),
        fixed=(0,),
    ),
    "loose": Kind(
        name="backlash (free load)",
        column=_free_load,
        rank=4,
        positive=True,
        fault=True,
        par=("gap", "frequency"),
    ),
    "flexible": Kind(
        name="flexible coupling",
        column=_resonant,
        filtered=True,
        rank=4,
        positive=True,
        fault=True,
        par=("frequency",),
    ),
    "lag": Kind(
        name="lag of the force",
        column=_no_column,
        filtered=True,
        rank=4,
        fault=True,
        par=("time constant",),
    ),
    "delay": Kind(
        name="delay of the force",
        column=_no_column,
        filtered=True,
        rank=4,
        fault=True,
        par=("delay",),
    ),
    "skew": Kind(
        name="clock drift of the force",
        column=_no_column,
        filtered=True,
        rank=4,
        fault=True,
        par=("rate",),
    ),
}
"""Kinds by key: laws, nuisances and faults alike."""


def through_bristle(kind: str) -> bool:
    """Return whether the state of the structure's bristle multiplies terms of a kind."""
    return TERMS[kind].contact in ("odd", "even", "rate")


def usual_size(values: Array) -> float:
    """Return the value from which a covariate counts: a round number near its mean."""
    mean = float(np.mean(values))
    if mean == 0.0:
        return 0.0
    digits = 1 - math.floor(math.log10(abs(mean)))
    return round(mean, digits)
