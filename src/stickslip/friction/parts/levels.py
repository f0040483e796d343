"""Levels of friction over the load: what sliding needs at a speed, and what a contact holds."""

import functools
import itertools
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from typing import Annotated

from typing_extensions import Doc, override

from stickslip.errors import InputError, StickslipError
from stickslip.friction import base
from stickslip.friction.parts.base import Becomes, Extra, Level, Part, Slip, SmoothLevel, Values
from stickslip.maths import Scalar, exp, log, power, tanh, where
from stickslip.quantities import Quantity
from stickslip.show.documents import open_regular
from stickslip.units import factor, is_of

AT_LARGEST = Doc("Speed at which friction peaks, if the static level is above the kinetic one.")
VANISHED = 36.0
"""exp(-36) = 2.3e-16: beyond this the exponential is below the last digit of its factor."""


def fade(speed: Scalar, stribeck_velocity: Scalar, exponent: Scalar) -> Scalar:
    """Return exp(-(v/v_s)^n), and 0 where that is below rounding.

    The layer in which it is not zero is often crossed in less than a millisecond. Naming its end
    makes the solver step onto it and not over it.
    """
    # From (v / v_s)^n = VANISHED.
    layer = stribeck_velocity * power(VANISHED, 1.0 / exponent)
    return where(speed < layer, exp(-power(speed / stribeck_velocity, exponent)), 0.0)


class Kinetic(Level):
    """One level, whatever the speed."""

    name = "level"
    title = "Coulomb"
    tex = r"\mu_k"
    rest = "kinetic_coefficient"
    vanishes = {"kinetic_coefficient": 0.0}
    below = ("step",)
    kinetic_coefficient: base.KineticCoefficient

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        return p.kinetic_coefficient + 0.0 * s.speed  # an array of speeds gives an array


class Surplus(Level):
    """A static level above the kinetic one, of which less is left the faster the contact slides."""

    rest = "static_coefficient"
    vanishes = {"static_coefficient": "kinetic_coefficient"}
    below = ("peak",)

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        return (p.static_coefficient - p.kinetic_coefficient) * self.left(p, s)

    def left(self, p: Values, s: Slip) -> Scalar:
        """Return the share of the surplus that is left at a speed."""
        raise NotImplementedError


class Step(Level):
    """A static level that ends with rest."""

    name = "step"
    title = "static"
    tex = ""
    rest = "static_coefficient"
    vanishes = {"static_coefficient": "kinetic_coefficient"}
    static_coefficient: base.StaticCoefficient | None = None

    @override
    def sliding(self, p: Values, s: Slip) -> None:
        return None


class Peak(Level):
    """A break-away level above the one at which sliding begins."""

    name = "peak"
    title = "break-away peak"
    tex = ""
    rest = "break_away_coefficient"
    vanishes = {"break_away_coefficient": "static_coefficient"}
    break_away_coefficient: (
        Annotated[
            float,
            Quantity(
                "mu_b",
                low=0,
                at_least="static_coefficient",
                scale="level",
                bounds=(0.0, 10.0),
                start=1.2,
            ),
            Doc("Largest friction force at rest, where that is above the one of vanishing speed."),
        ]
        | None
    ) = None

    @override
    def sliding(self, p: Values, s: Slip) -> None:
        return None


class Stribeck(Surplus):
    """A static surplus that fades exponentially."""

    name = "stribeck"
    title = "Stribeck"
    tex = r"(\mu_s - \mu_k) e^{-|v/v_s|^n}"
    static_coefficient: base.StaticCoefficient
    stribeck_velocity: base.StribeckVelocity
    fading_exponent: base.FadingExponent = 2.0

    @override
    def left(self, p: Values, s: Slip) -> Scalar:
        return fade(s.speed, p.stribeck_velocity, p.fading_exponent)


class Tustin(Surplus):
    """A static surplus that fades exponentially, with a corner at rest."""

    name = "tustin"
    title = "Tustin"
    compared = False
    tex = r"(\mu_s - \mu_k) e^{-|v|/v_s}"
    static_coefficient: base.StaticCoefficient
    stribeck_velocity: base.StribeckVelocity

    @override
    def left(self, p: Values, s: Slip) -> Scalar:
        return fade(s.speed, p.stribeck_velocity, 1.0)


