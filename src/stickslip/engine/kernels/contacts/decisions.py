"""Decisions of several contacts at one instant: who sticks, who slips, and what impacts give.

All coordinates at rest are decided together. With levels L in both directions, accelerations a,
and the needed friction r, which is what is left of the forces less inertia,

    held:    a_i = 0  and  -L_i- <= r_i <= L_i+
    pushed:  friction is the level, and a_i does not point against the push.

That is a boxed linear complementarity problem of accelerations. Its matrix is a principal part of
the mass matrix, which is positive definite, so that it has exactly one solution.

1. Those whose break-away has been reached slip; all others at rest begin as held.
2. The problem is solved with static levels. Who is pushed and moves has broken away, and has its
   kinetic friction from now on; it is solved again until nobody else breaks away. Friction passes
   its static peak before it drops.
3. If then somebody would move against its own friction, the problem with kinetic levels for all
   decides.

It is solved by block pivoting: all that violate their mode change it at once. Where that makes no
progress, one changes at a time, the last of them, which ends for every matrix of this kind (Murty,
Opsearch 11, 1974; together as Judice and Pires, Computers & Operations Research 21, 1994).

Where contacts close loops, forces of held ones are not unique, but accelerations are: they make
the least of a convex function, in which each contact has its level times its slip acceleration.
It is descended: from all held, the cut that is exceeded most slips, as far as nobody turns, who
is held then, until no cut is exceeded.

With static levels above the kinetic ones the rigid body's answer is not always unique. Decisions
in which letting the worst violator slip at once, and then the next, gives another one are counted.

Impacts at hard stops of one instant are a linear system of impulses: coordinates that strike have
q'+ = -e q'-, those that rest at a stop and would move into it have q'+ = 0, and along all others
the momentum M (q'+ - q'-) is 0. A stop that would have to pull gives no impulse.
"""

import math

from stickslip.engine.kernels import mode_transitions
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector, rare
from stickslip.engine.kernels.contacts import assembly, loops
from stickslip.engine.kernels.equations import combined
from stickslip.engine.kernels.guard_roots import CLOCK

MOST_MOVES = 40
"""Moves of a descent, and as many for each direction and cut: the function that is descended falls
with each, so that no set of modes comes again but by rounding. Random loops of up to ten contacts
took 0.38 at most. If moves run out, the modes at hand are taken: the guard of a level that they
exceed falls at once, and all is decided again.
"""
WAITING = 1
"""A coordinate at rest that is to be decided."""
BROKEN = 2
"""One that slips from now on."""
PATIENCE = 4
"""Trials without fewer violations after which one coordinate is changed at a time."""
STILL = 1e-10
"""Acceleration, over the largest there is, below which what is pushed to its level stays."""
AGAINST = 1e-9
"""The same against its own friction, above which a decision is wrong."""
TOLERATED = 1e-12
"""The same within a problem."""


def violates(i: int, kinetic: bool, tolerance: float, w: Vector, iw: IntVector) -> bool:
    """Whether a coordinate contradicts its mode: holds too much, or is pushed forwards."""
    mode = iw[iw[layout.MODES] + i]
    if mode == layout.HELD_FAST:
        needed = w[iw[layout.NEEDED] + i]
        back = 0 if needed >= 0.0 else 1
        levels = iw[layout.BOUNDS] if kinetic else iw[layout.LEVELS]
        # rounding of the forces of others is no push where the level is 0, say
        own = tolerance * loops.mass_along(i, w, iw)
        own = max(own, assembly.blur(i, w, iw))
        return abs(needed) > w[levels + 2 * i + back] * (1.0 + assembly.WITHIN) + own
    sign = 1.0 if mode > 0 else -1.0
    return sign * combined(i, iw[layout.ACCELERATION], w, iw) < -tolerance


