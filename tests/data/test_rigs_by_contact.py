"""Rig files of mechanisms with several contacts."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from benchmarks.several.brakes import ClutchTrain, DiscBrake, Lining, Rotor
from tests.contact_cases import coulomb

from stickslip import BlockChain, EventDriven, LuGre, TwoFeet, load_rig
from stickslip.data import LawEstimates, Rig, rig_schema, rig_toml
from stickslip.engine.simulation import simulate
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import Laws
from stickslip.mechanisms.drives import Pulse, Sine
from stickslip.study.sweep import band_of

PLAIN = EventDriven(tier="python")

FEET = """
[mechanism]
type = "two-feet"
mass = "2 kg"
front = "30 cm"
rear = 0.2
height = 0.15
stiffness = "50 N/m"

[friction]
static_coefficient = 0.7

[friction.front]
kinetic_coefficient = 0.6

[friction.rear.coulomb]
kinetic_coefficient = 0.2
static_coefficient = 0.3

[run]
t_end = "3 s"
initial = { x = "90 cm" }
"""
FRONT = "[friction.front]\nkinetic_coefficient = 0.6\n"
CLUTCHES = """
[mechanism]
type = "benchmarks.several.brakes:ClutchTrain"
rotors = [
    { inertia = "1 kg m^2", torque = { type = "sine", amplitude = "10 N m", frequency = "5 Hz" } },
    { inertia = 1.0 },
]
brake = { radius = "20 cm", load = "5 N" }

[[mechanism.clutches]]
radius = "1 m"
press = [{ type = "pulse", level = "20 N", duration = 10, start = "400 ms" },
         { type = "sine", amplitude = 1.0, frequency = 1.0 }]

