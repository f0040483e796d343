"""Steppers: DOP853, Rodas5P and the exact series of linear modes, and which one a mode takes.

All give the new state, an error (0 for a series that has ended) and a dense output:

* DOP853 (Dormand and Prince, order 8; Hairer, Norsett and Wanner, 1993) for smooth modes;
* Rodas5P (Steinebach, BIT 63, 2023), a Rosenbrock method of order 5, for stiff ones, with the
  analytic Jacobian;
* the Taylor series of y' = J y + b for modes with constant coefficients, exact to the last digit.

Errors are judged against the sizes that the states have had in the run. A mode without a series
begins with DOP853 and goes over to Rodas5P where stability, not accuracy, limits the step.
"""

import math

from stickslip.engine.kernels import equations
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector
from stickslip.engine.kernels.mode_transitions import set_flags
from stickslip.engine.kernels.numerics import NESTED_SHORT, interpolate, lu_factor, lu_solve

# What errors are judged against: the sizes that the states have had in the run.

LEAST = 1e-9
"""Least speed that counts, over that which the contact's own force gives in the time of the run."""

BALANCED = 1e-3
"""Size of a rate, over what a single force gives it in a step, of which others leave little: with a
tolerance of 1e-12, errors of 1e-15 of it count, and its rounding does not."""
TAIL = 1e-16
"""Size of the last two terms of a series, over that of the state, that a step may have."""
VANISHED = 1e-18
"""Size of a term, over the largest of its state, below which a series has ended."""


def first_sizes(t: float, t_end: float, w: Vector, iw: IntVector) -> None:
    """Set the sizes at the start.

    A body at rest has no speed to compare with. Where friction falls steeply from rest, it leaves
    as a power of time, which no relative error control gets started; a floor far below any speed
    of interest does. It follows from the forces at rest, and so from the scale of the problem.
    """
    n = iw[layout.N_STATES]
    scale = iw[layout.SCALE]
    y = iw[layout.Y]
    point = iw[layout.POINT]
    slip = iw[layout.SLIP]
    values = iw[layout.VALUES]
    for i in range(n):
        w[scale + i] = abs(w[y + i])
        w[point + i] = w[y + i]
    w[point + slip] = 0.0
    flags = set_flags(t, w, iw, point, 0, 0)
    equations.evaluate(equations.FIELD, 1, flags, t, w, point, values)
    forward = w[values + slip]
    equations.evaluate(equations.FIELD, -1, flags, t, w, point, values)
    floor = LEAST * 0.5 * abs(forward - w[values + slip]) * (t_end - t)
    w[scale + slip] = max(w[scale + slip], floor)


def size_of(i: int, h: float, w: Vector, iw: IntVector) -> float:
    """Return what an error of state `i` in a step is judged against."""
    scale = iw[layout.SCALE]
    coordinates = iw[layout.N_COORDINATES]
    size = max(w[scale + i], abs(w[iw[layout.Y] + i]), abs(w[iw[layout.Y1] + i]))
    if i < coordinates:
        return max(size, abs(h) * w[scale + i + coordinates])
    if i < 2 * coordinates:
        return max(size, BALANCED * abs(h) * w[iw[layout.PULLS] + i - coordinates])
    return size


def series_tail(h: float, w: Vector, iw: IntVector) -> float:
    """Return the tail of the series in the dense output over what is allowed."""
    dense = iw[layout.DENSE]
    n = iw[layout.N_STATES]
    error = 0.0
    if w[dense] >= layout.SERIES:
        last = dense + 1 + layout.SERIES * n
        for i in range(n):
            tail = abs(w[last + i]) + abs(w[last - n + i])
            if not tail < math.inf:
                return math.inf
            size = TAIL * size_of(i, h, w, iw)
            if tail > 0.0:
                error = max(error, tail / size if size > 0.0 else math.inf)
    return error


# DOP853: explicit Runge-Kutta of order 8 with dense output of order 7, for smooth modes.