def kinetic_levels(t: float, w: Vector, iw: IntVector) -> None:
    """Write the friction with which each coordinate would begin to slip, in both directions."""
    bounds, values = iw[layout.BOUNDS], iw[layout.LAW_VALUES]
    for i in range(2 * iw[layout.N_DIRECTIONS]):
        w[bounds + i] = 0.0
    for c in range(iw[layout.N_CONTACTS]):
        i = iw[iw[layout.SLIPS] + c]
        if iw[iw[layout.OPEN] + c] or not iw[iw[layout.HOLDS] + c]:
            continue
        factor = w[iw[layout.SLIP_FACTORS] + c]
        mode = iw[iw[layout.MODES] + i]
        iw[iw[layout.MODES] + i] = layout.HELD_FAST  # a law is asked at rest
        for k in range(2):
            side = 1 if (k == 0) == (factor > 0.0) else -1
            assembly.ask_law(c, side, t, w, iw, iw[layout.Y])
            level = w[values] + w[values + 1] * w[iw[layout.LOAD] + c]
            w[bounds + 2 * i + k] += abs(factor) * max(level, 0.0)  # bent bristles may push along
        iw[iw[layout.MODES] + i] = mode
    loops.cut_levels(bounds, w, iw)
    assembly.raise_levels(bounds, w, iw, iw[layout.Y])


def scale_of(w: Vector, iw: IntVector) -> float:
    """Return the largest acceleration at hand, or that a candidate's friction can make."""
    n, scale = iw[layout.N_COORDINATES], 0.0
    # Tolerances are shares of an acceleration: the largest that forces or levels at hand can make.
    for i in range(n):
        scale = max(scale, abs(w[iw[layout.ACCELERATION] + i]))
        if iw[iw[layout.CANDIDATES] + i] == WAITING:
            level = max(
                assembly.finite(w[iw[layout.LEVELS] + 2 * i]),
                assembly.finite(w[iw[layout.LEVELS] + 2 * i + 1]),
            )
            scale = max(scale, level / w[iw[layout.MASS] + i * n + i])
    for cut in range(iw[layout.N_DIRECTIONS], iw[layout.N_PAIRS]):
        level = max(w[iw[layout.LEVELS] + 2 * cut], w[iw[layout.LEVELS] + 2 * cut + 1])
        if level > 0.0:  # one that is none at the values at hand has neither level nor inertia
            scale = max(scale, level / loops.mass_along(cut, w, iw))
    return scale


def boxed(kinetic: bool, fresh: bool, scale: float, w: Vector, iw: IntVector) -> bool:
    """Solve the boxed problem for all that wait, by block pivoting; return whether it is solved.

    `fresh` says that everything is worked out for the modes at hand.

    Where blocks make no progress, one coordinate is changed at a time, the last of those that
    violate their mode (Murty), which comes to an end for a matrix of this kind.
    """
    n, modes, candidates = (
        iw[layout.N_COORDINATES],
        iw[layout.MODES],
        iw[layout.CANDIDATES],
    )
    if iw[layout.N_DIRECTIONS] > n:
        return descend(kinetic, fresh, scale, w, iw)
    fewest, patience = n + 1, PATIENCE
    for trial in range(20 + 20 * n):
        iw[layout.PIVOTINGS] += 1
        if trial > 0 or not fresh:
            assembly.reconsider(w, iw)
        if kinetic:
            kinetic_levels(w[layout.TIME], w, iw)
        count, last = 0, -1
        for i in range(n):
            if iw[candidates + i] == WAITING and violates(i, kinetic, TOLERATED * scale, w, iw):
                count += 1
                last = i
        if count == 0:
            return True
        # Blocks go on as long as they leave fewer violations than ever before.
        patience = PATIENCE if count < fewest else patience - 1
        fewest = min(fewest, count)
        # At the static level one is pushed and may stay; with kinetic friction it slips.
        pushed = layout.FORWARD if kinetic else layout.PUSHED
        for i in range(n):
            chosen = iw[candidates + i] == WAITING and (patience >= 0 or i == last)
            if chosen and violates(i, kinetic, TOLERATED * scale, w, iw):
                if iw[modes + i] == layout.HELD_FAST:
                    iw[modes + i] = pushed if w[iw[layout.NEEDED] + i] > 0.0 else -pushed
                else:
                    iw[modes + i] = layout.HELD_FAST
    return False


