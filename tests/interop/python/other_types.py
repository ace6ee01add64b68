"""A process of PyPI's cyclonedds in the ring's domain: reads and writes every topic of voxtouch's
table, prints the result as JSON.

usage: other_types.py FOLDER_OF_VOXTOUCH_TYPES DOMAIN ours|foreign
ours: with the types of `voxtouch types`; it writes the last sample that it read. foreign: with
types of the same names that contain arrays instead of our fields.
"""

import dataclasses
import json
import math
import sys
import time

from cyclonedds.builtin import (
    BuiltinDataReader,
    BuiltinTopicDcpsPublication,
    BuiltinTopicDcpsSubscription,
)
from cyclonedds.idl import make_idl_struct, types

sys.path.insert(0, sys.argv[1])
from voxtouch_types import TOPICS, join  # noqa: E402


def with_arrays(row):
    name = row.type.__idl_typename__
    inner = make_idl_struct(
        "Inner", name + "Inner", {"numbers": types.array[types.float64, 3], "text": str}
    )
    return (
        make_idl_struct(
            "Foreign",
            name,
            {
                "octets": types.array[types.uint8, 16],
                "inners": types.array[inner, 2],
                "more": types.sequence[types.array[types.int32, 4]],
            },
        ),
        inner,
    )


def foreign(row):
    """The same topic with a type of arrays under the same name, and a sample of it."""
    kind, inner = with_arrays(row)
    part = inner(numbers=[1.0, 2.0, 3.0], text="of none")
    return dataclasses.replace(row, type=kind), kind(
        octets=bytes(range(16)), inners=[part, part], more=[[1, 2, 3, 4]]
    )


def ours(row):
    return row, row.type()


def facts(path, samples):
    """Figures for comparison with the ring's."""
    found = {"count": len(samples)}
    if path == "device/state":
        found["sessions"] = sorted({s.session_id for s in samples})
        found["numbers"] = [s.sequence_number for s in samples]
        found["norms"] = [
            math.hypot(q.w, q.x, q.y, q.z) for q in (s.pose.orientation for s in samples)
        ]
    elif path == "rendering/contact":
        found["sessions"] = sorted({s.session_id for s in samples})
        found["touching"] = sum(s.surface_hits > 0 for s in samples)
        found["models"] = sorted({s.model for s in samples})
    elif path == "coupling/command":
        found["sessions"] = sorted({s.session_id for s in samples})
        found["forces"] = max(
            (math.hypot(*(getattr(s.wrench.force, a) for a in "xyz")) for s in samples), default=0.0
        )
    elif path == "node_status":
        found["nodes"] = sorted({s.node for s in samples if s.node})
        found["participants"] = sorted({bytes(s.participant).hex() for s in samples if s.node})
    return found


def typed_endpoints(participant, own):
    """[topic, whether it carries type information] of every endpoint of other participants on a
    topic of the table.
    """
    names = {row.dds_name() for row in TOPICS.values()}
    found = []
    for kind in (BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription):
        for e in BuiltinDataReader(participant, kind).take(N=10000):
            if e.topic_name in names and e.participant_key != own:
                found.append([e.topic_name, e.type_id is not None])
    return found


def main():
    domain, how = int(sys.argv[2]), {"ours": ours, "foreign": foreign}[sys.argv[3]]
    participant = join(domain)
    rows = {path: how(row) for path, row in TOPICS.items()}
    readers = {path: row.reader(participant) for path, (row, _) in rows.items()}
    seen = {path: [] for path in rows}

    def listen(seconds, enough=lambda: True):
        start = time.monotonic()
        while (spent := time.monotonic() - start) < seconds or (not enough() and spent < 30):
            for path, reader in readers.items():
                seen[path] += [s for s in reader.take(N=100) if s.sample_info.valid_data]
            time.sleep(0.01)

    listen(1.5, lambda: how is foreign or len(seen["device/state"]) > 1000)
    found = {
        path: facts(path, samples) if how is ours else {"count": len(samples)}
        for path, samples in seen.items()
    }
    endpoints = typed_endpoints(participant, participant.guid)
    writers = [
        (row.writer(participant), seen[path][-1] if how is ours and seen[path] else sample)
        for path, (row, sample) in rows.items()
    ]
    written = 0
    for _ in range(50):
        for writer, sample in writers:
            writer.write(sample)
            written += 1
        listen(0.02)
    print(
        json.dumps(
            {
                "topics": found,
                "endpoints": endpoints,
                "written": written,
                "matched": {
                    row.dds_name(): len(w.get_matched_subscriptions())
                    for (row, _), (w, _) in zip(rows.values(), writers)
                },
            }
        )
    )


if __name__ == "__main__":
    main()
