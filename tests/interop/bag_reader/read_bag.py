#!/usr/bin/env python3
"""Validates a voxtouch bag as rosbag2 (Humble) reads it, with the standard library only.

usage: read_bag.py MAKE_BAG closed|killed
"""

import os
import pathlib
import re
import signal
import sqlite3
import struct
import subprocess
import sys
import tempfile

START = 1_700_000_000_000_000_000
CHANGELOG = pathlib.Path(__file__).resolve().parents[3] / "deploy/CHANGELOG.md"
FOREVER = {"sec": 9223372036, "nsec": 854775807}


def tiny_yaml(text):
    """Block maps, block lists, and scalars of metadata.yaml. For machines without PyYAML."""
    rows = [
        (len(line) - len(line.lstrip()), line.strip()) for line in text.splitlines() if line.strip()
    ]

    def scalar(word):
        if word.startswith('"'):
            return word[1:-1].encode().decode("unicode_escape")
        if word in ("true", "false"):
            return word == "true"
        return int(word) if word.lstrip("-").isdigit() else word

    def block(at, indent):
        if at < len(rows) and rows[at][1].startswith("- "):
            out = []
            while at < len(rows) and rows[at][0] == indent and rows[at][1].startswith("- "):
                rest = rows[at][1][2:]
                if ": " in rest or rest.endswith(":"):
                    rows[at] = (indent + 2, rest)
                    value, at = block(at, indent + 2)
                else:
                    value, at = scalar(rest), at + 1
                out.append(value)
            return out, at
        out = {}
        while at < len(rows) and rows[at][0] == indent and not rows[at][1].startswith("- "):
            key, _, rest = rows[at][1].partition(":")
            at += 1
            if rest.strip():
                out[key] = {} if rest.strip() == "{}" else scalar(rest.strip())
            elif at < len(rows) and rows[at][1] == "{}":
                out[key], at = {}, at + 1
            elif at < len(rows) and (
                rows[at][0] > indent or (rows[at][0] == indent and rows[at][1].startswith("- "))
            ):
                out[key], at = block(at, rows[at][0])
            else:
                out[key] = None
        return out, at

    return block(0, rows[0][0])[0]


def load_yaml(text):
    ours = tiny_yaml(text)
    try:
        import yaml
    except ImportError:
        return ours
    theirs = yaml.safe_load(text)
    assert ours == theirs, "the tiny parser and PyYAML disagree"
    return theirs


def equal(what, got, expected):
    if got != expected:
        sys.exit(f"{what}: got {got!r}, wanted {expected!r}")


def check_columns(database):
    expected = {
        "schema": [("schema_version", "INTEGER", 0, 1), ("ros_distro", "TEXT", 1, 0)],
        "metadata": [
            ("id", "INTEGER", 0, 1),
            ("metadata_version", "INTEGER", 1, 0),
            ("metadata", "TEXT", 1, 0),
        ],
        "topics": [
            ("id", "INTEGER", 0, 1),
            ("name", "TEXT", 1, 0),
            ("type", "TEXT", 1, 0),
            ("serialization_format", "TEXT", 1, 0),
            ("offered_qos_profiles", "TEXT", 1, 0),
        ],
        "messages": [
            ("id", "INTEGER", 0, 1),
            ("topic_id", "INTEGER", 1, 0),
            ("timestamp", "INTEGER", 1, 0),
            ("data", "BLOB", 1, 0),
        ],
    }
    tables = {
        name for (name,) in database.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
    }
    equal("tables", tables, set(expected))
    for table, columns in expected.items():
        rows = database.execute(f"PRAGMA table_info({table})").fetchall()
        equal(
            f"columns of {table}",
            [(name, kind, notnull, pk) for (_, name, kind, notnull, _, pk) in rows],
            columns,
        )
    index = database.execute(
        "SELECT name, tbl_name FROM sqlite_master WHERE type = 'index'"
    ).fetchall()
    equal("index", index, [("timestamp_idx", "messages")])
    equal(
        "schema version", database.execute("SELECT schema_version FROM schema").fetchall(), [(3,)]
    )
    equal("integrity", database.execute("PRAGMA integrity_check").fetchone(), ("ok",))


def check_topics(database):
    topics = database.execute(
        "SELECT id, name, type, serialization_format, offered_qos_profiles FROM topics ORDER BY id"
    ).fetchall()
    equal(
        "topics",
        [t[1:4] for t in topics],
        [
            ("/haptic/device/state", "voxtouch_msgs/msg/DeviceState", "cdr"),
            ("/haptic/note", "std_msgs/msg/String", "cdr"),
        ],
    )
    stream, latched = (load_yaml(t[4]) for t in topics)
    common = {
        "history": 1,
        "depth": 1,
        "lifespan": FOREVER,
        "liveliness": 1,
        "liveliness_lease_duration": FOREVER,
        "avoid_ros_namespace_conventions": False,
    }
    equal(
        "qos of the stream",
        stream,
        [{**common, "reliability": 2, "durability": 2, "deadline": {"sec": 0, "nsec": 3000000}}],
    )
    equal(
        "qos of the latched topic",
        latched,
        [{**common, "reliability": 1, "durability": 1, "deadline": FOREVER}],
    )
    return topics


