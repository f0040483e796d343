"""Rig files: the bundled one, overrides, units, and everything that may be wrong with a file."""

import dataclasses
import hashlib
import json
import math
import tomllib
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import final

import pytest

from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    Measurement,
    PendulumCart,
    Rig,
    SerialArm,
    SpringBlock,
    TowedBlock,
    TwoLinkArm,
    TwoMassAxis,
    load_rig,
    simulate,
)
from stickslip.data import rig_schema
from stickslip.data.rigs.rig_writer import rig_toml
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.friction import LAWS
from stickslip.mechanisms import MECHANISMS, Link, Prescribed, Torque
from stickslip.mechanisms.drives import (
    PiecewiseAffine,
    PiecewiseLinear,
    Pulse,
    Ramp,
    Rotation,
    Sampled,
    SampledSwing,
    SevenStep,
    Sine,
    SineSwing,
    SplineSwing,
    Square,
    Sum,
    ThreePhase,
    TimedThreePhase,
)
from stickslip.mechanisms.drives.shapes import DRIVES, PROFILES

MECHANISM = '[mechanism]\ntype = "spring-block"\nmass = 1\n'
BUNDLED = files("stickslip.data").joinpath("paper_rig.toml").read_bytes()


@pytest.fixture
def read(tmp_path, monkeypatch):
    """Reads a rig file with the given text."""
    monkeypatch.chdir(tmp_path)

    def reader(text, overrides=None):
        Path("rig.toml").write_text(text, encoding="utf-8")
        return load_rig("rig.toml", overrides=overrides)

    return reader


# --- the bundled rig


def test_the_bundled_rig_is_table_one_of_the_paper():
    rig = load_rig()
    assert rig.mechanism == SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    assert rig.laws["coulomb"] == Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
    assert (rig.t_end, rig.path, rig.source) == (10.0, "paper_rig.toml", "paper")


def test_the_bundled_rig_has_the_measured_travel_with_its_rounding():
    (record,) = load_rig().measurement.records()
    assert (record.travel, record.uncertainty) == (0.20, {"travel": 0.005})
    assert record.uncertainty_kind == "rounding"


def test_the_bundled_rig_has_table_two():
    rows = {row.law: (row.travel, row.velocity_positive) for row in load_rig().published}
    assert rows == {
        "coulomb": (0.16, True),
        "dahl": (0.25, True),
        "lugre": (0.13, False),
        "stribeck": (0.45, True),
        "coulomb-viscous": (0.16, True),
    }


@pytest.mark.parametrize("row", load_rig().published, ids=lambda row: row.law)
def test_each_published_error_is_that_of_its_travel(row):
    measured = load_rig().measurement.travel
    # Table II prints whole percents.
    assert abs(row.travel - measured) / measured == pytest.approx(row.relative_error, abs=0.005)


def test_what_the_paper_does_not_print_is_marked_as_assumed():
    assumed = load_rig().assumed
    assert "coulomb" not in assumed
    assert assumed["lugre"] == ("stribeck_velocity", "bristle_stiffness", "bristle_damping")
    assert assumed["dahl"] == ("bristle_stiffness",)


def test_values_given_as_forces_are_divided_by_their_load():
    lugre = load_rig().laws["lugre"]
    assert lugre.bristle_stiffness == 1e4 / 9.81
    assert lugre.bristle_damping == 100 / 9.81


UNLOADED = '[mechanism]\ntype = "axis"\ninertia = 2.0\n'
OWN = """
[friction.own]
law = "both_ways(level) + viscous"
forward_kinetic_coefficient = "6 N +- 0.5 N"
backward_kinetic_coefficient = "5 N"
viscous_coefficient = 1.0
"""


def test_levels_may_be_forces_where_the_load_is_one(read):
    (law,) = read(UNLOADED + OWN).laws.values()
    assert (law.forward_kinetic_coefficient, law.backward_kinetic_coefficient) == (6.0, 5.0)
    turning = read(UNLOADED.replace("2.0", '"2 kg m^2"') + OWN.replace(" N", " N m"))
    (law,) = turning.laws.values()
    assert law.forward_kinetic_coefficient == 6.0
    shared = read(
        f'{UNLOADED}[friction]\nkinetic_coefficient = "600 cN"\nstatic_coefficient = "0.01 kN"'
    )
    assert shared.laws["coulomb"].kinetic_coefficient == pytest.approx(6.0)
    assert shared.laws["coulomb"].static_coefficient == pytest.approx(10.0)


def test_forces_over_a_known_load_are_refused_with_where_they_stand(read):
    where = (
        r"got '6 N.*stands as forward_kinetic_force under \[friction.own.forces\], with the load"
    )
    with pytest.raises(ParameterError, match=where):
        read(f"{UNLOADED}load = 3\n{OWN}")
    with pytest.raises(ParameterError, match="must be a pure number or in %, not in m,"):
        read(f"{UNLOADED}load = 3\n{OWN}".replace("6 N +- 0.5 N", "6 m"))


def test_forces_are_refused_where_the_record_tells_the_load(read):
    Path("run.csv").write_text(
        "velocity [m/s],friction [N],load [N]\n"
        + "".join(f"{v / 100},{2 + v},20\n" for v in range(1, 20)),
        encoding="utf-8",
    )
    with pytest.raises(ParameterError, match="forward_kinetic_force under"):
        read(f'{UNLOADED}[data]\nfile = "run.csv"\n{OWN}')
    pure = OWN.replace("6 N +- 0.5 N", "0.3").replace("5 N", "0.2")
    found = read(f'{UNLOADED}[data]\nfile = "run.csv"\n{pure}')
    assert found.measurement is not None


