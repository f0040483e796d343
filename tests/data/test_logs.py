"""Logs of robots: bags of ROS and MCAP, written by the libraries that write them."""

import bz2
import contextlib
import io
import math
import os
import signal
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time
from importlib.resources import files
from pathlib import Path

import lz4.frame
import numpy as np
import pytest
import zstandard
from tests.data.log_cases import (
    BEGIN,
    NANO,
    states,
    write_bag,
    write_json,
    write_mcap,
    write_ros1,
)

from stickslip import check, load_measurement, load_rig
from stickslip.cli import main
from stickslip.data import guess_data, guess_robot
from stickslip.data.readers.robot_guess import lag_of
from stickslip.errors import InputError
from stickslip.show.documents import private_folder

TIME = np.arange(300) / 100
SHOULDER = (np.sin(3 * TIME), 3 * np.cos(3 * TIME), np.cos(TIME))
ELBOW = (0.5 * np.sin(7 * TIME), 3.5 * np.cos(7 * TIME), np.sin(TIME))
STILL = (np.full(300, 0.25), np.zeros(300), np.zeros(300))
ARM = {"elbow": ELBOW, "shoulder": SHOULDER}
TOPIC = "/joint_states"
DESK = (files("stickslip.mechanisms") / "desk_arm.urdf").read_text()


@pytest.fixture
def urdf(tmp_path):
    (tmp_path / "arm.urdf").write_text(DESK)
    return tmp_path / "arm.urdf"


def exit_code(*arguments):
    with pytest.raises(SystemExit) as found:
        main([*map(str, arguments)])
    return found.value.code


def same(measurement, joints=ARM):
    """Whether a measurement holds joints as they were written, to the last bit of a double."""
    assert set(measurement.joint_names()) == set(joints)
    for name, (position, velocity, effort) in joints.items():
        np.testing.assert_array_equal(measurement.values(f"position.{name}"), position)
        np.testing.assert_array_equal(measurement.values(f"velocity.{name}"), velocity)
        np.testing.assert_array_equal(measurement.values(f"force.{name}"), effort)
    np.testing.assert_allclose(measurement.time, TIME, atol=1e-9)  # stamps are whole nanoseconds
    return True


@pytest.mark.parametrize(
    ("storage", "compression"),
    [("SQLITE3", ""), ("SQLITE3", "MESSAGE"), ("SQLITE3", "FILE"), ("MCAP", ""), ("MCAP", "FILE")],
)
def test_a_bag_is_read_as_it_was_written(tmp_path, storage, compression):
    topics = {TOPIC: states(TIME, ARM)}
    bag = write_bag(tmp_path / "bag", topics, storage=storage, compression=compression)
    assert same(load_measurement(bag))
    assert same(load_measurement(bag / "metadata.yaml"))
    assert load_measurement(bag).name == "bag"


def test_a_bare_file_of_a_bag_is_read_too(tmp_path):
    bag = write_bag(tmp_path / "bag", {TOPIC: states(TIME, ARM)})
    assert same(load_measurement(bag / "bag.db3"))


def test_a_bag_of_ros_1_is_read_as_it_was_written(tmp_path):
    assert same(load_measurement(write_ros1(tmp_path / "a.bag", {TOPIC: states(TIME, ARM)})))


@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
def test_mcap_of_ros_is_read_as_it_was_written(tmp_path, compression):
    file = write_mcap(tmp_path / "a.mcap", {TOPIC: states(TIME, ARM)}, compression=compression)
    assert same(load_measurement(file))


