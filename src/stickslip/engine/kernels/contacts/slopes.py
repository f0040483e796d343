"""Derivatives of what holds at a state with several contacts, along one variable at a time.

Variables v are the states, time and, where the equations have them, the numbers of the drives and
the parameters. The residual M a - h + W F of the equations of motion vanishes whatever they are,
and so does its derivative,

    M da = -d(M a - h)|_a - dW F - W dF,        dF = d(a_c + b_c N_c):

accelerations change by the solution of a system with the same mass matrix, of the free coordinates
alone (`respond`), and needed friction by what is left of held rows. Loads that are reactions change
by the equations that give them, as in `assembly.react`: without and at a unit of each
(`react_along`). Slopes of parts come sparse from the generated equations, column by column; those
of laws along slip speed, load, inputs, bristles and parameters, by the chain rule (`law_slope`).

Rates after an impact have slopes too. The changes c of the rates keep the momentum M c = 0 of all
coordinates that no stop holds, so that M dc = -dM c along these, where dM c is the difference of
the parts' slopes with c in place of a, and without. Along a stop that is struck the change is
-(1 + e) q', whose slope is that of q' and of the restitution e (`impact_slopes_along`).
"""

from stickslip.engine.kernels import equations
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector
from stickslip.engine.kernels.contacts import assembly
from stickslip.engine.kernels.contacts.loops import cut_levels
from stickslip.engine.kernels.contacts.motion import first_contact_guard, first_own_switch, watches
from stickslip.engine.kernels.mode_transitions import approach, wall_coordinate, wall_side


def prepare_slopes(t: float, w: Vector, iw: IntVector, at: int) -> None:
    """Write what the slopes along all variables are made of."""
    assembly.assemble(t, w, iw, at)
    assembly.put_motion(w, iw, at)
    equations.evaluate(
        equations.PART_SLOPES_OF,
        0,
        iw[layout.FLAGS],
        t,
        w,
        iw[layout.MOTION_POINT],
        iw[layout.PART_SLOPES],
    )
    for c in range(iw[layout.N_CONTACTS]):
        if not iw[iw[layout.OPEN] + c]:
            ask_slopes(c, t, w, iw, at)


def ask_slopes(contact: int, t: float, w: Vector, iw: IntVector, at: int) -> None:
    """Write the slopes of a contact's law in both directions, then those of its margins."""
    kind, flags = iw[iw[layout.KINDS] + contact], iw[iw[layout.LAW_FLAGS] + contact]
    room = iw[layout.LAW_SLOPE_ROOM]
    place = iw[layout.LAW_SLOPES] + 3 * contact * room
    side = assembly.side_of(contact, w, iw, at)
    row = assembly.set_row(contact, side, w, iw, at)
    equations.evaluate(equations.LAW_SLOPES_OF + kind, side, flags, t, w, row, place)
    if iw[iw[layout.DIRECTIONAL] + contact]:
        equations.evaluate(equations.LAW_SLOPES_OF + kind, -side, flags, t, w, row, place + room)
    else:
        # A law that is alike in both directions has one set of slopes.
        for k in range((4 + iw[iw[layout.BRISTLE_COUNTS] + contact]) * variables_of(contact, iw)):
            w[place + room + k] = w[place + k]
    if iw[layout.LAW_SWITCHES] > 0:
        equations.evaluate(
            equations.LAW_MARGIN_SLOPES + kind, side, flags, t, w, row, place + 2 * room
        )


def variables_of(contact: int, iw: IntVector) -> int:
    """Return along how many variables a contact's law has slopes."""
    return iw[iw[layout.LAW_BRISTLES] + contact] + iw[iw[layout.BRISTLE_COUNTS] + contact] + 1


def law_slope(contact: int, back: int, which: int, k: int, w: Vector, iw: IntVector) -> float:
    """Return the slope of a number of a contact's law along a variable, at a given load.

    `which` is 0 and 1 for constant and factor of friction, 2 and 3 for those of the level, and from
    4 on the rates of its bristles; `back` is 1 for the direction against which it slips.
    """
    wide = variables_of(contact, iw)
    row = iw[layout.LAW_SLOPES] + (3 * contact + back) * iw[layout.LAW_SLOPE_ROOM] + which * wide
    # Rates of bristles depend on the load by themselves; friction and levels have it outside.
    own = w[row + wide - 1] if which >= 4 else 0.0
    return own * w[iw[layout.LOAD_SLOPES] + contact] + own_slope(contact, row, k, w, iw)