# fmt: off
A = (
    0.05260015195876773,
    0.0197250569845379, 0.0591751709536137,
    0.02958758547680685, 0.0, 0.08876275643042054,
    0.2413651341592667, 0.0, -0.8845494793282861, 0.924834003261792,
    0.037037037037037035, 0.0, 0.0, 0.17082860872947386, 0.12546768756682242,
    0.037109375, 0.0, 0.0, 0.17025221101954405, 0.06021653898045596, -0.017578125,
    0.03709200011850479, 0.0, 0.0, 0.17038392571223998, 0.10726203044637328,
    -0.015319437748624402, 0.008273789163814023,
    0.6241109587160757, 0.0, 0.0, -3.3608926294469414, -0.868219346841726, 27.59209969944671,
    20.154067550477894, -43.48988418106996,
    0.47766253643826434, 0.0, 0.0, -2.4881146199716677, -0.590290826836843, 21.230051448181193,
    15.279233632882423, -33.28821096898486, -0.020331201708508627,
    -0.9371424300859873, 0.0, 0.0, 5.186372428844064, 1.0914373489967295, -8.149787010746927,
    -18.52006565999696, 22.739487099350505, 2.4936055526796523, -3.0467644718982196,
    2.273310147516538, 0.0, 0.0, -10.53449546673725, -2.0008720582248625, -17.9589318631188,
    27.94888452941996, -2.8589982771350235, -8.87285693353063, 12.360567175794303,
    0.6433927460157636,
    0.054293734116568765, 0.0, 0.0, 0.0, 0.0, 4.450312892752409, 1.8915178993145003,
    -5.801203960010585, 0.3111643669578199, -0.1521609496625161, 0.20136540080403034,
    0.04471061572777259,
    0.056167502283047954, 0.0, 0.0, 0.0, 0.0, 0.0, 0.25350021021662483, -0.2462390374708025,
    -0.12419142326381637, 0.15329179827876568, 0.00820105229563469, 0.007567897660545699,
    -0.008298,
    0.03183464816350214, 0.0, 0.0, 0.0, 0.0, 0.028300909672366776, 0.053541988307438566,
    -0.05492374857139099, 0.0, 0.0, -0.00010834732869724932, 0.0003825710908356584,
    -0.00034046500868740456, 0.1413124436746325,
    -0.42889630158379194, 0.0, 0.0, 0.0, 0.0, -4.697621415361164, 7.683421196062599,
    4.06898981839711, 0.3567271874552811, 0.0, 0.0, 0.0, -0.0013990241651590145,
    2.9475147891527724, -9.15095847217987,
)
C = (
    0.0, 0.05260015195876773, 0.0789002279381516, 0.1183503419072274, 0.2816496580927726,
    0.3333333333333333, 0.25, 0.3076923076923077, 0.6512820512820513, 0.6, 0.8571428571428571, 1.0,
    1.0, 0.1, 0.2, 0.7777777777777778,
)
ERROR_3 = (
    -0.18980075407240762, 0.0, 0.0, 0.0, 0.0, 4.450312892752409, 1.8915178993145003,
    -5.801203960010585, -0.4226823213237919, -0.1521609496625161, 0.20136540080403034,
    0.02265179219836082, 0.0,
)
ERROR_5 = (
    0.01312004499419488, 0.0, 0.0, 0.0, 0.0, -1.2251564463762044, -0.4957589496572502,
    1.6643771824549864, -0.35032884874997366, 0.3341791187130175, 0.08192320648511571,
    -0.022355307863886294, 0.0,
)
D = (
    -8.428938276109013, 0.0, 0.0, 0.0, 0.0, 0.5667149535193777, -3.0689499459498917,
    2.38466765651207, 2.117034582445028, -0.871391583777973, 2.2404374302607883,
    0.6315787787694688, -0.08899033645133331, 18.148505520854727, -9.194632392478356,
    -4.436036387594894,
    10.427508642579134, 0.0, 0.0, 0.0, 0.0, 242.28349177525817, 165.20045171727028,
    -374.5467547226902, -22.113666853125306, 7.733432668472264, -30.674084731089398,
    -9.332130526430229, 15.697238121770845, -31.139403219565178, -9.35292435884448,
    35.81684148639408,
    19.985053242002433, 0.0, 0.0, 0.0, 0.0, -387.0373087493518, -189.17813819516758,
    527.8081592054236, -11.57390253995963, 6.8812326946963, -1.0006050966910838,
    0.7777137798053443, -2.778205752353508, -60.19669523126412, 84.32040550667716,
    11.99229113618279,
    -25.69393346270375, 0.0, 0.0, 0.0, 0.0, -154.18974869023643, -231.5293791760455,
    357.6391179106141, 93.40532418362432, -37.45832313645163, 104.0996495089623, 29.8402934266605,
    -43.53345659001114, 96.32455395918828, -39.17726167561544, -149.72683625798564,
)


