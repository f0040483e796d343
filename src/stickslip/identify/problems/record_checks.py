"""What a record has to be before it is judged: a force with one sign, which is that of the motion.

A plain balance, of inertia, level, viscous friction and offset, is fitted to all rows. Where the
sign of the force is turned in the first :math:`k` of the stretches, and that leaves much less than
as it is, it changes there; in all of them, it is the other one. Where the friction that explains
most of what the inertia leaves gives energy to the motion, the force is that of the other sign.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress

import numpy as np

from stickslip.data import Finding, Measurement
from stickslip.errors import InputError
from stickslip.identify.fits import ROUNDS, SETTLED
from stickslip.identify.forces import Unknown
from stickslip.identify.posterior import Array
from stickslip.identify.problems.free_balance import free_form
from stickslip.identify.problems.record_columns import is_told
from stickslip.identify.problems.record_rows import MIDDLE, BalanceRows, moves, pieces_of
from stickslip.identify.problems.record_signals import STRETCHES, Record, records_of
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.mechanisms import Axis, Mechanism
from stickslip.quantities import vary
from stickslip.show.formatting import capital, percent

BACKWARD = 0.02
"""Share of the path forward that a motion in one direction goes back, by noise, at most."""
FLIPPED, FEWEST = 0.25, 20
"""What is left with the sign turned in a part, over what is left as it is, up to which it changes,
and rows in motion for that at least. Measured forces whose sign was turned left .14 at most, and
sound ones of stick-slip .42 to .5; of 1,300 made-up records of stick-slip in soft loops with so
many rows, one that swings up left .1 and all others .27 or more."""
TOO_SMALL = 0.1
"""Force of inertia and of all else over that of friction, up to which no delay makes that drive."""
LIFTED = "the motion lifts the body: its normal force is not above 0 N."
OTHER_SIGN = (
    "with the sign that the force has, friction would drive the motion: turn the sign of the force"
    " (its gain, -1), or that of the position"
)


def plain_columns(records: Sequence[Record]) -> tuple[BalanceRows, list[Array], list[Array]]:
    """Return rows of a balance, and columns (n,): of level and viscous friction, and of the rig."""
    pieces, every = pieces_of(records)
    rows, inertia = BalanceRows(pieces, MIDDLE, every), records[0].inertia is None
    direction = rows.seen(
        [p.direction * (1.0 if p.record.load is None else p.record.load) for p in pieces]
    )
    speed = rows.seen([p.velocity for p in pieces])
    rig = [np.ones(rows.count), *([rows.acceleration] if inertia else [])]
    rig += [rows.unknown(path) for path in records[0].unknown]
    return rows, [direction, speed], rig


def refuse_wrong_signs(records: Sequence[Record]) -> None:
    """Refuse records whose force has the other sign, or one that changes."""
    if wrong := wrong_sign(records):
        raise InputError(f"{wrong}.")


def sign_findings(
    measurement: Measurement, mechanism: Mechanism | None = None, unknown: Sequence[str] = ()
) -> Iterator[Finding]:
    """Yield that the force of a record has a wrong sign, or one that changes, as `select` refuses.

    Without a mechanism, nothing is known of its inertia and of a spring.
    """
    if mechanism is None:
        mechanism, unknown = Axis(inertia=1.0), ("mechanism.inertia", "mechanism.stiffness")
    own = [path for path in unknown if path.startswith("mechanism.")]
    for record in measurement.records():
        with suppress(InputError):  # what else is wrong with it is said elsewhere
            records = records_of(mechanism, record, unknown=own)
            if "force" in record.quantities() and (wrong := wrong_sign(records)):
                said, label = f"{capital(wrong)}.", record.name if measurement.trials else ""
                yield Finding(kind="force sign", sentence=said, severity="error", record=label)


def wrong_sign(records: Sequence[Record]) -> str:
    """Return what is wrong with the sign of the force of records; empty if nothing is."""
    first, moving = records[0], [record for record in records if moves(record)]
    pushed = any(np.any(item.force) for item in moving)
    if first.friction or not pushed or free_form(moving):
        return ""
    rows, slides, rig = plain_columns(moving)
    inertia, speed, response = first.inertia is None, slides[1], rows.response
    rests = rows.taken([piece.still for piece in rows.pieces])  # friction there has either sign
    stretches = np.minimum(np.arange(rows.count) * STRETCHES // rows.count, STRETCHES - 1)
    ways = [float(np.sum(np.maximum(side * rows.velocity, 0.0))) for side in (1.0, -1.0)]
    one_way = min(ways) < BACKWARD * max(ways)
    # in one direction a level is an offset, and damping may be sought: these may drive
    laws = [slide for slide in slides[one_way:] if is_told(slide, rig)]
    if not laws:
        return ""
    n, x = len(laws), np.column_stack([*laws, *rig])
    size = np.sqrt(np.mean(x * x, axis=0)) + 1e-300
    x = x / size
    gram = x.T @ x + 1e-9 * len(x) * np.eye(x.shape[1])
    driven = rows.seen([p.record.force for p in rows.pieces])
    other, count = response - driven, int(stretches.max()) + 1
    moments = np.array([x[stretches == k].T @ driven[stretches == k] for k in range(count)])
    left = []
    for k in range(count + 1):  # the last one turns all of them
        side = np.where(np.arange(count) < k, -1.0, 1.0)
        y = side[stretches] * driven + other
        moment = side @ moments + x.T @ other
        left.append(float(y @ y - moment @ np.linalg.solve(gram, moment)))
    best, most = int(np.argmin(left[:count])), 1.0 - THRESHOLDS.explained
    if left[best] < FLIPPED * left[0] and np.sum(~rests) >= FEWEST:
        if left[count] <= left[best]:
            return OTHER_SIGN
        begin = int(np.argmax(stretches == best))
        return (
            f"the sign of the force changes at about t = {rows.time[begin]:.3g} s: turned before"
            f" it, the force leaves {percent(left[best] / left[0])} of the squared error of a plain"
            " balance. Give the force the sign of the position all along"
        )
    c = np.linalg.solve(gram, x.T @ response)
    without = response - x[:, n:] @ np.linalg.solve(gram[n:, n:], x[:, n:].T @ response)
    wrong = float(np.mean(x[:, :n] @ c[:n] * speed)) < 0.0
    # in one direction friction that falls with the speed would drive: only inertia has a sign
    inertial = float(c[n + 1]) < 0.0 if inertia else left[count] < most * left[0]
    if n == 2 and not one_way:  # of what else acts, a part that is recorded late may drive
        beside = float(np.std(x[:, n:] @ c[n:]) + np.std(other))
        little = beside < TOO_SMALL * float(np.std(x[:, :n] @ c[:n]))
        inertial = inertial or (little and left[0] < most * float(driven @ driven))
    turned = wrong and inertial and left[0] < most * float(without @ without)
    return OTHER_SIGN if turned else ""


def settled(
    mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str], *, offset: bool = True
) -> Mechanism:
    """Return a mechanism with values of parameters about which the balance may be linear.

    Where forces are not linear in what is looked for, steps of Gauss and Newton with a level and
    viscous friction lead to where the balance leaves least; none changes a value to less than its
    half or more than its double, and one that leaves more is halved. A mechanism whose forces are
    linear stays as it is.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> t = np.arange(0.0, 10.0, 0.01)
    >>> q = np.sin(t) + np.sin(2.3 * t)
    >>> torque = 0.5 * (-np.sin(t) - 2.3**2 * np.sin(2.3 * t)) + 9.81 * np.sin(q)  # m l^2, m l
    >>> swing = Measurement(time=t, position=q, force=torque, turning=True)
    >>> paths = ["mechanism.mass", "mechanism.length"]
    >>> found = settled(Pendulum(mass=1.0, length=1.0), swing, paths)
    >>> round(found.mass, 2), round(found.length, 2)
    (2.0, 0.5)
    """

    def left(rig: Mechanism) -> tuple[float, dict[str, Unknown], Array]:
        """Return the mean square that a balance leaves, what is looked for, and steps (p,)."""
        records = records_of(rig, measurement, unknown=unknown, offset=offset)
        looked = {path: item for path, item in records[0].unknown.items() if not item.doubt}
        if not any(item.bent for item in looked.values()):
            return 0.0, {}, np.zeros(0)
        rows, friction, rig_ = plain_columns([record for record in records if moves(record)])
        table = np.column_stack([*friction, *rig_])
        at = len(friction) + len(rig_) - len(records[0].unknown)
        places = [at + k for k, path in enumerate(records[0].unknown) if path in looked]
        sizes = np.sqrt(np.mean(table**2, axis=0)) + 1e-300
        steps = np.linalg.lstsq(table / sizes, rows.response, rcond=1e-9)[0] / sizes
        own = np.delete(table / sizes, places, axis=1)  # what is left with the values as they are
        rest = rows.response - own @ np.linalg.lstsq(own, rows.response, rcond=1e-9)[0]
        return float(np.mean(rest**2)), looked, steps[places]

    least, looked, steps = left(mechanism) if unknown else (0.0, {}, np.zeros(0))
    for _ in range(ROUNDS if looked else 0):
        each = zip(looked.items(), steps.tolist(), strict=True)
        moved = {path: item.within(step) for (path, item), step in each}
        for halved in (1.0, 0.5, 0.25, 0.1, 0.03):
            values = {path: looked[path].given + halved * x for path, x in moved.items()}
            nearer = vary(mechanism, "mechanism", values)
            result = left(nearer)
            if result[0] < least:
                break
        else:
            break
        gained, mechanism = 1.0 - result[0] / least, nearer
        least, looked, steps = result
        if gained < SETTLED:
            break
    return mechanism