def margin_slope(contact: int, which: int, k: int, w: Vector, iw: IntVector) -> float:
    """Return the slope of the margin of a switch of a contact's law along a variable."""
    wide = variables_of(contact, iw)
    room = iw[layout.LAW_SLOPES] + (3 * contact + 2) * iw[layout.LAW_SLOPE_ROOM]
    row = room + which * wide
    by_load = w[row + wide - 1] * w[iw[layout.LOAD_SLOPES] + contact]
    return by_load + own_slope(contact, row, k, w, iw)


def own_slope(contact: int, at: int, k: int, w: Vector, iw: IntVector) -> float:
    """Return a slope along a variable from those along what stands in the row of a law."""
    n, bristle = iw[layout.N_COORDINATES], iw[iw[layout.BRISTLES] + contact]
    total = 0.0  # by the chain rule along bristles, inputs, parameters and slip speed
    if bristle >= 0:
        first = 2 * n + bristle
        if first <= k < first + iw[iw[layout.BRISTLE_COUNTS] + contact]:
            total += w[at + iw[iw[layout.LAW_BRISTLES] + contact] + k - first]
    inputs, own_inputs = (
        iw[iw[layout.INPUT_COUNTS] + contact],
        iw[iw[layout.INPUTS] + contact],
    )
    for i in range(inputs):
        slope = w[iw[layout.PART_COLUMN] + inputs_of_column(iw) + own_inputs + i]
        total += w[at + iw[iw[layout.LAW_BRISTLES] + contact] - inputs + i] * slope
    place = iw[iw[layout.VARIABLE_PLACES] + k] - iw[iw[layout.LAW_ROWS] + contact]
    if 0 < place < iw[iw[layout.LAW_BRISTLES] + contact]:
        total += w[at + place]
    # What is held has slip speed 0, whatever the variable is.
    if iw[iw[layout.MODES] + iw[iw[layout.SLIPS] + contact]] != layout.HELD_FAST:
        total += w[at] * speed_slope(contact, k, w, iw)
    return total


def speed_slope(contact: int, k: int, w: Vector, iw: IntVector) -> float:
    """Return the slope of a contact's slip speed along a variable."""
    n, i = iw[layout.N_COORDINATES], iw[iw[layout.SLIPS] + contact]
    rate = equations.slip_rate_along(i, iw[layout.MOTION_POINT], w, iw)
    # The product rule: slip factors change with parameters, rates with states.
    slope = factor_slope(contact, w, iw) * rate
    if n <= k < 2 * n:
        slope += equations.factor_of(i, k - n, w, iw) * w[iw[layout.SLIP_FACTORS] + contact]
    return assembly.side_of(contact, w, iw, iw[layout.MOTION_POINT]) * slope


def factor_slope(contact: int, w: Vector, iw: IntVector) -> float:
    """Return the slope of a contact's slip factor along the variable at hand."""
    first = iw[layout.N_COORDINATES] + iw[layout.N_HELD] + iw[layout.N_CONTACTS]
    return w[iw[layout.PART_COLUMN] + first + contact]


def is_rigid(contact: int, iw: IntVector) -> bool:
    """Whether a contact is held by its law: its friction is what is needed."""
    held = iw[iw[layout.MODES] + iw[iw[layout.SLIPS] + contact]] == layout.HELD_FAST
    return held and iw[iw[layout.HOLDS] + contact] == 1


