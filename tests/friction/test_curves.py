"""Levels that were measured at several speeds: ``table["curve.csv"]``."""

import math
import pickle

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from stickslip import Axis, EventDriven, TwoMassAxis, load_rig, simulate
from stickslip.errors import InputError
from stickslip.friction import law
from stickslip.friction.parts.levels import MOST_POINTS

POINTS = [(0.0, 2.0), (0.01, 1.5), (0.05, 1.2), (0.08, 1.25), (0.3, 1.1)]
TEXT = "table[0: 2, 0.01: 1.5, 0.05: 1.2, 0.08: 1.25, 0.3: 1.1]"


@pytest.mark.parametrize("count", [2, 3, 5, 32])
def test_the_curve_is_the_monotone_cubic_of_scipy_and_constant_beyond_its_points(count):
    random = np.random.default_rng(count)
    x = np.cumsum(random.uniform(1e-3, 0.1, count))
    y = np.round(random.uniform(0.5, 2.0, count), 6)
    x = np.round(x, 9)
    points = zip(x.tolist(), y.tolist(), strict=True)
    one = law(f"table[{', '.join(f'{a!r}: {b!r}' for a, b in points)}]")()
    v = np.linspace(x[0], x[-1], 501)
    wanted = PchipInterpolator(x, y)(v)
    # the cubics are summed in another order
    assert one.force(v, 3.0) == pytest.approx(3.0 * wanted, rel=1e-13)
    assert [one.force(float(u), 3.0) for u in v] == pytest.approx(3.0 * wanted, rel=1e-13)
    assert one.force(10.0, 1.0) == y[-1]
    assert one.force(-0.5 * x[0], 1.0) == -y[0]
    assert one.break_away(2.0) == 2.0 * y[0]
    assert y.min() <= one.force(v, 1.0).min() <= one.force(v, 1.0).max() <= y.max()


def test_a_block_on_a_falling_line_stops_as_its_closed_form():
    # 2 v' = v - 2 below 1 m/s
    falling = law("table[0: 2, 1: 1]")()
    run = simulate(Axis(inertia=2.0), falling, t_end=3.0, y0={"v": 0.9})
    (stop,) = run.events
    assert stop.t == pytest.approx(2.0 * math.log(2.0 / 1.1), rel=1e-10)
    assert run.certificate.certified
    slope = simulate(Axis(inertia=2.0), falling, t_end=0.5, y0={"v": 0.9}).sensitivity(
        "v", "curve_factor"
    )
    # v = 2 - 1.1 exp(t/2) at c = 1; d/dc of v' = -c (2 - v) / 2
    assert slope[-1] == pytest.approx(-1.1 * 0.25 * math.exp(0.25), rel=1e-8)


@pytest.mark.parametrize(
    "text",
    [
        "speed [mm/s];level [N]\n0;2.0\n10;1.5\n50;1.2\n80;1.25\n300;1.1\n",
        "0 2\n.01 1.5\n5e-2 1.2\n0.08 1.25\n0.3 1.1\n",
        "# a note\nvelocity [m/s],friction\n0,2\n0.01,1.5\n0.05,1.2\n0.08,1.25\n0.3,1.1",
    ],
)
def test_a_file_is_read_once_and_the_law_holds_its_points(tmp_path, text):
    path = tmp_path / "curve.csv"
    path.write_text(text, encoding="utf-8")
    kind = law(f'table["{path}"] + viscous')
    assert kind is law(f"{TEXT} + viscous")
    path.unlink()
    one = kind(viscous_coefficient=0.5)
    assert pickle.loads(pickle.dumps(one)) == one
    assert law(str(kind.composition)) is kind
    assert "." not in kind.name  # dots separate names in paths


TWO_WAYS = "table[-0.3: 3, -0.01: 4, 0: 2, 0.01: 1.5, 0.3: 1.1]"
AHEAD, BACK = law("table[0: 2, 0.01: 1.5, 0.3: 1.1]")(), law("table[0.01: 4, 0.3: 3]")()


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("{}", {}),
        ("{} + viscous", {"viscous_coefficient": 0.0}),
        ("dahl({})", {"bristle_stiffness": 1e5}),
        ("lugre({})", {"bristle_stiffness": 1e5, "bristle_damping": 0.0}),
    ],
)  # fmt: skip
def test_points_at_velocities_below_0_are_those_of_the_other_direction(text, values):
    one = law(text.format(TWO_WAYS))(**values)
    v = np.geomspace(0.001, 1.0, 50)
    assert one.directional
    assert law(str(one.composition)) is type(one)
    np.testing.assert_array_equal(one.steady(v, 3.0), AHEAD.force(v, 3.0))
    np.testing.assert_array_equal(one.steady(-v, 3.0), BACK.force(-v, 3.0))
    assert [one.steady(float(u), 3.0) for u in v] == pytest.approx(AHEAD.force(v, 3.0), rel=1e-15)
    assert [one.towards(side).break_away(2.0) for side in (1, -1)] == [4.0, 8.0]
    assert one.break_away(2.0) == 4.0  # the lower one


