r"""The verb `plan`: which travels to measure, how often and how well, or what else to measure.

1. *Now*: the judge of `select` takes the travels that were measured, or one that the first law
   makes as the rig stands, and draws laws; the quantiles of their travels over the settings are the
   band over all candidate laws.
2. *Law by law*, as readings are advised (`stickslip.identify.propose`): draws of a law, its level
   and the rig have a covariance :math:`K` of parameters and travels at the settings. `n` readings
   of each with errors :math:`S` leave :math:`K - K_t (K_{tt} + S/n)^{-1} K_t^T`: intervals and
   the band that the runs will give. Of typical travels of another law, :math:`d` off, it leaves
   :math:`S/n (K_{tt} + S/n)^{-1} d`: their scores and the volumes :math:`|K_{tt} + S/n|` of both
   are the evidence by which it is ruled out.
3. *The rig*: a parameter moves travels, and with them the level, in proportion to its uncertainty.
"""

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
from scipy.special import ndtri

from stickslip.data import Measurement
from stickslip.engine.simulation import simulate
from stickslip.errors import ConvergenceError, InputError
from stickslip.friction import Coulomb, FrictionLaw
from stickslip.identify import (
    INSENSITIVE,
    THRESHOLDS,
    TravelJudgement,
    band_of,
    judged_travels,
    knob_of,
    propagated,
)
from stickslip.identify.bands import Array
from stickslip.identify.candidates import plain
from stickslip.identify.fits import (
    LEAST_ERROR,
    READINGS,
    Estimate,
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
from stickslip.identify.judgement import RIVAL
from stickslip.identify.kinds.plan_sheet import (
    NUMBER,
    FurtherPlan,
    Plan,
    Preparation,
    Separation,
    further_plan,
    setting_text,
    values_text,
)
from stickslip.identify.kinds.travels import (
    ALONE,
    JudgedTravels,
    TravelKind,
    rounded_setting,
    started,
    unit_of,
    words_of,
)
from stickslip.identify.kinds.verbs import RouteName, select
from stickslip.identify.problems.travel_laws import STEPS, room_for
from stickslip.identify.problems.travels import OFFSET, block_scores
from stickslip.identify.propose import within_band
from stickslip.mechanisms import Mechanism, slip_of, stops_of
from stickslip.quantities import Quantity, all_paths, parameters, vary
from stickslip.show.formatting import joined, number, quantity


def _values(mechanism: Mechanism) -> dict[str, float]:
    return {path: value for path, _, value in parameters(mechanism, "mechanism")}


USUAL = ("coulomb", "viscous", "coulomb-viscous", "stribeck")
"""Laws that travels of a block may tell apart."""
COUNT = Quantity("settings", low=2, high=12)
READING = Quantity("u_s", "m", above=0)
SCATTER = 0.02
"""Standard deviation of a travel over the longest one where nothing was stated: repeats of dry
friction scatter by a few per cent."""
MOVED = 1e-3
"""Share by which a level is moved for the slope of its travels."""
LEAST = THRESHOLDS.fewest
"""Runs at each setting: fewer do not show their scatter ..."""
MOST = 10
"""... and more are not asked for."""
SURE = 3.0
"""Evidence of readings without errors over that which excludes a law, with which it is excluded in
nine of ten sets with errors: these leave a third to a half of it (it was in 42 of 42 sets)."""
HALF = 0.5
"""Part of a parameter of the rig in the level's uncertainty, over that of the readings: three as
large widen the interval by a third."""

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
    settings: int | None = None,
    uncertainty: float | None = None,
    t_end: float = 10.0,
    readings: int | None = None,
    vary: str | Sequence[str] | None = None,
    route: RouteName | None = None,
) -> Plan | FurtherPlan:
    """Plan what to measure: travels before any is, or what narrows most what a verdict leaves open.

    Of what was measured, other than travels to rest, it is what `select` proposes to measure next:
    of tables readings at velocities, loads and inputs with the width to which they may bring the
    band, else a further record, motion or setting. The rest is of travels, which are to tell
    friction laws apart and fix their parameters.

    The band of the travel over the settings and all laws is that of `select`: where it is
    widest, a reading narrows it most. What the runs will tell is what `select` makes of the travels
    that each law predicts.

    Parameters
    ----------
    mechanism : Mechanism
        What a compressed spring or a push sets in motion and friction stops, as it stands.
    laws : mapping, sequence or a single law, optional
        The candidates, as instances, types or names; of an instance the values are taken for
        plausible, but for its level; of others, what travels leave plausible. Coulomb, viscous,
        both together and Stribeck if not given.
    measurement : Measurement, optional
        Travels that were measured before: laws are fitted to them, and their uncertainty is
        counted on. Without it all laws travel as far as the first one at the present setting.
    parameter_uncertainties : mapping of str to float, optional
        Standard uncertainties of the mechanism's parameters, by path or last name; those of the
        measurement if not given. Where none is known, that which is needed is counted on.
    between : tuple of float, optional
        Least and largest setting of what is turned, SI. If not given, from the least to the largest
        of the measured trials and the mechanism as it stands; or from two fifths of the present
        setting to itself where no trial has another.
    settings : int, optional
        How many settings, from 2 to 12; 4 if not given, or as few as there are readings.
    uncertainty : float, optional
        Standard uncertainty of one travel [m], the scatter of repeats and that of the reading
        together; if not given that of the measurement, the scatter of its repeats if that is
        larger, or else 2 % of the longest travel. It lies
        between 1e-5 of the longest travel, to which runs are exact, and all of it.
    t_end : float
        Time after which a body counts as stopped [s].
    readings : int, optional
        Readings of a table, or runs to rest at most, from 1 to 300; if not given, no more than a
        table has.
    vary : str or sequence of str, optional
        Parameters to fit, as `select` takes them, of records.
    route : str, optional
        How the measurement is judged, as `select` takes it; not of travels.

    Returns
    -------
    Plan or FurtherPlan
        Settings, repeats, what to measure before and how well, and what the runs will tell; or
        readings to make, and what is expected of them.

    Raises
    ------
    InputError
        If no travel can be planned for the mechanism, the measurement cannot be judged, or an
        argument is out of its range or has no effect on a plan for such a measurement.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> from stickslip.identify import FurtherPlan, Plan
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> sheet = plan(rig, ["coulomb", "viscous"], uncertainty=0.004)
    >>> assert isinstance(sheet, Plan)  # which type checkers do not know
    >>> [one.value for one in sheet.settings], sheet.repeats
    ([0.04, 0.06, 0.08, 0.1], 3)
    >>> {one.path: f"{one.needed:.2g}" for one in sheet.preparations}
    {'mechanism.mass': '0.0045', 'mechanism.stiffness': '0.45', 'mechanism.compression': '0.00054'}
    >>> sheet.csv().splitlines()[:2]
    ['name,mechanism.compression [mm],travel [mm]', 'run 1,40,']

    Readings beside a table of friction:

    >>> import numpy as np
    >>> from stickslip import Axis, Measurement
    >>> v = np.linspace(0.1, 1.0, 10)
    >>> noise = 0.05 * np.random.default_rng(1).normal(size=10)
    >>> further = plan(Axis(inertia=1.0), None, Measurement(velocity=v, friction=2.0 + v + noise))
    >>> assert isinstance(further, FurtherPlan)
    >>> len(further.readings["velocity"])
    10
    """
    if readings is not None:
        readings = int(NUMBER.check("plan", "readings", readings))
    further = measurement is not None and is_further(mechanism, measurement)
    of_travels = {"between": between, "settings": settings, "uncertainty": uncertainty,
                  "parameter_uncertainties": parameter_uncertainties}  # fmt: skip
    refuse_ignored(of_travels | {"vary": vary, "route": route}, further=further)
    if further and measurement is not None:
        return further_plan(select(mechanism, laws, measurement, vary=vary, route=route), readings)
    if settings is None:
        settings = min(4, max(readings or 4, 2))
    count = int(COUNT.check("plan", "settings", settings))
    if readings is not None and readings < count:
        raise InputError(f"readings must be at least {count}, one at each setting, got {readings}.")
    if uncertainty is not None:
        uncertainty = READING.check("plan", "uncertainty", uncertainty)
    done = _done(mechanism, measurement, t_end)
    knob = _knob(mechanism, done)
    ends, source = _range(mechanism, knob, done, between)
    asked = laws_of(laws)
    if asked is None or asked == {}:  # a rig file without friction values has an empty mapping
        asked = list(USUAL)
    chosen, ordinary = started(TravelKind().laws(asked))
    error, repeated = _error(uncertainty, done)
    first = _first(chosen)
    start = chosen[first]
    if first in ordinary and not _has_level(start):  # its slope is of the size of the rig
        start = starting_law(Coulomb)
    trials = done or (_assumed(mechanism, start, t_end, error),)
    now = judged_travels(mechanism, trials, chosen, ordinary=ordinary, t_end=t_end)
    remarks = [f"{law.title} friction was left out: {why}" for law, why in now.dropped.values()]
    turned = all_paths(mechanism, "mechanism")[knob]
    places = np.array([rounded_setting(x, turned.unit) for x in np.linspace(*ends, count)])
    typical = {name: _typical(now, name, places) for name in chosen if name in now.evidence}
    kept, idle = _stopping(mechanism, knob, places.tolist(), typical, t_end, error)
    named = _first(kept)
    places, still = _moving(now, kept[named], places)
    travels = {name: _travels(law, now.at(places), t_end) for name, law in kept.items()}
    size = _checked(error, float(np.max(np.abs(travels[named]))))
    bench = _Bench(
        now=now, typical=kept, named=named, places=places, travels=travels, error=size,
        stated=_stated(mechanism, measurement, parameter_uncertainties), has_level=bool(done),
    )  # fmt: skip
    tellings = bench.tellings()
    repeats = max(LEAST, *(many or 0 for many in tellings.values()), 0)
    repeats = min(repeats, (readings or MOST * count) // len(places))
    band = band_of(now.travels(places))
    expectations = {name: bench.estimates(name, repeats) for name in kept}
    expected = np.max([bench.half_widths(x, repeats)[-len(places) :] for x in kept], axis=0)
    rows = tuple(
        Separation(
            path=knob, symbol=turned.symbol, unit=turned.unit, value=float(place),
            predicted={name: float(travel[i]) for name, travel in travels.items()},
            low=float(band.low[i]), high=float(band.high[i]), expected=float(expected[i]),
        )
        for i, place in enumerate(places)
    )  # fmt: skip
    return Plan(
        mechanism=mechanism, laws=kept, reference=named, settings=rows, repeats=repeats,
        uncertainty=size, assumed=error is None, repeated=repeated, range_source=source,
        preparations=bench.preparations(repeats),
        tellings=tellings, most=MOST,
        expectations=expectations, from_trials=bool(done),
        remarks=(*remarks, *idle, *still),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class _Bench:
    """The rig at the planned settings, and how well it and its readings are known."""

    now: TravelJudgement
    typical: Mapping[str, FrictionLaw]
    """Laws with values that are plausible now."""
    named: str
    """The law whose level the preparations are for."""
    places: Array
    """Settings (m,)."""
    travels: Mapping[str, Array]
    """Travels (m,) of the typical laws [m]."""
    error: float
    """Standard uncertainty of a reading [m]."""
    stated: Mapping[str, float]
    has_level: bool
    """Whether travels were measured, and not taken as the first law makes them."""

    def _moved(self, law: FrictionLaw, doubts: Mapping[str, float]) -> tuple[Any, Any]:
        """Return what uncertainties make of the travels of a law, by path: own, and shared."""
        shared = dict(doubts)
        by_hand = {self._knob: shared.pop(self._knob)} if self._knob in shared else {}
        trials = [replace(x, doubts=by_hand, shared=shared) for x in self.now.at(self.places)]
        return propagated(TravelModel(law, (), self.now.t_end), trials)

    def _slope(self, name: str) -> tuple[float, Array]:
        """Return the level of a typical law, and the slope of its travels (m,) over it."""
        law, path = self.typical[name], self.now.law_of(name).model.free[0]
        level = {p: value for p, _, value in parameters(law, "friction")}[path]
        model = TravelModel(law, [path], self.now.t_end)
        low, high = (model.travels(self.now.at(self.places), [(1.0 + step) * level])
                     for step in (-MOVED, MOVED))  # fmt: skip
        return level, (high - low) / (2.0 * MOVED)

    def _parts(self, name: str) -> tuple[Array, Array, Array]:
        """Return the covariance (p + m, p + m) of parameters and travels of a law, and S (m,).

        The covariance has two parts: the second is of what nobody stated of the rig, as is `needed`
        for a run of each setting.
        """
        law, drawn = self.now.law_of(name), self.now.draws_of(name).unknowns
        values = law.values(drawn)
        rows = np.hstack([values, law.table(self.now.at(self.places), drawn)])
        rows = within_band(rows[np.isfinite(rows).all(axis=1)])
        count, m = values.shape[1], len(self.places)
        doubts = {**self.needed(1), **self.stated}
        alone, shared = self._moved(self.typical[name], doubts)
        sought, moved = list[Array](), list[Array]()
        for path, x in shared.items():
            (moved if path in self.stated else sought).append(np.r_[np.zeros(count), x])
        if not self.has_level:  # the first travel was taken, and not measured
            level, slope = self._slope(name)
            moved.append(np.r_[level, np.zeros(count - 1), slope])
        own, columns = (np.reshape(x, (-1, count + m)) for x in (sought, moved))
        errors = self.error**2 + sum((x**2 for x in alone.values()), np.zeros(m))
        return np.cov(rows.T) + columns.T @ columns, own.T @ own, np.asarray(errors)

    @cached_property
    def _known(self) -> dict[str, tuple[Array, Array, Array]]:
        return {name: self._parts(name) for name in self.typical}

    def _covariance(self, name: str, repeats: int) -> tuple[Array, Array]:
        """Return that of `_parts` with the rig as is needed for so many runs, and S (m,)."""
        stated, sought, errors = self._known[name]
        return stated + sought / repeats, errors

    def _noise(self, scatter: Array) -> Array:
        """Return the covariance (m, m) of readings with variances (m,), which share an offset."""
        return np.diag(scatter) + (OFFSET * self.error) ** 2

    def left(self, name: str, repeats: int) -> Array:
        """Return the covariance (p + m, p + m) that so many runs of each setting leave of a law."""
        covariance, errors = self._covariance(name, repeats)
        read = covariance[-len(errors) :]
        own = read[:, -len(errors) :] + self._noise(errors / repeats)
        return np.asarray(covariance - read.T @ np.linalg.solve(own, read))

    def half_widths(self, name: str, repeats: int) -> Array:
        """Return half widths that the runs leave if a law holds: of parameters, then of travels."""
        own = np.diag(self.left(name, repeats))
        return np.asarray(ndtri(JudgedTravels.ends[1]) * np.sqrt(np.maximum(own, 0.0)))

    def estimates(self, name: str, repeats: int) -> tuple[Estimate, ...]:
        """Return the intervals of parameters to expect if a law holds, or why there is none."""
        law, free = self.typical[name], self.now.law_of(name).model.free
        halves = self.half_widths(name, repeats).tolist()
        known, result = dict(zip(free, halves, strict=False)), []
        for path, asked, value in parameters(law, "friction"):
            last, half = path.rpartition(".")[2], known.get(path, math.inf)
            if path not in free and last not in ADVICE:
                continue
            # off its limit, as `select` asks it to be
            settled = value - half > room_for(law, last, ())[0]
            half, reason = (half, "") if settled else (math.inf, ADVICE.get(last, INSENSITIVE))
            result.append(
                Estimate(path=path, quantity=asked, value=value, low=value - half,
                         high=value + half, interval="95 %", reason=reason)
            )  # fmt: skip
        return tuple(result)

    def tellings(self) -> dict[tuple[str, str], int | None]:
        """Return with how many runs a law that holds rules out another; None if `MOST` do not.

        The law with more parameters is taken to hold: the other one cannot imitate it. Of two with
        as many, whichever is harder to rule out.
        """
        sizes = {name: len(required_of(type(law))) for name, law in self.typical.items()}
        result = dict[tuple[str, str], int | None]()
        for one, other in combinations(sorted(sizes, key=sizes.__getitem__), 2):
            ways = [(other, one), (one, other)][: 1 + (sizes[one] == sizes[other])]
            pair = min(ways, key=lambda way: self.gained(way[0], way[1], MOST))
            needed = SURE * math.log(RIVAL)
            few = (n for n in range(LEAST, MOST + 1) if self.gained(*pair, n) >= needed)
            result[pair] = next(few, None)
        return dict(sorted(result.items(), key=lambda item: item[1] or math.inf))

    def gained(self, holds: str, rival: str, repeats: int) -> float:
        """Return the evidence of a law over a rival by readings without errors."""
        (of, errors), (other, _) = (self._covariance(name, repeats) for name in (holds, rival))
        apart, scatter = self.travels[holds] - self.travels[rival], errors / repeats
        m, nu, weights = len(errors), THRESHOLDS.freedom, np.ones(len(errors))
        for _ in range(STEPS):  # readings that a rival misses weigh less, as Student's t
            seen = other[-m:, -m:] + self._noise(scatter / weights)
            off = np.linalg.solve(seen, apart)
            left = off * scatter / weights
            weights = (nu + 1.0) / (nu + left**2 / scatter)
        cost = float(np.sum(block_scores(left**2 / scatter)) + (apart - left) @ off)
        volumes = (np.linalg.slogdet(x[-m:, -m:] + self._noise(scatter))[1] for x in (other, of))
        price = self.now.price(rival) - self.now.price(holds)
        return 0.5 * (cost + float(np.subtract(*volumes))) + price

    @property
    def _knob(self) -> str:
        assert self.now.knob is not None
        return self.now.knob[0]

    @cached_property
    def _per_unit(self) -> dict[str, float]:
        """Standard error of the level over itself by one run a setting, by source.

        That of the readings, and that of a parameter of the rig by its uncertainty, to first order.
        """
        known = _values(self.now.mechanism)
        units = {
            p: THRESHOLDS.rounding * (abs(v) or 1.0)
            for p, v in known.items()
            if v or p in self.stated
        }
        _, slope = self._slope(self.named)
        gain = slope / float(slope @ slope)
        alone, shared = self._moved(self.typical[self.named], units)
        result = {path: float(np.linalg.norm(gain * item)) for path, item in alone.items()}
        result |= {path: abs(float(gain @ item)) for path, item in shared.items()}
        size = {READINGS: self.error * float(np.linalg.norm(gain))}
        return size | {path: result[path] / unit for path, unit in units.items()}

    def _part(self, path: str, doubt: float, repeats: int) -> float:
        """Return the part of a source: what differs from run to run averages out."""
        many = repeats if path in (READINGS, self._knob) else 1
        return self._per_unit[path] * doubt / math.sqrt(many)

    def needed(self, repeats: int) -> dict[str, float]:
        """Return by path how well the rig is to be known for its part in the level to be small.

        Gravity and what the travels do not depend on are left out.
        """
        known = _values(self.now.mechanism)
        parts = {
            path: self._part(path, 1.0, repeats)
            for path in self._per_unit
            if path != READINGS and known[path] and not path.endswith(".gravity")
        }
        half = HALF * self._part(READINGS, 1.0, repeats)
        return {p: half / x for p, x in parts.items() if x * abs(known[p]) > THRESHOLDS.rounding}

    def preparations(self, repeats: int) -> tuple[Preparation, ...]:
        """Return what to measure before, and how well."""
        known = {path: (q, v) for path, q, v in parameters(self.now.mechanism, "mechanism")}
        return tuple(
            Preparation(
                path=path, quantity=known[path][0], value=known[path][1], needed=needed,
                stated=self.stated.get(path),
            )
            for path, needed in self.needed(repeats).items()
        )  # fmt: skip


def refuse_ignored(given: Mapping[str, object], *, further: bool, prefix: str = "") -> None:
    """Refuse arguments that have no effect on a plan: of travels, or `further` of others.

    Examples
    --------
    >>> refuse_ignored({"route": "balance"}, further=False, prefix="--")
    Traceback (most recent call last):
    stickslip.errors.InputError: --route has no effect on a plan of travels to rest: leave it out.
    """
    of_travels = ("between", "settings", "uncertainty", "parameter_uncertainties")
    for name in of_travels if further else ("vary", "route"):
        if given.get(name) is not None:
            what = "beside a table or records, but on one of travels" if further else "of travels"
            raise InputError(
                f"{prefix}{name} has no effect on a plan {what} to rest: leave it out."
            )


def is_further(mechanism: Mechanism, measurement: Measurement) -> bool:
    """Return whether `select` says what to measure beside a measurement: it is no travel to rest.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> is_further(rig, Measurement(travel=0.2))
    False
    """
    return driven_on(mechanism) or not measurement.records()[0].travelled


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
    alone = Measurement(travel=0.0)  # to check the mechanism
    check_given("plan", mechanism, alone if measurement is None else measurement)
    return () if measurement is None else trials_of(mechanism, measurement, t_end)


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


def _first(laws: Mapping[str, FrictionLaw]) -> str:
    """Return the name of the first law with a level, or of the first one."""
    return next((name for name, law in laws.items() if _has_level(law)), next(iter(laws)))


def _has_level(law: FrictionLaw) -> bool:
    return any(item.scale == "level" for _, item, _ in parameters(law, "friction"))


def _assumed(mechanism: Mechanism, law: FrictionLaw, t_end: float, error: float | None) -> Trial:
    """Return the travel that a law makes as the rig stands, as if it had been measured well."""
    trial = _trial(mechanism)
    signed = float(_travels(law, [trial], t_end)[0])
    phrase = f"{law.title} friction ({plain(values_text(law))})"
    if (travel := abs(signed)) == 0.0:
        raise InputError(
            f"{phrase} holds the body at rest: lower the friction level, or raise the setting of"
            " the rig."
        )
    if said := _why_none(mechanism, law, t_end, SCATTER * travel if error is None else error):
        raise InputError(f"there is no travel to plan with {phrase}: {said}")
    return replace(trial, travel=signed, half_width=THRESHOLDS.negligible * travel)


def _trial(
    mechanism: Mechanism, travel: float = 0.0, half_width: float = 0.0, **doubts: Any
) -> Trial:
    """Return a trial, whose travel need not be known."""
    return Trial(mechanism=mechanism, initial={}, travel=travel, half_width=half_width, **doubts)


def _travels(law: FrictionLaw, trials: Sequence[Trial], t_end: float) -> Array:
    """Return the travels (n,) of a law in trials [m]."""
    return TravelModel(law, (), t_end).travels(trials, ())


def _typical(now: TravelJudgement, name: str, places: Array) -> FrictionLaw:
    """Return a law with values that are plausible now: as fitted, or its draw in the middle.

    A fit whose best value of a part is 0 is another law by name only.
    """
    law = now.law_of(name)
    if not now.around_zero(name):
        return law.with_unknowns(now.unknowns_of(name))
    draws = now.drawn(name, THRESHOLDS.draws // 4)
    travels = law.table(now.at(places), draws.unknowns)
    further = np.abs(draws.unknowns[:, 1 : law.count])
    # those without a part are of another law by name only, too
    full = np.all(further > THRESHOLDS.negligible * further.max(axis=0, initial=0.0), axis=1)
    travels[~full & full.any()] = np.nan
    off = np.sum((travels - np.nanmedian(travels, axis=0)) ** 2, axis=1)
    return law.with_unknowns(draws.unknowns[int(np.nanargmin(off))])


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
    near = LEAST_ERROR * float(np.ptp(run[slip]))
    for stop in stops_of(mechanism):
        beyond = run[slip] - stop.position
        if stop.coordinate == slip and bool(
            np.any((beyond if stop.side == "upper" else -beyond) > -near)
        ):
            at = quantity(float(stop.position), mechanism.units[0])
            return f"the body hits the stop at {at}. Lower the setting of the rig."
    return ""


def _range(
    mechanism: Mechanism, path: str, done: Sequence[Trial], between: tuple[float, float] | None
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
    made = [_values(trial.mechanism)[path] for trial in done]
    sizes = sorted({abs(value) for value in (*made, present) if sign * value > 0.0})
    if sizes[0] <= (1.0 - THRESHOLDS.material) * sizes[-1]:
        low, high = sizes[0], sizes[-1]
        source = f"The settings span the {word} of the trials and of the rig"
    else:
        low, high = ALONE[0] * sizes[-1], sizes[-1]
        source = (
            f"{'The trials and the rig have' if done else 'The rig has'} one {word}: the settings"
            f" span {number(ALONE[0])} to 1 times that value"
        )
    low, high = (min(max(sign * item, asked.low), asked.high) for item in (low, high))
    shown = f"{number(factor * low)} to {number(factor * high)} {unit}".replace(" °", "°")
    return (low, high), f"{source}, {shown}. Use --between (Python: between) for another range."


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
    result, remarks = {}, []
    unit = all_paths(mechanism, "mechanism")[path].unit
    rigs = [vary(mechanism, "mechanism", {path: value}) for value in settings]
    for name, law in laws.items():
        size = error
        if size is None:
            size = SCATTER * float(np.max(np.abs(_travels(law, [*map(_trial, rigs)], t_end))))
        reasons = {
            value: said
            for value, rig in zip(settings, rigs, strict=True)
            if (said := _why_none(rig, law, t_end, size))
        }
        if not reasons:
            result[name] = law
            continue
        value, said = reasons.popitem()
        at = quantity(value, unit, degrees=True)
        remarks.append(f"{law.title} friction was left out: with {words_of(path)} {at}, {said}")
    if not result:
        raise InputError(f"no law can be planned for. {' '.join(remarks)}")
    return result, remarks


def _moving(now: TravelJudgement, law: FrictionLaw, places: Array) -> tuple[Array, list[str]]:
    """Return settings at which the body moves, and which were left out, as sentences."""
    assert now.knob is not None
    path, _ = now.knob
    unit = all_paths(now.mechanism, "mechanism")[path].unit
    travels = np.abs(_travels(law, now.at(places), now.t_end))
    moves = travels > THRESHOLDS.material * np.max(travels)
    if moves.sum() < 2:
        ends = " to ".join(quantity(item, unit, degrees=True) for item in (places[0], places[-1]))
        raise InputError(
            f"the body moves at {moves.sum()} of {len(places)} settings of the {words_of(path)}"
            f" from {ends}: raise the setting of the rig, or give a higher range with --between"
            " (Python: between)."
        )
    idle = [setting_text(item, unit) for item in places[~moves].tolist()]
    said = f"At {joined(idle)} the body hardly moves, so no runs are planned there."
    return places[moves], [said] if idle else []


def _checked(error: float | None, longest: float) -> float:
    """Return the standard uncertainty of a reading that is counted on [m]."""
    size = SCATTER * longest if error is None else error
    if not LEAST_ERROR * longest <= size <= longest:
        least, most, got = (quantity(item, "m") for item in (LEAST_ERROR * longest, longest, size))
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
    squares = sum(float(np.var(setting)) * len(setting) for setting in settings.values())
    freedom = len(done) - len(settings)
    scatter = math.sqrt(squares / freedom) if freedom >= LEAST - 1 else 0.0
    if scatter > float(errors.max()):
        return scatter, freedom
    return (float(errors.max()) if stated else None), 0


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