class Lorentz(Surplus):
    """A static surplus that fades with the square of the speed."""

    name = "lorentz"
    title = "Hess and Soom"
    compared = False
    tex = r"\frac{\mu_s - \mu_k}{1 + (v/v_s)^2}"
    static_coefficient: base.StaticCoefficient
    stribeck_velocity: base.StribeckVelocity

    @override
    def left(self, p: Values, s: Slip) -> Scalar:
        u = s.speed / p.stribeck_velocity
        return 1.0 / (1.0 + u * u)


class Hyperbolic(Surplus):
    """A static surplus that fades with the speed itself."""

    name = "hyperbolic"
    title = "Popp and Stelter"
    compared = False
    tex = r"\frac{\mu_s - \mu_k}{1 + |v|/v_s}"
    static_coefficient: base.StaticCoefficient
    stribeck_velocity: base.StribeckVelocity

    @override
    def left(self, p: Values, s: Slip) -> Scalar:
        return 1.0 / (1.0 + s.speed / p.stribeck_velocity)


class BrownMcPhee(SmoothLevel):
    """One smooth curve that peaks near mu_s at the transition velocity."""

    name = "brown_mcphee"
    title = "Brown and McPhee"
    tex = r"\left[\mu_k \tanh(4u) + (\mu_s - \mu_k) \frac{u}{(u^2/4 + 3/4)^2}\right]"
    tex_where = r"u = |v|/v_t"
    kinetic_coefficient: base.KineticCoefficient
    static_coefficient: base.StaticCoefficient
    transition_velocity: Annotated[
        float,
        Quantity("v_t", "m/s", above=0, scale="speed", bounds=(1e-4, 1.0), start=0.01),
        AT_LARGEST,
    ]

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        mu_k, mu_s = p.kinetic_coefficient, p.static_coefficient
        u = s.speed / p.transition_velocity
        # At u = 1 this is 1 and tanh(4) nearly so: the curve passes mu_s there, within 0.0007 mu_k.
        d = 0.25 * u * u + 0.75
        return mu_k * tanh(4.0 * u) + (mu_s - mu_k) * u / (d * d)


class Simscape(SmoothLevel):
    """The curve of the Translational Friction block: a bump on a hyperbolic tangent."""

    name = "simscape"
    title = "Simscape"
    tex = r"\left[\sqrt{2e} (\mu_s - \mu_k) u e^{-u^2} + \mu_k \tanh(10 |v|/v_b)\right]"
    tex_where = r"u = |v|/(\sqrt 2 v_b)"
    kinetic_coefficient: base.KineticCoefficient
    static_coefficient: base.StaticCoefficient
    breakaway_velocity: Annotated[
        float,
        Quantity("v_b", "m/s", above=0, scale="speed", bounds=(1e-4, 1.0), start=0.01),
        AT_LARGEST,
    ]

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        mu_k, mu_s = p.kinetic_coefficient, p.static_coefficient
        u = s.speed / (math.sqrt(2.0) * p.breakaway_velocity)
        # The bump is mu_s - mu_k at its largest, at u = 1 / sqrt(2), which is v = v_b.
        bump = math.sqrt(2.0 * math.e) * (mu_s - mu_k) * exp(-u * u) * u
        return bump + mu_k * tanh(10.0 * s.speed / p.breakaway_velocity)


