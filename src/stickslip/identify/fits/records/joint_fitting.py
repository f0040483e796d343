"""Fits laws to several joints at once, from one record of positions and forces."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement, refuse_faults, refuse_unused, with_doubts
from stickslip.engine.formulation import JointTorques
from stickslip.errors import InputError, ParameterError
from stickslip.friction import CandidateSpec, FrictionLaw, given_to, specification
from stickslip.identify.fits.estimation.parameters import (
    OFFSET,
    WIDE,
    FreeParameter,
)
from stickslip.identify.fits.force_map.data import MotionSegment, moved
from stickslip.identify.fits.force_map.force_balance import SAMPLES
from stickslip.identify.fits.force_map.holds import hold_of
from stickslip.identify.fits.force_map.joint_balance import (
    check_joints,
    contacts_along,
    joint_stretches,
    regression_of,
)
from stickslip.identify.fits.records.links import told_links
from stickslip.identify.fits.series.inverse_dynamics import positions_of
from stickslip.identify.fits.series.start_values import MOST
from stickslip.identify.fits.settings import NEGLIGIBLE, ROUNDS, SETTLED, Hold, RecordSettings
from stickslip.identify.fits.validation import (
    LAW,
    fixed_values,
    law_quantities,
    names_of,
    varied_paths,
)
from stickslip.mechanisms import LINKS, Mechanism
from stickslip.quantities import Quantity, all_paths, parameters, vary
from stickslip.show.formatting import joined, percent

Array = NDArray[np.float64]
JointLaw: TypeAlias = FrictionLaw | type[FrictionLaw] | CandidateSpec | str | None

JOINTS = "joints"
"""The route of records of several joints."""
SIGNALS = {"positions": ("position", "velocity"), "forces": ("force",)}
"""What may be exchanged, and the quantities of a record that it is."""
OTHER_UNITS: Mapping[str, Mapping[str, tuple[str, float]]] = {
    "rad": {"positions": ("degrees", math.pi / 180.0), "forces": ("mN m", 1e-3)},
    "m": {"positions": ("millimetres", 1e-3), "forces": ("mN", 1e-3)},
}
"""Units that columns may be in by mistake, and what they are in SI, by the unit of a joint."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Motion:
    """What records say whatever the laws are: motions, and the forces that these take."""

    torques: JointTorques
    """What a motion takes."""
    mechanism: Mechanism
    """The mechanism with the start values of what is looked for."""
    linear: tuple[FreeParameter, ...]
    """Parameters of the mechanism that are fitted, from linear regression."""
    left: Array
    """What the regression leaves of the force of each joint (m,)."""
    share: Array
    """What it leaves with parameters within their bounds, over the spread of the force (m,)."""
    inertias: Array
    """What moves with each joint (m,)."""
    stretches: tuple[tuple[MotionSegment, ...], ...]
    """Stretches of each joint at the parameters' start."""

    @property
    def resting(self) -> tuple[str, ...]:
        """Coordinates that rest in all records, or hardly move: nothing tells their friction."""
        pairs = zip(self.torques.coordinates, self.stretches, strict=True)
        return tuple(name for name, own in pairs if not _rows(own))

    @classmethod
    def of(cls, asked: "_Asked", measurement: Measurement, hold: Hold) -> "_Motion":
        """Derive the motions."""
        torques = JointTorques.of(asked.mechanism, asked.linear, by_position=asked.zeros)
        for _ in range(ROUNDS):
            own = cls.along(torques, asked, measurement, hold)
            if not torques.bent:
                return own
            start = {item.path: item.start for item in own.linear}
            change = _change(asked.mechanism, start)
            asked = replace(asked, mechanism=vary(asked.mechanism, "mechanism", start))
            if change < SETTLED:
                break
        return cls.along(torques, asked, measurement, hold)

    @classmethod
    def along(
        cls,
        torques: JointTorques,
        asked: "_Asked",
        measurement: Measurement,
        hold: Hold,
    ) -> "_Motion":
        """Derive the motions with slopes at the values of the mechanism."""
        (derived,) = joint_stretches(
            torques, asked.mechanism, measurement, hold=hold, samples=(SAMPLES,), slipping=True
        )
        linear, left, within = _start(asked, torques, derived)
        values = {path: v for path, _, v in parameters(asked.mechanism, "mechanism")}
        at = np.array([values[path] for path in torques.linear])
        first = np.array([item.start for item in linear])
        mechanism = vary(
            asked.mechanism, "mechanism", dict(zip(torques.linear, first.tolist(), strict=True))
        )
        return cls(
            torques=torques,
            mechanism=mechanism,
            linear=linear,
            left=left,
            share=within / _spread(derived),
            inertias=torques.inertias(mechanism, _middle(measurement, torques.coordinates)),
            stretches=tuple(tuple(moved(one, first - at) for one in joint) for joint in derived),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class JointFitter:
    """Fits laws by contact to records of several joints, whose motion is derived once for all."""

    mechanism: Mechanism
    """Mechanism that was measured, as it was given."""
    measurement: Measurement
    """Records in time of positions and forces by joint."""
    vary: str | Sequence[str] | None
    """Parameters to fit."""
    fixed: Mapping[str, float] | None
    """Values of parameters that are held."""
    settings: RecordSettings
    """Starts, seed and hold."""
    motion: _Motion
    """What the records say whatever the laws are."""
    asked: "_Asked"
    """What is fitted, by contact."""
    asked_hold: Hold | None = None
    """How forces run between samples, if that was given."""

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        laws: Mapping[str, JointLaw] | type[FrictionLaw] | str,
        measurement: Measurement,
        *,
        vary: str | Sequence[str] | None = None,
        fixed: Mapping[str, float] | None = None,
        settings: RecordSettings | None = None,
    ) -> "JointFitter":
        """Check the records and derive their motion."""
        settings = settings or RecordSettings()
        given = settings.hold
        for record in measurement.records():
            check_joints(record, mechanism.coordinates)
        zeros = bool(settings.position_zeros)
        if vary is not None and LINKS in names_of(vary):
            mechanism, links = told_links(mechanism, measurement, settings.holding, zeros=zeros)
            vary = [*(one for one in names_of(vary) if one != LINKS), *links]
        asked = _Asked.of(mechanism, laws, vary, fixed, measurement, zeros=zeros)
        refuse_unused(measurement)
        refuse_faults(measurement, asked.mechanism)
        with with_doubts(measurement, asked.mechanism):
            hold = hold_of(asked.mechanism, measurement, settings.hold, vary=asked.linear)
            settings = settings if hold is None else hold.applied(settings)
            motion = _Motion.of(asked, measurement, settings.holding)
        return cls(
            asked=asked,
            asked_hold=given,
            mechanism=mechanism,
            measurement=measurement,
            vary=vary,
            fixed=fixed,
            settings=settings,
            motion=motion,
        )

    @property
    def contacts(self) -> Mapping[str, str]:
        """Contacts by coordinate: the joints that rub and move."""
        known = contacts_along(self.mechanism).items()
        return {along: one.name for along, one in known if along not in self.motion.resting}

    @property
    def resting(self) -> tuple[str, ...]:
        """What is to be said of joints that rest, whose friction is not fitted: sentences."""
        return tuple(
            f"The joint {name} rests throughout: its friction is not identified, and was not"
            " fitted. Record it moving."
            for name in self.motion.resting
        )

    def wrong_columns(self, laws: Mapping[str, JointLaw] | str) -> str:
        """Return which signals would explain the forces if exchanged or converted, as a sentence.

        Looked for where a regression leaves most of the force of some joint; empty elsewhere, and
        if none takes most of that away.
        """
        names, units = self.mechanism.coordinates, self.mechanism.units
        share = float(np.max(self.motion.share))
        if share < MOST:
            return ""
        zeros = bool(self.settings.position_zeros)
        found = []
        for finding, other in _suspected(self.measurement, names, units):
            try:
                asked = _Asked.of(self.mechanism, laws, self.vary, self.fixed, other, zeros=zeros)
                seen = _Motion.of(asked, other, self.settings.holding)
            except InputError:
                continue
            found.append((float(np.max(seen.share)), finding))
        left, finding = min(found, default=(np.inf, ""))
        if left > MOST * min(share, 1.0):
            return ""
        falls = (
            f"what the mechanism does not explain of the forces falls from {percent(share)}"
            f" to {percent(left)}"
        )
        return finding.replace("{falls}", falls)