def test_mcap_in_json_is_read_as_it_was_written(tmp_path):
    plain = [
        (state["logged"], {k: [*map(float, state[k])] for k in ("position", "velocity", "effort")}
         | {"name": state["name"], "header": {"stamp": {"sec": state["stamp"] // NANO,
                                                      "nanosec": state["stamp"] % NANO}}})
        for state in states(TIME, ARM)
    ]  # fmt: skip
    assert same(load_measurement(write_json(tmp_path / "a.mcap", {TOPIC: plain})))
    listed = [
        (one["logged"], {"joints": [
            {"name": name, "position": float(q), "velocity": float(v), "effort": float(f)}
            for name, q, v, f in zip(one["name"], one["position"], one["velocity"], one["effort"],
                                     strict=True)]})
        for one in states(TIME, ARM)
    ]  # fmt: skip
    file = write_json(tmp_path / "b.mcap", {TOPIC: listed}, kind="foxglove.JointStates")
    assert same(load_measurement(file))


def test_the_order_of_joints_in_a_message_does_not_matter(tmp_path):
    turned = {name: ARM[name] for name in ("shoulder", "elbow")}
    messages = [states(TIME, one) for one in (ARM, turned)]
    mixed = [messages[row % 2][row] for row in range(len(TIME))]
    assert same(load_measurement(write_bag(tmp_path / "bag", {TOPIC: mixed})))


def test_log_times_stand_in_for_headers_without_a_stamp(tmp_path):
    messages = states(TIME, ARM, stamped=False, late=0.5)
    guess = guess_data(write_bag(tmp_path / "bag", {TOPIC: messages}))
    assert same(load_measurement(tmp_path / "bag"))
    assert any("header stamps of 0" in doubt and TOPIC in doubt for doubt in guess.doubts)
    # one stamp of 0 among others is as bad as all of them
    some = [*states(TIME[:1], ARM, stamped=False), *states(TIME, ARM)[1:]]
    guess = guess_data(write_bag(tmp_path / "some", {TOPIC: some}))
    assert any("header stamps of 0" in doubt for doubt in guess.doubts)


def test_joints_of_two_publishers_are_brought_to_one_clock(tmp_path):
    slow = np.arange(0.005, 2.99, 0.02)
    gripper = {"finger": (np.sin(2 * slow), None, np.cos(2 * slow))}
    both = sorted([*states(TIME, ARM), *states(slow, gripper)], key=lambda state: state["logged"])
    file = write_bag(tmp_path / "bag", {TOPIC: both})
    guess = guess_data(file)
    assert any("'position.finger'" in doubt and "interpolated" in doubt for doubt in guess.doubts)
    assert any("(50 Hz)" in doubt for doubt in guess.doubts)
    read = load_measurement(file, repair="gaps")
    inside = (slow[0] <= TIME) & (slow[-1] >= TIME)
    np.testing.assert_allclose(read.time, TIME[inside], atol=1e-9)
    # the error of a straight line between samples is at most h^2/8 times the acceleration
    error = read.values("position.finger") - np.sin(2 * TIME[inside])
    assert np.abs(error).max() < 4 * 0.02**2 / 8 * 1.01


def test_nothing_is_interpolated_across_a_hole(tmp_path):
    slow = np.concatenate([np.arange(0.0, 1.0, 0.02), np.arange(2.0, 2.995, 0.02)])
    finger = {"finger": (np.sin(2 * slow), None, None)}
    bag = write_bag(tmp_path / "bag", {TOPIC: states(TIME, ARM), "/hand": states(slow, finger)})
    read = load_measurement(bag, repair="gaps")
    assert not np.any((read.time > 0.985) & (read.time < 1.995))
    assert np.count_nonzero(read.time < 1.0) > 90


def test_of_joints_in_two_topics_the_one_with_more_samples_is_read(tmp_path):
    half = {name: tuple(part[::2] for part in parts) for name, parts in ARM.items()}
    topics = {"/filtered": states(TIME[::2], half), TOPIC: states(TIME, ARM)}
    bag = write_bag(tmp_path / "bag", topics)
    assert same(load_measurement(bag))
    guess = guess_data(bag)
    assert any("/filtered" in doubt and "left out" in doubt for doubt in guess.doubts)
    other = load_measurement(bag, columns={"position": "/filtered/position.elbow"}, repair="gaps")
    assert other.joint_names() == ()
    np.testing.assert_allclose(other.position[::2], half["elbow"][0], atol=1e-15)


