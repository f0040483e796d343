"""Where searches begin: start values and bounds of laws, and values that are tried by runs."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, replace
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement
from stickslip.errors import ConvergenceError
from stickslip.friction import Coulomb, FrictionLaw
from stickslip.identify.fits.contact_inputs import load_of
from stickslip.identify.fits.levenberg_marquardt import ResidualJacobian, improve
from stickslip.identify.fits.motions import SLOW
from stickslip.identify.fits.parameters import (
    WIDE,
    FreeParameter,
    FreeParameters,
    Sizes,
    is_level,
    refuse_open,
    with_ranges,
)
from stickslip.identify.fits.settings import MOST, RESOLUTION, ROUNDS
from stickslip.identify.fits.shooting.measured_motions import PlainBalance
from stickslip.identify.fits.shooting.multiple_shooting import Shooting
from stickslip.identify.fits.shooting.segments import segments_of
from stickslip.identify.fits.validation import LAW
from stickslip.mechanisms import Mechanism, slip_of
from stickslip.quantities import Quantity, fields_of, full_path, parameters
from stickslip.show.formatting import number

Array = NDArray[np.float64]


LITTLE = 0.01
"""Share of a force that is next to nothing of it, and of samples that are few of them."""
SURPLUS = 0.2
"""Static surplus to begin with, over the kinetic level; that level itself is tried, too."""
FAST = 0.5
"""Share of the largest speed (its 99th percentile) above which slip counts as steady."""
FARTHER = 10.0
"""How much farther than its range an exponent, a change with an input, and what spans decades is
looked for."""


MECHANISM, SENSOR = "mechanism.offset", "measurement.offset.friction"
"""Paths of the constant force: of the mechanism if it has one, else of the force sensor."""


class ConstantForce(NamedTuple):
    """A constant force beside friction."""

    path: str = SENSOR
    """Its path."""
    value: float = 0.0
    """Its value where it is not looked for [N]."""


def constant_of(mechanism: Mechanism) -> ConstantForce:
    """Return the constant force of a mechanism, or that of the force sensor if it has none.

    Examples
    --------
    >>> from stickslip import Axis
    >>> constant_of(Axis(inertia=1.0, offset=0.5))
    ConstantForce(path='mechanism.offset', value=0.5)
    """
    own = getattr(mechanism, "offset", None)
    return ConstantForce() if own is None else ConstantForce(MECHANISM, own or 0.0)


@dataclass(frozen=True, kw_only=True)
class StartEstimate:
    """What friction against motion says at a glance.

    Examples
    --------
    >>> from stickslip import Axis, Measurement
    >>> t = np.arange(0.0, 20.0, 0.01)
    >>> force = -6.0 * np.sin(2.0 * t) + 5.0 * np.sign(np.cos(2.0 * t)) + 0.5
    >>> record = Measurement(time=t, position=np.sin(2.0 * t) / 2.0, force=force)
    >>> found = PlainBalance.of(Axis(inertia=3.0), record, inertia=True)
    >>> rough = StartEstimate.of(found, load=1.0, stroke=1.0)
    >>> round(rough.level, 1), round(rough.offset, 1)
    (5.0, 0.5)
    """

    level: float
    """Friction over normal force while sliding, less the viscous part."""
    viscous: float
    """Growth of friction with speed [N s/m]."""
    offset: float
    """Constant force beside friction [N]."""
    force: float
    """Typical friction force [N]."""
    load: float
    """Typical normal force [N]."""
    speed: float
    """Largest speed, the 99th percentile [m/s]."""
    stiffness: float
    """Slope of friction against displacement in presliding, over the normal force [1/m]."""
    two_sided: bool
    """Whether there is slip in both directions."""
    sides: tuple["StartEstimate", ...] = ()
    """The same of backward and of forward slip alone."""

    @property
    def sizes(self) -> Sizes:
        """The sizes that the ranges of a law's parameters are multiples of."""
        back, ahead = self.sides or (self, self)
        level = max(self.force / self.load, 1e-12)
        slope = self.force / self.speed
        typical = {
            "level": self.level,
            "level+": ahead.level,
            "level-": back.level,
            "load": self.load,
            "force": self.level * self.load,
            "slope": self._slope,
            "slope+": ahead._slope,
            "slope-": back._slope,
            "drag": 0.1 * slope / self.speed,
            "speed": self.speed,
            "displacement": self.level / self.stiffness,
            "stiffness": self.stiffness,
            "damping": 0.01 * self.level / self.speed,
        }
        reach = typical | {
            **dict.fromkeys(("level", "level+", "level-"), level),
            "force": self.force,
            **dict.fromkeys(("slope", "slope+", "slope-"), slope),
            "drag": slope / self.speed,
            "displacement": level / self.stiffness,
            "damping": 0.1 * level / self.speed,
        }
        return Sizes(typical=typical, reach=reach)

    @property
    def _slope(self) -> float:
        return max(self.viscous, 1e-3 * self.force / self.speed)

    @classmethod
    def of(
        cls, found: PlainBalance, *, load: float, stroke: float, offset: float | None = None
    ) -> "StartEstimate":
        """Return what a plain balance says; the offset is looked for if it is not given.

        Of bristles it says nothing: they are taken to yield within a part of the stroke [m].
        """
        v, f = found.velocity, found.friction
        speed = float(np.percentile(np.abs(v), 99.0)) or 1.0
        ahead, back = v > SLOW * speed, v < -SLOW * speed
        two_sided = bool(min(np.mean(ahead), np.mean(back)) > LITTLE)
        if offset is None:
            offset = found.values["offset"] if two_sided else 0.0
        size, fast = np.abs(f - offset), np.abs(v) >= FAST * speed

        def level(side: NDArray[np.bool_]) -> float:
            rows = side & fast if (side & fast).any() else fast
            return max(float(np.median(size[rows])) / load, 1e-12)

        whole = level(ahead | back)
        own: dict[str, Any] = {
            # where speeds hardly differ a level passes for a viscous part, and the other way round
            "viscous": min(max(found.values["viscous"], 0.0), MOST * whole * load / speed),
            "offset": offset,
            "load": load,
            "speed": speed,
            "two_sided": two_sided,
            "force": max(float(np.sqrt(np.mean(size**2))), 1e-12),
            "stiffness": whole / (LITTLE * (stroke or 1.0)),
        }
        levels = [level(side) if two_sided else whole for side in (back, ahead)]
        return cls(
            level=whole, sides=(cls(level=levels[0], **own), cls(level=levels[1], **own)), **own
        )

    def law(
        self, kind: type[FrictionLaw], known: Mapping[str, float], named: Collection[str] = ()
    ) -> FrictionLaw:
        """Return a law of a kind: known values by name, else of these sizes where it needs some.

        What it may do without it has if it is named.
        """
        values: dict[str, Any] = {}
        for declared in fields(kind):
            quantity = fields_of(kind).get(declared.name)
            own = declared.name in named
            if quantity is None or (declared.default is None and not own):
                continue
            if declared.name in known:
                values[declared.name] = float(known[declared.name])
                continue
            needed = not isinstance(declared.default, (int, float))
            if needed if quantity.structural else own or declared.name in _wanted(kind):
                value = self.sizes.of(with_ranges(kind, declared.name)).start
                value = min(max(value, quantity.low), quantity.high)
                if quantity.at_least is not None and quantity.at_least in values:
                    value = values[quantity.at_least] * (1.0 + SURPLUS)
                values[declared.name] = value
        return kind(**values)

    def unknowns(
        self,
        law: FrictionLaw | type[FrictionLaw],
        *,
        free: Collection[str] | None = None,
        known: Mapping[str, float] | None = None,
        held: Collection[str] = (),
        constant: str | None = None,
    ) -> tuple[FrictionLaw, FreeParameters]:
        """Return a law to start from, and its unknowns with those of a constant force, if any."""
        known = known or {}
        typed = isinstance(law, type)
        kind = law if isinstance(law, type) else type(law)
        paths_of = {f"friction.{name}": quantity for name, quantity in fields_of(kind).items()}
        alone = [name for name in free or () if name.count(".") < 2 and name != LAW]
        named = {full_path(name, paths_of).partition(".")[2] for name in alone}
        start: FrictionLaw
        if isinstance(law, type):
            start = self.law(kind, known, named)
        else:
            bare = [name for name in named if getattr(law, name) is None]
            start = replace(law, **{n: getattr(self.law(kind, known, bare), n) for n in bare})
        held = [*held, *(f"friction.{name}" for name in known)]
        paths = looked_for(start, whole=typed, free=free, held=held)
        if isinstance(law, type):
            refuse_open(law, {path.removeprefix("friction.") for path in (*paths, *held)})
            start = _with_defaults(start, paths, known)
        return start, self.free_parameters(start, paths, constant)

    def free_parameters(
        self, law: FrictionLaw, paths: Collection[str], constant: str | None
    ) -> FreeParameters:
        """Return the parameters at some paths, and a constant force, to be looked for."""
        known = _values(law)
        items = [
            self._unknown(law, path, quantity, value, known)
            for path, (quantity, value) in known.items()
            if path in paths
        ]
        if constant is not None:
            most = WIDE * self.force
            items.append(
                FreeParameter(
                    path=constant,
                    quantity=Quantity("o", "N", or_unit="N m"),
                    start=self.offset,
                    low=-most,
                    high=most,
                )
            )
        return FreeParameters(tuple(items), {path: value for path, (_, value) in known.items()})

    def _unknown(
        self,
        law: FrictionLaw,
        path: str,
        quantity: Quantity,
        value: float,
        known: Mapping[str, tuple[Quantity, float]],
    ) -> FreeParameter:
        ranged = quantity if quantity.scale else with_ranges(law, path.rpartition(".")[2])
        assert ranged.bounds is not None
        (least, most), reach = ranged.bounds, ranged.scaled_by(self.sizes.reach)
        limit = quantity.low if quantity.above is None else quantity.above
        base = f"{path.rpartition('.')[0]}.{quantity.at_least}" if quantity.at_least else ""
        above = base if base in known else ""
        log = ranged.structural or (ranged.above is not None and least > 0.0)
        # a change with an input: its bounds are numbers over the unit, whatever the input's size
        signed = ranged.scale == "none" and least < 0.0
        if quantity.structural:
            low, high = least / FARTHER, most * FARTHER
        elif ranged.scale == "none":
            wide = FARTHER * abs(value) if signed else 0.0
            low, high = min(least, value - wide), max(most, value + wide)
        elif log:
            size = value if is_level(quantity) else min(reach, value)
            low = least * size * (1.0 / WIDE if is_level(quantity) else 1.0)
            high = FARTHER * most * max(reach, value)
        else:
            size = max(reach, abs(value))
            low = limit + (0.0 if quantity.above is None else 1e-9 * reach)
            low, high = max(low, -WIDE * size), max(most * reach, WIDE * size)
        if above:
            return FreeParameter(
                path=path, quantity=quantity, start=value, low=0.0, high=high, above=above
            )
        return FreeParameter(
            path=path,
            quantity=quantity,
            start=value,
            low=max(low, quantity.low),
            high=min(high, quantity.high),
            log=log,
        )