@rare
def descend(kinetic: bool, fresh: bool, scale: float, w: Vector, iw: IntVector) -> bool:
    """Solve the boxed problem for all that wait and are held, where contacts close loops.

    Accelerations go towards those of the modes at hand, as far as nothing turns that is pushed: it
    is held then. Where nothing turns, the cut that is exceeded most is let go. The function that
    has its least at the answer falls with each move, so that none comes again.
    """
    n, modes, candidates = (
        iw[layout.N_COORDINATES],
        iw[layout.MODES],
        iw[layout.CANDIDATES],
    )
    now, target = iw[layout.REACHED_SO_FAR], iw[layout.ACCELERATION]
    begun = False
    for trial in range(MOST_MOVES * (1 + iw[layout.N_PAIRS])):
        iw[layout.PIVOTINGS] += 1
        if trial > 0 or not fresh:
            assembly.reconsider(w, iw)
        share, turned = 1.0, -1
        # The largest share of the way on which nothing pushed turns against its push.
        for i in range(iw[layout.N_DIRECTIONS]):
            mode = iw[modes + i]
            if begun and iw[candidates + i] == WAITING and mode != layout.HELD_FAST:
                sign = 1.0 if mode > 0 else -1.0
                before = sign * combined(i, now, w, iw)
                after = sign * combined(i, target, w, iw)
                if after < -TOLERATED * scale and max(before, 0.0) < share * (before - after):
                    share, turned = max(before, 0.0) / (before - after), i
        for j in range(n):
            w[now + j] += share * (w[target + j] - w[now + j]) if begun else 0.0
            if share == 1.0:  # without the rounding of the sum
                w[now + j] = w[target + j]
        begun = True
        if turned >= 0:
            iw[modes + turned] = layout.HELD_FAST
            loops.close_loops(True, w, iw)
            continue
        if kinetic:
            kinetic_levels(w[layout.TIME], w, iw)
        worst = worst_cut(kinetic, scale, w, iw)
        if worst < 0:
            return True
        let_go(worst, layout.FORWARD if kinetic else layout.PUSHED, w, iw)
    return False


def worst_cut(kinetic: bool, scale: float, w: Vector, iw: IntVector) -> int:
    """Return the held coordinate or the cut whose level is exceeded most, or -1."""
    worst, most = -1, 0.0
    levels = iw[layout.BOUNDS] if kinetic else iw[layout.LEVELS]
    for i in range(iw[layout.N_PAIRS]):
        held = iw[iw[layout.MODES] + i] == layout.HELD_FAST and not iw[iw[layout.LOOPED] + i]
        if not held or not violates(i, kinetic, TOLERATED * scale, w, iw):
            continue
        needed = w[iw[layout.NEEDED] + i]
        level = w[levels + 2 * i + (0 if needed >= 0.0 else 1)]
        # as accelerations, so that motions are compared whatever they are a multiple of
        beyond = (abs(needed) - level) / math.sqrt(loops.mass_along(i, w, iw))
        if beyond > most:
            worst, most = i, beyond
    return worst


@rare
def let_go(i: int, pushed: int, w: Vector, iw: IntVector) -> None:
    """Let a held coordinate go, or all that is held and has a part in a cut, as they are pushed."""
    side = 1.0 if w[iw[layout.NEEDED] + i] > 0.0 else -1.0
    if i < iw[layout.N_DIRECTIONS]:
        iw[iw[layout.MODES] + i] = pushed if side > 0.0 else -pushed
        return
    for d in range(iw[layout.N_DIRECTIONS]):
        rate = side * loops.crossing(i, d, w, iw)
        if iw[iw[layout.MODES] + d] == layout.HELD_FAST and rate != 0.0:
            iw[iw[layout.MODES] + d] = pushed if rate > 0.0 else -pushed


