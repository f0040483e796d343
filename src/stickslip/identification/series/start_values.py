"""Where fits to records begin: values and bounds of every unknown, from the record itself."""

import dataclasses
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.errors import InputError
from stickslip.experiments import Measurement, usual_top_speed
from stickslip.formatting import number
from stickslip.friction import FrictionLaw
from stickslip.identification.estimation.parameters import (
    FreeParameter,
    FreeParameters,
    Sizes,
    with_ranges,
)
from stickslip.identification.series.applied_force import driven
from stickslip.identification.series.inverse_dynamics import (
    InverseDynamics,
    check_is_mass,
    inverse_dynamics,
    is_mass,
    mass_of,
    positions_of,
)
from stickslip.identification.validation import LAW
from stickslip.mechanisms import Mechanism, normal_of, only_contact
from stickslip.quantities import Quantity, fields_of, full_path, parameters, unchecked

REVERSED = 0.01
"""Inertial share of a negative mass from which the force acts against the motion."""
BENDING, BRAKES = 0.5, 0.5
"""Inertial share of a negative mass up to which bristles may stand for it, and the level over the
standard deviation of the friction from which one brakes."""
WIDE = 30.0
"""How far bounds lie from what regression found."""
NUISANCE = {"offset"}
"""Parameters of a mechanism that are looked for whatever the law: sensors and cables have them."""
PRESLIDING = 1e-3
"""Length over which bristles give way, over the stroke."""
ONE_WAY = 0.01
"""Share of samples that must go each way for a record to be two-sided."""
REACH = 100.0
"""How far levels and slopes may go above what linear regression found."""
CREDIBLE = 1.0 / REACH
"""Share of the force from which a regressed level is one to start from: bounds go beyond the force.
Below it, such as below 0, regression has mistaken the level for mass or slope."""
SEEN = 1e-3
"""Share of the force that the inertia must take for its regression to say anything."""
UNEXPLAINED = 0.8
"""Share of the force that a regression leaves above which its signs accuse no channel. A force
recorded with the wrong sign fits as well as with the right one."""


def inertia_of(
    mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str]
) -> FreeParameter | None:
    """Return the mass of a mechanism where it is looked for, to start from by robust regression."""
    check_is_mass(unknown)
    if not unknown:
        return None
    known = {path: quantity for path, quantity, _ in parameters(mechanism, "mechanism")}
    path = full_path(unknown[0].rpartition(".")[2], known)
    both, apart = (
        _regressed(mechanism, measurement, vary=["inertia"], directional=side)
        for side in (False, True)
    )
    check_signs(both, driven=driven(measurement))
    value = apart["inertia"] if apart["inertia"] > 0.0 else mass_of(mechanism)
    return FreeParameter(
        path=path, quantity=known[path], start=value, low=value / WIDE, high=value * WIDE, log=True
    )


def _regressed(
    mechanism: Mechanism, measurement: Measurement, vary: Sequence[str], *, directional: bool
) -> InverseDynamics:
    return inverse_dynamics(mechanism, measurement, vary=vary, directional=directional, robust=True)


@dataclass(frozen=True, kw_only=True)
class Scales:
    """What a record says about the sizes of friction, before any law is chosen."""

    load: float
    """Normal force [N] that levels are divided by."""
    level: float
    """Level [N], not negative."""
    levels: tuple[float, float]
    """The same forwards and backwards."""
    slope: float
    """Viscous coefficient [N s/m], not negative."""
    slopes: tuple[float, float]
    """The same forwards and backwards."""
    offset: float
    """Constant force [N]."""
    inertia: float
    """Mass [kg]."""
    speed: float
    """Speed [m/s] that is rarely exceeded."""
    stroke: float
    """Range of positions [m]."""
    two_sided: bool = True
    """Whether the record slips both ways."""

    @classmethod
    def of_level(
        cls, level: float, *, load: float, speed: float, stroke: float, inertia: float
    ) -> "Scales":
        """Return the sizes where no more is known than a level [N] and the largest speed [m/s]."""
        return cls(
            load=load,
            level=level,
            levels=(level, level),
            slope=level / speed,
            slopes=(level / speed, level / speed),
            offset=0.0,
            inertia=inertia,
            speed=speed,
            stroke=stroke,
        )