def test_the_bundled_rig_gives_the_closed_form_travel():
    rig = load_rig()
    run = simulate(rig.mechanism, rig.laws["coulomb"], t_end=rig.t_end)
    # k x0^2 / (2 mu m g); the solver's error is below 1e-9 m.
    assert run["x"][-1] == pytest.approx(0.5 / (0.25 * 9.81), abs=1e-9)


def test_the_digest_is_that_of_the_file_and_changes_with_overrides():
    assert load_rig().digest == hashlib.sha256(BUNDLED).hexdigest()
    assert load_rig(overrides={"run.t_end": 5}).digest != load_rig().digest
    assert (
        load_rig(overrides={"run.t_end": 5}).digest != load_rig(overrides={"run.t_end": 6}).digest
    )


# --- what a file may say


def test_a_mechanism_alone_is_a_rig(read):
    rig = read(MECHANISM)
    assert rig.title == "rig"
    assert (rig.measurement, dict(rig.laws), rig.published) == (None, {}, ())


def test_a_byte_order_mark_is_no_harm(read):
    assert read("\ufeff" + MECHANISM).mechanism.mass == 1.0


@pytest.mark.parametrize(
    ("text", "drive"),
    [
        ('type="pulse"\nlevel="10 N"\nduration="100 ms"', Pulse(level=10.0, duration=0.1)),
        ('type="sampled"\ntimes=[0,1]\nvalues=[1,2.5]\nhold="first"', None),
        ('type="piecewise-linear"\ntimes=[0,1]\nvalues=[1,2.5]', None),
        ('type="sine"\namplitude=1\nfrequency="2 Hz"\nphase="90 deg"', None),
        (
            'type="square"\nhigh="5 N"\nlow="-2 N"\nperiod="400 ms"\nduty="25 %"\nstart=0.1',
            Square(high=5.0, low=-2.0, period=0.4, duty=0.25, start=0.1),
        ),
        ('type="ramp"\nrate="1 N/s"', None),
    ],
)
def test_every_drive_can_be_written(read, text, drive):
    found = read(f"{MECHANISM}[mechanism.drive]\n{text}").mechanism.drive
    assert isinstance(found, DRIVES[text.split('"')[1]])
    assert drive is None or found == drive


INCLINED = {
    "spring-block": "mass = 1",
    "pendulum-cart": "cart_mass = 1\nball_mass = 1\nlength = 1",
    "capsule": "capsule_mass = 1\ninner_mass = 1",
}


@pytest.mark.parametrize("kind", INCLINED)
def test_the_ground_is_inclined_by_an_angle_in_degrees_or_radians(read, kind):
    text = f'[mechanism]\ntype = "{kind}"\n{INCLINED[kind]}\n'
    rig = read(text + 'incline = "-12 deg"\n')
    assert rig.mechanism.incline == pytest.approx(math.radians(-12.0), rel=1e-15)
    assert (
        read(rig_toml(rig.mechanism, Coulomb(kinetic_coefficient=0.5))).mechanism == rig.mechanism
    )
    assert read(text).mechanism.incline == 0.0
    with pytest.raises(InputError, match=r"incline \(beta\) must be at least -1.57 .* got 12"):
        read(text + "incline = 12\n")


def test_a_list_of_drives_is_their_sum(read):
    pulse = '[[mechanism.drive]]\ntype = "pulse"\nlevel = 1\nduration = 1\n'
    assert isinstance(read(MECHANISM + pulse).mechanism.drive, Pulse)
    both = read(MECHANISM + pulse + pulse).mechanism.drive
    assert isinstance(both, Sum)
    assert both.value(0.5) == 2.0


def test_another_mechanism_is_chosen_by_its_type(read):
    rig = read('[mechanism]\ntype="towed-block"\nmass="1 kg"\nstiffness="2 N/m"\nspeed="100 mm/s"')
    assert rig.mechanism == TowedBlock(mass=1.0, stiffness=2.0, speed=0.1)


SWING = """[mechanism]
type = "pendulum-cart"
cart_mass = "500 g"
ball_mass = 0.1
length = "300 mm"
[mechanism.pendulum]
type = "prescribed"
limit = 2.5
[mechanism.pendulum.profile]
"""
PROFILE_TABLES = {
    'type = "three-phase"\namplitude = "45 deg"\nfast = 120\nslow = 30\nfirst = "slow"': (
        ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0, first="slow")
    ),
    'type = "three-phase"\namplitude = 0.8\nfast = 120\nslow = 30\nlast = "60 rad/s^2"': (
        ThreePhase(amplitude=0.8, fast=120.0, slow=30.0, last=60.0)
    ),
    'type = "timed-three-phase"\namplitude = 0.8\nfirst_duration = "80 ms"\n'
    'middle_duration = 0.4\nlast_duration = "200 ms"': (
        TimedThreePhase(amplitude=0.8, first_duration=0.08, middle_duration=0.4, last_duration=0.2)
    ),
    'type = "sampled-swing"\ntimes = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]\n'
    'positions = [0.0, 0.1, 0.2, 0.2, 0.1, 0.1, 0.0, 0.0]\nspacing = "250 ms"': (
        SampledSwing(
            times=[0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7],
            positions=[0.0, 0.1, 0.2, 0.2, 0.1, 0.1, 0.0, 0.0],
            spacing=0.25,
        )
    ),
    'type = "rotation"\nrate = "300 rpm"': (Rotation(rate=10.0 * math.pi)),
    'type = "seven-step"\namplitude = 0.8\nfast = 120\nslow = 30\ntop_rate = 6\npause = "20 ms"': (
        SevenStep(amplitude=0.8, fast=120.0, slow=30.0, top_rate=6.0, pause=0.02)
    ),
    'type = "sine-swing"\namplitude = 0.8\nfrequency = "2 Hz"': (
        SineSwing(amplitude=0.8, frequency=2.0)
    ),
    'type = "spline-swing"\npositions = [0.0, 0.5, 0.2, -0.4]\nduration = 1.5': (
        SplineSwing(positions=(0.0, 0.5, 0.2, -0.4), duration=1.5)
    ),
}
NO_FRICTION = Coulomb(kinetic_coefficient=0.1)


