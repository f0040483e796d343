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
from stickslip.engine.kernels.backend import Vector, Wholes
from stickslip.engine.kernels.contacts import assembly
from stickslip.engine.kernels.contacts.loops import cut_levels
from stickslip.engine.kernels.contacts.motion import first_contact_guard, first_own_switch, watches
from stickslip.engine.kernels.mode_transitions import approach, wall_coordinate, wall_side


def prepare_slopes(t: float, w: Vector, whole: Wholes, at: int) -> None:
    """Write what the slopes along all variables are made of."""
    assembly.assemble(t, w, whole, at)
    assembly.put_motion(w, whole, at)
    equations.evaluate(
        equations.PART_SLOPES_OF,
        0,
        whole[layout.FLAGS],
        t,
        w,
        whole[layout.MOTION_POINT],
        whole[layout.PART_SLOPES],
    )
    for c in range(whole[layout.N_CONTACTS]):
        if not whole[whole[layout.OPEN] + c]:
            ask_slopes(c, t, w, whole, at)


def ask_slopes(contact: int, t: float, w: Vector, whole: Wholes, at: int) -> None:
    """Write the slopes of a contact's law in both directions, then those of its margins."""
    kind, flags = whole[whole[layout.KINDS] + contact], whole[whole[layout.LAW_FLAGS] + contact]
    room = whole[layout.LAW_SLOPE_ROOM]
    place = whole[layout.LAW_SLOPES] + 3 * contact * room
    side = assembly.side_of(contact, w, whole, at)
    row = assembly.set_row(contact, side, w, whole, at)
    equations.evaluate(equations.LAW_SLOPES_OF + kind, side, flags, t, w, row, place)
    if whole[whole[layout.DIRECTIONAL] + contact]:
        equations.evaluate(equations.LAW_SLOPES_OF + kind, -side, flags, t, w, row, place + room)
    else:
        # A law that is alike in both directions has one set of slopes.
        for k in range(
            (4 + whole[whole[layout.BRISTLE_COUNTS] + contact]) * variables_of(contact, whole)
        ):
            w[place + room + k] = w[place + k]
    if whole[layout.LAW_SWITCHES] > 0:
        equations.evaluate(
            equations.LAW_MARGIN_SLOPES + kind, side, flags, t, w, row, place + 2 * room
        )


def variables_of(contact: int, whole: Wholes) -> int:
    """Return along how many variables a contact's law has slopes."""
    return (
        whole[whole[layout.LAW_BRISTLES] + contact]
        + whole[whole[layout.BRISTLE_COUNTS] + contact]
        + 1
    )


def law_slope(contact: int, back: int, which: int, k: int, w: Vector, whole: Wholes) -> float:
    """Return the slope of a number of a contact's law along a variable, at a given load.

    `which` is 0 and 1 for constant and factor of friction, 2 and 3 for those of the level, and from
    4 on the rates of its bristles; `back` is 1 for the direction against which it slips.
    """
    wide = variables_of(contact, whole)
    row = (
        whole[layout.LAW_SLOPES]
        + (3 * contact + back) * whole[layout.LAW_SLOPE_ROOM]
        + which * wide
    )
    # Rates of bristles depend on the load by themselves; friction and levels have it outside.
    own = w[row + wide - 1] if which >= 4 else 0.0
    return own * w[whole[layout.LOAD_SLOPES] + contact] + own_slope(contact, row, k, w, whole)


def margin_slope(contact: int, which: int, k: int, w: Vector, whole: Wholes) -> float:
    """Return the slope of the margin of a switch of a contact's law along a variable."""
    room = whole[layout.LAW_SLOPES] + (3 * contact + 2) * whole[layout.LAW_SLOPE_ROOM]
    return own_slope(contact, room + which * variables_of(contact, whole), k, w, whole)