def along(k: int, w: Vector, iw: IntVector) -> None:
    """Write the slopes along a variable of accelerations, forces, levels and rates of bristles."""
    column = iw[layout.PART_COLUMN]
    n, held, contacts = iw[layout.N_COORDINATES], iw[layout.N_HELD], iw[layout.N_CONTACTS]
    part_column(k, w, iw)
    for c in range(contacts):
        w[iw[layout.LOAD_SLOPES] + c] = w[column + n + held + c]
    if iw[layout.N_REACTIONS] > 0:
        react_along(k, w, iw)
    respond(k, w, iw)
    for i in range(2 * iw[layout.N_DIRECTIONS]):
        w[iw[layout.LEVEL_SLOPES] + i] = 0.0
    for c in range(contacts):
        if not iw[iw[layout.OPEN] + c]:
            add_levels(c, k, w, iw)
            for b in range(iw[iw[layout.BRISTLE_COUNTS] + c]):
                place = iw[layout.BRISTLE_SLOPES] + iw[iw[layout.BRISTLES] + c] + b
                w[place] = law_slope(c, 0, 4 + b, k, w, iw) if assembly.bends(c, iw) else 0.0
    if iw[layout.N_DIRECTIONS] > n:
        cut_levels(iw[layout.LEVEL_SLOPES], w, iw)


def part_column(k: int, w: Vector, iw: IntVector) -> None:
    """Write the slopes of all parts along a variable."""
    column = iw[layout.PART_COLUMN]
    for i in range(inputs_of_column(iw) + iw[layout.N_INPUTS]):
        w[column + i] = 0.0
    for j in range(iw[iw[layout.PART_STARTS] + k], iw[iw[layout.PART_STARTS] + k + 1]):
        w[column + iw[iw[layout.PART_ROWS] + j]] = w[iw[layout.PART_SLOPES] + j]


def stops_of_column(iw: IntVector) -> int:
    """Return the first row of the parts that is of a hard stop; margins of switches end there."""
    held, contacts = iw[layout.N_HELD], iw[layout.N_CONTACTS]
    return iw[layout.N_COORDINATES] + held + 2 * contacts * (1 + held) + iw[layout.N_SWITCHES]


def inputs_of_column(iw: IntVector) -> int:
    """Return the first row of the parts that is a contact input; hard stops end there."""
    return stops_of_column(iw) + iw[layout.N_WALLS] * iw[layout.WALL_COLUMNS]


def respond(k: int, w: Vector, iw: IntVector) -> None:
    """Write the slopes of friction, accelerations and needed friction for given ones of loads."""
    n, column, mass = iw[layout.N_COORDINATES], iw[layout.PART_COLUMN], iw[layout.MASS]
    result, needed = iw[layout.ACCELERATION_SLOPES], iw[layout.NEEDED_SLOPES]
    # Slopes of the parts are those of M a - h; forces gain their negative.
    for i in range(n):
        w[result + i] = -w[column + i]
    for c in range(iw[layout.N_CONTACTS]):
        slope = 0.0
        if not iw[iw[layout.OPEN] + c] and not is_rigid(c, iw):
            slope = friction_slope(c, k, w, iw)
            i = iw[iw[layout.SLIPS] + c]
            own = sliding_friction(c, w, iw)
            grows = w[iw[layout.SLIP_FACTORS] + c] * slope + factor_slope(c, w, iw) * own
            equations.spread(i, grows, result, w, iw)
        # Of a rigid contact the rows below give what it needs.
        w[iw[layout.FRICTION_SLOPES] + c] = slope
    for i in range(n):
        w[needed + i] = w[result + i]
    assembly.solve_free(w, iw, result)
    for i in range(n):
        # What loops hold is read along their cuts, of which held parts must still be there.
        if iw[iw[layout.MODES] + i] != layout.HELD_FAST and not iw[iw[layout.LOOPED] + i]:
            w[needed + i] = 0.0
        elif not iw[layout.DIAGONAL]:
            for j in range(n):
                w[needed + i] -= w[mass + i * n + j] * w[result + j]
    for cut in range(iw[layout.N_DIRECTIONS], iw[layout.N_PAIRS]):
        w[needed + cut] = equations.combined(cut, needed, w, iw)


def friction_slope(contact: int, k: int, w: Vector, iw: IntVector) -> float:
    """Return the slope of the friction of a contact that slips, or that has bristles."""
    i = iw[iw[layout.SLIPS] + contact]
    slips = iw[iw[layout.MODES] + i] in (layout.FORWARD, layout.BACKWARD)
    if not slips and iw[iw[layout.BRISTLES] + contact] < 0:
        return 0.0
    load = w[iw[layout.LOAD] + contact]
    # Friction a + b N: slopes of a and b at the load at hand, then b times that of the load.
    own = law_slope(contact, 0, 0, k, w, iw) + load * law_slope(contact, 0, 1, k, w, iw)
    side = assembly.side_of(contact, w, iw, iw[layout.MOTION_POINT])
    return (
        side * own + w[iw[layout.FRICTION_FACTOR] + contact] * w[iw[layout.LOAD_SLOPES] + contact]
    )