def test_every_profile_is_met_here():
    assert {type(profile) for profile in PROFILE_TABLES.values()} == set(PROFILES.values())


@pytest.mark.parametrize(("text", "profile"), PROFILE_TABLES.items())
def test_every_profile_of_a_motor_can_be_read_and_written(read, text, profile):
    found = read(SWING + text).mechanism
    assert found.pendulum == Prescribed(profile=profile, limit=2.5)
    assert read(rig_toml(found, NO_FRICTION)).mechanism == found


def test_a_torque_is_read_with_its_drive_and_its_limit(read):
    found = read(
        '[mechanism]\ntype = "capsule"\ncapsule_mass = 1\ninner_mass = 0.2\n[mechanism.drive]\n'
        'type = "torque"\nlimit = 2\n[mechanism.drive.drive]\ntype = "sine"\n'
        'amplitude = 3\nfrequency = "2 Hz"'
    ).mechanism
    motor = Torque(drive=Sine(amplitude=3.0, frequency=2.0), limit=2.0)
    assert found == Capsule(capsule_mass=1.0, inner_mass=0.2, drive=motor)
    assert read(rig_toml(found, NO_FRICTION)).mechanism == found


DRIVEN = [
    Axis(inertia=1.0, drive=Sine(amplitude=3.0, frequency=2.0)),
    SpringBlock(
        mass=1.0, drive=Pulse(level=2.0, duration=1.0) + Sine(amplitude=1.0, frequency=2.0)
    ),
    TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, modulation=Ramp(rate=0.1)),
    TwoMassAxis(
        motor_inertia=1.0,
        load_inertia=2.0,
        stiffness=5.0,
        drive=Sampled(times=[0, 1, 2], values=[1, 0, 2], hold="first"),
    ),
    TwoLinkArm(
        upper_mass=0.6,
        upper_length=0.2,
        upper_centre=0.1,
        upper_inertia=0.012,
        lower_mass=0.5,
        lower_centre=0.2,
        lower_inertia=0.03,
        elbow_drive=PiecewiseLinear(times=[0, 1], values=[0, 1]),
    ),
    PendulumCart(
        cart_mass=1.0,
        ball_mass=0.2,
        length=0.3,
        pendulum=Torque(drive=Square(high=0.5, low=-0.2, period=0.5) + Ramp(rate=0.1), limit=2.0),
    ),
]


@pytest.mark.parametrize("mechanism", DRIVEN, ids=lambda one: one.name)
def test_drives_of_mechanisms_motors_and_parts_are_written(read, mechanism):
    text = rig_toml(mechanism, NO_FRICTION)
    assert "left out" not in text
    assert read(text).mechanism == mechanism


def test_a_drive_that_no_rig_file_can_have_is_left_out_and_named(read):
    steps = PiecewiseAffine(times=[0.0, 0.1], values=[1.0, 3.0], slopes=[5.0, 0.0])
    motor = Torque(drive=Sine(amplitude=1.0, frequency=2.0) + steps)
    text = rig_toml(Capsule(capsule_mass=1.0, inner_mass=0.2, drive=motor), NO_FRICTION)
    assert text.startswith("# mechanism.drive.drive is left out: a rig file cannot have a Sum, so")
    assert read(text).mechanism.drive == Torque()
    link = Link(mass=1.0, length=0.3, centre=0.15, inertia=0.03)
    arm = SerialArm(links=(link, dataclasses.replace(link, torque=steps)))
    said, _, rest = rig_toml(arm, NO_FRICTION).partition("\n")
    assert said.startswith("# mechanism.links.1.torque is left out: a rig file cannot have a Piece")
    assert read(rest).mechanism.links[1].torque is None


def test_a_motor_in_a_file_runs_as_it_does_in_python(read):
    text, profile = next(iter(PROFILE_TABLES.items()))
    rig = read(SWING + text)
    cart = PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=profile, limit=2.5)
    )
    ends = [simulate(one, NO_FRICTION, t_end=0.3, throw=False) for one in (rig.mechanism, cart)]
    assert ends[0]["x"][-1] == ends[1]["x"][-1] != 0.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('type = "three-fase"', "pendulum.profile.type in rig.toml: 'three-fase'. Did you mean"),
        ('type = "sine-swing"\namplitude = 1', r"frequency \(f\) is missing"),
        ('type = "sine-swing"\namplitude = "1 kg"\nfrequency = 1', r"amplitude \(theta_m\)"),
    ],
)
def test_a_bad_profile_gives_one_message_with_its_place(read, text, message):
    with pytest.raises(InputError, match=message):
        read(SWING + text)


