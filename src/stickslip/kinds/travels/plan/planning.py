"""The verb `plan`: which travels to measure for a law, how often and how well.

All numbers come from runs. Each law has the level with which the body travels equally far at the
present setting; rivals are fitted to the travels of the law that is taken to hold; intervals follow
from the slopes of the travels there.
"""

import contextlib
import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError, InputError, StickslipError
from stickslip.experiments import Measurement
from stickslip.formatting import joined, number, percent, quantity
from stickslip.friction import LAWS, Coulomb, FrictionLaw, law_type
from stickslip.identification import (
    LEAST_ERROR,
    READINGS,
    Laws,
    TravelModel,
    Trial,
    check_given,
    driven_on,
    laws_of,
    required_of,
    standard_errors,
    starting_law,
    trials_of,
    uncertainties_of,
)
from stickslip.identify import covariance_of, doubling_slope
from stickslip.kinds.travels.fit import fit_trials, payable
from stickslip.kinds.travels.plan.preparing import how_to, otherwise
from stickslip.kinds.travels.plan.sheet import Expectation, Plan, Preparation, Telling
from stickslip.kinds.travels.result import TravelFit
from stickslip.kinds.travels.search import expected_fit
from stickslip.kinds.travels.settings import (
    Separation,
    knob_of,
    predictions,
    rounded_setting,
    unit_of,
    words_of,
)
from stickslip.mechanisms import Mechanism, slip_of, stops_of
from stickslip.quantities import Quantity, fields_of, parameters, vary
from stickslip.selection import check_any
from stickslip.simulation import simulate

Array: TypeAlias = NDArray[np.float64]

USUAL = ("coulomb", "viscous", "coulomb-viscous", "stribeck")
"""Laws that travels of a block may tell apart."""
RANGE = (0.4, 1.0)
"""Settings planned, over the present one, where no range is given and no trial has another."""
NARROW = 0.9
"""Least setting of trials over the largest, above which they are one setting."""
COUNT = Quantity("settings", low=2, high=12)
READING = Quantity("u_s", "m", above=0)
SCATTER = 0.02
"""Standard deviation of a travel over the longest one where nothing was stated: repeats of dry
friction scatter by a few per cent."""
FREEDOM = 2
"""Readings beyond the first at their setting from which on their scatter is counted on."""
ROUGH = 0.01
"""Share to which a parameter of a rig is known without much ado: of what is needed better, the cost
of this is said."""
LEAST, MOST = 3, 10
"""Runs at each setting: fewer do not show their scatter, more are not asked for."""
TELLING = 3.523
"""Standard deviations that tell two laws apart: 2.241 for the test of `select` (97.5 % quantile of
chi-square with one degree of freedom), 1.282 more for nine of ten such sets to pass it."""
HALF = 0.5
"""Part of a parameter of the rig in the level's uncertainty, over that of the readings: three as
large widen the interval by a third."""
TINY = 1e-6
"""Share of a parameter that stands for its uncertainty where only the slope is asked for."""
VISCOUS = 0.25
"""Viscous part over the level at the largest speed, where nobody gave a value: a fifth of both. A
law without a level has a viscous part that is as large as the usual level there."""
NEAR = 0.9
"""A second point, over the first, where the search of a rival's parameters begins."""
NEAR_STOP = 1e-9
"""Distance from a hard stop at which the body is at it [m]."""
MOVES = 0.05
"""Share of the longest travel below which a setting is not worth a run."""

ADVICE = {
    "static_coefficient": (
        "Pull slowly until the block moves: the force at break-away is $mu_s$ times the load."
    ),
    "bristle_stiffness": (
        "Record a presliding loop: apply an alternating force below break-away; the slope of force"
        " against displacement gives $sigma_0$."
    ),
    "bristle_damping": "Record presliding loops at two rates, which give $sigma_1$.",
    "stribeck_velocity": (
        "Record the velocity over the last centimetre (240 frames per second or more): the rise of"
        " friction before the stop gives $v_s$."
    ),
    "viscous_coefficient": "Record the velocity of one run: its curvature gives $sigma_2$.",
    "viscous_exponent": (
        "Record the velocity of one run: how its decay changes with the speed gives $p$."
    ),
}
"""Which measurement pays for a parameter that a travel does not fix, the most telling first."""