def check_messages(database, topics):
    rows = database.execute(
        "SELECT timestamp, data FROM messages WHERE topic_id = ? ORDER BY timestamp, id",
        (topics[0][0],),
    ).fetchall()
    equal("number of states", len(rows), 500)
    for i, (time, data) in enumerate(rows):
        equal(f"time of {i}", time, START + 1_000_000 * i)
        equal(f"size of {i}", len(data), 4 + 3 * 8 + 7 * 8 + 6 * 8 + 2 * 4)
        equal(f"header of {i}", data[:4], b"\0\1\0\0")
        session, sequence, stamp = struct.unpack_from("<QQq", data, 4)
        equal(f"ids of {i}", (session, sequence, stamp), (77, i, 1_000_000 * i))
        x = 0.001 * i
        equal(
            f"pose of {i}", struct.unpack_from("<7d", data, 28), (x, -x, 2 * x, 0.0, 0.0, 0.0, 1.0)
        )
        equal(f"twist of {i}", struct.unpack_from("<6d", data, 84), (1.0, 0.0, 0.0, 0.0, 0.0, 0.0))
        equal(f"buttons and flags of {i}", struct.unpack_from("<II", data, 132), (1, 5))
    (text,) = database.execute(
        "SELECT data FROM messages WHERE topic_id = ?", (topics[1][0],)
    ).fetchall()
    (length,) = struct.unpack_from("<I", text[0], 4)
    equal("text", text[0][8 : 8 + length], b"hello\0")


def check_metadata(folder, database, topics, closed):
    with open(os.path.join(folder, "metadata.yaml"), encoding="utf-8") as file:
        info = load_yaml(file.read())["rosbag2_bagfile_information"]
    keys = [
        "version",
        "storage_identifier",
        "duration",
        "starting_time",
        "message_count",
        "topics_with_message_count",
        "compression_format",
        "compression_mode",
        "relative_file_paths",
        "files",
        "custom_data",
        "ros_distro",
    ]
    equal("keys of metadata.yaml", list(info), keys)
    equal("version", info["version"], 8)
    equal("storage", info["storage_identifier"], "sqlite3")
    equal("compression", (info["compression_format"], info["compression_mode"]), ("", ""))
    equal("files", info["relative_file_paths"], ["run_0.db3"])
    equal(
        "described topics",
        [
            (
                t["topic_metadata"]["name"],
                t["topic_metadata"]["type"],
                t["topic_metadata"]["offered_qos_profiles"],
            )
            for t in info["topics_with_message_count"]
        ],
        [(t[1], t[2], t[4]) for t in topics],
    )
    hashes = [
        t["topic_metadata"]["type_description_hash"] for t in info["topics_with_message_count"]
    ]
    layout = re.search(r"\| DeviceState \| `(\w+)` \|", CHANGELOG.read_text(encoding="utf-8"))
    equal("type hashes", hashes, [layout[1], ""])
    equal("counts", [t["message_count"] for t in info["topics_with_message_count"]], [500, 1])
    equal("count", info["message_count"], 501)
    equal("start", info["starting_time"], {"nanoseconds_since_epoch": START})
    equal("duration", info["duration"], {"nanoseconds": 499_000_000})
    equal(
        "file",
        info["files"],
        [
            {
                "path": "run_0.db3",
                "starting_time": info["starting_time"],
                "duration": info["duration"],
                "message_count": 501,
            }
        ],
    )
    # The row inside the database: without it Jazzy would take the QoS texts for its newest form.
    rows = database.execute("SELECT metadata_version, metadata FROM metadata").fetchall()
    equal("rows of metadata", [r[0] for r in rows], [8])
    inner = load_yaml(rows[0][1])
    equal("version in the database", inner["version"], 8)
    equal("keys in the database", list(inner), keys)
    if closed:
        equal("metadata in the database", inner, info)


def main():
    make_bag, ending = sys.argv[1:]
    with tempfile.TemporaryDirectory() as parent:
        folder = os.path.join(parent, "run")
        made = subprocess.run([make_bag, folder, ending], check=False)
        equal("exit of make_bag", made.returncode, 0 if ending == "closed" else -signal.SIGKILL)
        left = sorted(os.listdir(folder))
        expected = ["metadata.yaml", "run_0.db3", "voxtouch_recording.json"]
        if ending == "killed":
            expected[2:2] = ["run_0.db3-shm", "run_0.db3-wal"]
            if (
                "voxtouch_recording.json" not in left
            ):  # the logger reports losses once a second: the kill may be earlier
                expected.remove("voxtouch_recording.json")
        equal("files in the folder", left, expected)
        # Read-only, as rosbag2 opens it.
        database = sqlite3.connect(f"file:{folder}/run_0.db3?mode=ro", uri=True)
        check_columns(database)
        topics = check_topics(database)
        check_messages(database, topics)
        check_metadata(folder, database, topics, ending == "closed")
        database.close()
    print(f"a bag that was {ending} is as rosbag2 wants it")


main()
