"""rosbags and mcap, of PyPI, read every message of bags in both storages, complete, split and after
a kill, without a workspace and without our code.

usage: judges.py MAKE_BAG
"""

import pathlib
import signal
import subprocess
import sys
import tempfile

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

START = 1_700_000_000_000_000_000
STATE, NOTE = "/haptic/device/state", "/haptic/note"
IDL = pathlib.Path(__file__).resolve().parents[3] / "idl"


def equal(what, got, expected):
    if got != expected:
        sys.exit(f"{what}: got {got!r}, wanted {expected!r}")


def rosbags_types(storage):
    """Of our messages: an MCAP contains them; for sqlite3 the user provides them from idl."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    if storage == "sqlite3":
        store.register(
            get_types_from_msg(
                (IDL / "msg/DeviceState.msg").read_text(), "voxtouch_msgs/msg/DeviceState"
            )
        )
    return store


def by_rosbags(folder, storage):
    with Reader(folder) as reader:
        store = rosbags_types(storage)
        for connection in reader.connections:
            if storage == "mcap":
                equal("format of the definition", connection.msgdef.format.name, "MSG")
                if connection.msgtype.startswith("voxtouch_msgs"):
                    store.register(
                        {
                            k: v
                            for k, v in get_types_from_msg(
                                connection.msgdef.data, connection.msgtype
                            ).items()
                            if k not in store.fielddefs
                        }
                    )
        equal(
            "topics",
            sorted((c.topic, c.msgtype) for c in reader.connections),
            [(STATE, "voxtouch_msgs/msg/DeviceState"), (NOTE, "std_msgs/msg/String")],
        )
        equal("count", reader.message_count, 501)
        equal(
            "start and end", (reader.start_time, reader.end_time), (START, START + 499_000_000 + 1)
        )
        states = [
            (time, store.deserialize_cdr(data, c.msgtype))
            for c, time, data in reader.messages()
            if c.topic == STATE
        ]
        notes = [
            store.deserialize_cdr(data, c.msgtype).data
            for c, _, data in reader.messages()
            if c.topic == NOTE
        ]
        part = list(reader.messages(start=START + 100_000_000, stop=START + 300_000_000))
    equal("notes", notes, ["hello"])
    equal("a part", len(part), 200)
    return [(time, s.sequence_number, s.pose.position.z) for time, s in states]


def by_mcap(folder):
    states, notes = [], []
    for file in sorted(folder.glob("*.mcap")):
        with open(file, "rb") as opened:
            reader = make_reader(opened, validate_crcs=True, decoder_factories=[DecoderFactory()])
            equal("profile", reader.get_header().profile, "ros2")
            summary = reader.get_summary()
            if summary is not None:
                equal(
                    "counted in the summary",
                    summary.statistics.message_count,
                    sum(1 for _ in reader.iter_messages()),
                )
                equal("chunks", len(summary.chunk_indexes), summary.statistics.chunk_count)
                equal("metadata", [m.name for m in reader.iter_metadata()], ["rosbag2"])
                for channel in summary.channels.values():
                    equal(
                        "encoding",
                        (channel.message_encoding, summary.schemas[channel.schema_id].encoding),
                        ("cdr", "ros2msg"),
                    )
                    assert "history" in channel.metadata["offered_qos_profiles"], channel.metadata
            opened.seek(0)
            for _, channel, message, decoded in reader.iter_decoded_messages():
                if channel.topic == NOTE:
                    notes.append(decoded.data)
                else:
                    states.append(
                        (message.log_time, decoded.sequence_number, decoded.pose.position.z)
                    )
    equal("notes", notes, ["hello"])
    return states


def main(make_bag):
    expected = [(START + 1_000_000 * i, i, 0.002 * i) for i in range(500)]
    for storage in ("sqlite3", "mcap"):
        for ending in ("closed", "killed"):
            for split in ((), ("split",)):
                with tempfile.TemporaryDirectory() as parent:
                    folder = pathlib.Path(parent) / "run"
                    made = subprocess.run([make_bag, folder, ending, storage, *split], check=False)
                    equal(
                        "exit of make_bag",
                        made.returncode,
                        0 if ending == "closed" else -signal.SIGKILL,
                    )
                    endings = {"sqlite3": "*.db3", "mcap": "*.mcap"}[storage]
                    equal("files", len(list(folder.glob(endings))), 3 if split else 1)
                    equal("rosbags", by_rosbags(folder, storage), expected)
                    if storage == "mcap":
                        equal("mcap", by_mcap(folder), expected)
                    print(f"{storage}, {ending}{', split' if split else ''}: every message is read")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    main(sys.argv[1])