def _with_defaults(
    law: FrictionLaw, fitted: Collection[str], known: Mapping[str, float]
) -> FrictionLaw:
    """Return a law in which what is not fitted has its known value or its default, if any."""
    names = {path.rpartition(".")[2] for path in fitted}
    plain = {
        field.name: field.default
        for field in fields(law)
        if field.name in fields_of(type(law)) and field.name not in names
        if field.default is not MISSING
    }
    return replace(law, **{**plain, **{n: v for n, v in known.items() if n not in names}})


def looked_for(
    law: FrictionLaw, *, whole: bool, free: Collection[str] | None = None, held: Collection[str]
) -> list[str]:
    """Return the paths of the parameters of a law that a fit looks for.

    Those of its `fit_order` and of laws within it, as far as they are given. A whole exponent is
    among them only if `whole` is true, or if it is named.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=0.5, bristle_stiffness=1e3)
    >>> looked_for(law, whole=False, held=["bristle_stiffness"])
    ['friction.kinetic_coefficient', 'friction.viscous_coefficient']
    >>> looked_for(law, whole=False, free=["yield_exponent"], held=[])
    ['friction.yield_exponent']
    """
    own = {f"friction.{name}" for name in _wanted(type(law))}
    standing = {path for path, _, _ in parameters(law, "friction")}
    within = {path for path in standing if path.count(".") > 1}
    known = {path: quantity for path, (quantity, _) in _values(law).items()}
    named = {full_path(name, known) for name in free or () if name != LAW}
    usual = free is None or LAW in free
    result = [
        path
        for path in known
        if path in named
        or (usual and (path in within or (path in own and (whole or path in standing))))
    ]
    names = {**known, **dict.fromkeys(("mechanism.offset", "measurement.offset.friction"))}
    out = {full_path(name, names) for name in held if name != "offset"}
    return [path for path in result if path not in out]