def own_slope(contact: int, at: int, k: int, w: Vector, whole: Wholes) -> float:
    """Return a slope along a variable from those along what stands in the row of a law."""
    n, bristle = whole[layout.N_COORDINATES], whole[whole[layout.BRISTLES] + contact]
    total = 0.0  # by the chain rule along bristles, inputs, parameters and slip speed
    if bristle >= 0:
        first = 2 * n + bristle
        if first <= k < first + whole[whole[layout.BRISTLE_COUNTS] + contact]:
            total += w[at + whole[whole[layout.LAW_BRISTLES] + contact] + k - first]
    inputs, own_inputs = (
        whole[whole[layout.INPUT_COUNTS] + contact],
        whole[whole[layout.INPUTS] + contact],
    )
    for i in range(inputs):
        slope = w[whole[layout.PART_COLUMN] + inputs_of_column(whole) + own_inputs + i]
        total += w[at + whole[whole[layout.LAW_BRISTLES] + contact] - inputs + i] * slope
    place = whole[whole[layout.VARIABLE_PLACES] + k] - whole[whole[layout.LAW_ROWS] + contact]
    if 0 < place < whole[whole[layout.LAW_BRISTLES] + contact]:
        total += w[at + place]
    # What is held has slip speed 0, whatever the variable is.
    if whole[whole[layout.MODES] + whole[whole[layout.SLIPS] + contact]] != layout.HELD_FAST:
        total += w[at] * speed_slope(contact, k, w, whole)
    return total


def speed_slope(contact: int, k: int, w: Vector, whole: Wholes) -> float:
    """Return the slope of a contact's slip speed along a variable."""
    n, i = whole[layout.N_COORDINATES], whole[whole[layout.SLIPS] + contact]
    rate = equations.slip_rate_along(i, whole[layout.MOTION_POINT], w, whole)
    # The product rule: slip factors change with parameters, rates with states.
    slope = factor_slope(contact, w, whole) * rate
    if n <= k < 2 * n:
        slope += equations.factor_of(i, k - n, w, whole) * w[whole[layout.SLIP_FACTORS] + contact]
    return assembly.side_of(contact, w, whole, whole[layout.MOTION_POINT]) * slope


def factor_slope(contact: int, w: Vector, whole: Wholes) -> float:
    """Return the slope of a contact's slip factor along the variable at hand."""
    first = whole[layout.N_COORDINATES] + whole[layout.N_HELD] + whole[layout.N_CONTACTS]
    return w[whole[layout.PART_COLUMN] + first + contact]


def is_rigid(contact: int, whole: Wholes) -> bool:
    """Whether a contact is held by its law: its friction is what is needed."""
    held = whole[whole[layout.MODES] + whole[whole[layout.SLIPS] + contact]] == layout.HELD_FAST
    return held and whole[whole[layout.HOLDS] + contact] == 1


def along(k: int, w: Vector, whole: Wholes) -> None:
    """Write the slopes along a variable of accelerations, forces, levels and rates of bristles."""
    column = whole[layout.PART_COLUMN]
    n, held, contacts = whole[layout.N_COORDINATES], whole[layout.N_HELD], whole[layout.N_CONTACTS]
    part_column(k, w, whole)
    for c in range(contacts):
        w[whole[layout.LOAD_SLOPES] + c] = w[column + n + held + c]
    if whole[layout.N_REACTIONS] > 0:
        react_along(k, w, whole)
    respond(k, w, whole)
    for i in range(2 * whole[layout.N_DIRECTIONS]):
        w[whole[layout.LEVEL_SLOPES] + i] = 0.0
    for c in range(contacts):
        if not whole[whole[layout.OPEN] + c]:
            add_levels(c, k, w, whole)
            for b in range(whole[whole[layout.BRISTLE_COUNTS] + c]):
                place = whole[layout.BRISTLE_SLOPES] + whole[whole[layout.BRISTLES] + c] + b
                w[place] = law_slope(c, 0, 4 + b, k, w, whole) if assembly.bends(c, whole) else 0.0
    if whole[layout.N_DIRECTIONS] > n:
        cut_levels(whole[layout.LEVEL_SLOPES], w, whole)