def add_levels(contact: int, k: int, w: Vector, iw: IntVector) -> None:
    """Add the slopes of a contact's levels to those of its coordinate."""
    if not iw[iw[layout.HOLDS] + contact]:
        return
    factor, load = w[iw[layout.SLIP_FACTORS] + contact], w[iw[layout.LOAD] + contact]
    ahead = 0 if assembly.side_of(contact, w, iw, iw[layout.MOTION_POINT]) > 0 else 1
    for which in range(2):
        back = 0 if which == ahead else 1
        place = 2 * contact + which
        level = w[iw[layout.LEVEL_CONSTANT] + place] + w[iw[layout.LEVEL_FACTOR] + place] * load
        slope = law_slope(contact, back, 2, k, w, iw)
        slope += load * law_slope(contact, back, 3, k, w, iw)
        slope += w[iw[layout.LEVEL_FACTOR] + place] * w[iw[layout.LOAD_SLOPES] + contact]
        grows = factor_slope(contact, w, iw) * (1.0 if factor > 0.0 else -1.0)
        to = which if factor > 0.0 else 1 - which
        row = iw[layout.LEVEL_SLOPES] + 2 * iw[iw[layout.SLIPS] + contact] + to
        w[row] += abs(factor) * slope + grows * level


def shared_slope(contact: int, w: Vector, iw: IntVector) -> float:
    """Return the slope of the part that a held contact has of the needed friction."""
    i, factor = iw[iw[layout.SLIPS] + contact], w[iw[layout.SLIP_FACTORS] + contact]
    # The part is the needed friction over the slip factor: the quotient rule.
    part = w[iw[layout.NEEDED] + i] / factor
    change = w[iw[layout.NEEDED_SLOPES] + i] - part * factor_slope(contact, w, iw)
    return assembly.equal_part(contact, change, w, iw)


def shared_part(contact: int, w: Vector, iw: IntVector) -> float:
    """Return the part that a held contact has of the needed friction, or what slides there."""
    if is_rigid(contact, iw):
        return assembly.equal_part(
            contact, w[iw[layout.NEEDED] + iw[iw[layout.SLIPS] + contact]], w, iw
        )
    return sliding_friction(contact, w, iw)


def sliding_friction(contact: int, w: Vector, iw: IntVector) -> float:
    """Return the friction of a contact that slips, or that has bristles."""
    factor, load = w[iw[layout.FRICTION_FACTOR] + contact], w[iw[layout.LOAD] + contact]
    return w[iw[layout.FRICTION_CONSTANT] + contact] + factor * load


def surplus_slope(row: int, w: Vector, iw: IntVector) -> float:
    """Return the slope of the force that a held coordinate needs beside those that act on it."""
    n, held, contacts = iw[layout.N_COORDINATES], iw[layout.N_HELD], iw[layout.N_CONTACTS]
    slips = iw[layout.PART_COLUMN] + n + held + 2 * contacts
    normals = slips + contacts * held
    total = w[iw[layout.PART_COLUMN] + n + row]
    for i in range(n):
        total += w[iw[layout.MASS] + (n + row) * n + i] * w[iw[layout.ACCELERATION_SLOPES] + i]
    for c in range(contacts):
        if iw[iw[layout.OPEN] + c]:
            continue
        slope = w[iw[layout.FRICTION_SLOPES] + c]
        if is_rigid(c, iw):
            slope = shared_slope(c, w, iw)
        total += w[iw[layout.HELD_SLIPS] + c * held + row] * slope
        total += w[slips + c * held + row] * shared_part(c, w, iw)
        if iw[iw[layout.REACTS] + c]:
            # Loads act by their normals, which may turn with the variable.
            total -= w[normals + c * held + row] * w[iw[layout.LOAD] + c]
    return total


