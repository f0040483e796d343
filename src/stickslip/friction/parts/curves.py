"""A level that was measured at several speeds: a curve through its points."""

import functools
import itertools
import math
import re
from collections.abc import Sequence
from decimal import Decimal
from pathlib import Path
from typing import Annotated, final

from typing_extensions import Doc, override

from stickslip.documents import open_regular
from stickslip.errors import InputError, StickslipError
from stickslip.friction.parts.base import Extra, Part, Slip, Values
from stickslip.maths import Scalar, where
from stickslip.quantities import Quantity
from stickslip.units import factor, is_of

MOST_POINTS = 32
"""More points are noise, and every one is a place that a run steps onto."""
LARGEST = 100_000
"""Bytes of a file with a curve."""
POINT = r"\s*([-+.\deE]+)\s*:\s*([-+.\deE]+)\s*"
SPEEDS, LEVELS = ("m/s", "rad/s"), ("1", "N", "N m")
"""Units that columns of a file may be converted to."""


@final
class Table(Extra):
    """A curve through measured levels: cubics between them without overshoot, constant beyond."""

    name = "table"
    title = "measured levels"
    argument = "curve"
    tex = r"c\, \mu_{\text{table}}(|v|)"
    vanishes = {"curve_factor": 0.0}
    curve_factor: Annotated[
        float,
        Quantity("c", low=0, scale="none", bounds=(0.1, 10.0), start=1.0, per_load=True),
        Doc("Factor on the measured levels."),
    ] = 1.0

    def __init__(self, points: Sequence[tuple[float, float]] = ((0.0, 1.0), (1.0, 1.0))) -> None:
        self.points = tuple(points)

    @override
    def of(self, argument: str) -> Part:
        return Table(_points(argument)) if argument else self

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        return p.curve_factor * self.points[0][1]

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        return p.curve_factor * curve_through(self.points, monotone_slopes(self.points), s.speed)


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
    if low < high:
        middle = (low + high) // 2
        edge = points[middle][0]
        beyond = _within(points, slopes, middle + 1, high, v)
        if isinstance(edge, float) and edge == 0.0:
            return beyond
        return where(v < edge, _within(points, slopes, low, middle, v), beyond)
    if low in (0, len(points)):
        return points[min(low, len(points) - 1)][1] + 0.0 * v
    (x, y), (x_1, y_1) = points[low - 1 : low + 1]
    h, rise = x_1 - x, (y_1 - y) / (x_1 - x)
    m, m_1 = slopes[low - 1 : low + 1]
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
        turns = rise[k - 1] * rise[k] <= 0.0
        mean = 0.0 if turns else (before + after) / (before / rise[k - 1] + after / rise[k])
        inner.append(mean)
    return [_end(h[0], h[1], rise[0], rise[1]), *inner, _end(h[-1], h[-2], rise[-1], rise[-2])]


def _end(h: float, next_h: float, rise: float, next_rise: float) -> float:
    """Return the slope at an end from its two nearest pieces, limited so that nothing turns."""
    slope = ((2.0 * h + next_h) * rise - h * next_rise) / (h + next_h)
    if slope * rise <= 0.0:
        return 0.0
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
        lambda found: f"{found[1]}{found[2]}{folder / found[3]}{found[2]}",
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
    return ", ".join(f"{_written(x)}: {_written(y)}" for x, y in points)


@functools.lru_cache(maxsize=256)
def _points(argument: str) -> tuple[tuple[float, float], ...]:
    """Return the points of a text, checked."""
    try:
        found = [(float(x), float(y)) for x, y in re.findall(POINT, argument)]
    except ValueError:
        raise InputError(f"table[{argument}] has what is no number.") from None
    return tuple(_checked(found, f"table[{argument[:40]}]"))


def _checked(points: list[tuple[float, float]], said: str) -> list[tuple[float, float]]:
    """Return points, or say what is wrong with them."""
    if not 2 <= len(points) <= MOST_POINTS:
        count = "1 point" if len(points) == 1 else f"{len(points)} points"
        finer = "; average a finer one" if len(points) > MOST_POINTS else ""
        raise InputError(f"{said} has {count}: a curve needs 2 to {MOST_POINTS}{finer}.")
    for i, (x, y) in enumerate(points, 1):
        if not (math.isfinite(x) and math.isfinite(y) and x >= 0.0 and y > 0.0):
            raise InputError(
                f"{said}: point {i} has the speed {x:g} and the level {y:g}; the speed must be at"
                " least 0 and the level above 0, the sizes of velocity and friction."
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
            text = file.read(LARGEST + 1).decode("utf-8-sig")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise InputError(f"{said} cannot be read: {reason}.") from None
    if len(text) > LARGEST:
        raise InputError(f"{said} has more than {LARGEST} characters: average it.")
    written = [line for line in text.splitlines() if line.strip()]
    lines = [line for line in written if not line.startswith("#")]
    scales = (1.0, 1.0)
    if lines and re.search(r"[A-DF-Za-df-z]", lines[0]):
        scales = _scales(lines.pop(0), said)
    elif headers := [line for line in written if line.startswith("#") and "[" in line]:
        scales = _scales(headers[-1], said)
    points = []
    for i, line in enumerate(lines, 1):
        cells = [one for one in re.split(r"[;,\s]+", line.strip()) if one]
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
    found = []
    for cell, allowed in zip(cells, (SPEEDS, LEVELS), strict=False):
        named = re.search(r"\[([^\[\]]*+)\]", cell)
        unit = named[1].strip() if named else allowed[0]
        unit = "1" if unit == "-" else unit
        try:
            (target, *_) = [one for one in allowed if one == unit or is_of(unit, one)]
            found.append(1.0 if target == unit else factor(unit, target))
        except (StickslipError, ValueError):
            raise InputError(
                f"{said}: a column in [{unit}] is no {'speed' if allowed is SPEEDS else 'level'};"
                f" it must be in {', '.join(allowed)} or a multiple."
            ) from None
    return found[0], (found[1] if len(found) > 1 else 1.0)


def _written(x: float) -> str:
    """Return a number without a decimal point."""
    _, digits, exponent = Decimal(repr(x)).normalize().as_tuple()
    assert isinstance(exponent, int)  # it is finite
    whole = "".join(map(str, digits))
    return f"{whole}{'0' * exponent}" if 0 <= exponent < 4 else f"{whole}e{exponent}"