def part_column(k: int, w: Vector, whole: Wholes) -> None:
    """Write the slopes of all parts along a variable."""
    column = whole[layout.PART_COLUMN]
    for i in range(inputs_of_column(whole) + whole[layout.N_INPUTS]):
        w[column + i] = 0.0
    for j in range(whole[whole[layout.PART_STARTS] + k], whole[whole[layout.PART_STARTS] + k + 1]):
        w[column + whole[whole[layout.PART_ROWS] + j]] = w[whole[layout.PART_SLOPES] + j]


def stops_of_column(whole: Wholes) -> int:
    """Return the first row of the parts that is of a hard stop; margins of switches end there."""
    held, contacts = whole[layout.N_HELD], whole[layout.N_CONTACTS]
    return whole[layout.N_COORDINATES] + held + 2 * contacts * (1 + held) + whole[layout.N_SWITCHES]


def inputs_of_column(whole: Wholes) -> int:
    """Return the first row of the parts that is a contact input; hard stops end there."""
    return stops_of_column(whole) + whole[layout.N_WALLS] * whole[layout.WALL_COLUMNS]


def respond(k: int, w: Vector, whole: Wholes) -> None:
    """Write the slopes of friction, accelerations and needed friction for given ones of loads."""
    n, column, mass = whole[layout.N_COORDINATES], whole[layout.PART_COLUMN], whole[layout.MASS]
    found, needed = whole[layout.ACCELERATION_SLOPES], whole[layout.NEEDED_SLOPES]
    # Slopes of the parts are those of M a - h; forces gain their negative.
    for i in range(n):
        w[found + i] = -w[column + i]
    for c in range(whole[layout.N_CONTACTS]):
        slope = 0.0
        if not whole[whole[layout.OPEN] + c] and not is_rigid(c, whole):
            slope = friction_slope(c, k, w, whole)
            i = whole[whole[layout.SLIPS] + c]
            own = sliding_friction(c, w, whole)
            grows = w[whole[layout.SLIP_FACTORS] + c] * slope + factor_slope(c, w, whole) * own
            equations.spread(i, grows, found, w, whole)
        # Of a rigid contact the rows below give what it needs.
        w[whole[layout.FRICTION_SLOPES] + c] = slope
    for i in range(n):
        w[needed + i] = w[found + i]
    assembly.solve_free(w, whole, found)
    for i in range(n):
        # What loops hold is read along their cuts, of which held parts must still be there.
        if (
            whole[whole[layout.MODES] + i] != layout.HELD_FAST
            and not whole[whole[layout.LOOPED] + i]
        ):
            w[needed + i] = 0.0
        elif not whole[layout.DIAGONAL]:
            for j in range(n):
                w[needed + i] -= w[mass + i * n + j] * w[found + j]
    for cut in range(whole[layout.N_DIRECTIONS], whole[layout.N_PAIRS]):
        w[needed + cut] = equations.combined(cut, needed, w, whole)


def friction_slope(contact: int, k: int, w: Vector, whole: Wholes) -> float:
    """Return the slope of the friction of a contact that slips, or that has bristles."""
    i = whole[whole[layout.SLIPS] + contact]
    slips = whole[whole[layout.MODES] + i] in (layout.FORWARD, layout.BACKWARD)
    if not slips and whole[whole[layout.BRISTLES] + contact] < 0:
        return 0.0
    load = w[whole[layout.LOAD] + contact]
    # Friction a + b N: slopes of a and b at the load at hand, then b times that of the load.
    own = law_slope(contact, 0, 0, k, w, whole) + load * law_slope(contact, 0, 1, k, w, whole)
    side = assembly.side_of(contact, w, whole, whole[layout.MOTION_POINT])
    return (
        side * own
        + w[whole[layout.FRICTION_FACTOR] + contact] * w[whole[layout.LOAD_SLOPES] + contact]
    )


