"""Records of several joints: from arrays, from files and from rig files, in parts and as trials."""

import numpy as np
import pytest

from stickslip import Axis, Measurement, TwoLinkArm, check, load_measurement, load_rig, select
from stickslip.data import refuse_same
from stickslip.data.differentiation import rows_of
from stickslip.errors import InputError, ParameterError, UnknownNameError

TIME = np.arange(50) / 100
ANGLES = {"shoulder": np.sin(TIME), "elbow": np.cos(TIME)}
TORQUES = {"shoulder": 2.0 * TIME, "elbow": -TIME}

RIG = """
[mechanism]
type = "two-link-arm"
upper_mass = 0.5
upper_length = "200 mm"
upper_centre = 0.1
upper_inertia = 0.02
lower_mass = 0.6
lower_centre = 0.2
lower_inertia = 0.03

[data]
file = "arm.csv"
columns = { time = "t", position.shoulder = "q1", position.elbow = "q2", force.shoulder = "m1" }
units = { position.shoulder = "deg", force.elbow = "N m" }
gain = { force.shoulder = -1.0 }
offset = { force.elbow = "0.5 N m" }
"""


def arm(**given):
    return Measurement(time=TIME, position=ANGLES, force=TORQUES, **given)


@pytest.fixture
def folder(tmp_path):
    rows = ["t,q1,q2 [rad],m1,force.elbow"]
    rows += [f"{t},{180 * t},{t},{2 * t},{3 * t}" for t in TIME.tolist()]
    (tmp_path / "arm.csv").write_text("\n".join(rows), encoding="utf-8")
    (tmp_path / "arm.toml").write_text(RIG, encoding="utf-8")
    return tmp_path


def test_each_joint_is_a_record_with_the_times_of_all():
    record = arm(offset={"force.elbow": 0.25})
    assert record.joint_names() == ("shoulder", "elbow")
    assert record.kind == "series"
    assert record.position is None
    np.testing.assert_array_equal(record.joints["elbow"].time, record.time)
    np.testing.assert_array_equal(record.values("force.elbow"), TORQUES["elbow"] - 0.25)
    assert record.quantities()[:2] == ("position.shoulder", "force.shoulder")


def test_rows_are_taken_of_all_joints_and_trials_have_the_same():
    part = rows_of(arm(), 10, 20)
    np.testing.assert_array_equal(part.joints["elbow"].force, TORQUES["elbow"][10:20])
    other = Measurement(time=TIME, position={"wrist": TIME}, name="b")
    with pytest.raises(InputError, match="must have the same joints"):
        Measurement(trials=(arm(name="a"), other))
    with pytest.raises(InputError, match="identical to the fitted one"):
        refuse_same(arm(), arm())


def test_columns_of_a_file_are_named_by_joint_and_converted_one_by_one(folder):
    rig = load_rig(folder / "arm.toml")
    one = rig.measurement
    assert set(one.joints) == {"shoulder", "elbow"}
    np.testing.assert_allclose(one.values("position.shoulder"), np.pi * TIME)
    np.testing.assert_allclose(one.values("force.shoulder"), -2.0 * TIME)
    np.testing.assert_allclose(one.values("force.elbow"), 3.0 * TIME - 0.5)
    assert one.unit("force.elbow") == "N m"


def test_a_quantity_that_has_no_joint_is_refused_by_name(folder):
    with pytest.raises(UnknownNameError, match=r"load\.elbow"):
        load_measurement(folder / "arm.csv", columns={"load.elbow": "m1"})
    with pytest.raises(InputError, match="without a dot"):
        Measurement(time=TIME, position={"left.elbow": TIME})
    with pytest.raises(InputError, match="joints are given too"):
        Measurement(time=TIME, position=ANGLES, joints=arm().joints)


def test_forces_of_a_joint_are_not_compared_with_its_motion_alone():
    """The torque of an elbow accelerates both links, and may well act against its own motion."""
    t = np.arange(0.0, 8.0, 0.004)
    q = {"shoulder": np.sin(3.0 * t), "elbow": 0.5 * np.sin(3.0 * t)}
    rate = 1.5 * np.cos(3.0 * t)
    coupled = {"shoulder": -2.0 * q["shoulder"], "elbow": 0.3 * q["elbow"] - 0.05 * rate}
    elbow = Measurement(time=t, position=q["elbow"], force=coupled["elbow"])
    assert "signs first. The inertia is −0.387 times as given" in str(
        select(Axis(inertia=0.1), None, elbow)
    )
    assert check(Measurement(time=t, position=q, force=coupled)).worst == "info"


def test_angles_of_a_joint_are_told_in_radians():
    t = np.arange(0.0, 8.0, 0.004)
    coarse = {name: np.round(np.sin(3.0 * t + k), 2) for k, name in enumerate(ANGLES)}
    arm = TwoLinkArm(
        upper_mass=0.5, upper_length=0.2, upper_centre=0.1, upper_inertia=0.02,
        lower_mass=0.6, lower_centre=0.2, lower_inertia=0.03,
    )  # fmt: skip
    found = check(Measurement(time=t, position=coarse, force=coarse), mechanism=arm)
    steps = [str(finding) for finding in found.findings if "Position is quantised" in str(finding)]
    assert steps
    assert all("rad" in line for line in steps)