[friction]
kinetic_coefficient = 0.5
"""


@pytest.fixture
def read(tmp_path, monkeypatch):
    """Reads a rig file with the given text."""
    monkeypatch.chdir(tmp_path)

    def reader(text, overrides=None):
        Path("rig.toml").write_text(text, encoding="utf-8")
        return load_rig("rig.toml", overrides=overrides, allow_import=True)

    return reader


def test_each_contact_has_a_table_beside_what_is_shared(read):
    rig = read(FEET)
    assert rig.law_by_contact() == {"front": coulomb(0.6, 0.7), "rear": coulomb(0.2, 0.3)}
    assert rig.initial == {"x": 0.9}
    assert not rig.laws
    assert "front: coulomb; rear: coulomb" in repr(rig)


def test_a_rig_moves_as_its_mechanism_and_laws_in_python(read):
    rig = read(FEET)
    solver = EventDriven(tier="python")
    run = simulate(rig.mechanism, rig.law_by_contact(), t_end=1.0, y0=rig.initial, solver=solver)
    body = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15, stiffness=50.0)
    laws = {"front": coulomb(0.6, 0.7), "rear": coulomb(0.2, 0.3)}
    assert run["x"][-1] == simulate(body, laws, t_end=1.0, y0={"x": 0.9}, solver=solver)["x"][-1]


def test_without_tables_of_contacts_all_of_them_share_a_law(read):
    rig = read(CLUTCHES)
    assert rig.laws["coulomb"].kinetic_coefficient == 0.5
    assert not rig.contacts


def test_parts_and_their_drives_are_tables(read):
    press = Pulse(level=20.0, duration=10.0, start=0.4) + Sine(amplitude=1.0, frequency=1.0)
    assert read(CLUTCHES).mechanism == ClutchTrain(
        rotors=(Rotor(inertia=1.0, torque=Sine(amplitude=10.0, frequency=5.0)), Rotor(inertia=1.0)),
        clutches=(Lining(radius=1.0, press=press),),
        brake=Lining(radius=0.2, load=5.0),
    )


def test_overrides_reach_a_law_of_one_contact_and_a_number_of_one_part(read):
    rig = read(FEET, {"friction.rear.coulomb.kinetic_coefficient": "0.25"})
    assert rig.law_by_contact()["rear"] == coulomb(0.25, 0.3)
    rig = read(FEET, {"friction.static_coefficient": 0.9})  # shared: it comes before all
    assert rig.law_by_contact() == {"front": coulomb(0.6, 0.9), "rear": coulomb(0.2, 0.9)}
    rig = read(CLUTCHES, {"mechanism.clutches.0.load": "3 N"})
    assert rig.mechanism.clutches[0].load == 3.0


def test_a_contact_at_which_nothing_rubs_says_so(read):
    rig = read(FEET.replace(FRONT, 'front = "none"\n'))
    assert rig.law_by_contact() == {"front": None, "rear": coulomb(0.2, 0.3)}


def test_a_contact_without_a_table_has_the_shared_values(read):
    shared = "[friction]\nkinetic_coefficient = 0.5\n"
    rig = read(FEET.replace("[friction]\n", shared).replace(FRONT, ""))
    assert rig.law_by_contact()["front"] == coulomb(0.5, 0.7)


def test_laws_are_chosen_by_name_for_all_contacts_or_for_each(read):
    lugre = (
        "[friction.front.lugre]\nbristle_stiffness = 1e4\nbristle_damping = 5.0\n"
        "stribeck_velocity = 0.01\n"
    )
    text = FEET.replace("[friction.rear.coulomb]", f"{lugre}\n[friction.rear.coulomb]")
    rig = read(text)
    assert isinstance(rig.law_by_contact()["front"], LuGre)  # the only one with a table
    assert rig.law_by_contact({"front": "coulomb"})["front"] == coulomb(0.6, 0.7)
    assert rig.law_by_contact("coulomb")["front"] == coulomb(0.6, 0.7)
    with pytest.raises(InputError, match=r"'rear' has no values of the law 'lugre'.*none"):
        rig.law_by_contact("lugre")
    with pytest.raises(UnknownNameError, match="Did you mean 'rear'"):
        rig.law_by_contact({"reer": "coulomb"})


ESTIMATES = '[estimates]\nlaw = { front = "coulomb", rear = "coulomb" }\n'
BAD = {
    "a misspelt contact": ("friction.front]", "friction.fronnt]", "Did you mean 'front'"),
    "a misspelt law": ("rear.coulomb", "rear.coulom", r"in \[friction.rear\].*'coulomb'"),
    "a misspelt value": (
        "kinetic_coefficient = 0.6", "kinetik_coefficient = 0.6",
        r"in \[friction.front\].*'kinetic_coefficient'",
    ),
    "a law beside contacts": (
        FRONT, "[friction.coulomb]\nkinetic_coefficient = 0.6\n",
        r"\[friction.coulomb\] stands beside tables of contacts.*\[friction.front.coulomb\]",
    ),
    "a missing value": (
        "kinetic_coefficient = 0.2\n", "",
        r"friction.rear.coulomb.kinetic_coefficient \(mu_k\) is missing.*\[friction.rear\]",
    ),
    "levels in the wrong order": (
        "kinetic_coefficient = 0.6", "kinetic_coefficient = 0.8",
        "friction.front.coulomb: Coulomb.static_coefficient .* must be at least",
    ),
    "no table": ("[friction.front]\nkinetic_coefficient = 0.6", 'front = "no"', "must be a table"),
    "a wrong unit": ('"2 kg"', '"2 m"', "mechanism.mass .* must be in kg"),
    "no such state": ("x = ", "y = ", r"run.initial: 'y'"),
    "a wrong unit of a state": ('"90 cm"', '"90 kg"', "run.initial: x .* must be in m"),
    "too few parts": ("mass", "mas", "Did you mean 'mass'"),
    "estimates of one law": (
        "[run]", '[estimates]\nlaw = "coulomb"\n\n[run]',
        'name these, as in law = { front = "coulomb", rear = "coulomb" }',
    ),
    "estimates of no contact": (
        "[run]", '[estimates]\nlaw = { frnt = "coulomb" }\n\n[run]',
        r"contact in estimates.law in rig.toml: 'frnt'. Did you mean 'front'",
    ),
    "estimates of a law that is not there": (
        "[run]", '[estimates]\nlaw = { rear = "dahl" }\n\n[run]',
        "rig.toml: the contact 'rear' has no values of the law 'dahl'",
    ),
    "an interval of no contact": (
        "[run]", f'{ESTIMATES}intervals.raer.kinetic_coefficient = [0.1, 0.3]\n\n[run]',
        r"parameter of the laws in estimates in rig.toml: 'raer.kinetic_coefficient'",
    ),
    "an interval of no parameter": (
        "[run]", f'{ESTIMATES}intervals.rear.kinetic = [0.1, 0.3]\n\n[run]',
        r"'rear.kinetic'. Did you mean 'rear.kinetic_coefficient'",
    ),
    "no names of laws": (
        "[run]", "[estimates]\nlaw = { rear = 3 }\n\n[run]",
        "estimates.law must be the name of a law",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("old", "new", "message"), BAD.values(), ids=BAD)
def test_a_mistake_gives_one_message_with_place_and_cure(read, old, new, message):
    assert old in FEET
    with pytest.raises(InputError, match=message):
        read(FEET.replace(old, new))


def test_a_contact_without_any_law_is_named_when_it_is_asked_for(read):
    rig = read(FEET.replace(FRONT, ""))
    with pytest.raises(InputError, match="'front' has no values of any law"):
        rig.law_by_contact()


def test_overrides_of_contacts_are_named_where_they_are_wrong(read):
    with pytest.raises(InputError, match=r"override of .*: friction.rear.coulomb.static_coeff"):
        read(FEET, {"friction.rear.coulomb.static_coefficient": 0.1})
    with pytest.raises(UnknownNameError, match=r"override of .*'reer'. Did you mean 'rear'"):
        read(FEET, {"friction.reer.kinetic_coefficient": 0.1})


@pytest.mark.parametrize("name", ["coulomb", "dahl"])
def test_a_contact_that_is_named_like_a_law_is_refused(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    Path("own_feet.py").write_text(
        "from stickslip.mechanisms import Contact, Mechanism\n"
        "class Feet(Mechanism):\n"
        "    name, coordinates, rates, units = 'feet', ('x', 'y'), ('v', 'w'), ('m', 'm')\n"
        "    def kinetic_energy(self, q, q_dot): return q_dot['x'] ** 2 + q_dot['y'] ** 2\n"
        "    def potential_energy(self, t, q): return 0.0\n"
        "    def forces(self, t, q, q_dot, drives): return {}\n"
        "    def drives(self): return {}\n"
        "    def contacts(self):\n"
        "        return (Contact(slip='x', load=1.0, name='a'),\n"
        f"                Contact(slip='y', load=1.0, name='{name}'))\n"
    )
    Path("rig.toml").write_text('[mechanism]\ntype = "own_feet:Feet"\n[friction]\n')
    try:
        with pytest.raises(InputError, match=f"contact '{name}' has the name of a law"):
            load_rig("rig.toml", allow_import=True)
    finally:
        import sys

        sys.modules.pop("own_feet", None)
        sys.path.remove(str(tmp_path.resolve()))


ROUND = {
    "two feet": (
        TwoFeet(mass=2.0, front=0.3, rear=0.2), {"front": coulomb(0.6, 0.7), "rear": None},
    ),
    "two laws": (
        TwoFeet(mass=2.0, front=0.3, rear=0.2),
        {
            "front": coulomb(0.6, 0.7),
            "rear": LuGre(
                kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.01,
                bristle_stiffness=1e4, bristle_damping=5.0,
            ),
        },
    ),
    "one contact": (
        DiscBrake(inertia=1.0, pads=(Lining(radius=0.1, load=3.0),)), {"pad-1": coulomb(0.2)},
    ),
    "parts with drives": (
        ClutchTrain(
            rotors=(Rotor(inertia=1.0, torque=Sine(amplitude=math.pi, frequency=1.0)),
                    Rotor(inertia=2.0)),
            clutches=(Lining(radius=0.1, press=Pulse(level=1.0, duration=2.0)
                             + Sine(amplitude=0.1, frequency=2.0)),),
            brake=Lining(radius=0.3, load=1.0),
        ),
        {"clutch-1": coulomb(0.3), "brake": None},
    ),
    "a shared law": (BlockChain(blocks=3, mass=1.0, coupling=2.0, speed=0.1), coulomb(0.1, 0.2)),
}  # fmt: skip


@pytest.mark.parametrize(("mechanism", "laws"), ROUND.values(), ids=ROUND)
def test_what_is_written_is_read_back(read, mechanism, laws):
    rig = read(rig_toml(mechanism, laws, t_end=2.0))
    assert rig.mechanism == mechanism
    if rig.contacts:
        assert rig.law_by_contact() == laws
    else:
        (law,) = rig.laws.values()
        assert law == (next(iter(laws.values())) if isinstance(laws, dict) else laws)


def test_the_schema_leaves_room_for_contacts_of_which_it_knows_no_names():
    friction = rig_schema()["$defs"]["Friction"]
    assert {"$ref": "#/$defs/Friction"} in friction["additionalProperties"]["anyOf"]


def test_the_schema_takes_names_and_intervals_by_contact():
    """Without quotes, TOML makes a table of the contact in ``rear.kinetic_coefficient``."""
    known = rig_schema()["$defs"]["EstimatesTable"]["properties"]
    interval, table = known["intervals"]["additionalProperties"]["anyOf"]
    assert interval["type"] == "array"
    assert table == {"type": "object", "additionalProperties": interval}
    assert [entry["type"] for entry in known["law"]["anyOf"]] == ["string", "object"]


def test_rig_checks_names_of_contacts_and_states():
    body = TwoFeet(mass=2.0, front=0.3, rear=0.2)
    with pytest.raises(UnknownNameError, match="'front'"):
        Rig(mechanism=body, contacts={"fornt": None})
    with pytest.raises(UnknownNameError, match="initial"):
        Rig(mechanism=body, initial={"xx": 1.0})
    with pytest.raises(InputError, match="no laws by contact"):
        Rig(mechanism=body).law_by_contact()


ARM = """
[mechanism]
type = "two-link-arm"
upper_mass = 0.6
upper_length = 0.2
upper_centre = 0.1
upper_inertia = 0.012
lower_mass = 0.5
lower_centre = 0.2
lower_inertia = 0.03
[friction]
kinetic_coefficient = 0.2
static_coefficient = 0.3
{shared}
[friction.elbow]
{elbow}
"""
SPEED = 'stribeck_velocity = "3 deg/s"'


@pytest.mark.parametrize(("shared", "elbow"), [(SPEED, ""), ("", SPEED)])
def test_a_contact_that_slips_along_an_angle_takes_speeds_of_turning(read, shared, elbow):
    law = read(ARM.format(shared=shared, elbow=elbow)).law_by_contact(
        {"shoulder": "coulomb", "elbow": "stribeck"}
    )["elbow"]
    assert law.stribeck_velocity == pytest.approx(math.radians(3.0))


def test_a_contact_that_slips_along_a_line_does_not(read):
    axis = '[mechanism]\ntype = "axis"\ninertia = 1.0\n[friction]\n'
    pendulum = axis.replace("axis", "pendulum").replace("inertia", "length = 0.5\nmass")
    assert read(pendulum + SPEED) is not None
    with pytest.raises(InputError, match=r"stribeck_velocity \(v_s\) must be in m/s.*deg/s"):
        read(axis + SPEED)


def test_more_contacts_than_can_be_simulated_are_refused(read):
    with pytest.raises(
        InputError, match=r"rig\.toml: mechanism\.blocks .* at most 1000, got 10000"
    ):
        read('[mechanism]\ntype = "block-chain"\nblocks = 10000\nmass = 1.0\ncoupling = 1.0\n')


KNOWN = LawEstimates(
    law={"front": "coulomb", "rear": "coulomb"},
    intervals={"front.kinetic_coefficient": (0.5, 0.7), "rear.kinetic_coefficient": (0.1, 0.3)},
    covariance_of=("front.kinetic_coefficient", "rear.kinetic_coefficient"),
    covariance=((0.0026, -0.0025), (-0.0025, 0.0026)),
    not_identified={"front.static_coefficient": "it never sticks"},
    not_fitted=("rear.static_coefficient",),
)
"""Correlated across the contacts: -0.96."""
BODY = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15, stiffness=50.0)
LAWS = {"front": coulomb(0.6, 0.7), "rear": coulomb(0.2, 0.3)}


def test_estimates_by_contact_are_read_back_as_they_were_written(read):
    rig = read(rig_toml(BODY, LAWS, estimates=KNOWN))
    assert rig.estimates == KNOWN
    assert rig.law_by_contact() == LAWS


def test_estimates_of_some_contacts_need_no_word_on_the_others(read):
    own = """[estimates]
