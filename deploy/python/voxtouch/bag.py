"""Recorded runs as arrays: rosbag2 folders in sqlite3 or MCAP, split ones too, also of a ring that
was killed.
"""

import collections.abc
import json
import pathlib
import struct

import numpy

from ._bag_files import FileError, files_of, open_file
from ._definitions import DEFINITIONS
from .messages import Definition, table


class BagError(Exception):
    """A sentence: the unusable part of the bag."""


def open_bag(path):
    """A bag's folder, or one of its files, as a Bag. Reads no messages yet. BagError where there is
    no bag.

    bag = open_bag(path)
    list(bag)                                  # names of topics
    bag["/haptic/device/state"]["pose"]        # a numpy structured array
    bag.frame("/haptic/coupling/command")      # the same as a pandas DataFrame, with columns such
                                               as wrench.force.z
    """
    return Bag(path)


class Bag(collections.abc.Mapping):
    """Topics by name, each as a numpy structured array: `bag_time_ns` [ns] (when it was recorded;
    simulated time in lockstep), then the fields of its message, with the units of idl/msg. A
    topic is read at the first access, and kept.

    `types` has each topic's ROS type, `notes` sentences on irregularities that did not prevent
    reading.
    """

    def __init__(self, path):
        self.path = pathlib.Path(path).expanduser()
        self.notes, self.types, self._definitions, self._tables = [], {}, {}, {}
        try:
            self._files = [open_file(file) for file in files_of(self.path)]
        except (FileError, OSError) as error:
            raise BagError(
                str(error) if str(error).startswith(str(self.path)) else f"{self.path}: {error}"
            ) from None
        for file in self._files:
            for name, kind, definition in file.topics.values():
                self.types.setdefault(name, kind)
                if definition:
                    self._definitions.setdefault(kind, definition)

    def __iter__(self):
        return iter(self.types)

    def __len__(self):
        return len(self.types)

    def __getitem__(self, topic):
        if topic not in self._tables:
            self._tables[topic] = self._table(topic)
        return self._tables[topic]

    def raw(self, topic):
        """(bag time [ns], bytes in CDR with their four bytes of encapsulation) of each message, in
        order of arrival. KeyError: no such topic.

        `TOPICS[...].type.deserialize(bytes)` of voxtouch.types makes a message that can be
        written again.
        """
        if topic not in self.types:
            raise KeyError(f"{self.path} has no topic {topic!r}; topics: {', '.join(self.types)}")
        for file in self._files:
            requested = [number for number, (name, _, _) in file.topics.items() if name == topic]
            if not requested:
                continue
            try:
                for _, time, data in file.messages(requested):
                    yield time, data
            except FileError as error:
                note = f"{file.file}: it is only partly readable ({error})"
                if note not in self.notes:
                    self.notes.append(note)

    def frame(self, topic):
        """The topic as a pandas DataFrame: a column for each number, `wrench.force.z`, `value.0`.
        Needs pandas.
        """
        import pandas

        columns = {}

        def flatten(name, values):
            if values.dtype.names:
                for inner in values.dtype.names:
                    flatten(f"{name}.{inner}" if name else inner, values[inner])
            elif values.ndim > 1:
                for n in range(values.shape[1]):
                    flatten(f"{name}.{n}", values[:, n])
            else:
                columns[name] = values

        flatten("", self[topic])
        return pandas.DataFrame(columns)

    def frames(self):
        """Every topic that can be read, as pandas DataFrames by name."""
        return {topic: self.frame(topic) for topic in self}

    def recording(self):
        """The logger's report of the recording: version, samples lost, errors; {} without one."""
        folder = self.path if self.path.is_dir() else self.path.parent
        try:
            recording = json.loads((folder / "voxtouch_recording.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return recording if isinstance(recording, dict) else {}

    def definition(self, topic):
        """The layout of the topic's messages: from the bag if it has it (MCAP), otherwise that
        of this version. BagError if it is unknown, or if the recording version had another
        one."""
        kind = self.types[topic]
        if kind in self._definitions:
            return Definition(kind, self._definitions[kind])
        if kind not in DEFINITIONS:
            raise BagError(
                f"{self.path}: {topic} is of type {kind}, which neither the bag nor this version of"
                " voxtouch explains. A bag in MCAP explains its types."
            )
        text, here = DEFINITIONS[kind]
        recording = self.recording()
        for one in recording.get("topics", []):
            if (
                isinstance(one, dict)
                and one.get("type") == kind
                and one.get("type_hash") not in (None, here)
            ):
                raise BagError(
                    f"{self.path}: it was recorded by voxtouch"
                    f" {recording.get('voxtouch', '(unknown version)')}, whose {kind} is"
                    f" laid out differently than in this version. Read it with the recording "
                    f"version."
                )
        return Definition(kind, text)

    def _table(self, topic):
        rows = list(self.raw(topic))
        times = numpy.array([time for time, _ in rows], numpy.int64)
        try:
            return table(self.definition(topic), times, [data for _, data in rows])
        except (struct.error, KeyError, ValueError) as error:
            raise BagError(
                f"{self.path}: messages of {topic} have a layout different from "
                f"{self.types[topic]} is"
                f" ({error})"
            ) from None