def plan(
    mechanism: Mechanism,
    laws: Laws | FrictionLaw | type[FrictionLaw] | str | None = None,
    measurement: Measurement | None = None,
    *,
    parameter_uncertainties: Mapping[str, float] | None = None,
    between: tuple[float, float] | None = None,
    settings: int = 4,
    uncertainty: float | None = None,
    t_end: float = 10.0,
) -> Plan:
    """Plan travels that tell friction laws apart and fix their parameters.

    Parameters
    ----------
    mechanism : Mechanism
        What a compressed spring or a push sets in motion and friction stops, as it stands.
    laws : mapping, sequence or a single law, optional
        The candidates, as instances, types or names; of an instance the values are taken for
        plausible, but for its level. Coulomb, viscous, both together and Stribeck if not given.
    measurement : Measurement, optional
        Travels that were measured before: levels are fitted to them, and their uncertainty is
        counted on. Without it all laws travel as far as the first one at the present setting.
    parameter_uncertainties : mapping of str to float, optional
        Standard uncertainties of the mechanism's parameters, by path or last name; those of the
        measurement if not given. Where none is known, that which is needed is counted on.
    between : tuple of float, optional
        Least and largest setting of what is turned, SI. If not given, from the least to the largest
        of the measured trials and the mechanism as it stands; or from two fifths of the present
        setting to itself where no trial has another.
    settings : int
        How many settings, from 2 to 12.
    uncertainty : float, optional
        Standard uncertainty of one travel [m], the scatter of repeats and that of the reading
        together; if not given that of the measurement, the scatter of its repeats if that is
        larger, or else 2 % of the longest travel. It lies
        between 1e-5 of the longest travel, to which runs are exact, and all of it.
    t_end : float
        Time after which a body counts as stopped [s].

    Returns
    -------
    Plan
        Settings, repeats, what to measure before and how well, and what the runs will tell.

    Raises
    ------
    InputError
        If no travel can be planned for the mechanism, or an argument is out of its range.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> sheet = plan(rig, ["coulomb", "viscous"], uncertainty=0.004)
    >>> [one.value for one in sheet.settings], sheet.repeats
    ([0.04, 0.06, 0.08, 0.1], 3)
    >>> {one.path: f"{one.needed:.2g}" for one in sheet.preparations}
    {'mechanism.mass': '0.0045', 'mechanism.stiffness': '0.45', 'mechanism.compression': '0.00054'}
    >>> sheet.csv().splitlines()[:2]
    ['name,mechanism.compression [mm],travel [mm]', 'run 1,40,']
    """
    count = int(COUNT.check("plan", "settings", settings))
    if uncertainty is not None:
        uncertainty = READING.check("plan", "uncertainty", uncertainty)
    done = _done(mechanism, measurement, t_end)
    knob = _knob(mechanism, done)
    ends, source = _range(mechanism, knob, done, between)
    candidates = _candidates(mechanism, laws, t_end)
    error, repeated = _error(uncertainty, done)
    if not done:
        _check_present(mechanism, candidates[_first(candidates)], t_end, error)
    levelled, remarks = _levelled(mechanism, candidates, done, t_end)
    settings_at = _settings(mechanism, knob, ends, count)
    levelled, idle = _stopping(mechanism, knob, settings_at, levelled, t_end, error)
    named = _first(levelled)
    rows, still = _rows(mechanism, knob, settings_at, levelled, named, t_end)
    size = _checked(error, max(abs(row.predicted[named]) for row in rows))
    stated = _stated(mechanism, measurement, parameter_uncertainties)
    bench = _Bench(mechanism=mechanism, rows=rows, error=size, stated=stated, t_end=t_end)
    contrasts = _contrasts(bench.known(levelled[named], LEAST), levelled)
    needed = [one.repeats(size) for one in contrasts]
    repeats = max([LEAST, *(n for n in needed if n is not None)])
    bench = bench.known(levelled[named], repeats)
    share = bench.share(levelled[named], repeats)
    return Plan(
        mechanism=mechanism,
        laws=levelled,
        reference=named,
        settings=rows,
        repeats=repeats,
        uncertainty=size,
        assumed=error is None,
        repeated=repeated,
        preparations=tuple(
            replace(one, rough=_rough(bench, one, levelled, named, contrasts, repeats))
            for one in bench.preparations(levelled[named], repeats)
        ),
        rest=otherwise(mechanism, levelled[named], share),
        tellings=tuple(one.telling(size, repeats) for one in contrasts),
        expectations=tuple(_expected(bench, levelled, repeats)),
        range_source=source,
        from_trials=bool(done),
        remarks=(*remarks, *idle, *still),
    )


