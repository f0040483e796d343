"""What a record has to be before it is judged: a force with one sign, which is that of the motion.

A plain balance, of inertia, level, viscous friction and offset, is fitted to all rows. Where the
sign of the force is turned in the first :math:`k` of the stretches, and that leaves much less than
any other number does, it changes there. Where the friction that explains most of what the inertia
leaves gives energy to the motion, the force is that of the other sign.
"""

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.identify.problem import Array
from stickslip.identify.problems.record_signals import Along
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.show.formatting import percent


def refuse_wrong_signs(
    rows: Along, response: Array, stretches: NDArray[np.intp], *, inertia: bool
) -> None:
    """Refuse records whose force has the other sign, or one that changes.

    Taken are signals at the rows, their balance (n,) [N], the number of the stretch of each (n,),
    and whether the inertia is not known.
    """
    direction = rows.seen(rows.direction * rows.load)
    speed = rows.seen(rows.velocity)
    rig = [np.ones(rows.count), *([rows.acceleration] if inertia else [])]
    rig += [rows.taken(path) for path in rows.records[0].unknown]
    beside = np.column_stack(rig)
    apart = direction - beside @ np.linalg.lstsq(beside, direction, rcond=1e-9)[0]
    # of a motion in one direction a level is an offset, which may drive
    told = np.linalg.norm(apart) > THRESHOLDS.same_span * np.linalg.norm(direction)
    laws = [direction, speed] if told else [speed]
    n = len(laws)
    x = np.column_stack([*laws, *rig])
    size = np.sqrt(np.mean(x * x, axis=0)) + 1e-300
    x = x / size
    gram = x.T @ x + 1e-9 * len(x) * np.eye(x.shape[1])
    driven = rows.seen(rows.raw)
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
    most = 1.0 - THRESHOLDS.explained
    if left[best] < most * left[0]:
        first = int(np.argmax(stretches == best))
        raise InputError(
            f"the sign of the force changes at about t = {rows.times[first]:.3g} s: turned before"
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