def _suspected(
    measurement: Measurement, names: Sequence[str], units: Sequence[str]
) -> Iterator[tuple[str, Measurement]]:
    """Yield what may be wrong with columns, as a sentence, and the records without it."""
    for (i, j), what in itertools.product(itertools.combinations(range(len(names)), 2), SIGNALS):
        if units[i] == units[j]:
            yield (
                f"The {what} of {names[i]} and {names[j]} seem to be exchanged: with the one as the"
                " other, {falls}. Check which column is of which joint.",
                _with_exchanged(measurement, names[i], names[j], SIGNALS[what]),
            )
    for name, unit in zip(names, units, strict=True):
        for what, signals in SIGNALS.items():
            yield (
                f"The {what} of {name} seem to have the opposite sign: with the other one,"
                " {falls}. Check the sign of the column.",
                _multiplied(measurement, name, signals, -1.0),
            )
        for what, (scale, factor) in OTHER_UNITS.get(unit, {}).items():
            yield (
                f"The {what} of {name} seem to be in {scale}: as such, {{falls}}. Check the unit of"
                " the column.",
                _multiplied(measurement, name, SIGNALS[what], factor),
            )


def _multiplied(
    measurement: Measurement, name: str, signals: Sequence[str], factor: float
) -> Measurement:
    """Return records in which some signals of a joint are multiplied by a factor."""
    records = []
    for record in measurement.records():
        own = record.joints[name]
        known = {one: factor * getattr(own, one) for one in signals if one in own.quantities()}
        offset = {one: factor * size if one in known else size for one, size in own.offset.items()}
        joints = {**record.joints, name: replace(own, **known, offset=offset)}
        records.append(replace(record, joints=joints))
    return replace(measurement, trials=tuple(records)) if measurement.trials else records[0]