# Rows of A one after the other: row s, of s numbers, begins at s * (s - 1) // 2.

# Four rows of 16, for the dense output.
# fmt: on


def dop853_stage(s: int, t: float, h: float, w: Vector, iw: IntVector, at: int) -> None:
    """Evaluate stage `s` from the ones before it, at a state that is written to `at`."""
    stages = iw[layout.STAGES]
    y = iw[layout.Y]
    n = iw[layout.N_STATES]
    row = s * (s - 1) // 2
    for i in range(n):
        total = 0.0
        for j in range(s):
            total += A[row + j] * w[stages + j * n + i]
        w[at + i] = w[y + i] + h * total
    equations.field(t + C[s] * h, w, iw, at, stages + s * n)


def dop853_step(t: float, h: float, w: Vector, iw: IntVector, rtol: float) -> float:
    """Try a step; return its error over the tolerance.

    Stage 12 is the slope at the solution, which is left in Y1.
    """
    stages = iw[layout.STAGES]
    y1 = iw[layout.Y1]
    n = iw[layout.N_STATES]
    equations.field(t, w, iw, iw[layout.Y], stages)
    for s in range(1, 13):
        dop853_stage(s, t, h, w, iw, y1)
    sum_5 = 0.0
    sum_3 = 0.0
    for i in range(n):
        size = rtol * size_of(i, h, w, iw)
        error_5 = 0.0
        error_3 = 0.0
        for s in range(13):
            error_5 += ERROR_5[s] * w[stages + s * n + i]
            error_3 += ERROR_3[s] * w[stages + s * n + i]
        if error_5 != 0.0 or error_3 != 0.0:
            share_5 = error_5 / size if size > 0.0 else math.inf
            share_3 = error_3 / size if size > 0.0 else math.inf
            sum_5 += share_5 * share_5  # a power would raise where this becomes infinite
            sum_3 += share_3 * share_3
    # Hairer, Norsett and Wanner, section II.10: the square of the estimate of order 5 over that of
    # order 3 falls as h^8, as the error does; where steps are too long for that, the root leaves
    # the estimate of order 5 alone.
    total = sum_5 + 0.01 * sum_3
    return 0.0 if total == 0.0 else abs(h) * sum_5 / math.sqrt(total * n)


def dop853_dense(t: float, h: float, w: Vector, iw: IntVector) -> None:
    """Fill the dense output of the step just taken."""
    dense = iw[layout.DENSE]
    stages = iw[layout.STAGES]
    y1 = iw[layout.Y1]
    y = iw[layout.Y]
    point = iw[layout.POINT]
    n = iw[layout.N_STATES]
    w[dense] = 0.0
    for i in range(n):
        # The first four rows are the cubic of Hermite through both ends and their slopes; four more
        # from three further stages make it order 7.
        at = dense + 1 + i
        first, last = w[stages + i], w[stages + 12 * n + i]
        change = w[y1 + i] - w[y + i]
        w[at] = w[y + i]
        w[at + n] = change
        w[at + 2 * n] = h * first - change
        w[at + 3 * n] = 2.0 * change - h * (last + first)
    for s in range(13, 16):
        dop853_stage(s, t, h, w, iw, point)
    for row in range(4):
        for i in range(n):
            total = 0.0
            for s in range(layout.DOP853_STAGES):
                total += D[16 * row + s] * w[stages + s * n + i]
            w[dense + 1 + (4 + row) * n + i] = h * total


# Rodas5P: Rosenbrock method of order 5 with analytic Jacobian and df/dt, for stiff modes.