law.rear = "coulomb"
intervals.rear.kinetic_coefficient = [0.1, 0.3]
[run]"""
    rig = read(FEET.replace("[run]", own))
    assert rig.estimates.intervals == {"rear.kinetic_coefficient": (0.1, 0.3)}
    draws = rig.estimates.draw(Laws(members=tuple(rig.law_by_contact().items())), 3)
    assert list(draws) == ["friction.rear.kinetic_coefficient"]


@pytest.mark.parametrize(
    ("path", "left"),
    [
        ("friction.rear.coulomb.kinetic_coefficient", ["front.kinetic_coefficient"]),
        ("friction.front.kinetic_coefficient", ["rear.kinetic_coefficient"]),
        ("friction.kinetic_coefficient", []),
    ],
)
def test_what_is_overridden_at_a_contact_is_no_longer_an_estimate(read, path, left):
    text = FEET.replace("[friction]", "[friction]\nkinetic_coefficient = 0.4")
    known = rig_toml(BODY, LAWS, estimates=KNOWN)
    text = text.replace("[run]", known[known.index("[estimates]") :] + "[run]")
    rig = read(text, {path: 0.25})
    assert list(rig.estimates.intervals) == left
    assert list(rig.estimates.covariance_of) == left


def test_what_joints_have_in_common_makes_no_band():
    """Two pads brake by the sum of their coefficients: opposite errors leave the travel alone."""
    pads = (Lining(radius=0.1, load=100.0), Lining(radius=0.1, load=100.0))
    brake = DiscBrake(inertia=0.5, pads=pads)
    laws = {"pad-1": coulomb(0.3, 0.5), "pad-2": coulomb(0.2, 0.5)}
    names = ("pad-1.kinetic_coefficient", "pad-2.kinetic_coefficient")
    alone = LawEstimates(
        law=dict.fromkeys(laws, "coulomb"),
        intervals={names[0]: (0.28, 0.32), names[1]: (0.18, 0.22)},
    )
    spread = 1e-4
    opposite = replace(
        alone, covariance_of=names, covariance=((spread, -spread), (-spread, spread))
    )
    asked = {"t_end": 3.0, "count": 12, "y0": {"omega": 20.0}, "solver": PLAIN}
    band = band_of(brake, laws, alone, **asked)
    drawn = sum(band.draws[f"friction.{name}"] for name in names)
    expected = np.quantile(0.5 * 0.5 * 20.0**2 / (10.0 * drawn), [0.025, 0.5, 0.975])
    np.testing.assert_allclose(band.travel, expected, rtol=1e-9)  # of the solver
    low, _, high = band_of(brake, laws, opposite, **asked).travel
    assert np.ptp(expected) > 1.0
    assert high - low < 1e-9 * low


def test_all_coordinates_of_several_contacts_have_a_band():
    chain = BlockChain(blocks=2, mass=1.0, coupling=4.0)
    laws = {"block-1": coulomb(0.3, 0.5), "block-2": coulomb(0.2, 0.5)}
    known = LawEstimates(
        law={"block-2": "coulomb"}, intervals={"block-2.kinetic_coefficient": (0.15, 0.25)}
    )
    asked = {"t_end": 2.0, "count": 3, "y0": {"v1": 3.0}, "solver": PLAIN}
    band = band_of(chain, laws, known, **asked)
    assert set(band.states) == {"x1", "x2", "v1", "v2"}
    for i in (0, 1, 2):
        np.testing.assert_array_equal(band.states["x2"][i, -1], band.travels["x2"][i])
    assert band.to_dict()["travel"].keys() == {"x1", "x2"}
    assert "travel of x2" in band._repr_html_()
    with pytest.raises(InputError, match=r"several coordinates, x1, x2"):
        assert band.travel


HOT = """
[mechanism]
type = "benchmarks.several.brakes:DiscBrake"
inertia = 0.5
pads = [{ radius = 0.1, load = 60 }, { radius = 0.12, load = 40 }]

