"""page_cost.py [SECONDS [ROUNDS]]: cost of the page of voxtouch view for the ring, run manually.

One ring runs; in turns of SECONDS (8) it has a page with a plain WebSocket client that reads all
data, and none. Latency is that of each sample, from the device's write to the coupling's write of
its command, by DDS's source time stamps, read by this process throughout. Needs Python with
cyclonedds 11 (build/python/bin/python), VOXTOUCH_BIN, VOXTOUCH_DEPLOY.
"""

import json
import statistics
import subprocess
import sys
import tempfile
import threading
import time

from page_client import BIN, Process, WebSocket, scene, until

DOMAIN = 95
TYPES = tempfile.TemporaryDirectory()
subprocess.run(
    [BIN / "voxtouch", "types", "--python", TYPES.name], check=True, stdout=subprocess.DEVNULL
)
sys.path.insert(0, TYPES.name)

from cyclonedds.qos import Policy, Qos  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from voxtouch_types import TOPICS, join  # noqa: E402


class Tap:
    """Sequence numbers and times of writing of one stream."""

    def __init__(self, participant, path):
        self.reader = DataReader(
            participant,
            TOPICS[path].topic(participant),
            qos=Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5000)),
        )
        self.written = {}

    def take(self):
        for m in self.reader.take(N=5000):
            if m.sample_info.valid_data:
                self.written[m.sequence_number] = m.sample_info.source_timestamp


class Client(threading.Thread):
    """Reads a page's socket to its end."""

    def __init__(self, address):
        super().__init__(daemon=True)
        self.socket, self.frames = WebSocket(address), 0
        self.start()

    def run(self):
        while (message := self.socket.receive()) is not None:
            self.frames += message["type"] == "frame"


def phase(states, commands, seconds):
    states.take(), commands.take()
    states.written.clear(), commands.written.clear()
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        time.sleep(0.05)
        states.take(), commands.take()
    last = max(commands.written, default=0)
    asked = [n for n in states.written if n <= last]
    us = sorted(
        (commands.written[n] - states.written[n]) * 1e-3 for n in asked if n in commands.written
    )
    return {
        "p50_us": us[len(us) // 2],
        "p99_us": us[len(us) * 99 // 100],
        "samples": len(asked),
        "unanswered": len(asked) - len(us),
        "missing": max(asked) - min(asked) + 1 - len(asked),
    }


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 8.0
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 6
    participant = join(DOMAIN)
    states, commands = Tap(participant, "device/state"), Tap(participant, "coupling/command")
    found = {"without": [], "with": []}
    with Process(
        "up", scene("cup"), "--motion", "slide", "--domain", str(DOMAIN), "--no-record"
    ) as up:
        until(lambda: up.output().count(" samples  force") > 3, 60, up.output())
        for n in range(rounds):
            for how in (
                ("without", "with") if n % 2 == 0 else ("with", "without")
            ):  # a machine that slows down favours neither
                if how == "without":
                    time.sleep(1.0)
                    found[how].append(phase(states, commands, seconds))
                    continue
                with Process("view", "--domain", str(DOMAIN), "--port", "0") as page:
                    client = Client(page.address())
                    until(
                        lambda: client.frames > 60, 30, "frames"
                    )  # the page has built the scene too
                    before, since = client.frames, time.monotonic()
                    found[how].append(phase(states, commands, seconds))
                    found[how][-1]["frames_per_s"] = round(
                        (client.frames - before) / (time.monotonic() - since), 1
                    )
    for how, phases in found.items():
        print(
            how, *(json.dumps({k: round(v, 1) for k, v in p.items()}) for p in phases), sep="\n  "
        )
        print(
            how,
            {
                figure: round(sum(p[figure] for p in phases))
                for figure in ("samples", "unanswered", "missing")
            },
        )
    for figure in "p50_us", "p99_us":
        ratios = [b[figure] / a[figure] for a, b in zip(found["without"], found["with"])]
        print(
            f"{figure}: with over without {', '.join(f'{r:.3f}' for r in ratios)}; median"
            f" {statistics.median(ratios):.3f}"
        )


if __name__ == "__main__":
    main()
