"""What a record has to be before it is judged: a force with one sign, which is that of the motion.

A plain balance, of inertia, level, viscous friction and offset, is fitted to all rows. Where the
sign of the force is turned in the first :math:`k` of the stretches, and that leaves much less than
any other number does, it changes there. Where the friction that explains most of what the inertia
leaves gives energy to the motion, the force is that of the other sign.
"""

from collections.abc import Sequence

import numpy as np

from stickslip.errors import InputError
from stickslip.identify.problems.free_balance import free_form
from stickslip.identify.problems.record_columns import is_told
from stickslip.identify.problems.record_rows import MIDDLE, BalanceRows, moves, pieces_of
from stickslip.identify.problems.record_signals import STRETCHES, Record
from stickslip.show.formatting import percent

EXPLAINED = 0.5
"""Part of what a plain balance leaves that another sign takes off, at least."""


def _is_driven(record: Record) -> bool:
    return bool(np.any(record.force))


def refuse_wrong_signs(records: Sequence[Record]) -> None:
    """Refuse records whose force has the other sign, or one that changes."""
    first, moving = records[0], [one for one in records if moves(one)]
    if first.friction or not moving or free_form(moving) or not any(map(_is_driven, moving)):
        return
    pieces, every = pieces_of(moving)
    rows, inertia = BalanceRows(pieces, MIDDLE, every), first.inertia is None
    response = rows.response
    stretches = np.minimum(np.arange(rows.count) * STRETCHES // rows.count, STRETCHES - 1)
    direction = rows.seen(
        [p.direction * (1.0 if p.record.load is None else p.record.load) for p in pieces]
    )
    speed = rows.seen([p.velocity for p in pieces])
    rig = [np.ones(rows.count), *([rows.acceleration] if inertia else [])]
    for path, one in first.unknown.items():
        force = rows.seen([p.record.unknown[path].force for p in pieces])
        rig.append(one.inertia * rows.acceleration - force)
    # of a motion in one direction a level is an offset, and damping may be sought: these may drive
    laws = [one for one in (direction, speed) if is_told(one, rig)]
    if not laws:
        return
    n = len(laws)
    x = np.column_stack([*laws, *rig])
    size = np.sqrt(np.mean(x * x, axis=0)) + 1e-300
    x = x / size
    gram = x.T @ x + 1e-9 * len(x) * np.eye(x.shape[1])
    driven = rows.seen([p.record.force for p in pieces])
    other = response - driven
    count = int(stretches.max()) + 1
    moments = np.array([x[stretches == k].T @ driven[stretches == k] for k in range(count)])
    left = []
    for k in range(count):
        sign = np.where(stretches < k, -1.0, 1.0)
        y = sign * driven + other
        side = np.where(np.arange(count) < k, -1.0, 1.0)
        moment = side @ moments + x.T @ other
        left.append(float(y @ y - moment @ np.linalg.solve(gram, moment)))
    best = int(np.argmin(left))
    most = 1.0 - EXPLAINED
    if left[best] < most * left[0]:
        begin = int(np.argmax(stretches == best))
        raise InputError(
            f"the sign of the force changes at about t = {rows.time[begin]:.3g} s: turned before"
            f" it, the force leaves {percent(left[best] / left[0])} of the squared error of a plain"
            " balance. Give the force the sign of the position all along."
        )
    c = np.linalg.solve(gram, x.T @ response)
    friction = x[:, :n] @ c[:n]
    plain = np.linalg.solve(gram[n:, n:], x[:, n:].T @ response)
    without = response - x[:, n:] @ plain
    wrong = float(np.mean(friction * speed)) < 0.0
    inertial = float(c[n + 1]) < 0.0 if inertia else True
    if wrong and inertial and left[0] < most * float(without @ without):
        raise InputError(
            "with the sign that the force has, friction would drive the motion: turn the sign of"
            " the force, or that of the position."
        )