[contact]
temperature = "20 degC"

[contact.pad-2]
temperature = "573.15 K"

[friction.hot]
law = "level * exponential[temperature]"
kinetic_coefficient = 0.4
level_temperature_decay = 0.001
"""


def test_each_of_several_contacts_may_have_a_table_of_inputs_of_its_own(read, tmp_path):
    rig = read(HOT)
    (hot,) = rig.laws.values()
    run = simulate(rig.mechanism, hot, t_end=0.1, y0={"omega": 2.0})
    # torques fade as exp(-0.02) and exp(-0.3): the closed form of a constant torque
    torque = 0.4 * (6.0 * math.exp(-0.02) + 4.8 * math.exp(-0.3))
    expected = 0.2 - 0.5 * torque / 0.5 * 0.01
    assert run["phi"][-1] == pytest.approx(expected, rel=1e-12)
    path = tmp_path / "again.toml"
    path.write_text(rig_toml(rig.mechanism, hot), encoding="utf-8")
    assert load_rig(path, allow_import=True).mechanism == rig.mechanism
    cooled = read(HOT, overrides={"contact.pad-2.temperature": "20 degC"})
    assert cooled.mechanism.contact_pad_2_temperature == 20.0
    one = read(HOT, overrides={"contact.pad-1.temperature": 90.0})
    assert one.mechanism.contact_pad_1_temperature == 90.0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[contact.pad-2]", "[contact.pad-3]", r"unknown key in \[contact\].*'pad-3'.*'pad-2'"),
        ("573.15 K", "-5 K", r"contact.pad-2.temperature \(T\) must be at least"),
        ('temperature = "573.15 K"', "heat = 3.0", "'heat'"),
        ('temperature = "573.15 K"', "position = 3.0", "computes contact.pad-2.position"),
    ],
)
def test_wrong_inputs_of_a_contact_are_named(read, old, new, words):
    assert old in HOT
    with pytest.raises(InputError, match=words):
        read(HOT.replace(old, new))