# fmt: off
# Rows one after the other: row s, of s numbers, begins at s * (s - 1) // 2.
A_RODAS = (
    3.0,
    2.849394379747939, 0.45842242204463923,
    -6.954028509809101, 2.489845061869568, -10.358996098473584,
    2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641,
    -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256,
    0.030198172008377946,
    -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256,
    0.030198172008377946, 1.0,
    -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256,
    0.030198172008377946, 1.0, 1.0,
)
C_RODAS = (
    -14.155112264123755,
    -17.97296035885952, -2.859693295451294,
    147.12150275711716, -1.41221402718213, 71.68940251302358,
    165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306,
    24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125,
    -0.6610691825249471,
    30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783,
    -19.097331116725623, -28.087943162872662,
    37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047,
    -40.06618937091002, -54.66780262877968, -9.48861652309627,
)
TIMES_RODAS = (
    0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0,
    1.0,
)
SLOPES_RODAS = (
    0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734,
    2.325825639765069, 0.0, 0.0, 0.0,
)
# Three rows of 8, for the dense output.
DENSE_RODAS = (
    25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204,
    0.524948541321073, 1.1241088310450404, 0.4272876194431874, -0.17202221070155493,
    -9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796,
    20.176138334709044, 15.98066361424651, -6.789040303419874, -6.710236069923372,
    11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643,
    -52.072871366152654, -59.78993625266729, -0.15582684282751913, 4.883087185713722,
)
GAMMA = 0.21193756319429014
RODAS_STAGES = 8


# fmt: on


def rodas_matrix(t: float, h: float, w: Vector, iw: IntVector) -> bool:
    """Factorise 1 / (gamma h) - J."""
    matrix = iw[layout.MATRIX]
    n = iw[layout.N_STATES]
    equations.jacobian(t, w, iw, iw[layout.Y], matrix)
    for i in range(n * n):
        w[matrix + i] = -w[matrix + i]
    for i in range(n):
        w[matrix + i * n + i] += 1.0 / (GAMMA * h)
    return lu_factor(w, matrix, n, iw[layout.PIVOTS])


def rodas_step(t: float, h: float, w: Vector, iw: IntVector, rtol: float) -> float:
    """Try a step; return its error over the tolerance. The solution is left in Y1."""
    y = iw[layout.Y]
    drift = iw[layout.DRIFT]
    stages = iw[layout.STAGES]
    y1 = iw[layout.Y1]
    matrix = iw[layout.MATRIX]
    pivots = iw[layout.PIVOTS]
    point = iw[layout.POINT]
    n = iw[layout.N_STATES]
    if not rodas_matrix(t, h, w, iw):
        return math.inf
    equations.time_slope(t, w, iw, y, drift)
    per_step = 1.0 / h
    # Stages are those of Hairer and Wanner, section IV.7: sums of C over h stand for products with
    # the Jacobian, so that each costs one evaluation and one solution with the same factors.
    for s in range(RODAS_STAGES):
        row = s * (s - 1) // 2
        stage = stages + s * n
        for i in range(n):
            total = w[y + i]
            product = 0.0
            for j in range(s):
                earlier = w[stages + j * n + i]
                total += A_RODAS[row + j] * earlier
                product += C_RODAS[row + j] * earlier
            w[y1 + i] = total
            w[point + i] = product
        equations.field(t + TIMES_RODAS[s] * h, w, iw, y1, stage)
        slope = h * SLOPES_RODAS[s]
        for i in range(n):
            w[stage + i] += w[point + i] * per_step + slope * w[drift + i]
        lu_solve(w, matrix, n, pivots, stage)
        hold_still(stage, w, iw)
    for i in range(n):
        w[y1 + i] += w[stages + 7 * n + i]
    return rodas_error(h, w, iw, rtol)


def hold_still(to: int, w: Vector, iw: IntVector) -> None:
    """Keep what is held where it is, whatever pivots round to."""
    n = iw[layout.N_COORDINATES]
    for i in range(n):
        if iw[layout.N_CONTACTS] > 0:
            held = iw[iw[layout.MODES] + i] == layout.HELD_FAST
        else:
            held = iw[layout.MODE] == 0 and iw[layout.SLIP] == n + i
        if held:
            w[to + i] = 0.0
            w[to + n + i] = 0.0
    if iw[layout.N_DIRECTIONS] > n:
        equations.bind(to, 1, w, iw)
        equations.bind(to + n, 1, w, iw)