def _with_exchanged(
    measurement: Measurement, one: str, other: str, names: Sequence[str]
) -> Measurement:
    """Return records in which two joints have each other's signals of some names."""
    records = []
    for record in measurement.records():
        joints = dict(record.joints)
        for a, b in ((one, other), (other, one)):
            own, from_ = record.joints[a], record.joints[b]
            signals = {name: getattr(from_, name) for name in names}
            kept = {name: size for name, size in own.offset.items() if name not in names}
            moved = {name: size for name, size in from_.offset.items() if name in names}
            joints[a] = replace(own, **signals, offset={**kept, **moved})
        records.append(replace(record, joints=joints))
    return replace(measurement, trials=tuple(records)) if measurement.trials else records[0]


@dataclass(frozen=True, kw_only=True)
class _Asked:
    """What is fitted, by contact."""

    mechanism: Mechanism
    """The mechanism with its fixed values."""
    laws: Mapping[str, FrictionLaw | type[FrictionLaw] | None]
    """By contact, in their order."""
    free: Mapping[str, tuple[str, ...]]
    """Parameters of each law that are fitted, called as if there were no other; `LAW` for all."""
    known: Mapping[str, Mapping[str, float]]
    """Values of each law that are held, by name."""
    linear: tuple[str, ...]
    """Paths of the mechanism's parameters that are fitted."""
    zeros: bool
    """Whether positions of each record count from a place that is not known."""
    offsets: Mapping[str, float]
    """Constant forces that are held, by coordinate."""

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        laws: Mapping[str, JointLaw] | type[FrictionLaw] | str,
        vary_: str | Sequence[str] | None,
        fixed: Mapping[str, float] | None,
        measurement: Measurement,
        *,
        zeros: bool,
    ) -> "_Asked":
        """Resolve names to full paths."""
        contacts = tuple(one.name for one in contacts_along(mechanism).values())
        if isinstance(laws, FrictionLaw):
            raise InputError(
                "a law given alone would be shared by all joints, which fits do not do: give its"
                f" type {type(laws).__name__}, or laws by contact, as"
                f" {{{', '.join(f'{name!r}: ...' for name in contacts)}}}."
            )
        if not isinstance(laws, Mapping):
            laws = dict.fromkeys(contacts, laws)
        usual: dict[str, tuple[str, ...]] = {}
        kinds: dict[str, FrictionLaw | type[FrictionLaw] | None] = {}
        for name, given in given_to(contacts, laws).items():
            law, usual[name] = _law_of(name, given)
            kinds[name] = law
        quantities = {
            path.replace("friction.", f"friction.{name}.", 1): quantity
            for name, law in kinds.items()
            for path, quantity in law_quantities(law).items()
        }
        own = all_paths(mechanism, "mechanism")
        held = [OFFSET + name for name in mechanism.coordinates]
        known: dict[str, Quantity] = {
            **quantities, **own, **dict.fromkeys(held, Quantity("o", "N"))
        }  # fmt: skip
        values = fixed_values(fixed, known, lambda path: path.partition(".")[0])
        names = (LAW,) if vary_ is None else names_of(vary_)
        whole_laws = (LAW, *(f"friction.{name}.*" for name in kinds))
        varied = varied_paths(names, {**quantities, **own}, values, whole_laws)
        linear = tuple(path for path in varied if path in own)
        for record in measurement.records():
            for path in record.overrides:
                if path in linear or path in values:
                    raise InputError(
                        f"trial {record.name or 'without a name'} overrides {path}, which is one"
                        " value for all trials here: leave the override out, or do not name it in"
                        " vary or fixed."
                    )
        held_own = {path: value for path, value in values.items() if path in own}
        free, held_laws = {}, {}
        for name, law in kinds.items():
            prefix = f"friction.{name}."
            mine = {p.removeprefix(prefix): v for p, v in values.items() if p.startswith(prefix)}
            if isinstance(law, FrictionLaw) and mine:
                changes = {f"friction.{field}": value for field, value in mine.items()}
                kinds[name] = vary(law, "friction", changes)
            held_laws[name] = mine
            whole = LAW in varied or f"friction.{name}.*" in varied
            named = [f"friction.{p.removeprefix(prefix)}" for p in varied if p.startswith(prefix)]
            whole |= isinstance(law, type) and not named and not mine  # no values of it were given
            free[name] = (*(usual[name] if whole else ()), *(p for p in named if "*" not in p))
        return cls(
            mechanism=vary(mechanism, "mechanism", held_own) if held_own else mechanism,
            laws=kinds,
            free=free,
            known=held_laws,
            linear=linear,
            zeros=zeros,
            offsets={
                path.removeprefix(OFFSET): values.get(path, 0.0)
                for path in held
                if zeros or path in values  # a zero and a constant force are hardly told apart
            },
        )


