"""Bags of `voxtouch up`: rosbags, mcap and our reader open each of them. Each run is replayed
bit-identically, in lockstep, and in real time if nothing was lost.

usage: up_bags.py BIN DEPLOY [RINGS] [SECONDS]
Runs RINGS rings (6), each for SECONDS (2) of the device's time, with alternating scene, storage and
splitting, every sixth in lockstep, and kills the logger of every fifth. Prints a line per ring and
a summary. Exit status 1: a reader failed, the readers' numbers of messages differ, or a replay
differs without reporting missing data.
"""

import collections
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import mcap.reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

DOMAIN = 98
STATE = "/haptic/device/state"
SCENES = (
    ("cup", "slide"),
    ("cup_friction", "slide"),
    ("objects", "slide"),
    ("block", "fall"),
    ("cup_viscosity", "slide"),
)
SQLITE3 = ("--record-format", "sqlite3")
FORMATS = ((), SQLITE3, ("--record-split-s", "0.7"), (*SQLITE3, "--record-split-s", "0.7"))
IDL = pathlib.Path(__file__).resolve().parents[3] / "idl"


def types_of_idl():
    """Definitions of our messages, as provided by a user with a workspace: sqlite3 bags have
    none."""
    types = {}
    for file in sorted((IDL / "msg").glob("*.msg")):
        types |= get_types_from_msg(file.read_text(), f"voxtouch_msgs/msg/{file.stem}")
    for file in sorted((IDL / "ros").glob("*/msg/*.msg")):
        types |= get_types_from_msg(file.read_text(), f"{file.parents[1].name}/msg/{file.stem}")
    return types