def break_away(scale: float, w: Vector, iw: IntVector) -> bool:
    """Let those slip that static levels do not hold, one problem after the other.

    Everything is worked out for the modes at hand, before and after. Returns whether the answer is
    one: nobody moves against its own friction.
    """
    n, modes, candidates = iw[layout.N_DIRECTIONS], iw[layout.MODES], iw[layout.CANDIDATES]
    solved, fresh, more = True, True, 1
    while more > 0:
        solved = boxed(False, fresh, scale, w, iw) and solved
        more = 0
        fresh = True
        if n > iw[layout.N_COORDINATES] and hold_still_ones(scale, w, iw):
            fresh = False
        for i in range(n):
            mode = iw[modes + i]
            if iw[candidates + i] == WAITING and abs(mode) == layout.PUSHED:
                fresh = False
                if abs(combined(i, iw[layout.ACCELERATION], w, iw)) > STILL * scale:
                    iw[modes + i] = layout.FORWARD if mode > 0 else layout.BACKWARD
                    iw[candidates + i] = BROKEN
                    more += 1
                else:
                    iw[modes + i] = layout.HELD_FAST
    if not fresh:
        assembly.reconsider(w, iw)
    for i in range(n):
        if iw[candidates + i] == BROKEN and iw[modes + i] != layout.FREE:
            along = iw[modes + i] * combined(i, iw[layout.ACCELERATION], w, iw)
            solved = solved and not along < -AGAINST * scale
            if n > iw[layout.N_COORDINATES]:  # what cannot move does not slip
                solved = solved and not loops.is_bound(i, w, iw)
    return solved


@rare
def hold_still_ones(scale: float, w: Vector, iw: IntVector) -> bool:
    """Hold what is pushed and does not move, where contacts close loops; return whether any is."""
    result = False
    for i in range(iw[layout.N_DIRECTIONS]):
        pushed = (
            iw[iw[layout.CANDIDATES] + i] == WAITING
            and iw[iw[layout.MODES] + i] != layout.HELD_FAST
        )
        if pushed and abs(combined(i, iw[layout.ACCELERATION], w, iw)) <= STILL * scale:
            iw[iw[layout.MODES] + i] = layout.HELD_FAST
            result = True
    if result:
        loops.close_loops(True, w, iw)
    return result


def one_by_one(w: Vector, iw: IntVector) -> None:
    """Let the worst violator of the static levels slip with kinetic friction, then the next."""
    modes, candidates = iw[layout.MODES], iw[layout.CANDIDATES]
    worst = 0
    while worst >= 0:
        assembly.reconsider(w, iw)
        worst, excess = -1, assembly.WITHIN
        for i in range(iw[layout.N_PAIRS]):
            waits = i >= iw[layout.N_DIRECTIONS] or iw[candidates + i] == WAITING
            waits = waits and not iw[iw[layout.LOOPED] + i]
            if waits and iw[modes + i] == layout.HELD_FAST:
                needed = w[iw[layout.NEEDED] + i]
                level = w[iw[layout.LEVELS] + 2 * i + (0 if needed >= 0.0 else 1)]
                beyond = abs(needed) / level - 1.0 if level > 0.0 else abs(needed)
                if beyond > excess:
                    worst, excess = i, beyond
        if worst >= 0:
            let_go(worst, layout.FORWARD, w, iw)


def begin_decision(iw: IntVector) -> int:
    """Set the candidates back: forced ones slip, others are held. Return how many wait."""
    waiting = 0
    for i in range(iw[layout.N_DIRECTIONS]):
        if iw[iw[layout.CANDIDATES] + i] != 0:
            forced = iw[iw[layout.FORCED] + i]
            iw[iw[layout.MODES] + i] = forced
            iw[iw[layout.CANDIDATES] + i] = WAITING if forced == 0 else BROKEN
            waiting += 1 if forced == 0 else 0
    return waiting


def is_ambiguous(w: Vector, iw: IntVector) -> bool:
    """Whether letting the worst violator slip first gives another answer than the one at hand."""
    n, modes, kept = iw[layout.N_DIRECTIONS], iw[layout.MODES], iw[layout.KEPT]
    # Whatever the trial gives, the answer at hand is put back.
    for i in range(n):
        iw[kept + i] = iw[modes + i]
    begin_decision(iw)
    one_by_one(w, iw)
    differs = False
    for i in range(n):
        differs = differs or iw[modes + i] != iw[kept + i]
        iw[modes + i] = iw[kept + i]
    assembly.reconsider(w, iw)
    return differs


