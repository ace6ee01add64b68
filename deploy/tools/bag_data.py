"""Content of a recorded run, as arrays and dictionaries. The layouts of the messages come from
idl/msg.

Reads rosbag2 folders (see bag_files.py), also of a killed ring. Needs numpy, a dependency of
python3-matplotlib.
"""

import functools
import json
import pathlib
import struct
import sys

import numpy
from bag_files import FileError, files_of, open_file
from numpy.lib import recfunctions

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "idl"))
from generate_idl import PRIMITIVES, parse  # noqa: E402
from type_hash import type_hash  # noqa: E402

numpy.seterr(
    all="ignore"
)  # a bag may contain any number; non-finite ones are ignored in drawings and counts
OWN = "voxtouch_msgs"
FORMATS = {
    "bool": "?",
    "byte": "u1",
    "char": "u1",
    "float32": "<f4",
    "float64": "<f8",
    **{f"{u}int{8 * n}": f"<{s}{n}" for u, s in (("", "i"), ("u", "u")) for n in (1, 2, 4, 8)},
}
AT_ONCE = 20000  # messages that are buffered before their numbers are extracted


class BagError(Exception):
    """A sentence: the unusable part of the bag."""


# -------------------- messages
@functools.cache
def message(name, package=OWN):
    """(fields, constants) of a message, from its .msg file."""
    folder = ROOT / "idl" / ("" if package == OWN else f"ros/{package}") / "msg"
    fields, constants = parse(folder / f"{name}.msg", package)
    return fields, {key: int(value) for _, key, value in constants}


class Messages(dict):
    """(fields, constants) by (package, name), read on demand."""

    def __missing__(self, key):
        return message(key[1], key[0])


def layout_hash(kind):
    """The hash of a type such as voxtouch_msgs/msg/NodeStatus in this version's layout; "" for an
    unknown type.
    """
    package, _, name = kind.partition("/msg/")
    try:
        return type_hash(Messages(), package, name)
    except (OSError, SystemExit):
        return ""


def constants(name):
    return message(name)[1]


@functools.cache
def layout(name, package=OWN):
    """(dtype, whole): the fixed-size fields at the front of a message, and whether these are all.
    Ends before padding.
    """
    out, at = [], 0
    for kind, owner, array, count, field in message(name, package)[0]:
        one, whole = (
            layout(kind, owner)
            if owner
            else (numpy.dtype(FORMATS[kind]) if kind in FORMATS else None, True)
        )
        if one is None or not whole or array not in (None, "fixed") or at % min(8, one.itemsize):
            return numpy.dtype(out), False
        out.append((field, one, (count,)) if array else (field, one))
        at += one.itemsize * (count or 1)
    return numpy.dtype(out), True


def decode(name, data, last=None):
    """A message as a dictionary, up to the field `last`. `data` begins with the encapsulation
    header.
    """
    return Decoder(data).fields(name, OWN, last)


class Decoder:
    def __init__(self, data):
        self.data, self.at = data, 4

    def number(self, kind):
        size = PRIMITIVES[kind][1]
        self.at += -(self.at - 4) % size
        (value,) = struct.unpack_from(
            "<"
            + {"bool": "?", "byte": "B", "char": "B", "float32": "f", "float64": "d"}.get(
                kind,
                (
                    {1: "b", 2: "h", 4: "i", 8: "q"}[size].upper()
                    if kind[0] == "u"
                    else {1: "b", 2: "h", 4: "i", 8: "q"}[size]
                ),
            ),
            self.data,
            self.at,
        )
        self.at += size
        return value

    def text(self):
        length = self.number("uint32")
        if self.at + length > len(self.data):
            raise struct.error("a string exceeds its message")
        self.at += length
        return self.data[self.at - length : self.at - 1].decode(errors="replace") if length else ""

    def value(self, kind, owner):
        return (
            self.fields(kind, owner)
            if owner
            else self.text()
            if kind == "string"
            else self.number(kind)
        )

    def fields(self, name, package, last=None):
        out = {}
        for kind, owner, array, size, field in message(name, package)[0]:
            if array:
                count = size if array == "fixed" else self.number("uint32")
                if count > len(self.data):
                    raise struct.error("a sequence exceeds its message")
                out[field] = [self.value(kind, owner) for _ in range(count)]
            else:
                out[field] = self.value(kind, owner)
            if field == last:
                break
        return out