def add_levels(contact: int, k: int, w: Vector, whole: Wholes) -> None:
    """Add the slopes of a contact's levels to those of its coordinate."""
    if not whole[whole[layout.HOLDS] + contact]:
        return
    factor, load = w[whole[layout.SLIP_FACTORS] + contact], w[whole[layout.LOAD] + contact]
    ahead = 0 if assembly.side_of(contact, w, whole, whole[layout.MOTION_POINT]) > 0 else 1
    for which in range(2):
        back = 0 if which == ahead else 1
        place = 2 * contact + which
        level = (
            w[whole[layout.LEVEL_CONSTANT] + place] + w[whole[layout.LEVEL_FACTOR] + place] * load
        )
        slope = law_slope(contact, back, 2, k, w, whole)
        slope += load * law_slope(contact, back, 3, k, w, whole)
        slope += w[whole[layout.LEVEL_FACTOR] + place] * w[whole[layout.LOAD_SLOPES] + contact]
        grows = factor_slope(contact, w, whole) * (1.0 if factor > 0.0 else -1.0)
        to = which if factor > 0.0 else 1 - which
        row = whole[layout.LEVEL_SLOPES] + 2 * whole[whole[layout.SLIPS] + contact] + to
        w[row] += abs(factor) * slope + grows * level


def shared_slope(contact: int, w: Vector, whole: Wholes) -> float:
    """Return the slope of the part that a held contact has of the needed friction."""
    i, factor = whole[whole[layout.SLIPS] + contact], w[whole[layout.SLIP_FACTORS] + contact]
    # The part is the needed friction over the slip factor: the quotient rule.
    part = w[whole[layout.NEEDED] + i] / factor
    change = w[whole[layout.NEEDED_SLOPES] + i] - part * factor_slope(contact, w, whole)
    return assembly.equal_part(contact, change, w, whole)


def shared_part(contact: int, w: Vector, whole: Wholes) -> float:
    """Return the part that a held contact has of the needed friction, or what slides there."""
    if is_rigid(contact, whole):
        return assembly.equal_part(
            contact, w[whole[layout.NEEDED] + whole[whole[layout.SLIPS] + contact]], w, whole
        )
    return sliding_friction(contact, w, whole)


def sliding_friction(contact: int, w: Vector, whole: Wholes) -> float:
    """Return the friction of a contact that slips, or that has bristles."""
    factor, load = w[whole[layout.FRICTION_FACTOR] + contact], w[whole[layout.LOAD] + contact]
    return w[whole[layout.FRICTION_CONSTANT] + contact] + factor * load


def surplus_slope(row: int, w: Vector, whole: Wholes) -> float:
    """Return the slope of the force that a held coordinate needs beside those that act on it."""
    n, held, contacts = whole[layout.N_COORDINATES], whole[layout.N_HELD], whole[layout.N_CONTACTS]
    slips = whole[layout.PART_COLUMN] + n + held + 2 * contacts
    normals = slips + contacts * held
    total = w[whole[layout.PART_COLUMN] + n + row]
    for i in range(n):
        total += (
            w[whole[layout.MASS] + (n + row) * n + i] * w[whole[layout.ACCELERATION_SLOPES] + i]
        )
    for c in range(contacts):
        if whole[whole[layout.OPEN] + c]:
            continue
        slope = w[whole[layout.FRICTION_SLOPES] + c]
        if is_rigid(c, whole):
            slope = shared_slope(c, w, whole)
        total += w[whole[layout.HELD_SLIPS] + c * held + row] * slope
        total += w[slips + c * held + row] * shared_part(c, w, whole)
        if whole[whole[layout.REACTS] + c]:
            # Loads act by their normals, which may turn with the variable.
            total -= w[normals + c * held + row] * w[whole[layout.LOAD] + c]
    return total


def react_along(k: int, w: Vector, whole: Wholes) -> None:
    """Write the slopes of the loads that are reactions."""
    # The same equations as those of the reactions themselves: `assembly.react`.
    for trial in range(whole[layout.N_REACTIONS] + 1):
        assembly.put_loads(trial - 1, whole[layout.LOAD_SLOPES], w, whole)
        respond(k, w, whole)
        for row in range(whole[layout.N_REACTIONS]):
            assembly.note_surplus(trial, row, surplus_slope(row, w, whole), w, whole)
    assembly.balance(whole[layout.LOAD_SLOPES], w, whole)