def decide(w: Vector, iw: IntVector) -> bool:
    """Decide all candidates; return whether there is an answer.

    A candidate, not 0 in CANDIDATES, is at rest. FORCED has the direction of one whose break-away
    has been reached, and 0 otherwise. As the time is rounded, that may be after it: forces and
    loads are those that little later. Accelerations and all else are left as those of the answer at
    the time itself.
    """
    now = w[layout.TIME]
    waiting, broken = begin_decision(iw), 0
    for i in range(iw[layout.N_DIRECTIONS]):
        broken += 1 if iw[iw[layout.CANDIDATES] + i] == BROKEN else 0
    if waiting == 0 and broken < 2:  # of several, one may push another back
        assembly.refresh(now, w, iw, iw[layout.Y])
        return True
    if broken > 0:
        w[layout.TIME] = now + CLOCK * max(now, w[layout.LENGTH])
    t = w[layout.TIME]
    assembly.refresh(t, w, iw, iw[layout.Y])
    scale = scale_of(w, iw)
    iw[layout.DECISIONS] += 1
    solved = break_away(scale, w, iw)
    if not solved:
        # Somebody would move against its own friction: all are decided anew, with kinetic levels.
        for i in range(iw[layout.N_DIRECTIONS]):
            if iw[iw[layout.CANDIDATES] + i] != 0:
                iw[iw[layout.CANDIDATES] + i] = WAITING
                iw[iw[layout.MODES] + i] = layout.HELD_FAST
        solved = boxed(True, False, scale, w, iw)
        if iw[layout.N_DIRECTIONS] > iw[layout.N_COORDINATES] and hold_still_ones(scale, w, iw):
            assembly.reconsider(w, iw)
    moved = 0
    for i in range(iw[layout.N_DIRECTIONS]):
        if iw[iw[layout.CANDIDATES] + i] != 0 and iw[iw[layout.MODES] + i] != layout.HELD_FAST:
            moved += 1
    coupled = (
        not iw[layout.DIAGONAL] or iw[layout.N_REACTIONS] > 0
    )  # else each is decided by itself
    if coupled and solved and waiting > 1 and moved > 0 and is_ambiguous(w, iw):
        iw[layout.AMBIGUOUS] += 1
    if t > now:
        w[layout.TIME] = now
        assembly.refresh(now, w, iw, iw[layout.Y])
    return solved


# Impacts at hard stops where several contacts rub: those of one instant are solved together.
#
# Each stop that a coordinate reaches gives it an impulse, after which its speed is that before
# times the restitution, away from the stop. A coordinate that rests at its stop gets one too, if it
# would else move into it. All other rates follow by the mass matrix: what friction holds is no
# exception, for a bounded force does nothing in no time.

STRIKES = 2
"""A coordinate that reaches its stop."""
RESTS = 1
"""One that is at its stop already and would move into it."""
AT_ONCE = 1e-13
"""Distance from a stop, over the largest so far, below which it is reached in the instant too."""