def rodas_error(h: float, w: Vector, iw: IntVector, rtol: float) -> float:
    """Return the last stage, which is the error estimate, over the tolerance."""
    stages = iw[layout.STAGES]
    n = iw[layout.N_STATES]
    total = 0.0
    for i in range(n):
        error = w[stages + 7 * n + i]
        size = rtol * size_of(i, h, w, iw)
        if error != 0.0:
            share = error / size if size > 0.0 else math.inf
            total += share * share
    return math.sqrt(total / n)


def rodas_dense(w: Vector, iw: IntVector) -> None:
    """Fill the dense output of the step just taken."""
    dense = iw[layout.DENSE]
    stages = iw[layout.STAGES]
    y = iw[layout.Y]
    y1 = iw[layout.Y1]
    n = iw[layout.N_STATES]
    w[dense] = NESTED_SHORT
    for i in range(n):
        at = dense + 1 + i
        first = 0.0
        second = 0.0
        third = 0.0
        for s in range(RODAS_STAGES):
            stage = w[stages + s * n + i]
            first += DENSE_RODAS[s] * stage
            second += DENSE_RODAS[8 + s] * stage
            third += DENSE_RODAS[16 + s] * stage
        # Steinebach's (1 - x) y0 + x (y1 + (1 - x) (k1 + x (k2 + x k3))) in the nested form, where
        # k2 + x k3 is (k2 + k3) + (1 - x) (-k3).
        w[at] = w[y + i]
        w[at + n] = w[y1 + i] - w[y + i]
        w[at + 2 * n] = first
        w[at + 3 * n] = second + third
        w[at + 4 * n] = -third
        for row in range(5, 8):
            w[at + row * n] = 0.0


# Exact propagation of linear modes: the Taylor series of the solution, which is entire.
#
# With constant coefficients each term follows from the last, c[k + 1] = h / (k + 1) J c[k], and
# twenty of them give a step of more than a radian of the fastest motion to the last digit. The
# series stands in the dense output, so that guards become polynomials in the fraction of the step.
#
# Harmonic forces of one angular frequency W enter with their terms and the rates of these: a power
# (-1)^j (W h)^2j / (2 j)! of the former and (-1)^j (W h)^2j h / (2 j + 1)! of the latter in turn.

RATIOS = (0.0, 0.0, *(1.0 / (k * (k - 1.0)) for k in range(2, layout.SERIES + 1)))
"""1 / (k (k - 1)): the power k of a harmonic over that before the last, over the angle squared."""


def fill_waves(t: float, h: float, w: Vector, iw: IntVector, at: int) -> int:
    """Write the factors of all powers of the harmonics; return the last that counts, 0 if none."""
    first, rows = iw[layout.WAVES], iw[layout.N_WAVES]
    if rows == 0:
        return 0
    terms = first + layout.SERIES + 1
    equations.evaluate(equations.WAVES_OF, iw[layout.MODE], iw[layout.FLAGS], t, w, at, terms)
    acts = False
    for i in range(2 * rows):
        acts = acts or w[terms + i] != 0.0
    square = h * h * w[terms + 2 * rows] if acts else 0.0
    w[first] = 1.0
    w[first + 1] = h
    last = layout.SERIES + 1 if acts else 0
    for k in range(2, layout.SERIES + 1):
        factor = -square * RATIOS[k] * w[first + k - 2]
        w[first + k] = factor
        if k % 2 == 0 and last > k and abs(factor) <= VANISHED:
            last = k
    return last


def wave_at(k: int, w: Vector, iw: IntVector) -> tuple[float, int]:
    """Return the factor of a power of the harmonics, and the place of what it multiplies."""
    first = iw[layout.WAVES]
    return w[first + k], first + layout.SERIES + 1 + iw[layout.N_WAVES] * (k % 2)


def waves_tail(w: Vector, iw: IntVector) -> float:
    """Return the last term of the harmonics over what is allowed."""
    return abs(w[iw[layout.WAVES] + layout.SERIES]) / TAIL if iw[layout.N_WAVES] > 0 else 0.0