def scales_of(
    mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str] = ()
) -> Scales:
    """Return the sizes that robust linear regression of forces finds."""
    free = ["inertia"] if any(path.endswith(("inertia", "mass")) for path in unknown) else []

    both, apart = (
        _regressed(mechanism, measurement, free, directional=side) for side in (False, True)
    )
    size = float(np.median(np.abs(both.friction)))
    check_signs(both, driven=driven(measurement))
    positions = [np.ptp(positions_of(record)) for record in measurement.records()]
    ahead = float(np.mean(both.velocity > 0.0))
    speed = max(usual_top_speed(both.velocity), 1e-12)
    return Scales(
        load=load_of(mechanism),
        level=_level(both["level"], size),
        levels=(_level(apart["level+"], size), _level(apart["level-"], size)),
        slope=max(both["viscous"], 0.0),
        slopes=(max(apart["viscous+"], 0.0), max(apart["viscous-"], 0.0)),
        offset=both["offset"],
        inertia=both["inertia"] if both.inertial_share > SEEN else mass_of(mechanism),
        speed=speed,
        stroke=max(float(max(positions)), 1e-12),
        two_sided=ONE_WAY < ahead < 1.0 - ONE_WAY,
    )


def _level(regressed: float, size: float) -> float:
    """Return the level to start from [N]: half of the force where regression tells none."""
    return regressed if regressed > CREDIBLE * size else 0.5 * size


def check_signs(found: InverseDynamics, *, driven: bool) -> None:
    """Refuse a force that acts against the motion it should cause."""
    if _says_little(found) and not (found["level"] < 0.0 and found["viscous"] < 0.0):
        return
    said = ", ".join(f"{n} {number(v)}" for n, v in zip(found.names, found.values, strict=True))
    if not driven:
        raise InputError(
            "no drive was given, and friction alone cannot cause this motion: linear regression"
            f" gives {said}. Give the force if there was one; only a free decay needs none."
        )
    if found.relative_error > UNEXPLAINED:
        raise InputError(
            f"inertia and sliding friction leave {100.0 * found.relative_error:.0f} % of the force:"
            f" linear regression gives {said}, which therefore says nothing. Friction may hold the"
            " body for most of the record, so that it moves by deflection only, or another force"
            " acts. Record moves in which the body slides; check the meaning of each column."
        )
    raise InputError(
        f"the force acts against the motion that it should cause: linear regression gives {said}."
        " Check its sign (gain -1) and the meaning of each column."
    )


def _says_little(found: InverseDynamics) -> bool:
    """Whether an inertia that came out negative says nothing of the sign of the force.

    The motion was slow, and it takes a small share of the force; or slip in both directions has a
    level that brakes, beside which it takes less: a force that bends bristles goes with the
    acceleration too. In one direction a level is not told from a weight.
    """
    if found.inertial_share > -REVERSED:
        return True
    ahead = float(np.mean(found.velocity > 0.0))
    if not ONE_WAY < ahead < 1.0 - ONE_WAY or found.relative_error > UNEXPLAINED:
        return False
    level = min(found[name] for name in found.names if name.startswith("level"))
    return found.inertial_share > -BENDING and level > BRAKES * float(np.std(found.friction))


def load_of(mechanism: Mechanism) -> float:
    """Return the normal force at the contact [N] where that is a constant."""
    normal = normal_of(mechanism)
    load: float | None = only_contact(mechanism).load
    if normal is not None:  # what its coordinate is pressed down with at rest
        h = 1e-6
        up, down = (
            mechanism.potential_energy(0.0, defaultdict(float, {normal: side * h}))
            for side in (1.0, -1.0)
        )
        load = (up - down) / (2.0 * h)
    if load is None or load <= 0.0:
        raise InputError(
            f"start values need a constant normal force above 0 N, and"
            f" {type(mechanism).__name__} has {load!r}."
        )
    return float(load)


def law_unknowns(
    law: FrictionLaw | type[FrictionLaw],
    scales: Scales,
    free: Sequence[str] | None = None,
    known: Mapping[str, float] | None = None,
) -> tuple[FrictionLaw, tuple[FreeParameter, ...]]:
    """Return a law to start from, and its unknowns."""
    kind = law if isinstance(law, type) else type(law)
    known = known or {}
    names = [name for name in kind.fit_order if name not in known]
    if free is not None:
        known_paths = {f"friction.{name}": quantity for name, quantity in fields_of(kind).items()}
        wanted = set(names) if LAW in free else set()
        wanted |= {full_path(n, known_paths).partition(".")[2] for n in free if n != LAW}
        names = [name for name in (*kind.fit_order, *fields_of(kind)) if name in wanted]
        names = list(dict.fromkeys(names))
    sizes = _sizes(scales)
    ranges = {name: sizes.of(with_ranges(law, name)) for name in names}
    values = {name: one.start for name, one in ranges.items()}
    if not isinstance(law, type):
        values |= {n: v for n in names if (v := getattr(law, n)) is not None}
    else:
        values |= {n: float(v) for n, v in known.items()}
    start = _made(kind, law, values)
    free_parameters = []
    for name in names:
        quantity, low, high = fields_of(kind)[name], ranges[name].low, ranges[name].high
        above = quantity.at_least or ""
        if above and getattr(start, above, None) is None:
            above = ""
        log = quantity.above is not None
        if log and low <= 0.0:
            low = 1e-6 * max(ranges[name].start, 1e-300)
        signed = quantity.scale == "none" and low < 0.0
        low = min(low, 2.0 * values[name]) if signed else low
        surplus = getattr(start, above) if above else 0.0
        free_parameters.append(
            FreeParameter(
                path=f"friction.{name}",
                quantity=quantity,
                start=max(values[name], surplus),
                low=low,
                high=max(high, 2.0 * values[name]),
                log=log,
                above=f"friction.{above}" if above else "",
            )
        )
    return start, tuple(free_parameters)