def react_along(k: int, w: Vector, iw: IntVector) -> None:
    """Write the slopes of the loads that are reactions."""
    # The same equations as those of the reactions themselves: `assembly.react`.
    for trial in range(iw[layout.N_REACTIONS] + 1):
        assembly.put_loads(trial - 1, iw[layout.LOAD_SLOPES], w, iw)
        respond(k, w, iw)
        for row in range(iw[layout.N_REACTIONS]):
            assembly.note_surplus(trial, row, surplus_slope(row, w, iw), w, iw)
    assembly.balance(iw[layout.LOAD_SLOPES], w, iw)


def rate_slopes_along(
    first: int, count: int, t: float, w: Vector, iw: IntVector, at: int, to: int
) -> None:
    """Write the slopes of the time derivatives of all states along some variables."""
    n, states = iw[layout.N_COORDINATES], iw[layout.N_STATES]
    prepare_slopes(t, w, iw, at)
    for j in range(count):
        k = first + j
        along(k, w, iw)
        for i in range(n):
            # A place changes as its rate does, unless that is held.
            moves = k == n + i and iw[iw[layout.MODES] + i] != layout.HELD_FAST
            w[to + i * count + j] = 1.0 if moves else 0.0
            w[to + (n + i) * count + j] = w[iw[layout.ACCELERATION_SLOPES] + i]
        for b in range(states - 2 * n):
            w[to + (2 * n + b) * count + j] = w[iw[layout.BRISTLE_SLOPES] + b]


def guard_slopes_along(
    first: int, count: int, t: float, w: Vector, iw: IntVector, at: int, to: int
) -> None:
    """Write the slopes of all guards along some variables."""
    n, contacts = iw[layout.N_COORDINATES], iw[layout.N_CONTACTS]
    wide = iw[layout.LAW_SWITCHES] + 1
    prepare_slopes(t, w, iw, at)
    for i in range(iw[layout.N_GUARDS] * count):
        w[to + i] = 0.0
    for j in range(count):
        k = first + j
        along(k, w, iw)
        for i in range(iw[layout.N_PAIRS]):
            mode = iw[iw[layout.MODES] + i]
            if mode in (layout.FORWARD, layout.BACKWARD):
                if n <= k < 2 * n:
                    w[to + 2 * i * count + j] = mode * equations.factor_of(i, k - n, w, iw)
            elif mode == layout.HELD_FAST and not iw[iw[layout.LOOPED] + i]:
                needed = w[iw[layout.NEEDED_SLOPES] + i]
                levels = iw[layout.LEVEL_SLOPES] + 2 * i
                w[to + 2 * i * count + j] = w[levels] - needed
                w[to + (2 * i + 1) * count + j] = w[levels + 1] + needed
        for c in range(contacts):
            row = first_contact_guard(iw) + c * wide + iw[layout.LAW_SWITCHES]
            if not iw[layout.CONSTANT_LOADS] or iw[iw[layout.REACTS] + c]:
                load = w[iw[layout.LOAD_SLOPES] + c]
                w[to + row * count + j] = -load if iw[iw[layout.OPEN] + c] else load
            if watches(c, iw[iw[layout.MODES] + iw[iw[layout.SLIPS] + c]], iw):
                for s in range(iw[layout.LAW_SWITCHES]):
                    # A guard is the margin of a switch that is on, and its negative of one that is
                    # off.
                    sign = 1.0 if iw[iw[layout.LAW_FLAGS] + c] & (1 << s) else -1.0
                    slope = margin_slope(c, s, k, w, iw)
                    w[to + (row - iw[layout.LAW_SWITCHES] + s) * count + j] = sign * slope
        margins = iw[layout.PART_COLUMN] + stops_of_column(iw) - iw[layout.N_SWITCHES]
        for s in range(iw[layout.N_SWITCHES]):
            sign = 1.0 if iw[layout.FLAGS] & (1 << s) else -1.0
            w[to + (first_own_switch(iw) + s) * count + j] = sign * w[margins + s]
        stop_slopes(k, to + j, count, w, iw)