def vector(field):
    """x, y, z of many messages as n rows of three."""
    return numpy.stack([field["x"], field["y"], field["z"]], -1)


def norm(vectors):
    return numpy.sqrt((vectors * vectors).sum(-1))


# -------------------- bags
class Rows:
    """Data of one topic: its times [ns], and its numbers (`fields` of a message's front) or its
    whole messages.
    """

    def __init__(self, type_name, fields):
        self.fields, self.times, self.raw, self.parts = fields, [], [], []
        self.dtype, self.whole = layout(type_name)
        self.empty = numpy.empty(0, self.dtype)[list(fields)] if fields else None

    def take(self):
        """Copies the fields of many messages, so that the messages can be freed."""
        if not self.fields:
            return
        size = self.dtype.itemsize
        if any(len(data) != size + 4 if self.whole else len(data) < size + 4 for data in self.raw):
            raise BagError(
                "the layout of the messages differs from this version of voxtouch. Read the "
                "recording with its own version."
            )
        if self.raw:
            table = numpy.frombuffer(b"".join(data[4 : size + 4] for data in self.raw), self.dtype)
            self.parts.append(recfunctions.repack_fields(table[list(self.fields)]))
            self.raw = []

    def table(self):
        self.take()
        return numpy.concatenate(self.parts) if self.parts else self.empty