def series_fill(t: float, h: float, w: Vector, iw: IntVector, at: int) -> None:
    """Fill the dense output with the series of a step from the state at `at`."""
    dense = iw[layout.DENSE]
    drift = iw[layout.DRIFT]
    matrix = iw[layout.MATRIX]
    point = iw[layout.POINT]
    n = iw[layout.N_STATES]
    last = dense + 1
    equations.field(t, w, iw, at, last + n)
    equations.time_slope(t, w, iw, at, drift)
    equations.jacobian(t, w, iw, at, matrix)
    for i in range(n):
        w[last + i] = w[at + i]
        w[last + n + i] *= h
        w[point + i] = max(abs(w[last + i]), abs(w[last + n + i]))  # largest term yet
    waving = fill_waves(t, h, w, iw, at)
    if n == 2 and waving == 0:
        series_of_two(h, w, iw)
        return
    if n == 4:
        series_of_four(h, waving, w, iw)
        return
    # Two small terms in a row end the series: one alone may be zero by chance, as each second term
    # of an oscillation from rest is.
    small = 0
    terms = 1
    while terms < layout.SERIES and small < 2:
        last += n
        terms += 1
        factor = h / terms
        ended = terms >= waving
        power, waves = 0.0, drift
        if waving > 0:
            power, waves = wave_at(terms - 1, w, iw)
        for i in range(n):
            # df/dt is constant but for harmonics: time enters the second derivative of the state
            total = h * w[drift + i] if terms == 2 else power * w[waves + i]
            for j in range(n):
                total += w[matrix + i * n + j] * w[last + j]
            total *= factor
            w[last + n + i] = total
            w[point + i] = max(w[point + i], abs(total))
            ended = ended and abs(total) <= VANISHED * w[point + i]
        small = small + 1 if ended else 0
    w[dense] = terms - small


def series_of_two(h: float, w: Vector, iw: IntVector) -> None:
    """Fill in the series of two states, of one coordinate, from the second term after the first on.

    Most linear modes have two. In variables of their own the terms wait for no memory, which takes
    half the time.
    """
    drift = iw[layout.DRIFT]
    matrix = iw[layout.MATRIX]
    last = iw[layout.DENSE] + 1
    a = w[matrix]
    b = w[matrix + 1]
    c = w[matrix + 2]
    d = w[matrix + 3]
    x = w[last + 2]
    v = w[last + 3]
    largest_x = max(abs(w[last]), abs(x))
    largest_v = max(abs(w[last + 1]), abs(v))
    # time enters the second derivative and no other
    grown_x = h * w[drift]
    grown_v = h * w[drift + 1]
    small = 0
    terms = 1
    while terms < layout.SERIES and small < 2:
        terms += 1
        factor = h / terms
        next_x = grown_x + a * x + b * v
        next_v = grown_v + c * x + d * v
        grown_x = 0.0
        grown_v = 0.0
        x = factor * next_x
        v = factor * next_v
        w[last + 2 * terms] = x
        w[last + 2 * terms + 1] = v
        largest_x = max(largest_x, abs(x))
        largest_v = max(largest_v, abs(v))
        ended = abs(x) <= VANISHED * largest_x and abs(v) <= VANISHED * largest_v
        small = small + 1 if ended else 0
    w[iw[layout.DENSE]] = terms - small