def stop_slopes(k: int, to: int, stride: int, w: Vector, iw: IntVector) -> None:
    """Write the slopes of the distances from hard stops along the variable at hand."""
    stops = iw[layout.PART_COLUMN] + stops_of_column(iw)
    for wall in range(iw[layout.N_WALLS]):
        moves = 1.0 if k == wall_coordinate(wall, iw) else 0.0
        slope = w[stops + wall * iw[layout.WALL_COLUMNS]] - moves
        w[to + (iw[layout.FIRST_WALL] + wall) * stride] = wall_side(wall, iw) * slope


def impact_slopes_along(
    first: int, count: int, t: float, w: Vector, iw: IntVector, at: int, to: int
) -> None:
    """Write the slopes of all rates after the impacts of an instant along some variables.

    STRUCK is not 0 where a coordinate is stopped: it is 1 where it comes to rest. BOUNDS has what
    the rates change by. The momentum of all other coordinates stays, whatever the variables are.
    """
    n, change, point = iw[layout.N_COORDINATES], iw[layout.BOUNDS], iw[layout.MOTION_POINT]
    for i in range(n):
        iw[iw[layout.KEPT] + i] = iw[iw[layout.MODES] + i]
        if w[change + i] == -w[at + n + i] and assembly.stopped_side(i, w, iw, at) != 0:
            iw[iw[layout.STRUCK] + i] = 1
        # Struck coordinates are given, all others keep their momentum: held and free ones, so to
        # speak.
        iw[iw[layout.MODES] + i] = (
            layout.FREE if iw[iw[layout.STRUCK] + i] == 0 else layout.HELD_FAST
        )
    assembly.put_mass(t, w, iw, at)
    if not iw[layout.DIAGONAL]:
        assembly.factorise(w, iw)
    for i in range(iw[layout.N_STATES]):
        w[point + i] = w[at + i]
    for i in range(n * count):
        w[to + i] = 0.0
    for trial in range(2):  # of M a - h with and without the changes: what the mass matrix adds
        for i in range(n):
            w[point + iw[layout.N_STATES] + i] = w[change + i] if trial == 0 else 0.0
        equations.evaluate(
            equations.PART_SLOPES_OF, 0, iw[layout.FLAGS], t, w, point, iw[layout.PART_SLOPES]
        )
        for j in range(count):
            part_column(first + j, w, iw)
            for i in range(n):
                slope = w[iw[layout.PART_COLUMN] + i]
                w[to + i * count + j] += slope if trial == 1 else -slope
    for j in range(count):
        part_column(first + j, w, iw)
        respond_to_impact(first + j, to + j, count, w, iw, at)
    for i in range(n):
        iw[iw[layout.MODES] + i] = iw[iw[layout.KEPT] + i]


def respond_to_impact(k: int, to: int, stride: int, w: Vector, iw: IntVector, at: int) -> None:
    """Write the slopes of all rates after impacts along a variable, from those of the momenta."""
    n, result, given = (
        iw[layout.N_COORDINATES],
        iw[layout.ACCELERATION_SLOPES],
        iw[layout.NEEDED_SLOPES],
    )
    stops = iw[layout.PART_COLUMN] + stops_of_column(iw)
    for i in range(n):
        w[result + i] = w[to + i * stride]
        # The factor of the rate before it in its change, -1 for what comes to rest.
        w[given + i] = -1.0 if k == n + i and iw[iw[layout.STRUCK] + i] != 0 else 0.0
    for wall in range(iw[layout.N_WALLS]):
        i, columns = wall_coordinate(wall, iw), iw[layout.WALL_COLUMNS]
        if iw[iw[layout.STRUCK] + i] > 1 and approach(iw[layout.FIRST_WALL] + wall, w, iw) > 0.0:
            w[given + i] *= 1.0 + w[iw[layout.WALLS] + wall * columns + 1]
            w[given + i] -= w[stops + wall * columns + 1] * w[at + n + i]
    for i in range(n):
        for j in range(n):
            # Given changes act on the others by the coupling of the masses alone.
            if iw[iw[layout.STRUCK] + j] != 0 and j != i:
                w[result + i] -= w[iw[layout.MASS] + i * n + j] * w[given + j]
    assembly.solve_free(w, iw, result)
    for i in range(n):
        own = w[given + i] if iw[iw[layout.STRUCK] + i] != 0 else w[result + i]
        w[to + i * stride] = own + (1.0 if k == n + i else 0.0)