def test_a_current_of_a_joint_is_read_as_its_force_with_a_gain(tmp_path):
    t = np.linspace(0.0, 1.0, 50)
    names = {"t [s]": t, "q1 [rad]": t, "q2 [rad]": t, "i1 [A]": t, "i2 [mA]": 1e3 * t}
    rows = np.column_stack(list(names.values()))
    header = ",".join(names)
    np.savetxt(tmp_path / "r.csv", rows, delimiter=",", header=header, comments="")
    text = """
[mechanism]
type = "two-link-arm"
upper_mass = 0.5
upper_length = 0.2
upper_centre = 0.1
upper_inertia = 0.02
lower_mass = 0.6
lower_centre = 0.2
lower_inertia = 0.03
[data]
file = "r.csv"
[data.columns]
time = "t [s]"
position.shoulder = "q1 [rad]"
position.elbow = "q2 [rad]"
force.shoulder = "i1 [A]"
QUANTITY.elbow = "i2 [mA]"
[data.gain]
force.shoulder = 0.3
force.elbow = 2.4e-4
"""
    rig = tmp_path / "arm.toml"
    rig.write_text(text.replace("QUANTITY", "force"))
    joints = load_rig(rig).measurement.joints
    np.testing.assert_allclose(joints["shoulder"].force, 0.3 * t)
    np.testing.assert_allclose(joints["elbow"].force, 0.24 * t)
    assert joints["elbow"].turning
    motor = text.replace("QUANTITY", "force").replace("2.4e-4", '"0.24 N m/A"')
    rig.write_text(motor.replace("= 0.3\n", '= "300 mN m/A"\n'))
    for name, torque in (("shoulder", 0.3 * t), ("elbow", 0.24 * t)):
        np.testing.assert_allclose(load_rig(rig).measurement.joints[name].force, torque)
    rig.write_text(motor.replace("0.24 N m/A", "0.24 N m/V"))
    with pytest.raises(ParameterError, match=r"gain\.force\.elbow .* N m/V times a column in mA"):
        load_rig(rig)
    rig.write_text(text.replace("QUANTITY", "current"))
    with pytest.raises(InputError, match=r"current\.elbow is not a quantity.*as force\.elbow"):
        load_rig(rig)


def test_joints_have_contact_inputs_of_their_own():
    warm = {"shoulder": 20.0 + TIME, "elbow": 35.0}
    one = arm(inputs={"temperature": warm, "pressure": 2e5})
    assert one.input_names() == ("temperature", "pressure")
    assert one.contact_inputs() == {"pressure": 2e5}
    assert one.contact_inputs("elbow") == {"pressure": 2e5, "temperature": 35.0}
    part = rows_of(one, 10, 20)
    np.testing.assert_array_equal(part.joints["shoulder"].inputs["temperature"], 20.0 + TIME[10:20])
    read = load_measurement(one.to_dataframe())
    np.testing.assert_allclose(read.joints["shoulder"].inputs["temperature"], 20.0 + TIME)
    assert "temperature" in str(one)
    with pytest.raises(UnknownNameError, match=r"inputs, temperature.*'elbo'.*'elbow'"):
        arm(inputs={"temperature": {"elbo": 20.0}})
    with pytest.raises(InputError, match="gives position, which is a quantity"):
        arm(inputs={"position": {"elbow": 1.0}})
    with pytest.raises(InputError, match="by joint, but no position"):
        Measurement(time=TIME, position=TIME, inputs={"temperature": {"elbow": 20.0}})
    with pytest.raises(ParameterError, match=r"inputs\.temperature"):
        arm(inputs={"temperature": {"elbow": -300.0}})


def test_a_named_temperature_of_a_joint_that_is_not_there_is_refused():
    table = {"time": TIME, "q": TIME, "F": TIME, "T": 20.0 + TIME}
    for joint in ("", ".arm"):
        columns = {f"position{joint}": "q", f"force{joint}": "F", "temperature.elbow": "T"}
        with pytest.raises(UnknownNameError, match="joint in columns, temperature: 'elbow'"):
            load_measurement(table, columns=columns)


def test_a_named_column_of_a_joint_is_not_left_out_for_a_plain_one():
    table = {"time": TIME, "q": TIME, "p": TIME, "F": TIME}
    columns = {"position": "q", "position.arm": "p", "force": "F"}
    with pytest.raises(InputError, match=r"columns has position\.arm and the table position"):
        load_measurement(table, columns=columns)


def test_a_rig_file_names_the_temperature_of_each_joint(folder):
    text = RIG.replace(
        'force.shoulder = "m1" }', 'force.shoulder = "m1", temperature.elbow = "T" }'
    )
    text = text.replace('force.elbow = "N m" }', 'force.elbow = "N m", temperature.elbow = "K" }')
    (folder / "warm.toml").write_text(text, encoding="utf-8")
    rows = (folder / "arm.csv").read_text(encoding="utf-8").splitlines()
    told = [f"{rows[0]},T", *(f"{row},{300.15}" for row in rows[1:])]
    (folder / "arm.csv").write_text("\n".join(told), encoding="utf-8")
    found = load_rig(folder / "warm.toml").measurement
    np.testing.assert_allclose(found.joints["elbow"].inputs["temperature"], 27.0, rtol=1e-12)
    assert "temperature" not in found.joints["shoulder"].contact_inputs()