def by_rosbags(bag, is_mcap):
    """Number of messages of each topic, all decoded; for an MCAP with the definitions in it."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    with Reader(bag) as reader:
        types = {}
        for connection in reader.connections:
            if is_mcap:
                types |= get_types_from_msg(connection.msgdef.data, connection.msgtype)
        store.register(
            {
                name: fields
                for name, fields in (types if is_mcap else types_of_idl()).items()
                if name not in store.fielddefs
            }
        )
        counts = collections.Counter()
        for connection, _, data in reader.messages():
            store.deserialize_cdr(data, connection.msgtype)
            counts[connection.topic] += 1
    return counts


def by_mcap(bag):
    counts = collections.Counter()
    for file in sorted(bag.glob("*.mcap")):
        with open(file, "rb") as opened:
            for _, channel, _, _ in mcap.reader.make_reader(
                opened, validate_crcs=True, decoder_factories=[DecoderFactory()]
            ).iter_decoded_messages():
                counts[channel.topic] += 1
    return counts


def play(bin_folder, deploy, bag, turn, seconds):
    """Records a ring; whether it ran in lockstep, and whether its logger was killed."""
    (scene, motion), more = SCENES[turn % len(SCENES)], FORMATS[turn % len(FORMATS)]
    lockstep, killed = turn % 6 == 5, turn % 5 == 4
    words = [
        bin_folder / "voxtouch",
        "up",
        deploy / f"scenes/{scene}.yaml",
        "--device",
        "sim-phantom",
        "--motion",
        motion,
        "--record",
        bag,
        "--no-report",
        "--json",
        "--domain",
        str(DOMAIN),
        *more,
        *(["--lockstep"] if lockstep else []),
        *([] if killed else ["--duration", str(seconds)]),
    ]
    with tempfile.TemporaryFile() as said:
        up = subprocess.Popen([str(word) for word in words], stdout=said, stderr=subprocess.STDOUT)
        try:
            if killed:
                kill_logger(up, seconds)
            up.wait(300)
        finally:
            up.kill()
            up.wait()
        said.seek(0)
        if not (bag / "metadata.yaml").exists():
            raise SystemExit(
                f"{' '.join(map(str, words))} left no bag:\n{said.read().decode(errors='replace')}"
            )
    return (
        lockstep,
        killed,
        f"{scene}, {' '.join(more) or 'mcap'}"
        + (", lockstep" if lockstep else "")
        + (", logger killed" if killed else ""),
    )


def kill_logger(up, seconds):
    """Some time after it has begun: `up` then ends the ring by itself."""
    until = time.monotonic() + 60
    while time.monotonic() < until and up.poll() is None:
        children = pathlib.Path(f"/proc/{up.pid}/task/{up.pid}/children").read_text().split()
        for child in children:
            if (
                b"voxtouch_logger"
                in pathlib.Path(f"/proc/{child}/cmdline").read_bytes().split(b"\0")[0]
            ):
                time.sleep(seconds)
                subprocess.run(["kill", "-9", child], check=False)
                return
        time.sleep(0.05)


def replayed(bin_folder, bag):
    ran = subprocess.run(
        [str(bin_folder / "voxtouch"), "replay", str(bag), "--json"],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    try:
        return ran.returncode, json.loads(ran.stdout)
    except json.JSONDecodeError:
        return ran.returncode, {"error": ran.stderr + ran.stdout}


def judge(bin_folder, bag, is_mcap, lockstep, killed):
    """(verdict, faults): the verdict is one word."""
    faults, counts = [], collections.Counter()
    try:
        counts = by_rosbags(bag, is_mcap)
        if is_mcap and (other := by_mcap(bag)) != counts:
            faults.append(f"mcap reads {dict(other)}, rosbags {dict(counts)}")
    except Exception as error:  # any failure of a foreign reader is a result
        faults.append(f"a reader fails: {type(error).__name__}: {error}")
    status, output = replayed(bin_folder, bag)
    if "samples" not in output:
        return "refused", faults + [f"replay: {output.get('error')}"]
    # rosbags opens sqlite3 as a file that none writes, and so leaves out the write-ahead log that
    # a kill leaves next to it.
    without_log = killed and not is_mcap and 0 < counts[STATE] < output["samples"]
    doubled = any("duplicate sequence numbers" in note for note in output["notes"])
    if output["samples"] != counts[STATE] and not doubled and not without_log:
        faults.append(
            f"our reader reads {output['samples']} device samples, rosbags {counts[STATE]}"
        )
    if without_log:
        print(
            f"    rosbags reads {counts[STATE]} of {output['samples']} device samples: the rest"
            f" is in"
            " the write-ahead log"
        )
    if status == 0 and output["ok"] and not output["missing"]:
        return "equal", faults
    if output["missing"] and not (lockstep and not killed):
        return "lost", faults
    return "differs", faults + [f"nothing is missing, and it differs: {json.dumps(output)[:2000]}"]


def main(bin_folder, deploy, rings, seconds):
    verdicts, opened, bad = collections.Counter(), 0, 0
    for turn in range(rings):
        with tempfile.TemporaryDirectory(prefix="voxtouch_up_bags_") as folder:
            bag = pathlib.Path(folder) / "bag"
            lockstep, killed, what = play(bin_folder, deploy, bag, turn, seconds)
            verdict, faults = judge(bin_folder, bag, any(bag.glob("*.mcap")), lockstep, killed)
        kind = "lockstep" if lockstep and not killed else "killed" if killed else "real time"
        verdicts[kind, verdict] += 1
        opened += not any("reader" in fault or "reads" in fault for fault in faults)
        bad += bool(faults)
        print(
            f"{turn + 1}: {what}: {verdict}" + "".join(f"\n    {fault}" for fault in faults),
            flush=True,
        )
    print(f"{opened} of {rings} bags are read alike by all readers")
    for (kind, verdict), count in sorted(verdicts.items()):
        print(f"{kind}: {count} {'lost samples, as replay says' if verdict == 'lost' else verdict}")
    return bad > 0


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4, 5):
        raise SystemExit(__doc__)
    raise SystemExit(
        main(
            *(pathlib.Path(argument).resolve() for argument in sys.argv[1:3]),
            *(int(argument) for argument in (sys.argv[3:] + ["6", "2"][len(sys.argv) - 3 :])),
        )
    )