@dataclass(frozen=True, kw_only=True)
class _Bench:
    """The rig at the planned settings, and how well it and its readings are known."""

    mechanism: Mechanism
    rows: Sequence[Separation]
    error: float
    stated: Mapping[str, float]
    t_end: float
    doubts: Mapping[str, float] | None = None
    """What is counted on: as stated, or else as needed."""

    def trials(self, repeats: int = 1) -> list[Trial]:
        """Return the planned trials, none measured yet."""
        found = []
        path, doubts = self.rows[0].path, dict(self.doubts or {})
        by_hand = {path: doubts.pop(path)} if path in doubts else {}
        for row in self.rows:
            changed = vary(self.mechanism, "mechanism", {path: row.value})
            one = Trial(
                mechanism=changed, initial={}, travel=0.0, half_width=self.error,
                doubts=by_hand, shared=doubts,
            )  # fmt: skip
            found += [one] * repeats
        return found

    def fit(self, law: FrictionLaw, free: Sequence[str], repeats: int) -> TravelFit:
        """Return the fit to expect of some of a law's parameters."""
        known = {path: value for path, _, value in parameters(law, "friction")}
        values = [known[path] for path in free]
        return expected_fit(TravelModel(law, free, self.t_end), self.trials(repeats), values)

    def share(self, law: FrictionLaw, repeats: int) -> float:
        """Return the standard uncertainty of a law's level over itself."""
        (level,) = self.fit(law, payable(law, self.trials())[:1], repeats).estimates
        return math.hypot(*level.sources.values()) / level.value if level.sources else math.inf

    def width(self, law: FrictionLaw, repeats: int) -> tuple[str, float]:
        """Return the symbol of a law's level, and half its 95 % interval over its value."""
        (level,) = self.fit(law, payable(law, self.trials())[:1], repeats).estimates
        return level.quantity.symbol, 0.5 * (level.high - level.low) / level.value

    def needed(self, law: FrictionLaw, repeats: int) -> dict[str, float]:
        """Return by path how well the rig is to be known for its part in a law's level to be small.

        Gravity and what the travels do not depend on are left out.
        """
        known = {path: value for path, _, value in parameters(self.mechanism, "mechanism")}
        known |= {self.rows[0].path: max(row.value for row in self.rows)}
        units = {p: TINY * abs(v) for p, v in known.items() if v and not p.endswith(".gravity")}
        exact = replace(self, doubts=units)
        (level,) = exact.fit(law, payable(law, self.trials())[:1], repeats).estimates
        found = {}
        for path, unit in units.items():
            part = level.sources.get(path, 0.0)
            if part > TINY * unit / abs(known[path]) * level.value:
                found[path] = HALF * level.sources[READINGS] * unit / part
        return found

    def known(self, law: FrictionLaw, repeats: int) -> "_Bench":
        """Return the rig known as well as stated, or else as needed for a law's level."""
        return replace(self, doubts={**self.needed(law, repeats), **self.stated})

    def preparations(self, law: FrictionLaw, repeats: int) -> tuple[Preparation, ...]:
        """Return what to measure before, and how well."""
        known = {path: (q, v) for path, q, v in parameters(self.mechanism, "mechanism")}
        # how far the spring is compressed at most, whatever is set
        spring = "mechanism.compression"
        moved = [row.value for row in self.rows if row.path == spring]
        largest = max(map(abs, moved or [known[spring][1] if spring in known else 0.0]))
        return tuple(
            Preparation(
                path=path,
                quantity=known[path][0],
                value=known[path][1],
                needed=needed,
                stated=self.stated.get(path),
                how=how_to(self.mechanism, path, needed, largest),
            )
            for path, needed in self.needed(law, repeats).items()
        )


