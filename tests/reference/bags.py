"""Bags for the tests of tauscope's readers, written by other programs than tauscope.

    pip install rosbags==0.11.1 mcap==1.6.0 mcap-ros2-support==0.6.0
    python bags.py        # writes the folder bags/ beside this file

Every bag holds the same 60 samples at 100 Hz, `truth()` below: joint k of `NAMES` has position sin(3 t + k), velocity
3 cos(3 t + k) and effort 10 k + t. Messages name the joints in another order than the arm.
"""

import math
import shutil
from pathlib import Path

import numpy as np
from mcap_ros2.writer import Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

FOLDER = Path(__file__).parent / "bags"
NAMES = ["shoulder", "elbow", "wrist"]
ORDER = [2, 0, 1]
SAMPLES, PERIOD_NS, START_NS = 60, 10_000_000, 1_700_000_000_123_456_789
STORE = get_typestore(Stores.ROS2_HUMBLE)
SCHEMA = """std_msgs/Header header
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


def truth(sample):
    t = sample * PERIOD_NS * 1e-9
    return [(math.sin(3 * t + k), 3 * math.cos(3 * t + k), 10.0 * k + t) for k in range(len(NAMES))]


def message(sample, frame="", velocity=True):
    values = truth(sample)
    stamp = START_NS + sample * PERIOD_NS
    part = lambda which: [values[k][which] for k in ORDER]
    return {
        "header": {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}, "frame_id": frame},
        "name": [NAMES[k] for k in ORDER],
        "position": part(0),
        "velocity": part(1) if velocity else [],
        "effort": part(2),
    }


def cdr(sample, **more):
    T = STORE.types
    m = message(sample, **more)
    stamp = T["builtin_interfaces/msg/Time"](**m["header"]["stamp"])
    header = T["std_msgs/msg/Header"](stamp=stamp, frame_id=m["header"]["frame_id"])
    arrays = {key: np.array(m[key], dtype=np.float64) for key in ("position", "velocity", "effort")}
    state = T["sensor_msgs/msg/JointState"](header=header, name=m["name"], **arrays)
    return STORE.serialize_cdr(state, "sensor_msgs/msg/JointState")


def bag(name, plugin, mode=None):
    """A bag folder as `ros2 bag record` makes it. The bag's own stamps come 3 ms late and jitter."""
    folder = FOLDER / name
    writer = BagWriter(folder, version=8, storage_plugin=plugin)
    if mode:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        states = writer.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=STORE)
        text = writer.add_connection("/notes", "std_msgs/msg/String", typestore=STORE)
        note = STORE.serialize_cdr(STORE.types["std_msgs/msg/String"](data="begin"), "std_msgs/msg/String")
        writer.write(text, START_NS, note)
        for sample in range(SAMPLES):
            late = START_NS + sample * PERIOD_NS + 3_000_000 + (sample % 3) * 500_000
            writer.write(states, late, cdr(sample, frame="base"))


def bare(name, topics, velocity=True, samples=SAMPLES):
    """A bare MCAP file with the given topics in chunks of a few messages."""
    with open(FOLDER / name, "wb") as stream:
        writer = Writer(stream, chunk_size=2048)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", SCHEMA)
        for sample in range(samples):
            stamp = START_NS + sample * PERIOD_NS
            for topic in topics:
                writer.write_message(topic, schema, message(sample, velocity=velocity), stamp, stamp, sample)
        writer.finish()


if __name__ == "__main__":
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir()
    bag("sqlite", StoragePlugin.SQLITE3)
    bag("sqlite_messages", StoragePlugin.SQLITE3, CompressionMode.MESSAGE)
    bag("sqlite_file", StoragePlugin.SQLITE3, CompressionMode.FILE)
    bag("mcap", StoragePlugin.MCAP)
    bag("mcap_messages", StoragePlugin.MCAP, CompressionMode.MESSAGE)
    bare("bare.mcap", ["/joint_states"], velocity=False)
    bare("two_topics.mcap", ["/left/joint_states", "/right/joint_states"], samples=5)
    whole = (FOLDER / "bare.mcap").read_bytes()
    (FOLDER / "truncated.mcap").write_bytes(whole[: len(whole) * 6 // 10])