def _wanted(kind: type[FrictionLaw]) -> set[str]:
    """Return the names of the parameters that a fit of a law pays for, and those it needs."""
    needed = {
        declared.name
        for declared in fields(kind)
        if declared.name in fields_of(kind) and declared.default is declared.default_factory
    }
    return {*kind.fit_order, *needed}


def _values(law: FrictionLaw) -> dict[str, tuple[Quantity, float]]:
    """Return quantity and value of all parameters by path, whole exponents too."""
    result = {
        f"friction.{name}": (quantity, float(getattr(law, name)))
        for name, quantity in fields_of(type(law)).items()
        if getattr(law, name) is not None
    }
    result.update(
        (path, (quantity, value)) for path, quantity, value in parameters(law, "friction")
    )
    return result


# Values that are tried one by one before a search, as no regression or slope leads to them.
#
# Without a force there is nothing for a regression to start from, but the drive is known, and a run
# takes milliseconds.


LEVELS: Final = tuple(np.geomspace(0.01, 2.0, 16).tolist())
"""Levels over the load that are tried: a third more each, from rolling to rubber."""
SURPLUSES: Final = (1.02, 1.1, 1.2, 1.35, 1.6, 2.0)
"""Levels at rest over those of sliding that are tried."""
SPREAD: Final = tuple(np.geomspace(0.4, 2.5, 38).tolist())
"""Levels over the one to start from that are tried where there are stops: a twentieth more each."""
SHARES: Final = (0.1, 0.2, 0.35, 0.6, 1.0)
"""Shares of a segment that are taken in one after the other there."""
KEPT, STEPS = 8, 15
"""Starts of least residual that are followed downhill, and for how many steps: of 30 bristle laws
three and five leave five in another valley, eight and fifteen one; eight and eight one of ten."""
PRESLIDING: Final = 1e-3
"""Length over which bristles give way, over the stroke."""