def test_a_law_is_known_when_all_its_parameters_are(read):
    rig = read(f"{MECHANISM}[friction]\nkinetic_coefficient=0.2\nviscous_coefficient=0.1")
    assert sorted(rig.laws) == ["coulomb", "coulomb-viscous", "viscous"]


def test_a_law_s_own_value_goes_before_the_shared_one(read):
    text = "[friction]\nkinetic_coefficient=0.2\n[friction.coulomb]\nkinetic_coefficient=0.3\n"
    rig = read(MECHANISM + text)
    assert rig.laws["coulomb"].kinetic_coefficient == 0.3


def test_levels_may_be_given_as_forces(read):
    text = '[friction.dahl.forces]\nload="10 N"\nkinetic_force="2.5 N"\nbristle_stiffness=1e4\n'
    law = read(MECHANISM + text).laws["dahl"]
    assert (law.kinetic_coefficient, law.bristle_stiffness) == (0.25, 1000.0)


def test_a_shared_assumption_is_one_of_every_law_that_uses_it(read):
    text = "[friction]\nkinetic_coefficient={value=0.2, assumed=true}\nviscous_coefficient=1\n"
    rig = read(MECHANISM + text)
    assert rig.assumed == dict.fromkeys(("coulomb", "coulomb-viscous"), ("kinetic_coefficient",))


def test_several_trials_have_their_own_settings(read):
    spring = 'stiffness = 100\ncompression = "100 mm"\n'
    trial = (
        '[[trial]]\ntravel="72 mm"\nset={"mechanism.compression"="60 mm"}\ninitial={v="1 mm/s"}\n'
        "[[trial]]\ntravel=0.2\nset={compression=0.1}\n"
        "[[trial]]\ntravel=0.2\nset={mechanism.compression=0.1}\n"
    )
    first, second, third = read(MECHANISM + spring + trial).measurement.records()
    assert (first.travel, first.initial) == (0.072, {"v": 0.001})
    assert first.overrides == {"mechanism.compression": 0.06}
    assert second.overrides == third.overrides == {"mechanism.compression": 0.1}


# --- overrides


def test_overrides_are_read_as_on_a_command_line():
    rig = load_rig(
        overrides={
            "mechanism.attached": "true",
            "mechanism.compression": "60 mm",
            "mechanism.mass": "2",
            "friction.static_coefficient": 0.4,
            "run.t_end": "5 s",
            "trial.0.travel": "72 mm",
        }
    )
    assert rig.mechanism == SpringBlock(mass=2.0, stiffness=100.0, compression=0.06, attached=True)
    assert rig.laws["stribeck"].static_coefficient == 0.4
    assert (rig.t_end, rig.measurement.travel) == (5.0, 0.072)


@pytest.mark.parametrize(
    ("path", "full"),
    [
        ("m", "mechanism.mass"),
        ("mu_k", "friction.kinetic_coefficient"),
        ("friction.stribeck.v_s", "friction.stribeck.stribeck_velocity"),
    ],
)
def test_an_override_may_end_with_the_symbol_that_tables_print(path, full):
    assert load_rig(overrides={path: 0.3}).overridden == (full,)


def test_an_override_may_be_a_whole_table():
    drive = '{type = "pulse", level = "10 N", duration = "100 ms"}'
    rig = load_rig(overrides={"mechanism.compression": "0", "mechanism.drive": drive})
    assert rig.mechanism.drive == Pulse(level=10.0, duration=0.1)


def test_an_override_of_a_parameter_replaces_its_value_given_as_a_force():
    rig = load_rig(overrides={"friction.lugre.bristle_stiffness": "1e3 1/m"})
    assert rig.laws["lugre"].bristle_stiffness == 1e3
    assert "bristle_stiffness" not in rig.assumed["lugre"]


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"mechanism.atached": True}, r"key in \[mechanism\] of override.*mean 'attached'"),
        ({"runn.t_end": 1}, "key of override of paper_rig.toml: 'runn'. Did you mean 'run'"),
        ({"mechanism.mass": "-1"}, r"override of paper_rig.toml: mechanism.mass \(m\) .* got -1"),
        ({"mechanism.mass": "1\nfoo = 2"}, r"mechanism.mass \(m\)"),
        ({"mechanism.mass.x": 1}, "mechanism.mass is a value, not a table"),
        ({"mechanism": 5}, "mechanism must be a table"),
        ({"mechanism.stiffness": 0}, "override of paper_rig.toml: mechanism: .*no spring"),
        ({"friction.static_coefficient": 0.1}, r"is below kinetic_coefficient \(mu_k\) = 0.25"),
        ({"trial.3.travel": 1}, "'3' must be a whole number from 0 to 0"),
        ({"": 1}, "dotted path"),
        ({"a..b": 1}, "dotted path"),
        ({3: 1}, "dotted path"),
        ({"mechanism.mass": None}, "must be text, a number or a bool"),
        (5, "must be a mapping"),
    ],
)
def test_a_bad_override_says_that_it_is_one(overrides, message):
    with pytest.raises(InputError, match=message):
        load_rig(overrides=overrides)


# --- what a file may not say