def test_any_numbers_are_read_by_topic_and_field(tmp_path):
    pairs = [(time, 2.0 * time) for time in TIME.tolist()]
    bag = write_bag(tmp_path / "bag", {TOPIC: states(TIME, ARM)}, numbers={"/motor/torque": pairs})
    columns = {"position": "position.elbow", "force": "/motor/torque/data"}
    read = load_measurement(bag, columns=columns)
    np.testing.assert_allclose(read.force, 2.0 * TIME, atol=1e-12)
    guess = guess_data(bag, columns={"force": "/motor/torque/data"})
    assert guess.columns["force"] == "/motor/torque/data"
    alone = write_bag(tmp_path / "alone", {}, numbers={"/angle": pairs, "/torque": pairs})
    with pytest.raises(InputError, match=r"no topic with states of joints.*/angle \(std_msgs/msg/"):
        load_measurement(alone)
    columns = {"position": "/angle/data", "force": "/torque/data"}
    np.testing.assert_allclose(load_measurement(alone, columns=columns).position, 2.0 * TIME)


def test_joints_are_found_by_the_names_of_the_description(tmp_path, urdf):
    wheel = (5.0 * TIME, 5.0 + 0.0 * TIME, np.full(300, math.nan))
    late = np.sin(7 * (TIME - 0.04)) * 0.5
    arm = {**ARM, "elbow": (late, *ELBOW[1:]), "turret": STILL, "wheel": wheel}
    command = {"elbow": (ELBOW[0][::2], None, None)}
    topics = {TOPIC: states(TIME, arm), "/joint_commands": states(TIME[::2], command)}
    file = write_mcap(tmp_path / "log.mcap", topics)
    guess = guess_robot(file, urdf)
    assert guess.moving == ("elbow", "shoulder")
    assert guess.locked == {"turret": 0.25}
    # the sine, written at 50 Hz, is known to a hundredth of its step
    assert guess.delays == {"elbow": pytest.approx(0.04, abs=1e-3)}
    said = "\n".join(guess.doubts)
    for part in ("wheel", "turret did not move", "0 throughout", "rad is assumed"):
        assert part in said
    assert exit_code("init", file, "--urdf", urdf) == 0
    rig = load_rig(tmp_path / "log.toml")
    assert rig.mechanism.coordinates == ("shoulder", "elbow")
    assert set(rig.measurement.joint_names()) == {"shoulder", "elbow"}
    np.testing.assert_array_equal(rig.measurement.values("position.elbow"), late)
    found = check(rig.measurement, mechanism=rig.mechanism)
    assert not [finding for finding in found.findings if finding.severity == "error"]
    assert exit_code("check", tmp_path / "log.toml") == 0


def test_a_joint_that_moves_without_a_known_torque_is_locked(tmp_path, urdf):
    arm = {**ARM, "turret": (5.0 * TIME, 5.0 + 0.0 * TIME, np.full(300, math.nan))}
    guess = guess_robot(write_bag(tmp_path / "bag", {TOPIC: states(TIME, arm)}), urdf)
    assert guess.moving == ("elbow", "shoulder")
    assert any("turret moved, and what drove it" in doubt for doubt in guess.doubts)
    assert any("No effort was recorded of 'turret'" in doubt for doubt in guess.doubts)


def test_samples_without_an_effort_are_gaps(tmp_path):
    effort = ELBOW[2].copy()
    effort[10:20] = math.nan
    bag = write_bag(tmp_path / "bag", {TOPIC: states(TIME, {"elbow": (*ELBOW[:2], effort)})})
    guess = guess_data(bag)
    assert guess.repair == ("gaps",)
    read = load_measurement(bag, columns=guess.columns, repair=guess.repair)
    np.testing.assert_allclose(read.force, np.delete(ELBOW[2], np.s_[10:20]))