@dataclass(frozen=True, kw_only=True)
class _Contrast:
    """What a rival's fit to the travels of a law leaves, and how the rig spreads it."""

    holds: str
    rival: str
    rows: Sequence[Separation]
    left: Array
    """Differences of the travels (n,) [m]."""
    by_hand: Array
    """Standard errors from what is set anew for each run (n,) [m]."""
    shared: Mapping[str, Array]

    @property
    def longest(self) -> float:
        """The longest travel of the law that holds [m]."""
        return max(abs(row.predicted[self.holds]) for row in self.rows)

    def sigmas(self, error: float, repeats: int) -> float:
        """Return the differences over their uncertainty, with so many runs at each setting."""
        scatter = np.sqrt((error**2 + self.by_hand**2) / repeats)
        weighed = np.linalg.solve(covariance_of(scatter, self.shared), self.left)
        return math.sqrt(float(self.left @ weighed))

    def repeats(self, error: float) -> int | None:
        """Return how many runs at each setting tell the laws apart; None beyond `MOST`."""
        return next((n for n in range(1, MOST + 1) if self.sigmas(error, n) >= TELLING), None)

    def uncertainty(self, repeats: int) -> float:
        """Return the uncertainty of a reading at which so many runs do [m]; 0 if none is."""
        low, high = 1e-9, float(np.abs(self.left).max()) * math.sqrt(len(self.left) * repeats)
        if high <= low or self.sigmas(low, repeats) < TELLING:
            return 0.0
        for _ in range(60):
            middle = math.sqrt(low * high)
            low, high = (middle, high) if self.sigmas(middle, repeats) >= TELLING else (low, middle)
        return low

    def telling(self, error: float, repeats: int) -> Telling:
        """Return it as it stands in a plan."""
        worst = int(np.argmax(np.abs(self.left)))
        return Telling(
            holds=self.holds,
            rival=self.rival,
            gap=float(np.abs(self.left[worst])),
            setting=self.rows[worst],
            repeats=self.repeats(error),
            most=MOST,
            uncertainty=self.uncertainty(repeats),
            alike=float(np.abs(self.left[worst])) <= LEAST_ERROR * self.longest,
        )


def setting_of(mechanism: Mechanism, measurement: Measurement | None, t_end: float) -> str:
    """Return the path of what `plan` sets to get other travels.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> setting_of(SpringBlock(mass=1.0, stiffness=100.0, compression=0.1), None, 10.0)
    'mechanism.compression'
    """
    return _knob(mechanism, _done(mechanism, measurement, t_end))


def _done(mechanism: Mechanism, measurement: Measurement | None, t_end: float) -> tuple[Trial, ...]:
    """Return the trials of what was measured before."""
    if measurement is None:
        measurement = Measurement(travel=0.0)  # to check the mechanism alone
        check_given("plan", mechanism, measurement)
        return ()
    check_given("plan", mechanism, measurement)
    return trials_of(mechanism, measurement, t_end)


def _knob(mechanism: Mechanism, done: Sequence[Trial]) -> str:
    """Return the path of what is set to get other travels."""
    if driven_on(mechanism):
        raise InputError(
            f"{type(mechanism).__name__} does not come to rest because its drive never ends, so"
            " there is no travel to plan. Measure its position in time or its travel per cycle and"
            " give that to select, which proposes the next measurement (see"
            " docs/howto/fit-cart.md)."
        )
    knob = knob_of(mechanism, done)
    contacts = mechanism.contacts()
    if knob is None or len(contacts) != 1:
        raise InputError(
            "plan needs a body that a compressed spring or a push sets in motion (compression,"
            " drive.level or drive.amplitude other than 0) and that friction stops; this"
            f" {type(mechanism).__name__} is not one. For records in time, make a first record:"
            " check says what it can tell, and select proposes the next one."
        )
    return knob[0]


