"""Logs of a robot, written by the libraries that write them."""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

rosbags = pytest.importorskip("rosbags.rosbag2", reason="needs the package rosbags")
mcap_writer = pytest.importorskip("mcap.writer", reason="needs the package mcap")
ros2_writer = pytest.importorskip("mcap_ros2.writer", reason="needs mcap-ros2-support")

NANO = 1_000_000_000
BEGIN = 1_700_000_000 * NANO
"""Time of the first message of a log [ns]."""

State = Mapping[str, Any]
"""A joint state: its log time [ns], header time [ns], names, positions, velocities, efforts."""

JOINT_STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""


def states(
    times: Sequence[float],
    joints: Mapping[str, Sequence[Any]],
    *,
    stamped: bool = True,
    late: float = 0.0,
) -> list[State]:
    """Return joint states at times [s]; of each joint position, velocity and effort, or None."""
    found = []
    for row, time in enumerate(times):
        stamp = BEGIN + round(time * NANO)
        fields = [
            [joint[k][row] for joint in joints.values() if joint[k] is not None] for k in range(3)
        ]
        found.append(
            {
                "logged": stamp + round(late * NANO),
                "stamp": stamp if stamped else 0,
                "name": [*joints],
                "position": fields[0],
                "velocity": fields[1],
                "effort": fields[2],
            }
        )
    return found


def write_bag(
    folder: Path,
    topics: Mapping[str, Iterable[State]],
    *,
    numbers: Mapping[str, Iterable[tuple[float, float]]] | None = None,
    storage: str = "SQLITE3",
    compression: str = "",
) -> Path:
    """Write a bag of ROS 2 with joint states, and numbers by time [s]."""
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    writer = Writer(folder, version=9, storage_plugin=StoragePlugin[storage])
    if compression:
        writer.set_compression(CompressionMode[compression], CompressionFormat.ZSTD)
    with writer:
        for topic, messages in topics.items():
            kind = "sensor_msgs/msg/JointState"
            connection = writer.add_connection(topic, kind, typestore=store)
            for entry in messages:
                time = types["builtin_interfaces/msg/Time"](
                    sec=entry["stamp"] // NANO, nanosec=entry["stamp"] % NANO
                )
                message = types[kind](
                    header=types["std_msgs/msg/Header"](stamp=time, frame_id=""),
                    name=entry["name"],
                    **{
                        k: np.array(entry[k], dtype=float)
                        for k in ("position", "velocity", "effort")
                    },
                )
                writer.write(connection, entry["logged"], store.serialize_cdr(message, kind))
        for topic, pairs in (numbers or {}).items():
            kind = "std_msgs/msg/Float64"
            connection = writer.add_connection(topic, kind, typestore=store)
            for time, value in pairs:
                data = store.serialize_cdr(types[kind](data=value), kind)
                writer.write(connection, BEGIN + round(time * NANO), data)
    return folder


def write_ros1(file: Path, topics: Mapping[str, Iterable[State]]) -> Path:
    """Write a bag of ROS 1 with joint states."""
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    types, kind = store.types, "sensor_msgs/msg/JointState"
    with Writer(file) as writer:
        for topic, messages in topics.items():
            connection = writer.add_connection(topic, kind, typestore=store)
            for seq, entry in enumerate(messages):
                time = types["builtin_interfaces/msg/Time"](
                    sec=entry["stamp"] // NANO, nanosec=entry["stamp"] % NANO
                )
                message = types[kind](
                    header=types["std_msgs/msg/Header"](seq=seq, stamp=time, frame_id=""),
                    name=entry["name"],
                    **{
                        k: np.array(entry[k], dtype=float)
                        for k in ("position", "velocity", "effort")
                    },
                )
                writer.write(connection, entry["logged"], store.serialize_ros1(message, kind))
    return file


def write_mcap(
    file: Path, topics: Mapping[str, Iterable[State]], *, compression: str = "ZSTD"
) -> Path:
    """Write joint states of ROS 2 in MCAP."""
    from mcap.writer import CompressionType

    with file.open("wb") as stream:
        writer = ros2_writer.Writer(stream, compression=CompressionType[compression])
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        for topic, messages in topics.items():
            for entry in messages:
                stamp = {"sec": entry["stamp"] // NANO, "nanosec": entry["stamp"] % NANO}
                message = {k: entry[k] for k in ("name", "position", "velocity", "effort")}
                message["header"] = {"stamp": stamp, "frame_id": ""}
                writer.write_message(topic, schema, message, log_time=entry["logged"])
        writer.finish()
    return file


def write_json(
    file: Path, topics: Mapping[str, Iterable[tuple[int, Any]]], *, kind: str = "JointState"
) -> Path:
    """Write messages in JSON, each with its log time [ns], in MCAP."""
    from mcap.writer import Writer

    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema(kind, "jsonschema", b'{"type": "object"}')
        for topic, messages in topics.items():
            channel = writer.register_channel(topic, "json", schema)
            for logged, message in messages:
                data = json.dumps(message).encode()
                writer.add_message(channel, logged, data, publish_time=logged)
        writer.finish()
    return file
