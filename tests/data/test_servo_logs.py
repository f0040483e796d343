"""Data sets of LeRobot, logs of servos in JSON, text of Universal Robots and of libfranka."""

import json
from importlib.resources import files

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from stickslip import load_measurement, load_rig
from stickslip.data import guess_data, guess_robot
from stickslip.data.readers.robots import read_servo
from stickslip.errors import InputError

TIME = np.arange(120) / 30
NAMES = ["shoulder.pos", "elbow.pos"]
DESK = (files("stickslip.mechanisms") / "desk_arm.urdf").read_text()


def episode(number, *, fixed=False, late=0.1):
    """Return the states and actions of an episode, in degrees."""
    wanted = np.stack([40 * np.sin(3 * TIME), 30 * np.sin(5 * TIME + number)], axis=1)
    shifted = TIME - late
    state = np.stack([40 * np.sin(3 * shifted), 30 * np.sin(5 * shifted + number)], axis=1)
    size = len(TIME)
    kind = pa.list_(pa.float32(), 2) if fixed else pa.list_(pa.float32())
    return state.astype("float32"), {
        "observation.state": pa.array(state.astype("float32").tolist(), type=kind),
        "action": pa.array(wanted.astype("float32").tolist(), type=kind),
        "timestamp": pa.array((np.arange(size) / 30).astype("float32")),
        "frame_index": pa.array(np.arange(size)),
        "episode_index": pa.array(np.full(size, number)),
        "index": pa.array(np.arange(size) + number * size),
        "task_index": pa.array(np.zeros(size, dtype=int)),
    }


def info(version, **changes):
    names = {"motors": NAMES} if version == "v2.1" else NAMES
    feature = {"dtype": "float32", "shape": [2], "names": names}
    return {
        "codebase_version": version,
        "fps": 30,
        "total_frames": 240,
        "features": {"observation.state": feature, "action": feature},
    } | changes


@pytest.fixture
def dataset(tmp_path):
    """Write a data set of two episodes: a file for each, or one for both, as the version has."""

    def writer(version="v2.1", **changes):
        folder = tmp_path / "picks"
        (folder / "meta").mkdir(parents=True)
        (folder / "data/chunk-000").mkdir(parents=True)
        (folder / "meta/info.json").write_text(json.dumps(info(version, **changes)))
        parts = [pa.table(episode(k, fixed=version == "v3.0")[1]) for k in range(2)]
        if version == "v3.0":
            pq.write_table(pa.concat_tables(parts), folder / "data/chunk-000/file-000.parquet")
        else:
            for k, part in enumerate(parts):
                pq.write_table(part, folder / f"data/chunk-000/episode_{k:06d}.parquet")
        return folder

    return writer


@pytest.fixture
def urdf(tmp_path):
    (tmp_path / "arm.urdf").write_text(DESK)
    return tmp_path / "arm.urdf"


@pytest.mark.parametrize("version", ["v2.1", "v3.0"])
def test_episodes_of_lerobot_are_trials_with_joints(dataset, version):
    read = load_measurement(dataset(version))
    assert read.name == "picks"
    assert [trial.name for trial in read.trials] == ["trial 0", "trial 1"] or len(read.trials) == 2
    for number, trial in enumerate(read.trials):
        state, _ = episode(number)
        np.testing.assert_array_equal(trial.values("position.shoulder"), state[:, 0])
        np.testing.assert_array_equal(trial.values("position.elbow"), state[:, 1])
        # frames over fps, not their times in 24 bits
        np.testing.assert_array_equal(trial.time, np.arange(len(TIME)) / 30)


def test_joints_of_lerobot_are_found_with_their_delay(dataset, urdf, tmp_path):
    guess = guess_robot(dataset(), urdf, units={"position": "deg"})
    assert guess.moving == ("shoulder", "elbow")
    # three frames late: a sine of 30 samples a period is known to a hundredth of a frame
    assert guess.delays == {name: pytest.approx(0.1, abs=3e-3) for name in guess.moving}
    said = "\n".join(guess.doubts)
    for part in ("frame numbers over 30 fps", "turret", "no angle in rad", "no effort"):
        assert part in said
    from stickslip.data import guessed_rig

    text = guessed_rig(guess, "picks/meta/info.json", robot="arm.urdf")
    (tmp_path / "rig.toml").write_text(text)
    rig = load_rig(tmp_path / "rig.toml")
    assert rig.mechanism.coordinates == ("shoulder", "elbow")
    first = rig.measurement.trials[0].values("position.shoulder")
    np.testing.assert_allclose(first, np.deg2rad(episode(0)[0][:, 0].astype(float)), rtol=1e-12)