def _law_of(
    name: str, given: object
) -> tuple[FrictionLaw | type[FrictionLaw] | None, tuple[str, ...]]:
    """Return a law that was given for a contact, and which of its parameters are fitted."""
    if given is None:
        return None, ()
    if isinstance(given, str | CandidateSpec):
        found = specification(given) if isinstance(given, str) else given
        own = (LAW,) if found.free is None else tuple(f"friction.{one}" for one in found.free)
        return found.law, own
    kind = given if isinstance(given, type) else type(given)
    if not issubclass(kind, FrictionLaw):
        raise InputError(
            f"the law of the contact {name!r} must be a FrictionLaw, its type or its name, got"
            f" {given!r}."
        )
    return cast("FrictionLaw | type[FrictionLaw]", given), (LAW,)


def _change(mechanism: Mechanism, values: Mapping[str, float]) -> float:
    """Return the largest change of parameters from those of a mechanism, over their values."""
    before = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    return max(
        (abs(value - before[path]) / max(abs(value), 1e-300) for path, value in values.items()),
        default=0.0,
    )


def _spread(stretches: Sequence[Sequence[MotionSegment]]) -> Array:
    """Return the standard deviation of the applied force of each joint (m,)."""
    columns = [[one.applied[one.segment >= 0] for one in own] for own in stretches]  # type: ignore[index]
    sizes = [np.std(np.concatenate(own)) if sum(map(len, own)) else 0.0 for own in columns]
    found: Array = np.maximum(np.array(sizes, dtype=float), 1e-300)
    return found