SPRING = '[mechanism]\ntype = "spring-block"\n'
TRIAL = f"{MECHANISM}[[trial]]\ntravel = 0.2\n"
BAD_TEXT = {
    "misspelt key": (
        f"{MECHANISM}atached = true",
        r"in \[mechanism\] of rig.toml: 'atached'.*'att",
    ),
    "misspelt table": (f"{MECHANISM}[fricton]\nx = 1", "of rig.toml: 'fricton'. .*'friction'"),
    "no mass": (SPRING, r"mechanism.mass \(m\) is missing. Add mass under \[mechanism\], above 0"),
    "no mechanism": ("title = 'x'", r"mechanism is missing. Add \[mechanism\]"),
    "no type": ("[mechanism]\nmass = 1", "mechanism.type is missing"),
    "unknown type": ("[mechanism]\ntype = 'spring-blok'", "'spring-blok'. Did you mean 'spring-b"),
    "type of another kind": (
        "[mechanism]\ntype = [1]",
        "Known: axis, block-chain, capsule, pendulum",
    ),
    "mechanism as a value": ("mechanism = 5", "mechanism must be a table, got 5"),
    "negative": (
        f"{SPRING}mass = -1",
        r"rig.toml: mechanism.mass \(m\) must be above 0 kg, got -1",
    ),
    "zero": (f"{SPRING}mass = 0", "above 0 kg, got 0"),
    "not a number": (f"{SPRING}mass = nan", "must be finite and above 0 kg, got nan"),
    "infinite": (f"{SPRING}mass = inf", "must be finite and above 0 kg, got inf"),
    "beyond floats": (f"{SPRING}mass = 1{'0' * 400}", "above 0 kg, got 1000"),
    "beyond integers": (
        f"{SPRING}mass = 1{'0' * 5000}",
        "a number that cannot be read: it has too many digits",
    ),
    "truth": (f"{SPRING}mass = true", "mass .* must be a number.*got true"),
    "date": (f"{SPRING}mass = 1979-05-27", "mass .* must be a number"),
    "list": (f"{SPRING}mass = [1]", r"mass .* got \[1\]"),
    "unknown unit": (f"{SPRING}mass = '1 kgg'", r"mechanism.mass \(m\) has an unknown unit 'kgg'"),
    "wrong unit": (f"{SPRING}mass = '60 mm'", "in kg or a unit of that kind, not in mm"),
    "number in quotes": (f"{SPRING}mass = '1'", 'write "1 kg"'),
    "words": (f"{SPRING}mass = 'heavy'", 'text with a unit such as "1 kg"'),
    "text for truth": (f"{MECHANISM}attached = 'yes'", "must be true or false, got 'yes'"),
    "no spring": (f"{MECHANISM}compression = '60 mm'", "no spring to compress"),
    "unknown drive": (f"{MECHANISM}drive = {{type = 'puls'}}", "drive.type .*'pulse'"),
    "drive key": (
        f"{MECHANISM}drive = {{type = 'pulse', levl = 1}}",
        r"\[mechanism.drive\].*'level'",
    ),
    "drive value": (
        f"{MECHANISM}drive = {{type = 'sine', amplitude = 1, frequency = 0}}",
        r"mechanism.drive.frequency \(f\) must be above 0 Hz",
    ),
    "second drive": (
        f"{MECHANISM}drive = [{{type='ramp', rate=1}}, {{type='ramp'}}]",
        r"mechanism.drive.1.rate \(r\) is missing. Add rate under \[\[mechanism.drive\]\] number 2",
    ),
    "no drives": (f"{MECHANISM}drive = []", "must not be an empty list"),
    "drive as a number": (f"{MECHANISM}drive = 5", "must be a list of tables, got 5"),
    "points": (
        f"{MECHANISM}drive = {{type='sampled', times=[0,'1'], values=[1,2]}}",
        "drive.times must be a list of numbers in SI units, got '1' at index 1",
    ),
    "point order": (
        f"{MECHANISM}drive = {{type='sampled', times=[0,0], values=[1,2]}}",
        r"mechanism.drive: Sampled.times \[s\] must increase",
    ),
    "hold": (
        f"{MECHANISM}drive = {{type='sampled', times=[0,1], values=[1,2], hold='second'}}",
        "drive.hold must be 'zero' or 'first'",
    ),
    "friction key": (f"{MECHANISM}[friction]\nkinetic_coeficient = 1", "'kinetic_coefficient'"),
    "friction value": (
        f"{MECHANISM}[friction]\nkinetic_coefficient = -0.2",
        r"friction.kinetic_coefficient \(mu_k\) must be at least 0, got -0.2",
    ),
    "order of levels": (
        f"{MECHANISM}[friction]\nkinetic_coefficient = 0.3\nstatic_coefficient = 0.2",
        r"friction.coulomb: .*\(mu_s\) must be at least kinetic_coefficient = 0.3, got 0.2",
    ),
    "unknown law": (f"{MECHANISM}[friction.lugree]\nx = 1", "'lugree'. Did you mean 'lugre'"),
    "law as a value": (f"{MECHANISM}[friction]\nlugre = 1", "friction.lugre must be a table"),
    "half a law": (
        f"{MECHANISM}[friction.dahl]\nkinetic_coefficient = 0.3",
        r"friction.dahl.bristle_stiffness \(sigma_0\) is missing",
    ),
    "zero where one law forbids it": (
        f"{MECHANISM}[friction]\nkinetic_coefficient = 0\n[friction.dahl]\nbristle_stiffness = 1",
        "friction.dahl: .*above 0, got 0",
    ),
    "shared exponent": (
        f"{MECHANISM}[friction]\nviscous_exponent = 1\n[friction.power-viscous]\n"
        "kinetic_coefficient = 1",
        "depends on the law",
    ),
    "forces without load": (
        f"{MECHANISM}[friction.dahl.forces]\nbristle_stiffness = 1",
        r"friction.dahl.forces.load \(N\) is missing",
    ),
    "given twice": (
        f"{MECHANISM}[friction.dahl]\nkinetic_coefficient = 1\nbristle_stiffness = 3\n"
        "[friction.dahl.forces]\nload = 1\nbristle_stiffness = 1",
        "both give the same parameter",
    ),
    "misspelt mark": (
        f"{MECHANISM}[friction]\nkinetic_coefficient = {{value = 1, asumed = true}}",
        "keys value and assumed or uncertainty, got 'value', 'asumed'",
    ),
    "mark of another kind": (
        f"{MECHANISM}[friction]\nkinetic_coefficient = {{value = 1, assumed = 1}}",
        "write true or false",
    ),
    "no trials": (f"trial = []\n{MECHANISM}", "trial must not be an empty list"),
    "empty trial": (f"{MECHANISM}[[trial]]", r"Add travel under \[\[trial\]\] number 1"),
    "trial as a table": (f"{MECHANISM}[trial]\ntravel = 1", "trial must be a list of tables"),
    "uncertainty": (f"{TRIAL}uncertainty = 0", r"trial.0.uncertainty \(u_s\) must be above 0 m"),
    "kind of uncertainty": (f"{TRIAL}uncertainty = 1\nuncertainty_kind = 'x'", "or 'interval'"),
    "kind alone": (f"{TRIAL}uncertainty_kind = 'rounding'", "trial.0.uncertainty is missing"),
    "set of nothing": (f"{TRIAL}set = {{compresion = 1}}", "mean 'mechanism.compression'"),
    "set to nonsense": (f"{TRIAL}set = {{mass = '1 mm'}}", r"trial.0.set: mass \(m\).*not in mm"),
    "set twice": (
        f"{TRIAL}set = {{mass = 1, mechanism.mass = 1}}",
        "mechanism.mass is given twice",
    ),
    "set against the rig": (f"{TRIAL}set = {{compression = 1}}", "trial.0: .*no spring"),
    "set without a table": (f"{TRIAL}set = 5", "trial.0.set must be a table"),
    "initial state": (f"{TRIAL}initial = {{y = 1}}", "trial.0.initial: 'y'. Known: v, x, z"),
    "initial value": (f"{TRIAL}initial = {{x = '1 kg'}}", r"initial: x \(x\) must be in m"),
    "same name": (
        f"{TRIAL}name='a'\n[[trial]]\ntravel=1\nname='a'",
        "Trials 1 and 2 have the same name, 'a'",
    ),
    "published law": (f"{MECHANISM}[[published]]\nlaw = 'coulom'", "'coulom'. .*'coulomb'"),
    "published error": (
        f"{MECHANISM}[[published]]\nlaw = 'dahl'\nrelative_error = '-1 %'",
        r"published.0.relative_error \(e\) must be at least 0 %, got '-1 %'",
    ),
    "end time": (f"{MECHANISM}[run]\nt_end = '0 s'", r"run.t_end \(t_end\) must be above 0 s"),
    "title": (f"title = 5\n{MECHANISM}", "title must be text in quotes, got 5"),
    "syntax": (f"{MECHANISM}x = = 3", r"is not valid TOML: .*line 4, column 5"),
    "key twice": (f"{MECHANISM}mass = 2", "is not valid TOML"),
    "comment only": ("# nothing", "has no tables"),
    "depth": (f"x = {'[' * 5000}", "nested too deeply"),
    "empty": ("", "rig.toml: is empty"),
}