def test_positions_that_are_no_radians_are_not_taken_for_some(dataset, urdf):
    with pytest.raises(InputError, match="positions reach 40, which is no angle in rad"):
        guess_robot(dataset(), urdf)


@pytest.mark.parametrize("steps", [4096, 4095])
def test_steps_of_a_servo_say_that_positions_are_in_degrees(dataset, urdf, monkeypatch, steps):
    folder = dataset()
    for file in folder.glob("data/*/*.parquet"):
        table = pq.read_table(file)
        for name in ("observation.state", "action"):
            counts = np.rint(np.array(table[name].to_pylist()) * steps / 360.0) + 0.5
            kept = pa.array((counts * 360.0 / steps).astype("float32").tolist())
            table = table.set_column(table.column_names.index(name), name, kept)
        pq.write_table(table, file)
    guess = guess_robot(folder, urdf)
    assert any("steps of 360/4096: they are taken for degrees" in doubt for doubt in guess.doubts)
    first = load_measurement(folder).trials[0]
    expected = np.deg2rad(episode(0)[0][:, 0].astype(float))
    np.testing.assert_allclose(first.values("position.shoulder"), expected, atol=2e-3)


def test_times_that_were_measured_are_kept(dataset):
    folder = dataset()
    file = folder / "data/chunk-000/episode_000000.parquet"
    table = pq.read_table(file)
    jitter = (np.arange(len(TIME)) / 30 + 0.004 * np.sin(np.arange(len(TIME)))).astype("float32")
    place = table.schema.get_field_index("timestamp")
    pq.write_table(table.set_column(place, "timestamp", pa.array(jitter)), file)
    np.testing.assert_array_equal(load_measurement(folder).trials[0].time, jitter)


def test_features_beside_the_state_are_read_by_joint(dataset):
    state = {"dtype": "float32", "shape": [2], "names": NAMES}
    plain = state | {"names": None}
    folder = dataset(features={"observation.state": plain, "action": state})
    read = load_measurement(folder).trials[0]
    assert set(read.joint_names()) == {"motor_0", "motor_1"}
    mixed = state | {"names": ["elbow.pos", "elbow.torque"]}
    text = json.dumps(info("v2.1", features={"observation.state": mixed}))
    (folder / "meta/info.json").write_text(text)
    read = load_measurement(folder).trials[0]
    np.testing.assert_array_equal(read.values("force.elbow"), episode(0)[0][:, 1])


def cut(file):
    data = file.read_bytes()
    file.write_bytes(data[: len(data) // 2])


def without(name):
    def damage(file):
        pq.write_table(pq.read_table(file).drop([name]), file)

    return damage


def ragged(file):
    table = pq.read_table(file)
    rows = [[0.0] * (1 + k % 2) for k in range(table.num_rows)]
    place = table.schema.get_field_index("observation.state")
    pq.write_table(table.set_column(place, "observation.state", pa.array(rows)), file)


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (cut, "is not a Parquet file, or is damaged"),
        (without("timestamp"), "no column 'timestamp'"),
        (without("observation.state"), r"no column 'observation.state'"),
        (ragged, "different lengths"),
        (lambda file: [path.unlink() for path in file.parent.glob("*")], "no file data/"),
    ],
)
def test_a_damaged_data_set_is_refused(dataset, damage, message):
    folder = dataset()
    damage(folder / "data/chunk-000/episode_000000.parquet")
    with pytest.raises(InputError, match=message):
        guess_data(folder)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "is not JSON"),
        ("[]", "has no features"),
        ('{"features": {}, "fps": 30}', "no observation.state"),
        ('{"features": {"observation.state": {}}}', "fps must be a number"),
        ('{"features": {"observation.state": {}}, "fps": 0}', "fps must be a number"),
        ('{"features": {"observation.state": 3}, "fps": 30}', "must be a table"),
    ],
)
def test_a_damaged_description_is_refused(dataset, text, message):
    folder = dataset()
    (folder / "meta/info.json").write_text(text)
    with pytest.raises(InputError, match=message):
        load_measurement(folder)