def strike_stops(guard: int, w: Vector, iw: IntVector) -> None:
    """Change all rates by the impacts of an instant.

    STRUCK tells then which coordinates have reached a stop: 2.
    """
    n, y, change = iw[layout.N_COORDINATES], iw[layout.Y], iw[layout.BOUNDS]
    first = iw[layout.FIRST_WALL]
    for i in range(n):
        iw[iw[layout.STRUCK] + i] = 0
        w[change + i] = 0.0
    for wall in range(iw[layout.N_WALLS]):
        reach = AT_ONCE * w[iw[layout.REACHED] + first + wall]
        meets = (
            assembly.margin_of(wall, w, iw, y) <= reach
            and mode_transitions.approach(first + wall, w, iw) > 0.0
        )
        if first + wall == guard or meets:
            i = mode_transitions.wall_coordinate(wall, iw)
            w[y + i] = w[iw[layout.WALLS] + wall * iw[layout.WALL_COLUMNS]]
            iw[iw[layout.STRUCK] + i] = STRIKES
    assembly.refresh(w[layout.TIME], w, iw, y)
    for wall in range(iw[layout.N_WALLS]):
        i = mode_transitions.wall_coordinate(wall, iw)
        if iw[iw[layout.STRUCK] + i] == STRIKES and assembly.margin_of(wall, w, iw, y) == 0.0:
            # Those that stand beside a stop within rounding were put onto it: they rebound, too.
            rebound = restitution_of(wall, w, iw)
            w[change + i] = -(1.0 + rebound) * w[y + n + i]
    before = mode_transitions.energy_now(w, iw)
    share_impulses(w, iw)
    book_impacts(w, iw)
    for i in range(n):
        # What rests at its stop must keep rate 0 to the last bit.
        rate = w[y + n + i] + w[change + i]
        w[y + n + i] = 0.0 if iw[iw[layout.STRUCK] + i] == RESTS else rate
    if iw[layout.N_CHANNELS] > 0 and iw[layout.BOOKS] and iw[layout.STEPS] > 0:
        w[layout.SUPPLIED] += (
            mode_transitions.energy_now(w, iw) - before
        )  # with what is lost, what the guides have done


def restitution_of(wall: int, w: Vector, iw: IntVector) -> float:
    """Return the restitution of an impact, 0 where it is so slow that the coordinate stays.

    Everything is worked out for the modes at hand, before and after. What is not pressed while
    others are held may be while they slip: each impact lets these go, and the bounces end.
    """
    y, modes = iw[layout.Y], iw[layout.MODES]
    i, side = mode_transitions.wall_coordinate(wall, iw), mode_transitions.wall_side(wall, iw)
    at = iw[layout.WALLS] + wall * iw[layout.WALL_COLUMNS]
    restitution = w[at + 1]
    push = side * w[iw[layout.ACCELERATION] + i]
    size = w[iw[layout.SCALE] + iw[layout.N_COORDINATES] + i]
    if mode_transitions.approach(
        iw[layout.FIRST_WALL] + wall, w, iw
    ) > mode_transitions.resting_speed(w[layout.TIME], size, push, w[at], restitution):
        return restitution
    for j in range(iw[layout.N_DIRECTIONS]):
        iw[iw[layout.KEPT] + j] = iw[modes + j]
    pressed = is_pressed(i, side, w, iw)
    if not pressed:
        let_others_go(i, side, w, iw)
        pressed = is_pressed(i, side, w, iw)
    for j in range(iw[layout.N_DIRECTIONS]):
        iw[modes + j] = iw[iw[layout.KEPT] + j]
    assembly.refresh(w[layout.TIME], w, iw, y)
    return 0.0 if pressed else restitution


def is_pressed(i: int, side: int, w: Vector, iw: IntVector) -> bool:
    """Whether a coordinate that is held at its stop would be pressed against it."""
    iw[iw[layout.MODES] + i] = layout.HELD_FAST
    assembly.refresh(w[layout.TIME], w, iw, iw[layout.Y])
    # Friction helps to hold it: to leave, the force off the stop must exceed the level that way.
    level = assembly.finite(w[iw[layout.LEVELS] + 2 * i + (1 if side > 0 else 0)])
    return side * w[iw[layout.NEEDED] + i] + level > 0.0


def let_others_go(i: int, side: int, w: Vector, iw: IntVector) -> None:
    """Let what is held slip as the impact of a coordinate moves it, whose rate it reduces."""
    n, modes, result = iw[layout.N_COORDINATES], iw[layout.MODES], iw[layout.ACCELERATION]
    for j in range(n):
        iw[modes + j] = layout.FREE if j != i else layout.HELD_FAST
    if not iw[layout.DIAGONAL]:
        assembly.factorise(w, iw)
    for j in range(n):
        w[result + j] = side * w[iw[layout.MASS] + j * n + i] if j != i else 0.0
    assembly.solve_free(w, iw, result)
    for j in range(n):
        iw[modes + j] = iw[iw[layout.KEPT] + j]
        if j != i and iw[modes + j] == layout.HELD_FAST and w[result + j] != 0.0:
            iw[modes + j] = layout.FORWARD if w[result + j] > 0.0 else layout.BACKWARD