@pytest.mark.parametrize(("text", "message"), BAD_TEXT.values(), ids=BAD_TEXT)
def test_a_bad_file_gives_one_message_with_place_and_cure(read, text, message):
    with pytest.raises(InputError, match=message) as caught:
        read(text)
    said = str(caught.value)
    assert "rig.toml" in said
    assert "\n" not in said
    assert "pydantic" not in said
    assert caught.value.__cause__ is None
    assert caught.value.__suppress_context__ or caught.value.__context__ is None


def test_errors_are_of_the_kind_that_fits(read):
    with pytest.raises(UnknownNameError):
        read(f"{MECHANISM}atached = true")
    with pytest.raises(ParameterError):
        read(f"{SPRING}mass = -1")


@pytest.mark.parametrize("law", ["coulomb", "stribeck"])
def test_a_type_of_friction_is_said_to_be_the_name_of_its_table(read, law):
    with pytest.raises(ParameterError, match=rf"friction\.type: .* under \[friction\.{law}\]"):
        read(f'{MECHANISM}[friction]\ntype = "{law}"\nkinetic_coefficient = 0.2')


# --- files that cannot be read


def test_a_file_without_permission_says_so(tmp_path, monkeypatch):
    path = tmp_path / "rig.toml"
    path.write_text(MECHANISM)

    def refuse(self):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "read_bytes", refuse)
    with pytest.raises(InputError, match="cannot be read: Permission denied"):
        load_rig(path)


# --- rigs built in Python


LAW = Coulomb(kinetic_coefficient=0.1)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"overrides": {"mechanism.masss": 1.0}}, r"'mechanism\.masss'. Did you mean 'mechanism.m"),
        ({"overrides": {"mechanism.mass": -1.0}, "name": "b"}, r"trial b: .*\(m\) must be above 0"),
        ({"initial": {"y": 1.0}}, "state in initial of trial 0: 'y'"),
    ],
)
def test_a_trial_that_does_not_fit_the_mechanism_is_refused(parts, message):
    trial = Measurement(travel=0.1, **parts)
    block = SpringBlock(mass=1.0)
    with pytest.raises(InputError, match=message):
        Rig(mechanism=block, measurement=trial)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"laws": {"coulom": LAW}}, "unknown friction law 'coulom'"),
        ({"laws": {"dahl": LAW}}, "must be that law"),
        ({"assumed": {"dahl": ("yield_exponent",)}}, "law in Rig.assumed 'dahl'"),
        ({"mechanism": "block"}, "must be a Mechanism"),
        ({"t_end": 0.0}, r"Rig.t_end \(t_end\) must be above 0 s"),
    ],
)
def test_a_rig_checks_its_parts(parts, message):
    with pytest.raises(InputError, match=message):
        Rig(**{"mechanism": SpringBlock(mass=1.0), **parts})