class Bag:
    """Topics of one rig in a bag, by their names without the rig."""

    # The part of each message to keep, or None for all of it; ten minutes do not fit completely.
    STREAMS = {
        "device/state": (
            "DeviceState",
            ("session_id", "sequence_number", "sample_time_ns", "flags"),
        ),
        "rendering/contact": (
            "ContactState",
            (
                "session_id",
                "sequence_number",
                "sample_time_ns",
                "tool_pose",
                "object_pose",
                "wrench",
                "contact_wrench",
                "deepest_depth_m",
                "time_spent_ns",
                "flags",
            ),
        ),
        "coupling/command": (
            "ForceCommand",
            (
                "session_id",
                "sequence_number",
                "sample_time_ns",
                "wrench",
                "energy_j",
                "energy_rotation_j",
                "status",
            ),
        ),
        "validation": (
            "ValidationReport",
            ("session_id", "sequence_number", "sample_time_ns", "gap_m", "verdict"),
        ),
    }
    MESSAGES = {
        "device/description": "DeviceDescription",
        "rendering/plan": "ScenePlan",
        "coupling/design": "CouplingDesign",
        "node_status": "NodeStatus",
        "rendering/changed": "EffectChanged",
    }

    def __init__(self, path, rig="", requested=None, progress=lambda fraction: None):
        self.path = pathlib.Path(path)
        self.unreadable = []  # sentences on parts of files that could not be read
        self.notes = []  # sentences on irregularities that did not prevent reading
        self.require_same_layout()
        kinds = {**{name: kind for name, (kind, _) in self.STREAMS.items()}, **self.MESSAGES}
        requested = list(kinds) if requested is None else requested
        try:
            files = [open_file(file) for file in files_of(path)]
        except (FileError, OSError) as error:
            raise BagError(
                str(error) if str(error).startswith(str(self.path)) else f"{self.path}: {error}"
            ) from None
        self.rig = self.find_rig(
            {name: kind for file in files for name, kind, _ in file.topics.values()}, rig
        )
        self.rows = {
            name: Rows(kinds[name], self.STREAMS.get(name, (0, ()))[1]) for name in requested
        }
        for number, file in enumerate(files):
            rows = {
                row: self.rows[name]
                for row, (full, kind, _) in file.topics.items()
                for name in requested
                if full == f"/{self.rig}/{name}" and kind == f"{OWN}/msg/{kinds[name]}"
            }
            self.read(
                file, rows, lambda fraction, done=number: progress((done + fraction) / len(files))
            )
        try:
            self.tables = {
                name: self.rows[name].table() for name in requested if name in self.STREAMS
            }
        except BagError as error:
            raise BagError(f"{self.path}: {error}") from None
        self.times = {name: numpy.array(self.rows[name].times, numpy.int64) for name in requested}

    def require_same_layout(self):
        """A bag states the hashes of its types since there are any; an older one may be tried."""
        recording = self.recording()
        topics = (
            [one for one in recording.get("topics", []) if isinstance(one, dict)]
            if isinstance(recording.get("topics"), list)
            else []
        )
        pairs = {
            (one["type"], one["type_hash"])
            for one in topics
            if isinstance(one.get("type"), str) and isinstance(one.get("type_hash"), str)
        }
        changed = sorted(kind for kind, then in pairs if layout_hash(kind) not in ("", then))
        if changed:
            raise BagError(
                f"{self.path}: it was recorded by voxtouch"
                f" {recording.get('voxtouch', '(unknown version)')}, whose"
                f" {', '.join(changed)} {'is' if len(changed) == 1 else 'are'} laid out "
                f"differently than in this version. Read it with the recording version "
                f"(deploy/CHANGELOG.md lists the changes)."
            )

    def find_rig(self, topics, rig):
        rigs = sorted(
            {
                name.split("/")[1]
                for name, kind in topics.items()
                if kind.startswith(OWN + "/") and name.count("/") > 1
            }
        )
        if not rigs:
            raise BagError(
                f"{self.path}: not a recording of voxtouch: none of its {len(topics)} topics"
                f" has a type of {OWN}."
            )
        if rig and rig not in rigs:
            raise BagError(
                f"{self.path}: no messages on /{rig}/rendering/contact; the recording is of rig "
                f"{' and '.join(rigs)} (use --rig)."
            )
        if not rig and len(rigs) > 1:
            self.notes.append(
                f"The recording has rigs {', '.join(rigs)}; this is"
                f" {'haptic' if 'haptic' in rigs else rigs[0]} (--rig chooses another)."
            )
        return rig or ("haptic" if "haptic" in rigs else rigs[0])

    def read(self, file, rows, progress):
        try:
            for number, (topic, time, data) in enumerate(file.messages(rows, progress), 1):
                rows[topic].times.append(time)
                rows[topic].raw.append(data)
                if number % AT_ONCE == 0:
                    for one in rows.values():
                        one.take()
        except FileError as error:
            self.unreadable.append(f"{file.file.name} is only partly readable: {error}.")
            self.notes.append(self.unreadable[-1])
        except BagError as error:
            raise BagError(f"{self.path}: {error}") from None

    def messages(self, name, last=None, rows=None):
        """(row, time [ns], message as a dictionary) in order of arrival, of all rows or of
        these; unreadable ones are skipped with a note."""
        out, of, bad = [], self.rows[name], 0
        for row in range(len(of.raw)) if rows is None else rows:
            try:
                out.append((row, of.times[row], decode(self.MESSAGES[name], of.raw[row], last)))
            except struct.error:
                bad += 1
        if bad:
            self.notes.append(
                f"{bad} messages on /{self.rig}/{name} have a different layout than in this "
                f"version of voxtouch."
            )
        return out

    def recording(self):
        """The logger's report next to the recording; {} without one."""
        return self.file_of("voxtouch_recording.json")

    def summary(self):
        """The report of `voxtouch up` about the run, as in its --json; {} if it did not finish,
        is missing, or belongs to another run."""
        recording = self.file_of("voxtouch_run.json")
        limits, sentences = (
            recording.get("limits"),
            [
                recording.get("problems"),
                recording.get("notes"),
            ],
        )
        whole = isinstance(limits, dict) and all(
            isinstance(one, dict)
            and all(
                isinstance(one.get(key), (int, float, type(None)))
                for key in ("value", "at_most", "at_least")
            )
            for one in limits.values()
        )
        return recording if whole and all(isinstance(every, list) for every in sentences) else {}

    def file_of(self, name):
        try:
            recording = json.loads((self.path / name).read_text())
        except (OSError, ValueError):
            return {}
        return recording if isinstance(recording, dict) else {}
