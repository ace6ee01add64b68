"""A process of PyPI's cyclonedds 11 with given settings: the ROS topics that it discovers, the
samples that it receives from the ring, and the time of replies to effect changes.

usage: pypi_client.py FOLDER_OF_VOXTOUCH_TYPES DOMAIN SETTINGS SECONDS [CHANGES]

SETTINGS may be empty. Prints one JSON object.
"""

import json
import pathlib
import sys
import time

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader

sys.path[:0] = [
    sys.argv[1],
    *(
        str(pathlib.Path(__file__).resolve().parents[1] / folder)
        for folder in ("ros_tools", "services")
    ),
]
from looker import subscription, valid  # noqa: E402
from ros_services import Client  # noqa: E402
from voxtouch_types import TOPICS  # noqa: E402

GAIN = 2
STREAMS = ("device/state", "rendering/contact", "coupling/command")
LATCHED = ("tf_static", "rosout")
STANDARD = ("tf", "pose", "wrench", "markers", "diagnostics", "parameter_events", *LATCHED)


def ask_for_changes(participant, count):
    """Milliseconds until each was answered as made."""
    client, took = Client(participant, "/haptic/rendering", "change_effect"), []
    end = time.monotonic() + 10
    while not client.ready() and time.monotonic() < end:
        time.sleep(0.01)
    for n in range(count):
        begin = time.monotonic()
        if client.call(
            action=GAIN, effect="friction", value=[1.0 if n % 2 else 0.5, 0.0, 0.0]
        ).done:
            took.append(1e3 * (time.monotonic() - begin))
        time.sleep(0.01)
    return took


domain, settings, seconds = int(sys.argv[2]), sys.argv[3], float(sys.argv[4])
configured = Domain(domain, settings) if settings else None
participant = DomainParticipant(domain)
writers = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
taps = {
    path: DataReader(
        participant,
        TOPICS[path].topic(participant),
        qos=Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(1000)),
    )
    for path in STREAMS
}
readers = {
    path: subscription(participant, TOPICS[path].topic(participant), latched=path in LATCHED)
    for path in STANDARD
}
numbers, counts = {path: [] for path in STREAMS}, dict.fromkeys(STANDARD, 0)
begin, topics, first_s = time.monotonic(), {}, -1.0


def poll():
    for writer in valid(writers):
        if writer.topic_name.startswith("rt/"):
            topics.setdefault(writer.topic_name, time.monotonic() - begin)
    for path, reader in readers.items():
        counts[path] += len(valid(reader))


while (now_s := time.monotonic() - begin) < seconds:
    for path, tap in taps.items():
        numbers[path] += [sample.sequence_number for sample in valid(tap)]
    first_s = now_s if numbers["device/state"] and first_s < 0 else first_s
    poll()
    time.sleep(0.005)
answers_ms = ask_for_changes(participant, int(sys.argv[5])) if len(sys.argv) > 5 else []
poll()
print(
    json.dumps(
        {
            "topics": topics,
            "samples": len(numbers["device/state"]),
            "first_s": first_s,
            "answers_ms": answers_ms,
            "streams": {
                TOPICS[path].dds_name(): [len(n), n[-1] - n[0] + 1 - len(n) if n else 0]
                for path, n in numbers.items()
            },
            "standard": {TOPICS[path].dds_name(): n for path, n in counts.items()},
        }
    )
)