def rate_slopes_along(
    first: int, count: int, t: float, w: Vector, whole: Wholes, at: int, to: int
) -> None:
    """Write the slopes of the time derivatives of all states along some variables."""
    n, states = whole[layout.N_COORDINATES], whole[layout.N_STATES]
    prepare_slopes(t, w, whole, at)
    for j in range(count):
        k = first + j
        along(k, w, whole)
        for i in range(n):
            # A place changes as its rate does, unless that is held.
            moves = k == n + i and whole[whole[layout.MODES] + i] != layout.HELD_FAST
            w[to + i * count + j] = 1.0 if moves else 0.0
            w[to + (n + i) * count + j] = w[whole[layout.ACCELERATION_SLOPES] + i]
        for b in range(states - 2 * n):
            w[to + (2 * n + b) * count + j] = w[whole[layout.BRISTLE_SLOPES] + b]


def guard_slopes_along(
    first: int, count: int, t: float, w: Vector, whole: Wholes, at: int, to: int
) -> None:
    """Write the slopes of all guards along some variables."""
    n, contacts = whole[layout.N_COORDINATES], whole[layout.N_CONTACTS]
    wide = whole[layout.LAW_SWITCHES] + 1
    prepare_slopes(t, w, whole, at)
    for i in range(whole[layout.N_GUARDS] * count):
        w[to + i] = 0.0
    for j in range(count):
        k = first + j
        along(k, w, whole)
        for i in range(whole[layout.N_PAIRS]):
            mode = whole[whole[layout.MODES] + i]
            if mode in (layout.FORWARD, layout.BACKWARD):
                if n <= k < 2 * n:
                    w[to + 2 * i * count + j] = mode * equations.factor_of(i, k - n, w, whole)
            elif mode == layout.HELD_FAST and not whole[whole[layout.LOOPED] + i]:
                needed = w[whole[layout.NEEDED_SLOPES] + i]
                levels = whole[layout.LEVEL_SLOPES] + 2 * i
                w[to + 2 * i * count + j] = w[levels] - needed
                w[to + (2 * i + 1) * count + j] = w[levels + 1] + needed
        for c in range(contacts):
            row = first_contact_guard(whole) + c * wide + whole[layout.LAW_SWITCHES]
            if not whole[layout.CONSTANT_LOADS] or whole[whole[layout.REACTS] + c]:
                load = w[whole[layout.LOAD_SLOPES] + c]
                w[to + row * count + j] = -load if whole[whole[layout.OPEN] + c] else load
            if watches(c, whole[whole[layout.MODES] + whole[whole[layout.SLIPS] + c]], whole):
                for s in range(whole[layout.LAW_SWITCHES]):
                    # A guard is the margin of a switch that is on, and its negative of one that is
                    # off.
                    sign = 1.0 if whole[whole[layout.LAW_FLAGS] + c] & (1 << s) else -1.0
                    slope = margin_slope(c, s, k, w, whole)
                    w[to + (row - whole[layout.LAW_SWITCHES] + s) * count + j] = sign * slope
        margins = whole[layout.PART_COLUMN] + stops_of_column(whole) - whole[layout.N_SWITCHES]
        for s in range(whole[layout.N_SWITCHES]):
            sign = 1.0 if whole[layout.FLAGS] & (1 << s) else -1.0
            w[to + (first_own_switch(whole) + s) * count + j] = sign * w[margins + s]
        stop_slopes(k, to + j, count, w, whole)


def stop_slopes(k: int, to: int, stride: int, w: Vector, whole: Wholes) -> None:
    """Write the slopes of the distances from hard stops along the variable at hand."""
    stops = whole[layout.PART_COLUMN] + stops_of_column(whole)
    for wall in range(whole[layout.N_WALLS]):
        moves = 1.0 if k == wall_coordinate(wall, whole) else 0.0
        slope = w[stops + wall * whole[layout.WALL_COLUMNS]] - moves
        w[to + (whole[layout.FIRST_WALL] + wall) * stride] = wall_side(wall, whole) * slope