def series_of_four(h: float, waving: int, w: Vector, iw: IntVector) -> None:
    """Fill in the series of four states, of two coordinates, as `series_fill` does of any."""
    at, last, small, terms = iw[layout.MATRIX], iw[layout.DENSE] + 5, 0, 1
    x, y, u, v = w[last], w[last + 1], w[last + 2], w[last + 3]
    most_x, most_y = max(abs(w[last - 4]), abs(x)), max(abs(w[last - 3]), abs(y))
    most_u, most_v = max(abs(w[last - 2]), abs(u)), max(abs(w[last - 1]), abs(v))
    while terms < layout.SERIES and small < 2:
        last += 4
        terms += 1
        power, to = h if terms == 2 else 0.0, iw[layout.DRIFT]
        if waving > 0 and terms > 2:
            power, to = wave_at(terms - 1, w, iw)
        a, b, c, d = power * w[to], power * w[to + 1], power * w[to + 2], power * w[to + 3]
        a = a + w[at] * x + w[at + 1] * y + w[at + 2] * u + w[at + 3] * v
        b = b + w[at + 4] * x + w[at + 5] * y + w[at + 6] * u + w[at + 7] * v
        c = c + w[at + 8] * x + w[at + 9] * y + w[at + 10] * u + w[at + 11] * v
        d = d + w[at + 12] * x + w[at + 13] * y + w[at + 14] * u + w[at + 15] * v
        factor = h / terms
        x, y, u, v = factor * a, factor * b, factor * c, factor * d
        w[last], w[last + 1], w[last + 2], w[last + 3] = x, y, u, v
        most_x, most_y = max(most_x, abs(x)), max(most_y, abs(y))
        most_u, most_v = max(most_u, abs(u)), max(most_v, abs(v))
        ended = abs(x) <= VANISHED * most_x and abs(y) <= VANISHED * most_y
        ended = ended and abs(u) <= VANISHED * most_u and abs(v) <= VANISHED * most_v
        small = small + 1 if ended and terms >= waving else 0
    w[iw[layout.DENSE]] = terms - small


def series_step(t: float, h: float, w: Vector, iw: IntVector, at: int) -> float:
    """Try a step; return the tail of its series over what is allowed, the solution in Y1."""
    series_fill(t, h, w, iw, at)
    interpolate(w, iw, 1.0, iw[layout.Y1])
    return max(series_tail(h, w, iw), waves_tail(w, iw))


# Which stepper a mode takes: its exact series, DOP853, or Rodas5P where it is stiff.

FIRST_SHARE = 1e-3
"""First step of a run over the time to its first stop, before errors tell."""
PROBE = 1e-3
"""Stretch of time, over that to the next stop, that tells the sizes of states at rest."""
PROBES = 8
"""Stretches that are tried, each shorter by the same factor."""
PROBED = 1e-9
"""Size of a state over its change in that stretch, at least."""
BEYOND_HALF = 1e6
"""Change of a state in that stretch, over that in half of it, beyond which neither tells its size:
friction may grow exponentially at speeds against the mode, which stages of long steps reach."""
BLURRED = 4e4
"""Time over that stretch at which its rounding blurs all that a growing load does in it.

What tolerates less than the rounding of the time takes short steps until the state is larger.
"""
SLOW_CHANGE = 0.01
"""Change of every state in a step, over its size, that is slow."""
SLOW_STEPS = 15
"""Steps in a row that damping keeps short although all is slow, after which a mode is stiff; as
many as in the test of stiffness in Hairer's DOP853."""


def choose_stepper(stop: float, w: Vector, iw: IntVector) -> None:
    """Choose for the mode that begins."""
    values = iw[layout.VALUES]
    iw[layout.SLOW] = 0
    if iw[layout.N_CONTACTS] == 0 and iw[layout.HAS_BRISTLES] and abs(iw[layout.MODE]) == 1:
        iw[layout.STEPPER] = layout.STIFF
    else:
        equations.linear(w[layout.TIME], w, iw, iw[layout.Y], values)
        others = (
            layout.STIFF if iw[layout.N_CONTACTS] > 0 and iw[layout.HAS_BRISTLES] else layout.SMOOTH
        )
        iw[layout.STEPPER] = layout.EXACT if w[values] > 0.0 else others
    if iw[layout.STEPPER] != layout.EXACT:
        if iw[layout.N_CONTACTS] == 0:
            probe_sizes(stop, w, iw)
        if (
            not stop + w[layout.STEP] > stop
        ):  # none yet, or one left over from an event soon after 0
            w[layout.STEP] = FIRST_SHARE * (stop - w[layout.TIME])


