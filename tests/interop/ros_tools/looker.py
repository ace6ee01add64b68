"""A reader as RViz or rclpy make it by default: reliable, volatile, keep last 10; /tf_static
transient local. Lease and buffers as Cyclone DDS has them.

As a program (looker.py FOLDER_OF_TYPES DOMAIN RIG): reads everything and forgets it, until it is
ended.
"""

import sys
import time

if __name__ == "__main__":
    sys.path.insert(0, sys.argv[1])

from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.util import duration
from rviz_rules import Frames, Markers

PATHS = ("tf", "tf_static", "pose", "wrench", "markers", "clock")
NETWORK = """<CycloneDDS><Domain Id="any"><General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces>
<AllowMulticast>spdp</AllowMulticast></General></Domain></CycloneDDS>"""
_domains = {}


def join(domain):
    if domain not in _domains:
        _domains[domain] = Domain(domain, NETWORK)
    return DomainParticipant(domain)


def subscription(participant, topic, depth=10, latched=False):
    """A default reader of rclpy; `latched`: as tf2 creates one for static data."""
    qos = Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        Policy.History.KeepLast(depth),
        Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
    )
    return DataReader(participant, topic, qos=qos)


def valid(reader):
    """The messages that wait."""
    return [sample for sample in reader.take(N=1000) if sample.sample_info.valid_data]


class Looker:
    def __init__(self, participant, rig="haptic", paths=PATHS, depth=10):
        from voxtouch_types import TOPICS

        def reader(path):
            fixed = path == "tf_static"
            return subscription(
                participant, TOPICS[path].topic(participant, rig), 100 if fixed else depth, fixed
            )

        self.readers = {path: reader(path) for path in paths}
        self.frames, self.markers = Frames(), Markers()
        self.seen = {
            path: [] for path in paths
        }  # (seconds of this process's clock, seconds of the writer's wall clock, message)

    def poll(self, seconds, keeps_on=lambda: True):
        end = time.monotonic() + seconds
        while time.monotonic() < end and keeps_on():
            for path, reader in self.readers.items():
                for message in valid(reader):
                    self.take(path, message, time.monotonic())
            time.sleep(0.005)

    def take(self, path, message, now):
        self.seen[path].append((now, message.sample_info.source_timestamp * 1e-9, message))
        if path == "markers":
            self.markers.take(message, now)
        elif path in ("tf", "tf_static"):
            self.frames.take(message, path == "tf_static")

    def errors(self):
        """All errors that RViz would report, including frames of displayed markers."""
        lost = [
            f"marker {key}: tf has no way from {m.header.frame_id} to world"
            for key, (m, _) in self.markers.shown.items()
            if not self.frames.reach(m.header.frame_id, "world")
        ]
        return self.markers.errors + self.frames.errors + lost


if __name__ == "__main__":
    looker = Looker(join(int(sys.argv[2])), sys.argv[3])
    print("reads", flush=True)
    while True:
        looker.poll(1.0)
        for messages in looker.seen.values():
            messages.clear()