def test_times_out_of_order_and_doubles_are_repaired(tmp_path):
    messages = states(TIME, ARM)
    messages[50], messages[51] = messages[51], messages[50]
    messages.insert(80, messages[80])
    stamped = [message | {"logged": BEGIN + k} for k, message in enumerate(messages)]
    bag = write_bag(tmp_path / "bag", {TOPIC: stamped})
    assert guess_data(bag).repair == ("sort",)
    assert same(load_measurement(bag, repair="sort"))


def cut(share):
    def damage(file):
        data = file.read_bytes()
        file.write_bytes(data[: int(share * len(data))])

    return damage


def overwritten(file):
    data = bytearray(file.read_bytes())
    middle = len(data) // 2
    data[middle : middle + 64] = bytes(64)
    file.write_bytes(data)


@pytest.mark.parametrize(
    ("kind", "damage", "sentence"),
    [
        ("a.mcap", cut(0.6), "damaged"),
        ("a.mcap", cut(0.01), "damaged"),
        ("a.mcap", overwritten, "damaged"),
        ("a.mcap", lambda file: file.write_bytes(b"PK" + file.read_bytes()[2:]), "damaged"),
        ("a.mcap", lambda file: file.write_bytes(b""), "is empty"),
        ("bag/bag.db3", cut(0.3), "damaged"),
        ("bag/bag.db3", lambda file: file.write_bytes(b"no bag" * 99), "damaged"),
        ("bag/bag.db3", lambda file: file.unlink(), "damaged"),
        ("bag/metadata.yaml", cut(0.3), "damaged"),
        ("bag/metadata.yaml", lambda file: file.write_text("[]"), "damaged"),
    ],
)
def test_a_damaged_log_is_refused_in_one_sentence(tmp_path, capsys, kind, damage, sentence):
    bag = write_bag(tmp_path / "bag", {TOPIC: states(TIME, ARM)})
    mcap = write_mcap(tmp_path / "a.mcap", {TOPIC: states(TIME, ARM)}, compression="NONE")
    damage(tmp_path / kind)
    assert exit_code("init", mcap if kind == "a.mcap" else bag) == 2
    text = capsys.readouterr().err
    assert sentence in text
    assert "Traceback" not in text
    assert len(text.strip().splitlines()) <= 4  # one sentence, wrapped
    assert not [*tmp_path.glob("*.toml")]


def test_messages_that_contradict_themselves_are_refused_by_topic(tmp_path):
    short = [state | {"position": [1.0]} for state in states(TIME[:3], ARM)]
    with pytest.raises(InputError, match=r"message 1 of /joint_states.*2 names and 1 values"):
        load_measurement(write_bag(tmp_path / "short", {TOPIC: short}))
    twice = [state | {"name": ["elbow", "elbow"]} for state in states(TIME[:3], ARM)]
    with pytest.raises(InputError, match=r"message 1 of /joint_states has 'position.elbow' twice"):
        load_measurement(write_bag(tmp_path / "twice", {TOPIC: twice}))
    text = [(BEGIN, {"name": ["a"], "position": ["high"]})]
    with pytest.raises(InputError, match=r"message 1 of /joint_states is no JointState.*high"):
        load_measurement(write_json(tmp_path / "a.mcap", {TOPIC: text}))
    for number, messages in enumerate((states(TIME[:1], ARM), [states(TIME, ARM)[0]] * 50)):
        with pytest.raises(InputError, match=r"samples of /joint_states have one time"):
            guess_data(write_bag(tmp_path / f"still{number}", {TOPIC: messages}))
    commands = {"/joint_commands": states(TIME, ARM)}
    with pytest.raises(InputError, match=r"no joint has a position.*/joint_commands/reference.elb"):
        guess_data(write_mcap(tmp_path / "commands.mcap", commands))
    with pytest.raises(InputError, match="contains no messages"):
        load_measurement(write_mcap(tmp_path / "none.mcap", {TOPIC: []}))