def _candidates(
    mechanism: Mechanism, given: Laws | FrictionLaw | type[FrictionLaw] | str | None, t_end: float
) -> dict[str, FrictionLaw]:
    """Return the laws by name with plausible values."""
    laws = laws_of(given)
    if isinstance(laws, Mapping):
        found = dict(laws)
        if found:
            return found
        laws = None
    chosen = [LAWS[name] for name in USUAL] if laws is None else list(laws)
    found = {}
    for one in chosen:
        kind = law_type(one) if isinstance(one, str) else one
        law = _ordinary(mechanism, kind, t_end) if isinstance(kind, type) else kind
        found[law.name] = law
    check_any(found)
    return found


def _ordinary(mechanism: Mechanism, kind: type[FrictionLaw], t_end: float) -> FrictionLaw:
    """Return a law with ordinary values; its viscous part is what it would be on this rig."""
    law = starting_law(kind)
    slopes = [name for name in required_of(kind) if fields_of(kind)[name].scale == "slope"]
    if not slopes:
        return law
    beside = law if _has_level(law) else starting_law(Coulomb)
    path, level = _levels(beside)[0]
    one = _trial(mechanism)
    slope = doubling_slope(TravelModel(beside, [path], t_end), [one], [level])
    share = VISCOUS if beside is law else 1.0
    return vary(law, "friction", {f"friction.{slopes[0]}": share * slope})


def _first(laws: Mapping[str, FrictionLaw]) -> str:
    """Return the name of the first law with a level, or of the first one."""
    return next((name for name, law in laws.items() if _has_level(law)), next(iter(laws)))


def _has_level(law: FrictionLaw) -> bool:
    return bool(_levels(law))


def _levels(law: FrictionLaw) -> list[tuple[str, float]]:
    """Return paths and values of the levels of sliding."""
    return [
        (path, value)
        for path, quantity, value in parameters(law, "friction")
        if quantity.scale == "level" and quantity.at_least is None
    ]


def _levelled(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw],
    done: Sequence[Trial],
    t_end: float,
) -> tuple[dict[str, FrictionLaw], list[str]]:
    """Return laws with the level that travels measured before call for, or else the first law's.

    The sentences say which laws have none.
    """
    trials = list(done)
    found, remarks = {}, []
    for name, law in sorted(laws.items(), key=lambda item: not _has_level(item[1])):
        if not trials:
            one = _trial(mechanism)
            trials = [replace(one, travel=TravelModel(law, (), t_end).travel(one, ()))]
            if trials[0].travel == 0.0:
                raise InputError(
                    f"{law.title} friction{_values_of(law)} holds the body at rest: lower the"
                    " friction level, or raise the setting of the rig."
                )
        try:
            found[name] = fit_trials(law, trials, free=payable(law, trials)[:1], t_end=t_end).law
        except (ConvergenceError, InputError) as error:
            remarks.append(f"{law.title} friction was left out: {error}")
    _check_planned(found, remarks)
    return {name: found[name] for name in laws if name in found}, remarks


def _check_planned(laws: Mapping[str, FrictionLaw], remarks: Sequence[str]) -> None:
    """Refuse to plan for no law, with why each was left out."""
    if not laws:
        raise InputError(f"no law can be planned for. {' '.join(remarks)}")


def _why_none(mechanism: Mechanism, law: FrictionLaw, t_end: float, error: float) -> str:
    """Return why the distance of a run is no travel that friction ends; nothing if it is one.

    Bodies that still move by less than the error of a reading, as on undamped bristles, are at
    rest.
    """
    try:
        TravelModel(law, (), t_end).check_rest([_trial(mechanism)], (), [error])
    except ConvergenceError as reason:
        return str(reason)
    run = simulate(mechanism, law, t_end=t_end)
    slip = slip_of(mechanism)
    for stop in stops_of(mechanism):
        beyond = run[slip] - stop.position
        if stop.coordinate == slip and bool(
            np.any((beyond if stop.side == "upper" else -beyond) > -NEAR_STOP)
        ):
            at = quantity(float(stop.position), mechanism.units[0])
            return f"the body hits the stop at {at}. Lower the setting of the rig."
    return ""


