"""DOP853: explicit Runge-Kutta of order 8 with dense output of order 7, for smooth modes."""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.error_scale import size_of
from stickslip.kernels.model_interface import field
from stickslip.kernels.state_layout import DENSE, DOP853_STAGES, N_STATES, POINT, STAGES, Y1, Y

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
    0.0,
    0.05260015195876773,
    0.0789002279381516,
    0.1183503419072274,
    0.2816496580927726,
    0.3333333333333333,
    0.25,
    0.3076923076923077,
    0.6512820512820513,
    0.6,
    0.8571428571428571,
    1.0,
    1.0,
    0.1,
    0.2,
    0.7777777777777778,
)
ERROR_3 = (
    -0.18980075407240762,
    0.0,
    0.0,
    0.0,
    0.0,
    4.450312892752409,
    1.8915178993145003,
    -5.801203960010585,
    -0.4226823213237919,
    -0.1521609496625161,
    0.20136540080403034,
    0.02265179219836082,
    0.0,
)
ERROR_5 = (
    0.01312004499419488,
    0.0,
    0.0,
    0.0,
    0.0,
    -1.2251564463762044,
    -0.4957589496572502,
    1.6643771824549864,
    -0.35032884874997366,
    0.3341791187130175,
    0.08192320648511571,
    -0.022355307863886294,
    0.0,
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


def dop853_stage(s: int, t: float, h: float, w: Vector, whole: Wholes, at: int) -> None:
    """Evaluate stage `s` from the ones before it, at a state that is written to `at`."""
    stages = whole[STAGES]
    y = whole[Y]
    n = whole[N_STATES]
    row = s * (s - 1) // 2
    for i in range(n):
        total = 0.0
        for j in range(s):
            total += A[row + j] * w[stages + j * n + i]
        w[at + i] = w[y + i] + h * total
    field(t + C[s] * h, w, whole, at, stages + s * n)


def dop853_step(t: float, h: float, w: Vector, whole: Wholes, rtol: float) -> float:
    """Try a step; return its error over the tolerance.

    Stage 12 is the slope at the solution, which is left in Y1.
    """
    stages = whole[STAGES]
    y1 = whole[Y1]
    n = whole[N_STATES]
    field(t, w, whole, whole[Y], stages)
    for s in range(1, 13):
        dop853_stage(s, t, h, w, whole, y1)
    sum_5 = 0.0
    sum_3 = 0.0
    for i in range(n):
        size = rtol * size_of(i, h, w, whole)
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


def dop853_dense(t: float, h: float, w: Vector, whole: Wholes) -> None:
    """Fill the dense output of the step just taken."""
    dense = whole[DENSE]
    stages = whole[STAGES]
    y1 = whole[Y1]
    y = whole[Y]
    point = whole[POINT]
    n = whole[N_STATES]
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
        dop853_stage(s, t, h, w, whole, point)
    for row in range(4):
        for i in range(n):
            total = 0.0
            for s in range(DOP853_STAGES):
                total += D[16 * row + s] * w[stages + s * n + i]
            w[dense + 1 + (4 + row) * n + i] = h * total