def test_messages_of_another_encoding_are_named(tmp_path):
    from mcap.writer import Writer

    for encoding, schema, message in (
        ("protobuf", "protobuf", r"/joint_states \(protobuf\) cannot be decoded"),
        ("cdr", "ros2idl", "described in IDL"),
    ):
        file = tmp_path / f"{encoding}.mcap"
        with file.open("wb") as stream:
            writer = Writer(stream)
            writer.start()
            number = writer.register_schema("sensor_msgs/msg/JointState", schema, b"struct A {};")
            channel = writer.register_channel(TOPIC, encoding, number)
            writer.add_message(channel, BEGIN, b"0000", publish_time=BEGIN)
            writer.finish()
        with pytest.raises(InputError, match=message):
            load_measurement(file)


def test_a_log_of_another_robot_is_refused_by_name(tmp_path, urdf):
    bag = write_bag(tmp_path / "bag", {TOPIC: states(TIME, {"a1": ELBOW, "a2": SHOULDER})})
    with pytest.raises(InputError, match=r"the joints a1 and a2.*turret, shoulder and elbow"):
        guess_robot(bag, urdf)


@pytest.mark.parametrize("seed", range(5))
def test_a_lag_is_found_in_noise_and_under_held_commands(seed):
    random = np.random.default_rng(seed)
    time = np.arange(0.0, 10.0, 0.004)
    rates = random.uniform(1.0, 8.0, 4)
    lag = random.uniform(0.0, 0.2)

    def path(t):
        return sum(np.sin(rate * t + k) for k, rate in enumerate(rates))

    held = path(np.floor(time / 0.02) * 0.02)
    measured = path(time - lag) + random.normal(0.0, 1e-3, time.size)
    # a line between commands 20 ms apart is late by nothing, and a tenth of a step is noise
    assert lag_of(time, held, measured) == pytest.approx(lag, abs=2e-3)


@pytest.mark.parametrize("seed", range(5))
def test_the_lag_of_a_periodic_motion_is_the_smallest(seed):
    time = np.arange(0.0, 10.0, 0.005)
    noise = np.random.default_rng(seed).normal(0.0, 1e-3, time.size)
    measured = np.sin(15.0 * (time - 0.06)) + noise
    assert lag_of(time, np.sin(15.0 * time), measured) == pytest.approx(0.06, abs=1e-3)


def test_motions_that_differ_have_no_lag():
    time = np.arange(0.0, 10.0, 0.004)
    random = np.random.default_rng(1)
    walks = np.cumsum(random.normal(0.0, 1.0, (2, time.size)), axis=1)
    assert lag_of(time, *walks) is None
    assert lag_of(time, np.zeros(time.size), walks[0]) is None
    assert lag_of(time[:20], walks[0][:20], walks[0][:20]) is None


def test_the_digest_of_a_rig_covers_the_messages_of_a_bag(tmp_path, urdf):
    bag = write_bag(tmp_path / "bag", {TOPIC: states(TIME, ARM)})
    (tmp_path / "rig.toml").write_text(
        '[mechanism]\ntype = "urdf"\nfile = "arm.urdf"\nmoving = ["shoulder", "elbow"]\n'
        '[data]\nfile = "bag"\n'
    )
    first = load_rig(tmp_path / "rig.toml")
    assert [file.name for file in first.files] == ["arm.urdf", "metadata.yaml", "bag.db3"]
    changed = ARM | {"elbow": (-ELBOW[0], *ELBOW[1:])}
    other = write_bag(tmp_path / "other", {TOPIC: states(TIME, changed)})
    (bag / "bag.db3").write_bytes((other / "other.db3").read_bytes())
    assert load_rig(tmp_path / "rig.toml").digest != first.digest


