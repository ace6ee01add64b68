#!/usr/bin/env python3
"""Cost of DDS Security per hop, measured in turns, so that the machine's load affects all equally.

    tests/security/cost.py ring --build build      # the ring of five processes, plain and secured
    tests/security/cost.py hop --build build       # three processes that pass a sample on, one kind
                                                   of protection after the other

p50 and p99 are of a whole round, which is three hops; a ratio is of two rounds of one turn, or of
their medians. Results depend on the machine and are only printed, with its load.
"""

import argparse
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(HERE / "tests/support"))
from turns import in_turns, ring_latency  # noqa: E402


def ring(ask, keys, kind):
    return ring_latency(
        ask.build, ask.domain, ask.seconds, *(["--security", keys] if kind == "secured" else [])
    )


def hop(ask, _, kind):
    more = [] if kind == "plain" else ["--protection", kind]
    end = subprocess.run(
        [
            ask.build / "bin/wake_up",
            "--way",
            "waitset",
            "--rounds",
            "1",
            "--seconds",
            str(ask.seconds),
            "--domain",
            str(ask.domain),
            *more,
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    row = re.search(r"waitset\s+\d+\s+(\d+)\s+(\d+)", end.stdout)
    return float(row[1]), float(row[2])


KINDS = {
    "ring": (ring, ["plain", "secured"]),
    "hop": (
        hop,
        [
            "plain",
            "none",
            "payload",
            "submessage_signed",
            "submessage",
            "message",
            "submessage_and_payload",
        ],
    ),
}


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=KINDS)
    parser.add_argument("--build", type=pathlib.Path, default=HERE / "build", help="build folder")
    parser.add_argument("--domain", type=int, default=69)
    parser.add_argument("--turns", type=int, default=6)
    parser.add_argument("--seconds", type=float, default=6.0, help="of each kind in a turn")
    ask = parser.parse_args()
    measure, kinds = KINDS[ask.what]
    with tempfile.TemporaryDirectory(prefix="voxtouch_cost_") as folder:
        keys = str(pathlib.Path(folder, "keys"))
        subprocess.run(
            [ask.build / "bin/voxtouch", "keys", "--out", keys],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        rounds = in_turns(ask.turns, kinds, lambda kind: measure(ask, keys, kind))
    plain = rounds["plain"]
    for kind, figures in rounds.items():
        p50, p99 = (statistics.median(f[n] for f in figures) for n in (0, 1))
        pairs = sorted(f[0] / p[0] for f, p in zip(figures, plain))
        print(
            f"figure: {kind}: p50 {p50:.0f} us, p99 {p99:.0f} us, a hop"
            f" {(p50 - statistics.median(p[0] for p in plain)) / 3:+.1f} us; p50 over plain"
            f" {p50 / statistics.median(p[0] for p in plain):.2f}, by turns {pairs[0]:.2f} to"
            f" {pairs[-1]:.2f}, median {statistics.median(pairs):.2f}"
        )


if __name__ == "__main__":
    main()