# --- the schema


def test_the_schema_is_json_and_knows_every_registry():
    text = json.dumps(rig_schema(), allow_nan=False)
    for name in (*MECHANISMS, *DRIVES, *LAWS):
        assert f'"{name}"' in text


def test_the_schema_takes_a_composed_law_in_a_table_and_alone():
    friction = rig_schema()["$defs"]["Friction"]
    assert friction["properties"]["law"]["type"] == "string"
    assert {"$ref": "#/$defs/Friction"} in friction["additionalProperties"]["anyOf"]


def test_the_schema_says_units_and_ranges():
    properties = rig_schema()["$defs"]["SpringBlock"]["properties"]
    assert "beta" in str(properties["incline"])
    mass = properties["mass"]
    assert mass["x-unit"] == "kg"
    assert mass["anyOf"][0] == {"type": "number", "exclusiveMinimum": 0}


def test_every_default_in_the_schema_can_be_written_in_a_file():
    def nulls(node):
        items = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
        return (node is None) + sum(map(nulls, items))

    assert nulls(rig_schema()) == 0


def test_the_schema_allows_no_other_keys():
    schema = rig_schema()
    assert schema["additionalProperties"] is False
    parts = dict(schema["$defs"])
    del parts["Friction"]  # what is no law there may be a contact of the mechanism
    contact = parts.pop("Contact")  # and what is no input here
    assert contact["additionalProperties"] == {"$ref": "#/$defs/Contact"}
    assert all(part["additionalProperties"] is False for part in parts.values())


AXIS = """
[mechanism]
type = "axis"
inertia = { value = "95 kg", vary = true }
damping = { value = 2.0 }
"""
IN_FILE = """
[data]
file = "record.csv"
columns = { position = "q" }
units = { position = "mm" }
gain = { force = 35.15 }
offset = { force = "1 N" }
"""


@pytest.fixture
def axis(tmp_path):
    """Write a record and a rig that names it; return the rig as it is read."""
    (tmp_path / "record.csv").write_text("time,q,force\n0,1,2\n1,2,2\n2,4,2\n")
    (tmp_path / "again.csv").write_text("time,q,force\n0,1,2\n1,2,2\n")
    (tmp_path / "late.csv").write_text("time,q,force\n9,1,2\n8,1,2\n")

    def build(text=AXIS + IN_FILE, **overrides):
        (tmp_path / "axis.toml").write_text(text)
        return load_rig(tmp_path / "axis.toml", overrides=overrides)

    return build


def test_data_stand_beside_the_rig_file_and_are_read_as_it_says(axis):
    record = axis().measurement
    assert record.values("position").tolist() == [0.001, 0.002, 0.004]
    # 2 V times 35.15 N/V less the offset of 1 N
    assert record.values("force").tolist() == pytest.approx([69.3] * 3, rel=1e-12)


def test_a_parameter_marked_to_be_fitted_keeps_its_value_and_is_listed(axis):
    rig = axis()
    assert rig.vary == ("mechanism.inertia",)
    assert (rig.mechanism.inertia, rig.mechanism.damping) == (95.0, 2.0)
    assert axis(**{"mechanism.inertia": "90 kg"}).vary == ()


def test_a_rig_with_data_needs_no_friction(axis):
    assert axis().laws == {}


def test_several_files_are_trials(axis):
    text = AXIS + IN_FILE.replace('file = "record.csv"', 'files = ["record.csv", "again.csv"]')
    assert len(axis(text).measurement.records()) == 2


def test_a_second_record_is_read_alike(axis):
    rig = axis(AXIS + IN_FILE + 'validate = "late.csv"\nrepair = ["sort"]\n')
    assert rig.validate.time.tolist() == [8.0, 9.0]
    assert rig.validate.values("position").tolist() == [0.001, 0.001]


def test_a_force_is_held_unless_the_rig_says_that_its_samples_are_joined(axis):
    assert axis(AXIS + IN_FILE).hold is None
    assert axis(AXIS + IN_FILE + 'hold = "first"\n').hold == "first"