def note_pulls(w: Vector, iw: IntVector) -> None:
    """Note how large the forces are on coordinates that have had no rate yet.

    Where they balance, as those of a spring without tension far from 0 do, what is left of them as
    others begin to move is no more than their rounding for a while.
    """
    n, coordinates, slopes = (
        iw[layout.N_STATES],
        iw[layout.N_COORDINATES],
        iw[layout.MATRIX],
    )
    equations.jacobian(w[layout.TIME], w, iw, iw[layout.Y], slopes)
    for i in range(coordinates):
        rate = coordinates + i
        w[iw[layout.PULLS] + i] = 0.0
        if w[iw[layout.SCALE] + rate] == 0.0:
            for j in range(n):
                w[iw[layout.PULLS] + i] += abs(w[slopes + rate * n + j] * w[iw[layout.Y] + j])


def probe_sizes(stop: float, w: Vector, iw: IntVector) -> None:
    """Give a size to states that have none yet: a small part of what a first stretch brings.

    What is at rest begins as a power of time, which no relative error control gets started.
    """
    n = iw[layout.N_STATES]
    scale = iw[layout.SCALE]
    y1 = iw[layout.Y1]
    slip = iw[layout.SLIP]
    y = iw[layout.Y]
    mode = iw[layout.MODE]
    half = iw[layout.DENSE]
    missing = False
    for i in range(n):
        missing = missing or w[scale + i] == 0.0
    if missing:
        note_pulls(w, iw)
    h = PROBE * (stop - w[layout.TIME])
    trials = 0
    while missing and trials < PROBES and w[layout.TIME] + h > w[layout.TIME]:
        trials += 1
        rodas_step(w[layout.TIME], 0.5 * h, w, iw, 1.0)
        for i in range(n):
            w[half + i] = abs(w[y1 + i] - w[y + i])
        error = rodas_step(w[layout.TIME], h, w, iw, 1.0)
        for i in range(n):
            if w[scale + i] == 0.0 and abs(w[y1 + i] - w[y + i]) > BEYOND_HALF * w[half + i]:
                error = math.inf
        if error <= 1.0 and w[y1 + slip] * iw[layout.MODE] >= 0.0:
            blurred = abs(w[layout.TIME]) / (BLURRED * h)
            share = max(PROBED, min(1.0, blurred * blurred))
            for i in range(n):
                w[scale + i] = max(w[scale + i], share * abs(w[y1 + i] - w[y + i]))
            missing = False
        elif (
            iw[layout.HAS_BRISTLES]
            and error <= 1.0
            and w[y + slip] == 0.0
            and iw[layout.MODE] == mode
        ):
            iw[layout.MODE] = -mode  # what leads to the body tells only later which way it is drawn
        else:
            h *= PROBE
            iw[layout.MODE] = mode
    iw[layout.MODE] = mode


def watch_stiffness(h: float, w: Vector, iw: IntVector) -> None:
    """Go over to Rodas5P where steps stay short for the sake of a motion that has died away.

    Less the trace of the Jacobian, at the start of the step, is the sum of all dampings. It is
    asked for only where nothing changes much.
    """
    if iw[layout.N_CONTACTS] > 0 and iw[layout.N_VARIABLES] == 0:
        return  # there are no slopes, for nothing dies away
    y1 = iw[layout.Y1]
    y = iw[layout.Y]
    n = iw[layout.N_STATES]
    slow = True
    for i in range(n):
        change = abs(w[y1 + i] - w[y + i])
        slow = slow and change <= SLOW_CHANGE * size_of(i, 0.0, w, iw)
    if slow:
        slow = h * damping_of(w, iw) > 1.0
    iw[layout.SLOW] = iw[layout.SLOW] + 1 if slow else 0
    if iw[layout.SLOW] > SLOW_STEPS:
        iw[layout.STEPPER] = layout.STIFF
        w[layout.STEP] = h


def damping_of(w: Vector, iw: IntVector) -> float:
    """Return the sum of all rates at which motions die away, less those at which others grow.

    The series of one contact has the Jacobian at hand.
    """
    matrix, n = iw[layout.MATRIX], iw[layout.N_STATES]
    if iw[layout.STEPPER] != layout.EXACT or iw[layout.N_CONTACTS] > 0:
        equations.jacobian(w[layout.TIME], w, iw, iw[layout.Y], matrix)
    damping = 0.0
    for i in range(n):
        damping -= w[matrix + i * n + i]
    return damping