def _travel(mechanism: Mechanism, law: FrictionLaw, t_end: float) -> float:
    """Return how far the body is at the end from where it began [m]."""
    return abs(TravelModel(law, (), t_end).travel(_trial(mechanism), ()))


def _trial(mechanism: Mechanism) -> Trial:
    """Return a run that is not yet measured."""
    return Trial(mechanism=mechanism, initial={}, travel=0.0, half_width=0.0)


def _check_present(
    mechanism: Mechanism, law: FrictionLaw, t_end: float, error: float | None
) -> None:
    """Refuse a rig that makes no travel as it stands, where the laws are to make the same one."""
    size = SCATTER * _travel(mechanism, law, t_end) if error is None else error
    if said := _why_none(mechanism, law, t_end, size):
        raise InputError(
            f"there is no travel to plan with {law.title} friction{_values_of(law)}: {said}"
        )


def _values_of(law: FrictionLaw) -> str:
    """Return the values of a law, as they stand behind its name."""
    parts = [
        f"{q.symbol} = {quantity(value, q.unit)}" for _, q, value in parameters(law, "friction")
    ]
    return f" ({', '.join(parts)})" if parts else ""


def _range(
    mechanism: Mechanism,
    path: str,
    done: Sequence[Trial],
    between: tuple[float, float] | None,
) -> tuple[tuple[float, float], str]:
    """Return the ends of the settings, the smaller one first, and a sentence on where from."""
    known = {p: (q, value) for p, q, value in parameters(mechanism, "mechanism")}
    asked, present = known[path]
    unit, factor = unit_of(asked.unit)
    word = words_of(path)
    if between is not None:
        low, high = (asked.check("plan", "between", value) for value in between)
        if not 0.0 < low < high:
            raise InputError(
                f"between must be two settings of {path} ({asked.symbol}) above 0 {asked.unit},"
                f" the smaller one first, got {number(low)} and {number(high)}."
            )
        return between, ""
    sign = math.copysign(1.0, present)
    made = [
        {p: value for p, _, value in parameters(trial.mechanism, "mechanism")}[path]
        for trial in done
    ]
    sizes = sorted({abs(value) for value in (*made, present) if sign * value > 0.0})
    if sizes[0] <= NARROW * sizes[-1]:
        low, high = sizes[0], sizes[-1]
        source = f"The settings span the {word} of the trials and of the rig"
    else:
        low, high = RANGE[0] * sizes[-1], RANGE[1] * sizes[-1]
        source = (
            f"{'The trials and the rig have' if done else 'The rig has'} one {word}: the settings"
            f" span {number(RANGE[0])} to {number(RANGE[1])} times that value"
        )
    low, high = (min(max(sign * one, asked.low), asked.high) for one in (low, high))
    shown = f"{number(factor * low)} to {number(factor * high)} {unit}".replace(" °", "°")
    return (low, high), f"{source}, {shown}. Use --between (Python: between) for another range."


def _settings(
    mechanism: Mechanism, path: str, ends: tuple[float, float], count: int
) -> list[float]:
    """Return equidistant settings, to three digits of the unit in which they are read."""
    unit = {p: q.unit for p, q, _ in parameters(mechanism, "mechanism")}[path]
    return [rounded_setting(one, unit) for one in np.linspace(*ends, count)]


def _stopping(
    mechanism: Mechanism,
    path: str,
    settings: Sequence[float],
    laws: Mapping[str, FrictionLaw],
    t_end: float,
    error: float | None,
) -> tuple[dict[str, FrictionLaw], list[str]]:
    """Return the laws whose friction ends the travel at all settings, and why others do not.

    The distance of a body that still moves is that of an arbitrary time, and a hard stop ends the
    travels of all laws in one place.
    """
    found, remarks = {}, []
    unit = {p: q.unit for p, q, _ in parameters(mechanism, "mechanism")}[path]
    rigs = [vary(mechanism, "mechanism", {path: value}) for value in settings]
    for name, law in laws.items():
        size = error
        if size is None:
            size = SCATTER * max(_travel(rig, law, t_end) for rig in rigs)
        reasons = {
            value: said
            for value, rig in zip(settings, rigs, strict=True)
            if (said := _why_none(rig, law, t_end, size))
        }
        if not reasons:
            found[name] = law
            continue
        value, said = reasons.popitem()
        at = quantity(value, unit, degrees=True)
        remarks.append(f"{law.title} friction was left out: with {words_of(path)} {at}, {said}")
    _check_planned(found, remarks)
    return found, remarks