class Logarithmic(Extra):
    """A level that grows with the logarithm of the speed, from 0 at rest."""

    name = "logarithmic"
    title = "logarithmic level"
    holds = False
    tex = r"a \ln(1 + |v|/v_0)"
    vanishes = {"logarithmic_coefficient": 0.0}
    logarithmic_coefficient: Annotated[
        float,
        Quantity("a", low=0, scale="level", bounds=(0.0, 2.0), start=0.05),
        Doc("Growth of the level with the logarithm of the speed."),
    ]
    reference_velocity: Annotated[
        float,
        Quantity("v_0", "m/s", above=0, scale="speed", bounds=(1e-5, 1.0), start=0.01),
        Doc("Speed above which the growth is logarithmic."),
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        return 0.0

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        return p.logarithmic_coefficient * log(1.0 + s.speed / p.reference_velocity)


def rate(symbol: str, start: float, at_least: str | None = None) -> Quantity:
    """Return the quantity of the inverse of a speed."""
    return Quantity(
        symbol, "s/m", above=0, at_least=at_least, scale="1/speed", bounds=(1.0, 1e4), start=start
    )


class Makkar(SmoothLevel):
    """Differences of hyperbolic tangents: a bump on a rise to the kinetic level."""

    name = "makkar"
    title = "Makkar"
    compared = False
    tex = (
        r"\left[\gamma_1 (\tanh \gamma_2 |v| - \tanh \gamma_3 |v|)"
        r" + \mu_k \tanh \gamma_5 |v|\right]"
    )
    bump_coefficient: Annotated[
        float,
        Quantity("gamma_1", low=0, scale="level", bounds=(0.0, 2.0), start=0.1),
        Doc("Level that the bump adds at most, reached if it rises much faster than it falls."),
    ]
    fall_rate: Annotated[float, rate("gamma_3", 10.0), Doc("How fast the bump falls.")]
    rise_rate: Annotated[
        float,
        rate("gamma_2", 100.0, "fall_rate"),
        Doc("How fast the bump rises; it is none below fall_rate, where friction would drive."),
    ]
    kinetic_coefficient: base.KineticCoefficient
    smoothing_rate: Annotated[
        float, rate("gamma_5", 100.0), Doc("How fast the kinetic level is reached.")
    ]

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        v, mu_k = s.speed, p.kinetic_coefficient
        bump = p.bump_coefficient * (tanh(p.rise_rate * v) - tanh(p.fall_rate * v))
        return bump + mu_k * tanh(p.smoothing_rate * v)


class BengisuAkay(SmoothLevel):
    """A parabola up to the static level, and an exponential down to the kinetic one."""

    name = "bengisu_akay"
    title = "Bengisu and Akay"
    compared = False
    tex = r"h"
    tex_where = (
        r"h = \begin{cases} \mu_s \frac{|v|}{v_0} \left(2 - \frac{|v|}{v_0}\right) & |v| < v_0 \\"
        r" \mu_k + (\mu_s - \mu_k) e^{-\xi (|v| - v_0)} & |v| \ge v_0 \end{cases}"
    )
    kinetic_coefficient: base.KineticCoefficient
    static_coefficient: base.StaticCoefficient
    peak_velocity: Annotated[
        float,
        Quantity("v_0", "m/s", above=0, scale="speed", bounds=(1e-4, 1.0), start=0.01),
        AT_LARGEST,
    ]
    fall_rate: Annotated[float, rate("xi", 10.0), Doc("How fast friction falls beyond its peak.")]

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        mu_k, mu_s, u = p.kinetic_coefficient, p.static_coefficient, s.speed / p.peak_velocity
        beyond = mu_k + (mu_s - mu_k) * exp(-p.fall_rate * (s.speed - p.peak_velocity))
        # Both branches meet at mu_s. The slope jumps there: by the switch a step ends at it.
        return where(s.speed < p.peak_velocity, mu_s * u * (2.0 - u), beyond)


# A level that was measured at several speeds: a curve through its points.

MOST_POINTS = 32
"""More points of a direction are noise, and every one is a place that a run steps onto."""
LARGEST_FILE = 100_000
"""Bytes of a file with a curve."""
POINT = r"\s*([-+.\deE]+)\s*:\s*([-+.\deE]+)\s*"
SPEEDS, LEVELS = ("m/s", "rad/s"), ("1", "N", "N m")
"""Units that columns of a file may be converted to."""


class Table(Extra):
    """A curve through measured levels: cubics between them without overshoot, constant beyond.

    Points at velocities below 0 are those of the other direction; without any, both are alike.
    """

    name = "table"
    title = "measured levels"
    argument = "curve"
    vanishes = {"curve_factor": 0.0}
    curve_factor: Annotated[
        float,
        Quantity("c", low=0, scale="none", bounds=(0.1, 10.0), start=1.0, per_load=True),
        Doc("Factor on the measured levels."),
    ] = 1.0

    def __init__(self, points: Sequence[tuple[float, float]] = ((0.0, 1.0), (1.0, 1.0))) -> None:
        self.ahead = tuple(point for point in points if point[0] >= 0.0)
        self.back = tuple((-v, level) for v, level in reversed(points) if v < 0.0)

    @property
    @override
    def tex(self) -> str:  # type: ignore[override]  # of its points
        """Its term of the formula."""
        return rf"c\, \mu_{{\text{{table}}}}({'v' if self.back else '|v|'})"

    @property
    @override
    def directional(self) -> bool:  # type: ignore[override]  # of its points
        return bool(self.back)

    @override
    def one_way(self, side: int) -> str:
        return _text(self.back if self.back and side < 0 else self.ahead)

    @override
    def of(self, argument: str) -> Part:
        return Table(_points(argument)) if argument else self

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        return self.sliding(p, replace(s, speed=0.0))

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        both = [
            curve_through(points, monotone_slopes(points), s.speed)
            for points in filter(None, (self.ahead, self.back))
        ]
        return p.curve_factor * (both[0] if s.choose is None else s.choose(both[0], both[-1]))


def curve_through(
    points: Sequence[tuple[Scalar, Scalar]], slopes: Sequence[Scalar], v: Scalar
) -> Scalar:
    """Return the level at a speed on cubics between points, constant beyond them.

    Examples
    --------
    >>> curve_through([(0.1, 2.0), (0.3, 4.0)], [10.0, 10.0], 0.2)
    3.0
    """
    return _within(points, slopes, 0, len(points), v)


def _within(
    points: Sequence[tuple[Scalar, Scalar]],
    slopes: Sequence[Scalar],
    low: int,
    high: int,
    v: Scalar,
) -> Scalar:
    """Return the level at a speed below point `high` and not below the point before `low`."""
    # By halves, so that switches are nested log2(n) deep and not n.
    if low < high:
        middle = (low + high) // 2
        edge = points[middle][0]
        beyond = _within(points, slopes, middle + 1, high, v)
        if isinstance(edge, float) and edge == 0.0:  # speeds are not below 0
            return beyond
        return where(v < edge, _within(points, slopes, low, middle, v), beyond)
    if low in (0, len(points)):
        return points[min(low, len(points) - 1)][1] + 0.0 * v  # an array of speeds gives an array
    (x, y), (x_1, y_1) = points[low - 1 : low + 1]
    h, rise = x_1 - x, (y_1 - y) / (x_1 - x)
    m, m_1 = slopes[low - 1 : low + 1]
    # The cubic with slopes m and m_1 at its ends, in powers of the distance from the first.
    u = v - x
    b, c = (3.0 * rise - 2.0 * m - m_1) / h, (m + m_1 - 2.0 * rise) / (h * h)
    return y + u * (m + u * (b + u * c))


def monotone_slopes(points: Sequence[tuple[float, float]]) -> list[float]:
    """Return slopes at the points with which cubics between them are monotonic.

    Source: F. N. Fritsch and J. Butland, "A method for constructing local monotone piecewise cubic
    interpolants", 1984; at the ends the parabola through three points.

    Examples
    --------
    >>> monotone_slopes([(0.0, 1.0), (1.0, 2.0), (3.0, 2.0)])
    [1.3333333333333333, 0.0, 0.0]
    """
    h = [b - a for (a, _), (b, _) in itertools.pairwise(points)]
    rise = [(b[1] - a[1]) / (b[0] - a[0]) for a, b in itertools.pairwise(points)]
    if len(points) == 2:
        return [rise[0], rise[0]]
    inner = []
    for k in range(1, len(rise)):
        before, after = 2.0 * h[k] + h[k - 1], h[k] + 2.0 * h[k - 1]
        # A weighted harmonic mean, which is nearer to the smaller rise; none where the data turn.
        turns = rise[k - 1] * rise[k] <= 0.0
        mean = 0.0 if turns else (before + after) / (before / rise[k - 1] + after / rise[k])
        inner.append(mean)
    return [_end(h[0], h[1], rise[0], rise[1]), *inner, _end(h[-1], h[-2], rise[-1], rise[-2])]


def _end(h: float, next_h: float, rise: float, next_rise: float) -> float:
    """Return the slope at an end from its two nearest pieces, limited so that nothing turns."""
    slope = ((2.0 * h + next_h) * rise - h * next_rise) / (h + next_h)
    if slope * rise <= 0.0:
        return 0.0
    # Where the next rise turns, a steeper end would make the first cubic turn inside.
    if rise * next_rise <= 0.0 and abs(slope) > 3.0 * abs(rise):
        return 3.0 * rise
    return slope


def curves_beside(text: str, folder: Path) -> str:
    """Return the text of a law whose files with curves are named from a folder.

    Examples
    --------
    >>> curves_beside('table["curve.csv"] + viscous', Path("axis"))
    'table["axis/curve.csv"] + viscous'
    """
    return re.sub(
        r"""(\btable\s*\[\s*)(["'])([^\]"']*)\2""",
        lambda item: f"{item[1]}{item[2]}{folder / item[3]}{item[2]}",
        text,
    )


def curve_text(argument: str) -> str:
    """Return a curve as the notation writes it: points ``speed: level``, read from a file if named.

    Examples
    --------
    >>> curve_text("0: 2, 0.01: 1.8")
    '0: 2, 1e-2: 18e-1'
    """
    if re.fullmatch(rf"{POINT}(,{POINT})*", argument):
        points: Sequence[tuple[float, float]] = _points(argument)
    else:
        points = _read(argument.strip("\"' "))
    return _text(points)


def _text(points: Sequence[tuple[float, float]]) -> str:
    return ", ".join(f"{_written(x)}: {_written(y)}" for x, y in points)


@functools.lru_cache(maxsize=256)
def _points(argument: str) -> tuple[tuple[float, float], ...]:
    """Return the points of a text, checked."""
    try:
        result = [(float(x), float(y)) for x, y in re.findall(POINT, argument)]
    except ValueError:
        raise InputError(f"table[{argument}] has what is no number.") from None
    return tuple(_checked(result, f"table[{argument[:40]}]"))


def _checked(points: list[tuple[float, float]], said: str) -> list[tuple[float, float]]:
    """Return points, or say what is wrong with them."""
    back = sum(x < 0.0 for x, _ in points)
    for size, side in ((len(points) - back, "from 0 on"), (back, "below 0")):
        if (size or side == "from 0 on") and not 2 <= size <= MOST_POINTS:
            count = "1 point" if size == 1 else f"{size} points"
            of, each = (f" at velocities {side}", " in each direction") if back else ("", "")
            finer = "; average a finer one" if size > MOST_POINTS else ""
            raise InputError(
                f"{said} has {count}{of}: a curve needs 2 to {MOST_POINTS}{each}{finer}."
            )
    for i, (x, y) in enumerate(points, 1):
        if not (math.isfinite(x) and math.isfinite(y) and y > 0.0):
            raise InputError(
                f"{said}: point {i} has the speed {x:g} and the level {y:g}; both must be finite,"
                " and the level above 0 in either direction, the size of friction."
            )
        if i > 1 and x <= points[i - 2][0]:
            raise InputError(
                f"{said}: the speed {x:g} of point {i} is not above {points[i - 2][0]:g} before it:"
                " sort the points by speed, and average those of one speed."
            )
    return points


def _read(name: str) -> list[tuple[float, float]]:
    """Return the points of a file: speeds and levels, with a line of names and units or without."""
    said = f"the curve {name!r} of a table"
    try:
        with open_regular(Path(name)) as file:
            text = file.read(LARGEST_FILE + 1).decode("utf-8-sig")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise InputError(f"{said} cannot be read: {reason}.") from None
    if len(text) > LARGEST_FILE:
        raise InputError(f"{said} has more than {LARGEST_FILE} characters: average it.")
    written = [line for line in text.splitlines() if line.strip()]
    lines = [line for line in written if not line.startswith("#")]
    scales = (1.0, 1.0)
    if lines and re.search(r"[A-DF-Za-df-z]", lines[0]):
        scales = _scales(lines.pop(0), said)
    elif headers := [line for line in written if line.startswith("#") and "[" in line]:
        scales = _scales(headers[-1], said)
    points = []
    for i, line in enumerate(lines, 1):
        cells = [key for key in re.split(r"[;,\s]+", line.strip()) if key]
        try:
            x, y = map(float, cells)
        except ValueError:
            raise InputError(
                f"{said}: row {i}, {line.strip()[:40]!r}, must be a speed and a level,"
                " with decimal points."
            ) from None
        points.append((x * scales[0], y * scales[1]))
    return _checked(points, said)


def _scales(header: str, said: str) -> tuple[float, float]:
    """Return the factors of both columns to SI, from units in square brackets."""
    cells = re.split(r"[;,\t]|(?<=\])\s+(?=\w)", header)
    result = []
    for cell, allowed in zip(cells, (SPEEDS, LEVELS), strict=False):
        named = re.search(r"\[([^\[\]]*+)\]", cell)
        unit = named[1].strip() if named else allowed[0]
        unit = "1" if unit == "-" else unit
        try:
            (target, *_) = [name for name in allowed if name == unit or is_of(unit, name)]
            result.append(1.0 if target == unit else factor(unit, target))
        except (StickslipError, ValueError):
            raise InputError(
                f"{said}: a column in [{unit}] is no {'speed' if allowed is SPEEDS else 'level'};"
                f" it must be in {', '.join(allowed)} or a multiple."
            ) from None
    return result[0], (result[1] if len(result) > 1 else 1.0)


def _written(x: float) -> str:
    """Return a number without a decimal point."""
    minus, digits, exponent = Decimal(repr(x)).normalize().as_tuple()
    assert isinstance(exponent, int)  # it is finite
    whole = "-" * minus + "".join(map(str, digits))
    return f"{whole}{'0' * exponent}" if 0 <= exponent < 4 else f"{whole}e{exponent}"


# Levels that an input of the contact adds: loads of gears, pressures of seals.


class Fading(Extra):
    """A level that fades as the static surplus does."""

    needs = ("stribeck_velocity", "fading_exponent")

    @override
    def left(self, p: Values, s: Slip) -> Scalar:
        return fade(s.speed, p.stribeck_velocity, p.fading_exponent)


class Weight(Extra):
    """In proportion to the size of an input."""

    name = "weight"
    title = "load"
    argument = "input"
    tex = r"\mu_{1} |{0}|"
    vanishes = {"coefficient": 0.0}
    coefficient: Annotated[
        float,
        Quantity("mu_{0}", "1/{0}", low=0, scale="level", bounds=(0.0, 2.0), start=0.05),
        Doc("Growth of the level with the size of the input."),
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        (x,) = s.inputs
        return p.coefficient * abs(x)


class WeightFading(Fading):
    """In proportion to the size of an input, fading as the static surplus does."""

    name = "weight_fading"
    title = "load that fades"
    argument = "input"
    tex = r"\mu_{s{1}} |{0}| e^{-|v/v_s|^n}"
    vanishes = {"static_surplus": 0.0}
    static_surplus: Annotated[
        float,
        Quantity("mu_s{0}", "1/{0}", low=0, scale="level", bounds=(0.0, 2.0), start=0.05),
        Doc("Growth of the level at vanishing speed with the size of the input, beside the rest."),
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        (x,) = s.inputs
        return p.static_surplus * abs(x)


class Weight2(Extra):
    """In proportion to the square of an input."""

    name = "weight2"
    title = "load squared"
    argument = "input"
    tex = r"c_{1} {0}^2"
    vanishes = {"quadratic_coefficient": 0.0}
    quadratic_coefficient: Annotated[
        float,
        Quantity("c_{0}", "1/{0}^2", low=0, scale="level", bounds=(0.0, 2.0), start=0.05),
        Doc("Growth of the level with the square of the input."),
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        (x,) = s.inputs
        return p.quadratic_coefficient * x * x


def share(symbol: str) -> Quantity:
    """Return the quantity of a share of a torque that a gear loses."""
    return Quantity(symbol, "1/N", low=0, scale="level/force", bounds=(0.0, 1.0), start=0.05)


class Gear(Extra):
    """The load of a gear that does not lose as much of the motor's torque as of the other side's.

    Where ``k_m motor = k_e external`` it is 0, although the gear is loaded.
    """

    name = "gear"
    title = "load of a gear"
    inputs = ("motor", "external")
    tex = r"|k_m \tau_m - k_e \tau_e|"
    vanishes = {"motor_friction": 0.0, "external_friction": 0.0}
    becomes = (
        Becomes(
            name="weight",
            argument="transmitted",
            values=dict.fromkeys(
                ("motor_friction", "external_friction"), "transmitted_coefficient"
            ),
        ),
    )
    motor_friction: Annotated[
        float, share("k_m"), Doc("Share of the motor's torque that is lost, over the load.")
    ]
    external_friction: Annotated[
        float, share("k_e"), Doc("Share of the external torque that is lost, over the load.")
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        motor, external = s.inputs
        return abs(p.motor_friction * motor - p.external_friction * external)


class GearStribeck(Fading):
    """A load of the gear, fading as the static surplus does."""

    name = "gear_stribeck"
    title = "load of a gear that fades"
    inputs = ("motor", "external")
    tex = r"|k_{ms} \tau_m - k_{es} \tau_e| e^{-|v/v_s|^n}"
    vanishes = {"motor_static_friction": 0.0, "external_static_friction": 0.0}
    becomes = (
        Becomes(
            name="weight_fading",
            argument="transmitted",
            values=dict.fromkeys(
                ("motor_static_friction", "external_static_friction"), "transmitted_static_surplus"
            ),
        ),
    )
    motor_static_friction: Annotated[
        float,
        share("k_ms"),
        Doc("Share of the motor's torque that is lost beside the rest at vanishing speed."),
    ]
    external_static_friction: Annotated[
        float,
        share("k_es"),
        Doc("Share of the external torque that is lost beside the rest at vanishing speed."),
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        motor, external = s.inputs
        return abs(p.motor_static_friction * motor - p.external_static_friction * external)


def growth(symbol: str) -> Quantity:
    """Return the quantity of a growth with the square of a torque."""
    return Quantity(symbol, "1/N^2", low=0, scale="level/force^2", bounds=(0.0, 1.0), start=0.05)


class GearQuadratic(Fading):
    """The square of the smaller one of two torques that oppose each other, fading.

    It jumps where both are equal.
    """

    name = "gear_quadratic"
    title = "load of a gear squared"
    inputs = ("motor", "external")
    tex = r"Q e^{-|v/v_s|^n}"
    tex_where = (
        r"Q = \begin{cases} q_e \tau_e^2 & |\tau_e| < |\tau_m| \\ q_m \tau_m^2 & |\tau_e| >"
        r" |\tau_m| \end{cases} \text{ where } \tau_m \tau_e < 0, \text{ else } 0"
    )
    vanishes = {"motor_quadratic": 0.0, "external_quadratic": 0.0}
    motor_quadratic: Annotated[
        float, growth("q_m"), Doc("Growth with the square of the motor's torque, if smaller.")
    ]
    external_quadratic: Annotated[
        float, growth("q_e"), Doc("Growth with the square of the external torque, if smaller.")
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        motor, external = s.inputs
        squared = where(
            abs(motor) > abs(external),
            p.external_quadratic * external * external,
            p.motor_quadratic * motor * motor,
        )
        return where(motor * external < 0.0, squared, 0.0)