def test_of_two_topics_that_with_efforts_is_taken(tmp_path):
    fast, slow = np.arange(0.0, 4.0, 0.01), np.arange(0.0, 4.0, 0.02)
    topics = {
        "/fast": states(fast, {"a": (np.sin(fast), np.cos(fast), None)}),
        "/slow": states(slow, {"a": (np.sin(slow), np.cos(slow), 2.0 + slow)}),
    }
    record = load_measurement(write_mcap(tmp_path / "log.mcap", topics))
    assert record.joints["a"].values("force")[-1] == pytest.approx(2.0 + slow[-1])


# Logs that would take all memory, and what they do not hold.

MEGABYTE = zstandard.compress(bytes(2**20))
"""A frame; frames behind each other are one piece."""


def numbered(message, count=9):
    """Return messages in JSON, each with its time."""
    return [(BEGIN + k * NANO // 100, message(k)) for k in range(count)]


def as_chunk(file, data, said, method="zstd"):
    """Write an MCAP file of one compressed chunk, with what it says of its size."""
    out = io.BytesIO()
    write_json(file, {TOPIC: numbered(lambda k: {"name": ["a"], "position": [k]})})
    whole = file.read_bytes()
    begin = whole.index(b"\x06", 9)  # the record of the chunk, behind that of the header
    body = struct.pack("<QQQI", BEGIN, BEGIN, said, 0)
    body += struct.pack("<I", len(method)) + method.encode() + struct.pack("<Q", len(data)) + data
    out.write(whole[:begin] + struct.pack("<BQ", 6, len(body)) + body)
    out.write(struct.pack("<BQI", 15, 4, 0))  # end of the data; there is no summary
    out.write(struct.pack("<BQQQI", 2, 20, 0, 0, 0) + whole[:8])
    file.write_bytes(out.getvalue())
    return file


def test_a_chunk_is_expanded_within_bounds_only(tmp_path):
    large = as_chunk(tmp_path / "large.mcap", MEGABYTE * 400, 400 * 2**20)
    with pytest.raises(InputError, match=r"4\.194e\+08 expanded bytes in a piece exceed the limit"):
        load_measurement(large)
    for method, data in (("zstd", MEGABYTE * 400), ("lz4", lz4.frame.compress(bytes(2**20)) * 400)):
        lying = as_chunk(tmp_path / "lying.mcap", data, 100, method)
        with pytest.raises(InputError, match=r"expanded bytes in a piece exceed the limit"):
            load_measurement(lying)
    small = as_chunk(tmp_path / "small.mcap", MEGABYTE, 100)
    with pytest.raises(InputError, match=r"damaged.*another size than it says"):
        load_measurement(small)


def test_an_index_names_no_chunk_that_was_not_read(tmp_path):
    file = write_mcap(tmp_path / "a.mcap", {TOPIC: states(TIME, ARM)})
    data = bytearray(file.read_bytes())
    chunk = data.index(b"\x06", 9)
    at = data.index(struct.pack("<Q", chunk), data.index(b"\x0f" + struct.pack("<Q", 4)))
    data[at : at + 8] = struct.pack("<Q", chunk + 1)
    file.write_bytes(data)
    with pytest.raises(InputError, match=r"damaged.*index does not fit"):
        load_measurement(file)


@pytest.mark.parametrize("mode", ["FILE", "MESSAGE"])
def test_a_compressed_bag_is_expanded_within_bounds_and_leaves_nothing(tmp_path, mode, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    bag = write_bag(tmp_path / "bag", {TOPIC: states(TIME, ARM)}, compression=mode)
    assert same(load_measurement(bag))
    if mode == "FILE":
        (bag / "bag.db3.zstd").write_bytes(MEGABYTE * 900)
    else:
        with contextlib.closing(sqlite3.connect(bag / "bag.db3")) as file, file:
            file.execute("UPDATE messages SET data = ? WHERE id = 3", [MEGABYTE * 300])
    with pytest.raises(InputError, match=r"expanded bytes.* exceed the limit"):
        load_measurement(bag)
    assert not [*(tmp_path / "temporary").iterdir()]


def test_messages_that_a_bag_computes_are_refused(tmp_path):
    bag = write_bag(tmp_path / "bag", {TOPIC: states(TIME[:9], ARM)})
    with contextlib.closing(sqlite3.connect(bag / "bag.db3")) as file, file:
        file.execute("DROP TABLE messages")
        file.execute(
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER,"
            " data BLOB GENERATED ALWAYS AS (zeroblob(900000000)))"
        )
        file.execute("INSERT INTO messages(topic_id, timestamp) VALUES (1, 5)")
    with pytest.raises(InputError, match="its messages are computed and not stored"):
        load_measurement(bag)


def test_a_chunk_of_ros_1_is_expanded_within_bounds_only(tmp_path):
    file = write_ros1(tmp_path / "a.bag", {TOPIC: states(TIME[:9], ARM)})
    head = b"".join(
        struct.pack("<I", len(field)) + field
        for field in (b"op=\x05", b"compression=bz2", b"size=" + struct.pack("<I", 2**20))
    )
    piece = bz2.compress(bytes(2**20)) * 300
    data, place = file.read_bytes(), len(b"#ROSBAG V2.0\n")
    for _ in range(2):  # header and padding of the head of the bag
        place += 4 + struct.unpack_from("<I", data, place)[0]
    chunk = struct.pack("<I", len(head)) + head + struct.pack("<I", len(piece)) + piece
    file.write_bytes(data[:place] + chunk)
    with pytest.raises(InputError, match=r"expanded bytes in a piece exceed the limit"):
        load_measurement(file)


def test_names_that_change_with_each_message_are_refused(tmp_path):
    messages = numbered(lambda k: {"name": [f"j{k}"], "position": [0.5]}, count=5000)
    with pytest.raises(InputError, match=r"/joint_states: 4097 columns exceed the limit of 4096"):
        load_measurement(write_json(tmp_path / "a.mcap", {TOPIC: messages}))


def test_messages_that_a_bag_says_it_has_are_missed(tmp_path):
    bag = write_bag(tmp_path / "bag", {TOPIC: states(TIME, ARM)})
    with contextlib.closing(sqlite3.connect(bag / "bag.db3")) as file, file:
        file.execute("DELETE FROM messages WHERE id > 189")
    said = "The log says that /joint_states has 300 messages, and 189 were read"
    assert any(said in sentence for sentence in guess_data(bag).doubts)
    with contextlib.closing(sqlite3.connect(bag / "bag.db3")) as file, file:
        file.execute("DELETE FROM messages")
    with pytest.raises(InputError, match=r"has 300 messages, and 0 were read"):
        load_measurement(bag)


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_temporary_files_are_removed_however_a_process_ends(tmp_path, number):
    code = (
        "from stickslip.show.documents import private_folder\n"
        "import time\n"
        "with private_folder() as place:\n"
        "    (place / 'large').write_text('x')\n"
        "    print(place, flush=True)\n"
        "    time.sleep(60)\n"
    )
    command = [sys.executable, "-c", code]
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        place = Path(process.stdout.readline().strip())
        assert place.parent == tmp_path
        process.send_signal(number)
    old = time.time() - 100.0
    if place.exists():
        assert number == signal.SIGKILL
        os.utime(place, (old, old))
    (tmp_path / "stickslip-private-mine").mkdir()  # without a lock: of somebody else
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tempfile, "tempdir", str(tmp_path))
        with private_folder() as held:
            os.utime(held, (old, old))
            with private_folder():
                assert held.exists()
    assert [path.name for path in tmp_path.iterdir()] == ["stickslip-private-mine"]