BAM = {"mass": 0.49, "length": 0.1, "kp": 100, "vin": 7.4, "motor": "xl330", "trajectory": "sin"}
MOVES = np.arange(0.0, 4.0, 0.005)
ENTRIES = [
    {
        "position": float(np.sin(t)),
        "speed": float(np.cos(t)),
        "load": 0.1,
        "input_volts": 7.4,
        "temp": 30.0,
        "present_current": float(200 * np.cos(t)),
        "timestamp": float(t),
        "goal_position": float(np.sin(t + 0.1)),
        "torque_enable": bool(t < 3.0),
    }
    for t in MOVES
]


def test_a_log_of_a_servo_is_read_with_its_units(tmp_path):
    file = tmp_path / "run.json"
    file.write_text(json.dumps(BAM | {"entries": ENTRIES}))
    guess = guess_data(file)
    assert (
        guess.columns
        == {
            "time": "timestamp",
            "position": "position",
            "velocity": "speed",
            "current": "present_current",
            "reference": "goal_position",
            "temperature": "temp",
        }
        or "temperature" not in guess.columns
    )
    assert guess.turning
    assert any("mass 0.49 kg" in doubt and "kp 100" in doubt for doubt in guess.doubts)
    read = load_measurement(file, columns=guess.columns, motor_constant="2 N m/A")
    np.testing.assert_allclose(read.force, 2.0 * 0.2 * np.cos(MOVES), rtol=1e-12)
    np.testing.assert_array_equal(read.position, np.sin(MOVES))


def test_what_firmware_calls_a_torque_or_a_load_is_not_taken_for_one(tmp_path):
    """Logs of K-Scale have a torque of 10.5 at rest, of a servo of 3 N m."""
    plain = [
        {k: x for k, x in entry.items() if k != "present_current"}
        | {"torque": 10.49, "current": 17.2}
        for entry in ENTRIES
    ]
    file = tmp_path / "run.json"
    file.write_text(json.dumps(BAM | {"entries": plain}))
    guess = guess_data(file)
    assert not {"force", "load", "friction"} & {*guess.columns}
    assert any("not taken for a torque" in doubt.replace("is not", "not") for doubt in guess.doubts)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"entries": [{"timestamp": 0', "is not JSON"),
        ("[1, 2]", "no list of entries"),
        ('{"mass": 1}', "no list of entries"),
        ('{"entries": []}', "has no rows"),
        ('{"entries": [3]}', "no list of entries"),
        ('{"entries": [{"timestamp": 0.0}]}', "no 'position'; they have 'timestamp'"),
        ('{"entries": [{"timestamp": 0.0, "position": "up"}]}', "no 'position' of its entries"),
    ],
)
def test_a_damaged_log_of_a_servo_is_refused(tmp_path, text, message):
    file = tmp_path / "run.json"
    file.write_text(text)
    with pytest.raises(InputError, match=message):
        load_measurement(file)


@pytest.mark.parametrize("sign", ["", "-"])
def test_a_huge_integer_of_a_servo_is_no_number(tmp_path, sign):
    """JSON has integers of any length, and a float ends at 1.8e308."""
    huge = sign + "1" + "0" * 400
    file = tmp_path / "run.json"
    text = json.dumps(BAM | {"entries": ENTRIES})
    for old in ('"temp": 30.0', '"speed": 1.0', '"mass": 0.49'):
        text = text.replace(old, f"{old.split()[0]} {huge}", 1)
    file.write_text(text)
    read = load_measurement(file, columns={"time": "timestamp", "position": "position"})
    np.testing.assert_array_equal(read.position, np.sin(MOVES))
    table = read_servo(file).data
    assert np.isnan(table["speed [rad/s]"][0])
    assert np.isnan(table["temp [degC]"][0])
    assert table["speed [rad/s]"][1:].notna().all()
    said = " ".join(guess_data(file).doubts)
    assert "length 0.1 m" in said
    assert "mass 1" not in said.replace("-", "")
    everywhere = [{"timestamp": float(t), "position": int(huge)} for t in MOVES]
    file.write_text(json.dumps({"entries": everywhere}))
    with pytest.raises(InputError, match="no 'position' of its entries is a number"):
        load_measurement(file)


