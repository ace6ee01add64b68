"""A process of PyPI's cyclonedds 11 with the settings that it is given: which topics of ROS it finds, and what it gets of the device.

usage: pypi_client.py FOLDER_OF_VOXTOUCH_TYPES DOMAIN SETTINGS SECONDS; settings may be empty. Prints one JSON object.
"""
import json
import sys
import time

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.domain import Domain, DomainParticipant

sys.path.insert(0, sys.argv[1])
from voxtouch_types import TOPICS  # noqa: E402

domain, settings, seconds = int(sys.argv[2]), sys.argv[3], float(sys.argv[4])
configured = Domain(domain, settings) if settings else None
participant = DomainParticipant(domain)
writers = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
reader = TOPICS["device/state"].reader(participant)
begin, topics, samples, first_s = time.monotonic(), {}, 0, -1.0
while (now_s := time.monotonic() - begin) < seconds:
    for writer in writers.take(N=1000):
        if writer.sample_info.valid_data and writer.topic_name.startswith("rt/"):
            topics.setdefault(writer.topic_name, now_s)
    new = sum(s.sample_info.valid_data for s in reader.take(N=100))
    first_s = now_s if new and not samples else first_s
    samples += new
    time.sleep(0.005)
print(json.dumps({"topics": topics, "samples": samples, "first_s": first_s}))