def scanned(mechanism: Mechanism, measurement: Measurement, quantity: str) -> StartEstimate:
    """Return the sizes of friction that simulated runs with Coulomb friction suggest.

    Examples
    --------
    >>> from stickslip import Capsule, simulate
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    >>> run = simulate(capsule, Coulomb(kinetic_coefficient=0.2), t_end=0.5).sampled(100)
    >>> record = Measurement(time=run.t, position=run["x"])
    >>> 0.14 < scanned(capsule, record, "position").level < 0.28
    True
    """
    load = load_of(mechanism)
    path, bounds = "friction.kinetic_coefficient", fields_of(Coulomb)["kinetic_coefficient"]
    longest = 2.0 * max(float(np.max(np.asarray(record.time))) for record in measurement.records())
    level = FreeParameter(path=path, quantity=bounds, start=LEVELS[0], low=0.0, high=LEVELS[-1])
    problem = Shooting(
        law=Coulomb(kinetic_coefficient=LEVELS[0]),
        free_parameters=FreeParameters((level,), {}),
        segments=segments_of(
            mechanism, measurement, length=longest, resolution=RESOLUTION, quantity=quantity
        ),
        quantity=quantity,
    )
    seen = [problem.linearise(np.array([mu])) for mu in LEVELS]
    best = min(seen, key=lambda item: item.cost)
    runs = problem.runs(best) if np.isfinite(best.cost) else ()
    if not runs:
        raise ConvergenceError(
            f"no simulation of the {type(mechanism).__name__} reaches the end of the record with"
            f" Coulomb friction of {number(LEVELS[0])} to {number(LEVELS[-1])} times the load:"
            " check masses, lengths and the drive (in SI), and whether the body lifts off or tips"
            " over."
        )
    slip = mechanism.coordinates.index(slip_of(mechanism))
    place, rate = mechanism.coordinates[slip], mechanism.rates[slip]
    sampled = [run.sampled(10 * RESOLUTION) for run in runs]
    v = np.concatenate([item[rate] for item in sampled])
    moving = v[np.abs(v) > 0.0]
    ahead = float(np.mean(moving > 0.0)) if moving.size else 1.0
    result = float(best.values[0])
    stroke = max(*(float(np.ptp(item[place])) for item in sampled), 1e-12)
    return StartEstimate(
        load=load,
        level=result,
        viscous=0.0,
        offset=0.0,
        force=result * load,
        speed=max(float(np.percentile(np.abs(v), 98.0)), 1e-12),
        stiffness=result / (PRESLIDING * stroke),
        two_sided=LITTLE < ahead < 1.0 - LITTLE,
    )