def share_impulses(w: Vector, iw: IntVector) -> None:
    """Write the changes of all rates, from those of the coordinates that meet their stops.

    A stop that would have to pull gives no impulse; one at which a coordinate rests gives one where
    that would else move into it. Factors and accelerations are those of the impacts afterwards: a
    decision has to follow.
    """
    n, y, change, struck = (
        iw[layout.N_COORDINATES],
        iw[layout.Y],
        iw[layout.BOUNDS],
        iw[layout.STRUCK],
    )
    if not iw[layout.CONSTANT_MASS]:
        assembly.put_mass(w[layout.TIME], w, iw, y)
    for i in range(n):
        iw[iw[layout.KEPT] + i] = iw[iw[layout.MODES] + i]
    for _ in range(2 * iw[layout.N_WALLS]):
        follow(w, iw)
        settled = True
        for i in range(n):
            side = assembly.stopped_side(i, w, iw, y)
            if side == 0:
                continue
            if iw[struck + i] == 0 and side * (w[y + n + i] + w[change + i]) > 0.0:
                iw[struck + i] = RESTS
                w[change + i] = -w[y + n + i]
                settled = False
            # An impulse towards the stop would be a pull, which no stop gives.
            elif iw[struck + i] == RESTS and side * impulse(i, w, iw) > 0.0:
                iw[struck + i] = 0
                settled = False
        if settled:
            break
    for i in range(n):
        iw[iw[layout.MODES] + i] = iw[iw[layout.KEPT] + i]


def follow(w: Vector, iw: IntVector) -> None:
    """Write the changes of the rates that no stop gives: momentum along them stays."""
    n, change, result = iw[layout.N_COORDINATES], iw[layout.BOUNDS], iw[layout.ACCELERATION]
    # Struck coordinates are given, others keep their momentum: the solver for held and free ones
    # does.
    for i in range(n):
        iw[iw[layout.MODES] + i] = (
            layout.FREE if iw[iw[layout.STRUCK] + i] == 0 else layout.HELD_FAST
        )
    if not iw[layout.DIAGONAL]:
        assembly.factorise(w, iw)
    for i in range(n):
        w[result + i] = 0.0
        for j in range(n):
            if iw[iw[layout.STRUCK] + j] != 0 and j != i:
                w[result + i] -= w[iw[layout.MASS] + i * n + j] * w[change + j]
    assembly.solve_free(w, iw, result)
    for i in range(n):
        if iw[iw[layout.STRUCK] + i] == 0:
            w[change + i] = w[result + i]


def impulse(i: int, w: Vector, iw: IntVector) -> float:
    """Return the impulse along a coordinate that the changes of the rates take."""
    n, total = iw[layout.N_COORDINATES], 0.0
    for j in range(n):
        total += w[iw[layout.MASS] + i * n + j] * w[iw[layout.BOUNDS] + j]
    return total


def book_impacts(w: Vector, iw: IntVector) -> None:
    """Book what the stops take; books open after what happens as a run begins."""
    n, y, change = iw[layout.N_COORDINATES], iw[layout.Y], iw[layout.BOUNDS]
    if not iw[layout.BOOKS] or iw[layout.STEPS] == 0:
        return
    lost = 0.0
    for i in range(n):
        if iw[iw[layout.STRUCK] + i] != 0:
            # An impulse does its work at the mean of the rates before and after it.
            mean = w[y + n + i] + 0.5 * w[change + i]
            lost -= impulse(i, w, iw) * mean
    w[layout.LOST] += lost
    w[layout.GROSS] += lost
    if iw[layout.N_CHANNELS] > 0:
        w[layout.SUPPLIED] += lost