def test_the_schema_knows_data_and_marks():
    schema = rig_schema()
    table = schema["$defs"]["DataTable"]["properties"]
    reading = {"columns", "units", "gain", "offset", "repair", "hold", "conditions", "tolerance"}
    reading |= {"motor_constant", "layout"}
    assert {"file", "files", "validate"} | reading == {*table}
    inertia = schema["$defs"]["Axis"]["properties"]["inertia"]["anyOf"]
    assert any("vary" in kind.get("properties", ()) for kind in inertia)
    assert "friction" not in schema["required"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (AXIS + IN_FILE + "[[trial]]\ntravel = 0.1\n", "[data] and [[trial]] both give"),
        (AXIS + IN_FILE + 'files = ["a.csv"]\n', "data.file and data.files are both given"),
        (AXIS + IN_FILE.replace("record.csv", "no.csv"), "no.csv does not exist"),
        (AXIS + IN_FILE.replace('"q"', '"y"'), "column of"),
        (AXIS + IN_FILE.replace('"mm"', '"kg"'), "must be in m"),
        (AXIS + IN_FILE.replace("35.15", '"big"'), "data.gain.force"),
        (AXIS + IN_FILE.replace('"1 N"', '"1 m"'), "data.offset.force"),
        (AXIS + IN_FILE.replace("offset = { force", "offset = { fource"), "Did you mean 'force'"),
        (AXIS + IN_FILE + 'repair = ["mend"]\n', "must be 'sort', 'gaps' or 'hold'"),
        (AXIS + IN_FILE + 'hold = "second"\n', "must be 'zero' or 'first'"),
        (AXIS + IN_FILE + "repair = []\n", "must not be an empty list"),
        (AXIS + IN_FILE.replace("columns", "colums"), "Did you mean 'columns'"),
        (AXIS.replace("vary = true", "vary = 1"), "write true or false"),
        (AXIS.replace("vary = true", "assumed = true"), "the keys value and vary"),
    ],
)
def test_mistakes_in_data_name_the_rig_file_and_the_key(axis, text, message):
    with pytest.raises(InputError) as caught:
        axis(text)
    assert message in str(caught.value)
    assert "axis.toml" in str(caught.value)


CAPSULE = """
[mechanism]
type = "capsule"
capsule_mass = "800 g"
inner_mass = 0.2
[mechanism.drive]
type = "prescribed"
limit = "{limit}"
profile = {{ type = "three-phase", amplitude = "{amplitude}", fast = "50 m/s^2", slow = 9.81 }}
[friction]
kinetic_coefficient = 0.2
"""


CART = CAPSULE.replace('"capsule"', '"pendulum-cart"\nlength = 0.3')
for old, new in {
    "capsule_mass": "cart_mass",
    "inner_mass": "ball_mass",
    "m/s^2": "rad/s^2",
}.items():
    CART = CART.replace(old, new)
CART = CART.replace("mechanism.drive", "mechanism.pendulum")


@pytest.mark.parametrize(
    ("text", "motor", "amplitude", "limit", "size"),
    [(CAPSULE, "drive", "10 mm", "30 N", 0.01), (CART, "pendulum", "45 deg", "2 N m", math.pi / 4)],
    ids=["capsule", "cart"],
)
def test_what_a_motor_moves_is_straight_or_turns(tmp_path, text, motor, amplitude, limit, size):
    file = tmp_path / "rig.toml"
    file.write_text(text.format(amplitude=amplitude, limit=limit))
    found = getattr(load_rig(file).mechanism, motor)
    assert found.profile.amplitude == pytest.approx(size, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "amplitude", "limit", "message"),
    [
        (CAPSULE, "45 deg", "30 N", r"amplitude \(theta_m\) must be in m .* '45 deg'"),
        (CAPSULE, "10 mm", "2 N m", r"limit \(tau_m\) must be in N .* '2 N m'"),
        (CART, "45 mm", "2 N m", r"amplitude \(theta_m\) must be in rad .* '45 mm'"),
    ],
    ids=["capsule, angle", "capsule, torque", "cart, length"],
)
def test_a_motor_takes_units_of_what_it_moves(tmp_path, text, amplitude, limit, message):
    file = tmp_path / "rig.toml"
    file.write_text(text.format(amplitude=amplitude, limit=limit))
    with pytest.raises(InputError, match=message):
        load_rig(file)


def test_a_unit_of_neither_kind_is_refused(tmp_path):
    file = tmp_path / "rig.toml"
    file.write_text(CAPSULE.format(amplitude="10 kg", limit="30 N"))
    with pytest.raises(InputError, match=r"amplitude \(theta_m\) must be in m .* '10 kg'"):
        load_rig(file)


@pytest.mark.parametrize(
    "title", ["Friction of a µ-stage, 20 °C", 'a "quote" and a \\', "1\n2\x7f\x00"]
)
def test_any_title_is_written_so_that_it_is_read_again(read, title):
    assert read(rig_toml(SpringBlock(mass=1.0), NO_FRICTION, title=title)).title == title


def test_a_law_whose_name_is_no_bare_key_is_written_so_that_it_is_read_again():
    @final
    @dataclass(frozen=True, kw_only=True)
    class Named(Coulomb):
        name = "my law, 2nd"

    written = rig_toml(SpringBlock(mass=1.0), Named(kinetic_coefficient=0.5))
    assert tomllib.loads(written)["friction"]["my law, 2nd"]["kinetic_coefficient"] == 0.5


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("mime.toml", r"does not exist. Files in .*: mine.toml"),
        ("nowhere/rig.toml", r"The folder .* does not exist either"),
        (".", "is a folder"),
        ("a\0b", "cannot be read"),
        ("x" * 5000, "cannot be read"),
        (5, "A path must be text or a Path, got 5"),
        ("/dev/null", "is not a regular file"),
        (b"title = 'a'\nsubject = '\xff'\n", r"is not UTF-8 \(byte 0xff in line 2\)"),
        (b"#" * 20_000_000, "is 20 MB; a rig file may be at most 10 MB"),
    ],
    ids=lambda value: str(value)[:20],
)
def test_a_path_that_leads_to_no_rig_file_is_refused(tmp_path, monkeypatch, path, said):
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_bytes(path if isinstance(path, bytes) else MECHANISM.encode())
    with pytest.raises(InputError, match=said):
        load_rig("mine.toml" if isinstance(path, bytes) else path)