def _rows(
    mechanism: Mechanism,
    path: str,
    settings: Sequence[float],
    laws: Mapping[str, FrictionLaw],
    named: str,
    t_end: float,
) -> tuple[tuple[Separation, ...], list[str]]:
    """Return settings at which the body moves, and which were left out, as sentences."""
    rows = predictions(mechanism, laws, path, settings, t_end=t_end)
    least = MOVES * max((abs(row.predicted[named]) for row in rows), default=0.0)
    kept = tuple(row for row in rows if abs(row.predicted[named]) > least)
    if len(kept) < 2:
        word, unit = words_of(path), rows[0].unit if rows else ""
        ends = " to ".join(quantity(one, unit, degrees=True) for one in (settings[0], settings[-1]))
        raise InputError(
            f"the body moves at {len(kept)} of {len(settings)} settings of the {word} from {ends}:"
            " raise the setting of the rig, or give a higher range with --between (Python:"
            " between)."
        )
    idle = [row.text for row in rows if row not in kept]
    said = (
        [(f"At {joined(idle)} the body hardly moves, so no runs are planned there.")]
        if idle
        else []
    )
    return kept, said


def _checked(error: float | None, longest: float) -> float:
    """Return the standard uncertainty of a reading that is counted on [m]."""
    size = SCATTER * longest if error is None else error
    if not LEAST_ERROR * longest <= size <= longest:
        least, most, got = (quantity(one, "m") for one in (LEAST_ERROR * longest, longest, size))
        raise InputError(
            f"the uncertainty of a travel (u_s) must be from {least} (the accuracy of the"
            f" simulation) to {most} (the longest planned travel), got {got}: give it with"
            " --uncertainty (Python: uncertainty)."
        )
    return size


def _error(given: float | None, done: Sequence[Trial]) -> tuple[float | None, int]:
    """Return the standard uncertainty of a reading [m], None if nothing tells it.

    It is as given, or the larger of what was stated and the scatter of repeats; with how many
    readings beyond the first at their setting that scatter is from, 0 where it is not counted on.
    """
    if given is not None or not done:
        return given, 0
    errors, stated = standard_errors(done)
    settings: dict[Hashable, list[float]] = {}
    for trial in done:
        settings.setdefault(trial.run, []).append(trial.travel)
    squares = sum(float(np.var(one)) * len(one) for one in settings.values())
    freedom = len(done) - len(settings)
    scatter = math.sqrt(squares / freedom) if freedom >= FREEDOM else 0.0
    if scatter > float(errors.max()):
        return scatter, freedom
    return (float(errors.max()) if stated else None), 0


def _rough(
    bench: _Bench,
    one: Preparation,
    laws: Mapping[str, FrictionLaw],
    named: str,
    contrasts: Sequence[_Contrast],
    repeats: int,
) -> str:
    """Return what it costs to know a parameter of the rig to 1 % only; nothing if more will do."""
    size = max([abs(row.value) for row in bench.rows if row.path == one.path] or [abs(one.value)])
    if one.needed >= ROUGH * size:
        return ""
    worse = replace(bench, doubts={**(bench.doubts or {}), one.path: ROUGH * size})
    symbol, wanted = bench.width(laws[named], repeats)
    _, got = worse.width(laws[named], repeats)
    said = f"If it is known only to 1 %, the 95 % interval of ${symbol}$ "
    if percent(got) == percent(wanted):  # as it is stated to 1 %, say
        said += f"stays at ± {percent(got)} of the value"
    else:
        said += f"is ± {percent(got)} of the value instead of ± {percent(wanted)}"
    told = [pair for pair in contrasts if pair.sigmas(bench.error, repeats) >= TELLING]
    lost = [
        f"{laws[pair.holds].title} from {laws[pair.rival].title}"
        for pair in told
        if _contrast(worse, pair.holds, pair.rival, laws).sigmas(bench.error, repeats) < TELLING
    ]
    if lost:
        return f"{said}, and the runs no longer distinguish {joined(lost)}."
    return f"{said}; the runs distinguish the same laws." if told else f"{said}."