def test_a_body_slows_in_each_direction_as_the_points_of_that_direction_say():
    both = law("table[-1: 4, -0.1: 4, 0.1: 1, 1: 1]")()
    for speed, level in ((0.9, 1.0), (-0.9, 4.0)):
        run = simulate(Axis(inertia=2.0), both, t_end=3.0, y0={"v": speed})
        (stop,) = run.events
        # the time in which a constant force of the level takes the momentum
        assert stop.t == pytest.approx(2.0 * 0.9 / level, rel=1e-10)
        assert run.certificate.certified


WRONG = {
    "missing": (None, "cannot be read: No such file"),
    "picture": (b"\x89PNG\r\n\x1a\n\xff\xfe", "cannot be read: it is no text"),
    "empty": (b"", r"has 0 points: a curve needs 2 to 32\."),
    "one column": (b"1\n2\n", "row 1, '1', must be a speed and a level"),
    "words": (b"v,f\n0,1\n0.1,x1\n", "row 2, '0.1,x1', must be a speed and a level"),
    "unsorted": (b"0,2\n0.1,1\n0.05,1\n", r"the speed 0.05 of point 3 is not above 0.1 before"),
    "a speed twice": (b"0,2\n0.1,1\n0.1,1.1\n", "not above 0.1 before it"),
    "one point back": (
        b"-0.1,2\n0,2\n0.1,1\n",
        "1 point at velocities below 0: .* 2 to 32 in each",
    ),
    "only back": (b"-0.2,2\n-0.1,1\n", "0 points at velocities from 0 on: .* in each direction"),
    "a signed level": (
        b"-0.2,-2\n-0.1,-1\n0,1\n0.1,1\n",
        "level -2; .* above 0 in either direction",
    ),
    "a negative level": (
        b"0,2\n0.1,-1\n",
        "the level -1; both must be finite, and the level above 0",
    ),
    "infinite": (b"0,2\n1e999,1\n", "speed inf"),
    "no level at rest": (b"0,0\n0.1,1\n", "and the level above 0"),
    "a wrong unit": (b"position [mm],f [N]\n0,2\n1,1\n", r"a column in \[mm\] is no speed"),
    "too many": (b"".join(b"%d,1\n" % i for i in range(MOST_POINTS + 1)), "has 33 points"),
}


@pytest.mark.parametrize(("content", "said"), WRONG.values(), ids=WRONG)
def test_a_file_that_is_no_curve_is_refused_with_the_reason(tmp_path, content, said):
    path = tmp_path / "curve.csv"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=said):
        law(f'table["{path}"]')


@pytest.mark.parametrize(
    ("header", "points"),
    [
        ("# speed [mm/s],level [kN]", "0: 2000, 1e-2: 1000"),  # as numpy.savetxt writes it
        ("# rig of 2024\nspeed [mm/s];mu [-]", "0: 2, 1e-2: 1"),
        ("speed,level [kN]", "0: 2000, 10: 1000"),
        ("v [mm/s] F [N]", "0: 2, 1e-2: 1"),
        ("v[mm/s] ,\tF[N]", "0: 2, 1e-2: 1"),
        ("# made [by hand], in newtons\nv,F", "0: 2, 10: 1"),
    ],
)
def test_units_of_a_curve_are_those_of_their_column(tmp_path, header, points):
    path = tmp_path / "curve.csv"
    path.write_text(f"{header}\n0,2\n10,1\n", encoding="utf-8")
    assert str(law(f'table["{path}"]').composition) == f"table[{points}]"


def test_a_table_without_a_curve_says_how_to_write_one():
    with pytest.raises(InputError, match=r'write table\["curve.csv"\]'):
        law("level + table")


RIG = """
[mechanism]
type = "axis"
inertia = 2.0

[friction.joint]
law = 'table["curve.csv"] + viscous'
viscous_coefficient = 0.5
"""


def test_a_rig_file_names_curves_beside_it_and_several_contacts_have_their_own(
    tmp_path, monkeypatch
):
    (tmp_path / "rig").mkdir()
    rows = "".join(f"{x},{y}\n" for x, y in POINTS)
    (tmp_path / "rig" / "curve.csv").write_text(rows, encoding="utf-8")
    (tmp_path / "rig" / "axis.toml").write_text(RIG, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    rig = load_rig("rig/axis.toml", overrides={"friction.joint.curve_factor": 0.5})
    (one,) = rig.laws.values()
    assert one.force(0.05, 1.0) == pytest.approx(0.5 * 1.2 + 0.025, rel=1e-14)
    belt = TwoMassAxis(motor_inertia=1.0, load_inertia=2.0, stiffness=40.0, rubs="both")
    laws = {"load": one, "motor": law("lugre(table[1e-3: 3e-1, 1e-1: 2e-1])")(
        bristle_stiffness=1e3, bristle_damping=1.0
    )}  # fmt: skip
    run = simulate(belt, laws, t_end=3.0, y0={"v": 0.4}, solver=EventDriven(tier="compiled"))
    assert run.certificate.certified
    assert {event.contact for event in run.events} == {"load", "motor"}
