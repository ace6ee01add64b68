#!/usr/bin/env python3
"""Cost of readers for the ring: its p50 and p99 without and with processes that read all of its 1
kHz topics and all standard ones, in turns. Six readers and eight turns take 3 minutes.

    deploy/build voxtouch_cyclone_client && tests/interop/ros/readers_cost.py --build build

Target: p99 with six readers of at most 1.05 times that without. The result is only printed, because
it depends on the machine, which should be idle. Each reader is a process of Debian's Cyclone DDS
that polls 200 times a second.
"""

import argparse
import contextlib
import pathlib
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(HERE / "tests/support"))
from turns import in_turns, ring_latency  # noqa: E402


@contextlib.contextmanager
def readers(ask, count):
    """They discover the ring when it starts, and are ended with it."""
    running = [
        subprocess.Popen(
            [ask.build / "bin/voxtouch_cyclone_client", str(ask.domain), "", "3600"],
            stdout=subprocess.DEVNULL,
        )
        for _ in range(count)
    ]
    try:
        yield
    finally:
        for one in running:
            one.kill()
        for one in running:
            one.wait()


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--build", type=pathlib.Path, default=HERE / "build", help="build folder")
    parser.add_argument("--domain", type=int, default=99)
    parser.add_argument("--readers", type=int, default=6)
    parser.add_argument("--turns", type=int, default=8)
    parser.add_argument("--seconds", type=float, default=6.0, help="of each kind in a turn")
    ask = parser.parse_args()

    def measure(kind):
        with readers(ask, ask.readers if kind == "with readers" else 0):
            return ring_latency(ask.build, ask.domain, ask.seconds)

    rounds = in_turns(ask.turns, ["alone", "with readers"], measure)
    for n, name in ((0, "p50"), (1, "p99")):
        alone, loaded = (
            statistics.median(f[n] for f in rounds[kind]) for kind in ("alone", "with readers")
        )
        ratios = sorted(w[n] / a[n] for a, w in zip(rounds["alone"], rounds["with readers"]))
        print(
            f"figure: {name}: {alone:.0f} us alone, {loaded:.0f} us with {ask.readers} readers:"
            f" {loaded / alone:.2f} times; by turns {ratios[0]:.2f} to {ratios[-1]:.2f}, median"
            f" {statistics.median(ratios):.2f}"
        )


if __name__ == "__main__":
    main()