def _rows(stretches: Sequence[MotionSegment]) -> int:
    """Return how many rows of a joint are fitted."""
    return sum(int(np.count_nonzero(one.segment >= 0)) for one in stretches)


def _by_joint(residual: Array, joint: NDArray[np.intp], count: int) -> Array:
    """Return the root mean square of the rows of each joint (m,); 0 where it has none."""
    squares = np.bincount(joint, residual**2, minlength=count)
    found: Array = np.sqrt(squares / np.maximum(np.bincount(joint, minlength=count), 1))
    return found


def _start(
    asked: _Asked, torques: JointTorques, stretches: Sequence[Sequence[MotionSegment]]
) -> tuple[tuple[FreeParameter, ...], Array, Array]:
    """Return the parameters of the mechanism with start values, and what is left of each joint.

    From linear regression with Coulomb and viscous friction, and a constant force, of every joint.
    What is left comes twice: by the regression as it is, and with these parameters in bounds.
    """
    count, k = len(torques.coordinates), len(torques.linear)
    table, target, joint = regression_of(stretches, k)
    size = np.linalg.norm(table, axis=0)
    scaled = table / np.where(size > 0.0, size, 1.0)
    if torques.bent:
        _refuse_alike(torques.linear, scaled[:, :k])
    found = np.linalg.lstsq(scaled, target, rcond=1e-8)[0] / np.where(size > 0.0, size, 1.0)
    residual = target - table @ found
    left = _by_joint(residual, joint, count)
    values = {path: (quantity, v) for path, quantity, v in parameters(asked.mechanism, "mechanism")}
    force = float(np.sqrt(np.mean(target**2)))
    items = []
    for j, path in enumerate(torques.linear):
        quantity, nominal = values[path]
        seen = float(size[j]) / np.sqrt(len(target))
        reach = WIDE * max(force / max(seen, 1e-300), abs(nominal))
        least = quantity.low if quantity.above is None else quantity.above + 1e-6 * abs(nominal)
        low, high = max(least, nominal - reach), min(quantity.high, nominal + reach)
        start = min(max(nominal + float(found[j]), low), high)
        items.append(FreeParameter(path=path, quantity=quantity, start=start, low=low, high=high))
    if not _allows(asked.mechanism, {item.path: item.start for item in items}):
        items = [replace(item, start=values[item.path][1]) for item in items]
    change = np.array([item.start - values[item.path][1] for item in items])
    held = target - table[:, :k] @ change
    rest = scaled[:, k:]
    residual = held - rest @ np.linalg.lstsq(rest, held, rcond=1e-8)[0]
    within = _by_joint(residual, joint, count)
    least = 1e-12 * max(force, 1e-300)
    return tuple(items), np.maximum(left, least), np.maximum(within, least)


def _allows(mechanism: Mechanism, values: Mapping[str, float]) -> bool:
    """Whether a mechanism takes parameters together, as links with mass."""
    try:
        vary(mechanism, "mechanism", values)
    except ParameterError:
        return False
    return True


def _refuse_alike(names: Sequence[str], slopes: Array) -> None:
    """Refuse parameters that do the same to all forces, or nothing: searches would not settle."""
    _, sizes, directions = np.linalg.svd(slopes, full_matrices=False)
    if sizes[-1] < NEGLIGIBLE:
        same = [
            name for name, part in zip(names, directions[-1], strict=True) if abs(part) > NEGLIGIBLE
        ]
        if len(same) == 1:
            raise InputError(f"the forces of this motion do not depend on {same[0]}: fix it.")
        raise InputError(
            f"the motion does not tell {joined(same)} apart: fix one of them, such as {same[-1]}."
        )


def _middle(measurement: Measurement, names: Sequence[str]) -> Array:
    """Return the mean of each coordinate over all records (m,)."""
    records = measurement.records()
    return np.array(
        [
            np.mean(np.concatenate([positions_of(record.joints[name]) for record in records]))
            for name in names
        ]
    )