def impact_slopes_along(
    first: int, count: int, t: float, w: Vector, whole: Wholes, at: int, to: int
) -> None:
    """Write the slopes of all rates after the impacts of an instant along some variables.

    STRUCK is not 0 where a coordinate is stopped: it is 1 where it comes to rest. BOUNDS has what
    the rates change by. The momentum of all other coordinates stays, whatever the variables are.
    """
    n, change, point = whole[layout.N_COORDINATES], whole[layout.BOUNDS], whole[layout.MOTION_POINT]
    for i in range(n):
        whole[whole[layout.KEPT] + i] = whole[whole[layout.MODES] + i]
        if w[change + i] == -w[at + n + i] and assembly.stopped_side(i, w, whole, at) != 0:
            whole[whole[layout.STRUCK] + i] = 1
        # Struck coordinates are given, all others keep their momentum: held and free ones, so to
        # speak.
        whole[whole[layout.MODES] + i] = (
            layout.FREE if whole[whole[layout.STRUCK] + i] == 0 else layout.HELD_FAST
        )
    assembly.put_mass(t, w, whole, at)
    if not whole[layout.DIAGONAL]:
        assembly.factorise(w, whole)
    for i in range(whole[layout.N_STATES]):
        w[point + i] = w[at + i]
    for i in range(n * count):
        w[to + i] = 0.0
    for trial in range(2):  # of M a - h with and without the changes: what the mass matrix adds
        for i in range(n):
            w[point + whole[layout.N_STATES] + i] = w[change + i] if trial == 0 else 0.0
        equations.evaluate(
            equations.PART_SLOPES_OF, 0, whole[layout.FLAGS], t, w, point, whole[layout.PART_SLOPES]
        )
        for j in range(count):
            part_column(first + j, w, whole)
            for i in range(n):
                slope = w[whole[layout.PART_COLUMN] + i]
                w[to + i * count + j] += slope if trial == 1 else -slope
    for j in range(count):
        part_column(first + j, w, whole)
        respond_to_impact(first + j, to + j, count, w, whole, at)
    for i in range(n):
        whole[whole[layout.MODES] + i] = whole[whole[layout.KEPT] + i]


def respond_to_impact(k: int, to: int, stride: int, w: Vector, whole: Wholes, at: int) -> None:
    """Write the slopes of all rates after impacts along a variable, from those of the momenta."""
    n, found, given = (
        whole[layout.N_COORDINATES],
        whole[layout.ACCELERATION_SLOPES],
        whole[layout.NEEDED_SLOPES],
    )
    stops = whole[layout.PART_COLUMN] + stops_of_column(whole)
    for i in range(n):
        w[found + i] = w[to + i * stride]
        # The factor of the rate before it in its change, -1 for what comes to rest.
        w[given + i] = -1.0 if k == n + i and whole[whole[layout.STRUCK] + i] != 0 else 0.0
    for wall in range(whole[layout.N_WALLS]):
        i, columns = wall_coordinate(wall, whole), whole[layout.WALL_COLUMNS]
        if (
            whole[whole[layout.STRUCK] + i] > 1
            and approach(whole[layout.FIRST_WALL] + wall, w, whole) > 0.0
        ):
            w[given + i] *= 1.0 + w[whole[layout.WALLS] + wall * columns + 1]
            w[given + i] -= w[stops + wall * columns + 1] * w[at + n + i]
    for i in range(n):
        for j in range(n):
            # Given changes act on the others by the coupling of the masses alone.
            if whole[whole[layout.STRUCK] + j] != 0 and j != i:
                w[found + i] -= w[whole[layout.MASS] + i * n + j] * w[given + j]
    assembly.solve_free(w, whole, found)
    for i in range(n):
        own = w[given + i] if whole[whole[layout.STRUCK] + i] != 0 else w[found + i]
        w[to + i * stride] = own + (1.0 if k == n + i else 0.0)