def least_of(problem: Shooting, tried: Sequence[Array]) -> Array:
    """Return which of several start values (p,) leads to the least, a few steps downhill."""
    if len(tried) == 1:
        return tried[0]
    seen = [problem.linearise(values) for values in tried]
    best = sorted(seen, key=lambda item: item.cost)[:KEPT]
    ends = [_end(problem, item, rounds=STEPS) for item in best]
    return min(ends, key=lambda end: end.cost).values


def surplus_starts(free: FreeParameters) -> list[Array]:
    """Return starts (p,) with several levels at rest.

    Such a level decides at each rest whether the body breaks away or not, so that residuals jump
    with it, and no slope leads from one side to the other.
    """
    above = [item.path for item in free.items if item.above]
    if not above:
        return []
    rest = free.paths.index(above[0])
    level = free.paths.index(free.items[rest].above)
    result = []
    for surplus in SURPLUSES:
        values = free.start.copy()
        values[rest] = surplus * values[level]
        result.append(values)
    return result


def lengthened_starts(problem: Shooting) -> tuple[Shooting, list[Array]]:
    """Return a problem with better initial states, and a start (p,), from its first part on.

    After some impacts a run depends so much on friction and on its initial state that the sum of
    squares has a valley for each sequence of impacts, and the way down leads into the nearest.
    Before them it has few: levels are tried one by one there, and the best end is followed while
    ever more of the record is taken in.
    """
    free = problem.free_parameters
    levels = [item.quantity.scale == "level" for item in free.items]
    if not any(levels):
        return problem, []
    part = problem.shortened(SHARES[0])
    tried = [
        part.linearise(free.values(free.coordinates(np.where(levels, factor, 1.0) * free.start)))
        for factor in SPREAD
    ]
    end = min(tried, key=lambda item: item.cost)
    for share in SHARES:
        end = _end(problem.shortened(share), end)
    if not np.isfinite(end.cost):
        return problem, []
    return problem.starting_from(end), [end.values]


def _end(problem: Shooting, near: ResidualJacobian, rounds: int = ROUNDS) -> ResidualJacobian:
    """Return where a descent on more of a record ends that begins where one on less has ended."""
    here = problem.linearise(near.values, near)
    try:
        return improve(problem, near.values, near=here, rounds=rounds)[0]
    except ConvergenceError:
        return here