def _stated(
    mechanism: Mechanism, measurement: Measurement | None, doubts: Mapping[str, float] | None
) -> dict[str, float]:
    """Return stated uncertainties of the mechanism by full path."""
    given = (
        doubts if doubts is not None else measurement.parameter_uncertainties if measurement else {}
    )
    ((own, _),) = uncertainties_of(
        mechanism, Measurement(travel=0.0, parameter_uncertainties=given)
    )
    return own


def _contrasts(bench: _Bench, laws: Mapping[str, FrictionLaw]) -> list[_Contrast]:
    """Return for each pair of laws what it takes to rule one out, the easiest first.

    The law with more parameters is taken to hold: the other one cannot imitate it. Of two with as
    many, whichever is harder to rule out.
    """
    sizes = {name: len(required_of(type(law))) for name, law in laws.items()}
    found: dict[frozenset[str], _Contrast] = {}
    for holds, rival in permutations(laws, 2):
        if sizes[rival] > sizes[holds]:
            continue
        one = _contrast(bench, holds, rival, laws)
        known = found.get(frozenset((holds, rival)))
        if known is None or one.sigmas(bench.error, 1) < known.sigmas(bench.error, 1):
            found[frozenset((holds, rival))] = one
    return sorted(found.values(), key=lambda one: -one.sigmas(bench.error, 1))


def _contrast(bench: _Bench, holds: str, rival: str, laws: Mapping[str, FrictionLaw]) -> _Contrast:
    """Return what a rival's fit to the travels of a law leaves."""
    pairs = zip(bench.trials(), bench.rows, strict=True)
    trials = [replace(trial, travel=row.predicted[holds]) for trial, row in pairs]
    free = payable(laws[rival], trials)
    values = {path: value for path, _, value in parameters(laws[rival], "friction")}
    near = [[factor * values[path] for path in free] for factor in (1.0, NEAR)]
    fit = fit_trials(laws[rival], trials, free=free, starts=near, t_end=bench.t_end)
    return _Contrast(
        holds=holds,
        rival=rival,
        rows=bench.rows,
        left=np.array(fit.residuals),
        by_hand=np.sqrt(np.maximum(np.square(fit.standard_errors) - bench.error**2, 0.0)),
        shared={path: np.array(part) for path, part in fit.shared.items()},
    )


def _expected(bench: _Bench, laws: Mapping[str, FrictionLaw], repeats: int) -> list[Expectation]:
    """Return the intervals to expect: of what `select` fits, and of each other parameter beside."""
    found = []
    for name, law in laws.items():
        fitted = payable(law, bench.trials())
        estimates = [*bench.fit(law, fitted, repeats).estimates]
        for path, _, _ in parameters(law, "friction"):
            if path not in fitted:
                with contextlib.suppress(StickslipError):
                    estimates.append(bench.fit(law, [*fitted, path], repeats).estimate(path))
        for one in estimates:
            # off its limit, as `select` asks it to be
            settled = one.bounded and one.low > limit_of(law, one.path.rpartition(".")[2])
            found.append(
                Expectation(
                    law=name,
                    estimate=one,
                    fitted=one.path in fitted,
                    identified=settled,
                    advice="" if settled else ADVICE.get(one.path.rpartition(".")[2], ""),
                )
            )
    return found


def limit_of(law: FrictionLaw, name: str) -> float:
    """Return the lowest value that a parameter of a law may have beside the others.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.3)
    >>> limit_of(law, "kinetic_coefficient"), limit_of(law, "static_coefficient")
    (0.0, 0.2)
    """
    quantity = fields_of(type(law))[name]
    limits = [quantity.low, quantity.above or 0.0]
    if quantity.at_least is not None:
        limits.append(getattr(law, quantity.at_least))
    return float(max(limits))