def chain(names):
    """Return a description of links one behind the other."""
    links = [f"l{k}" for k in range(len(names) + 1)]
    inertial = (
        '<inertial><origin xyz="0.1 0 0"/><mass value="1"/><inertia ixx="0.01" iyy="0.01"'
        ' izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    text = "".join(f'<link name="{link}">{inertial}</link>' for link in links)
    for k, name in enumerate(names):
        text += (
            f'<joint name="{name}" type="continuous"><parent link="{links[k]}"/>'
            f'<child link="{links[k + 1]}"/><axis xyz="0 0 1"/></joint>'
        )
    return f'<robot name="chain">{text}</robot>'


UR = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")


def two_joints(tmp_path, **columns):
    """Write a log of joints a and b, of which columns are changed, and the robot."""
    t = np.arange(300) / 100
    table = {"time": t} | {f"{q}.{j}": np.sin(t) for q in ("position", "force") for j in "ab"}
    pd.DataFrame(table | columns).to_csv(tmp_path / "log.csv", index=False)
    (tmp_path / "ab.urdf").write_text(chain(["a", "b"]))
    return tmp_path / "log.csv", tmp_path / "ab.urdf"


def test_joints_of_different_rates_are_said_to_lose_rows(tmp_path):
    x = np.sin(np.arange(300) / 100)
    slow = np.where(np.arange(300) % 5 == 0, x, np.nan)
    guess = guess_robot(*two_joints(tmp_path, **{"position.b": slow}))
    assert guess.repair == ("gaps",)
    assert any("Only 60 rows of 300 have all" in doubt for doubt in guess.doubts)
    odd, even = (np.where(np.arange(300) % 2 == k, x, np.nan) for k in (0, 1))
    with pytest.raises(InputError, match="no row has all of its columns"):
        guess_robot(*two_joints(tmp_path, **{"position.a": odd, "position.b": even}))


def test_joints_with_times_of_their_own_are_not_mixed(tmp_path):
    t = np.arange(300) / 100
    log, urdf = two_joints(tmp_path, **{"time": "", "time.a": t, "time.b": 5.0 * t})
    with pytest.raises(InputError, match=r"times of their own, 'time\.a' and 'time\.b'"):
        guess_robot(log, urdf)


def test_a_channel_without_any_cell_drives_no_joint(tmp_path):
    guess = guess_robot(*two_joints(tmp_path, **{"force.b": np.nan}))
    assert guess.moving == ("a",)
    assert "b" in guess.locked
    assert not guess.repair


def test_a_position_in_a_unit_of_another_kind_is_named(tmp_path):
    log, urdf = two_joints(tmp_path)
    log.write_text(log.read_text().replace("position.a", "position.a [mm]", 1))
    with pytest.raises(InputError, match=r"log\.csv: column 'position\.a' must be in rad"):
        guess_robot(log, urdf)


@pytest.mark.parametrize("separator", [" ", ","])
def test_a_recording_of_universal_robots_is_read_joint_by_joint(tmp_path, separator):
    fields = ("target_q", "actual_q", "actual_qd", "actual_current", "target_moment")
    fields += ("joint_temperatures",)
    time = np.arange(400) / 125
    rates = 1.0 + np.arange(6)
    angle = np.sin(np.outer(time, rates))
    speed = rates * np.cos(np.outer(time, rates))
    ahead = np.sin(np.outer(time + 0.05, rates))
    heat = 25.0 + np.outer(time, rates)
    columns = np.hstack([1000 + time[:, None], ahead, angle, speed, 2 * speed, 3 * speed, heat])
    names = ["timestamp", *(f"{field}_{k}" for field in fields for k in range(6))]
    file = tmp_path / "ur.csv"
    np.savetxt(file, columns, delimiter=separator, header=separator.join(names), comments="")
    one = guess_data(file)
    assert one.columns["position"] == "actual_q_0"
    assert one.columns["velocity"] == "actual_qd_0"
    assert one.columns["current"] == "actual_current_0"
    assert one.columns["reference"] == "target_q_0"
    assert one.turning
    (tmp_path / "ur.urdf").write_text(chain([f"{name}_joint" for name in UR]))
    guess = guess_robot(file, tmp_path / "ur.urdf")
    assert guess.moving == tuple(f"{name}_joint" for name in UR)
    assert guess.columns["position.wrist_3_joint"] == "actual_q_5"
    assert guess.columns["current.elbow_joint"] == "actual_current_2"
    assert guess.columns["temperature.elbow_joint"] == "joint_temperatures_2"
    assert guess.motor_constant["elbow_joint"] == "1 N m/A"
    assert [*guess.delays.values()] == [pytest.approx(0.05, abs=1e-3)] * 6
    read = load_measurement(
        file, columns=guess.columns, motor_constant=guess.motor_constant, layout=guess.layout
    )
    np.testing.assert_allclose(read.values("force.elbow_joint"), 2 * speed[:, 2], rtol=1e-12)
    np.testing.assert_allclose(read.joints["elbow_joint"].inputs["temperature"], heat[:, 2])


def test_a_log_of_libfranka_is_read_in_milliseconds(tmp_path):
    time = np.arange(1500)
    phase = 0.003 * time[:, None] + np.arange(7)
    angle, speed = np.sin(phase), 3 * np.cos(phase)
    state = [angle, angle, speed, speed, 5 * speed, 0 * speed]
    command = [angle, speed, np.zeros((1500, 16)), np.zeros((1500, 6)), 4 * speed]
    parts = ("q", "q_d", "dq", "dq_d", "tau_J", "tau_ext_hat_filtered")
    names = ["time, success_rate"]
    names += [", ".join(f"state.{part}[{k}]" for k in range(7)) for part in parts]
    sizes = {"q_d": 7, "dq_d": 7, "O_T_EE_d": 16, "O_dP_EE_d": 6, "tau_J_d": 7}
    names += [", ".join(f"cmd.{size}[{k}]" for k in range(n)) for size, n in sizes.items()]
    rows = np.hstack([8000 + time[:, None], np.ones((1500, 1)), *state, *command])
    file = tmp_path / "franka.txt"
    np.savetxt(file, rows, delimiter=",", header=",".join(names), comments="")
    fingers = ["finger_left", "finger_right"]
    urdf = tmp_path / "fr3.urdf"
    urdf.write_text(chain([*(f"fr3_joint{k + 1}" for k in range(7)), *fingers]))
    guess = guess_robot(file, urdf)
    assert guess.moving == tuple(f"fr3_joint{k + 1}" for k in range(7))
    assert guess.columns["position.fr3_joint1"] == "state.q[0]"
    assert guess.columns["velocity.fr3_joint7"] == "state.dq[6]"
    assert guess.columns["force.fr3_joint7"] == "state.tau_J[6]"
    read = load_measurement(file, columns=guess.columns)
    np.testing.assert_allclose(read.time[-1] - read.time[0], 1.499)
    np.testing.assert_allclose(read.values("force.fr3_joint3"), 5 * speed[:, 2], rtol=1e-12)


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a":' * 100_000, "[" * 2_000 + "]" * 2_000])
@pytest.mark.parametrize("name", ["log.json", "meta/info.json"])
def test_json_of_any_depth_is_one_message(tmp_path, name, text):
    path = tmp_path / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    with pytest.raises(InputError, match=r"is not JSON|has no"):
        load_measurement(path)


def test_a_name_that_is_half_a_character_is_refused(tmp_path):
    path = tmp_path / "log.json"
    rows = [{"timestamp": t / 100, "position": np.sin(t / 10), "\ud800": 1.0} for t in range(200)]
    path.write_text(json.dumps({"entries": rows}))
    with pytest.raises(InputError, match="surrogates not allowed"):
        load_measurement(path)