def _made(
    kind: type[FrictionLaw], law: FrictionLaw | type[FrictionLaw], values: Mapping[str, float]
) -> FrictionLaw:
    """Return a law with start values; exponents stand in its equations, whole or not."""
    if not isinstance(law, type):
        return law
    defaults = {one.name: one.default for one in dataclasses.fields(kind) if one.name not in values}
    for name, default in defaults.items():
        if default is dataclasses.MISSING:
            symbol = fields_of(kind)[name].symbol
            raise InputError(
                f"{kind.__name__}.{name} ({symbol}) is neither varied nor fixed: add it to vary, or"
                f" give its value, fixed={{{name!r}: ...}}."
            )
    made = unchecked(kind, **{**defaults, **values})
    made.__post_init__()
    return made


def _sizes(s: Scales) -> Sizes:
    """Return the sizes that the ranges of a law's parameters are multiples of."""
    level, slope = s.level / s.load, max(s.slope, 1e-3 * s.level / s.speed)
    steepest = slope + 0.1 * s.level / s.speed
    displacement = PRESLIDING * s.stroke
    stiffness = level / displacement
    typical = {
        "level": level,
        "level+": s.levels[0] / s.load,
        "level-": s.levels[1] / s.load,
        "load": s.load,
        "force": s.level,
        "slope": slope,
        "slope+": s.slopes[0],
        "slope-": s.slopes[1],
        "drag": slope / s.speed,
        "speed": s.speed,
        "displacement": displacement,
        "stiffness": stiffness,
        "damping": 2.0 * (stiffness * s.inertia / s.load) ** 0.5,  # critical
    }
    reach = typical | {
        **dict.fromkeys(("level+", "level-"), level),
        **dict.fromkeys(("slope", "slope+", "slope-"), steepest),
        "drag": steepest / s.speed,
        "damping": level / s.speed,
    }
    return Sizes(typical=typical, reach=reach)


def mechanism_unknowns(
    mechanism: Mechanism,
    law: FrictionLaw,
    unknown: Sequence[str],
    scales: Scales,
    held: Collection[str] = (),
) -> tuple[FreeParameter, ...]:
    """Return the unknowns of a mechanism: those asked for, and what is always in doubt.

    A constant force is left out where it is held, and where the record has one number for it and a
    level: with laws that have a level of their own in each direction, and where slip is in one
    direction only.
    """
    known: Mapping[str, tuple[Quantity, float]] = {
        path: (quantity, value) for path, quantity, value in parameters(mechanism, "mechanism")
    }
    paths = [full_path(name, {path: one for path, (one, _) in known.items()}) for name in unknown]
    if scales.two_sided and not law.directional:
        paths += [f"mechanism.{n}" for n in NUISANCE if f"mechanism.{n}" in known]
    found = []
    for path in dict.fromkeys(path for path in paths if path not in held):
        quantity, value = known[path]
        name = path.rpartition(".")[2]
        begin = scales.offset if name == "offset" else value
        begin = scales.inertia if is_mass(mechanism, path) else begin
        found.append(mechanism_unknown(path, quantity, begin, scales.level))
    return tuple(found)


def mechanism_unknown(path: str, quantity: Quantity, start: float, level: float) -> FreeParameter:
    """Return an unknown of a mechanism under friction of a level [N], with wide bounds."""
    log = quantity.above is not None
    name = path.rpartition(".")[2]
    most = (REACH if name in NUISANCE else 1e3) * (level + abs(start))
    return FreeParameter(
        path=path,
        quantity=quantity,
        start=start,
        low=1e-3 * start if log else max(quantity.low, -most),
        high=1e3 * start if log else min(quantity.high, most),
        log=log,
    )


def joined(law: FrictionLaw, items: Sequence[FreeParameter]) -> FreeParameters:
    """Return the unknowns of a fit together, with what the law does not look for."""
    rest = {path: value for path, _, value in parameters(law, "friction")}
    return FreeParameters(tuple(items), rest)
