#!/usr/bin/env python3
"""What DDS Security costs a hop, measured in turns so that what else the machine does meets all alike.

    tests/security/cost.py ring --build build      # the ring of five processes, plain and secured
    tests/security/cost.py hop --build build       # three processes that hand a sample round, one kind of protection after the other

p50 and p99 are of a whole round, which is three hops; a ratio is of two rounds of one turn, or of their medians. Told, not judged, for the machine
decides more than the program: read the load beside it.
"""
import argparse
import json
import os
import pathlib
import re
import statistics
import subprocess
import tempfile

HERE = pathlib.Path(__file__).resolve().parents[2]


def ring(ask, keys, kind):
    more = ["--security", keys] if kind == "secured" else []
    end = subprocess.run([ask.build / "bin/voxtouch", "up", HERE / "deploy/scenes/cup.yaml", "--motion", "slide", "--duration", str(ask.seconds), "--no-record", "--json",
                          "--domain", str(ask.domain), *more], capture_output=True, text=True, check=False)
    latency = json.loads(end.stdout)["ring_latency_us"]
    return latency["p50"], latency["p99"]


def hop(ask, _, kind):
    more = [] if kind == "plain" else ["--protection", kind]
    end = subprocess.run([ask.build / "bin/wake_up", "--way", "waitset", "--rounds", "1", "--seconds", str(ask.seconds), "--domain", str(ask.domain), *more],
                         capture_output=True, text=True, check=True)
    row = re.search(r"waitset\s+\d+\s+(\d+)\s+(\d+)", end.stdout)
    return float(row[1]), float(row[2])


KINDS = {"ring": (ring, ["plain", "secured"]),
         "hop": (hop, ["plain", "none", "payload", "submessage_signed", "submessage", "message", "submessage_and_payload"])}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=KINDS)
    parser.add_argument("--build", type=pathlib.Path, default=HERE / "build", help="build folder")
    parser.add_argument("--domain", type=int, default=69)
    parser.add_argument("--turns", type=int, default=6)
    parser.add_argument("--seconds", type=float, default=6.0, help="of each kind in a turn")
    ask = parser.parse_args()
    measure, kinds = KINDS[ask.what]
    rounds = {kind: [] for kind in kinds}
    with tempfile.TemporaryDirectory(prefix="voxtouch_cost_") as folder:
        keys = str(pathlib.Path(folder, "keys"))
        subprocess.run([ask.build / "bin/voxtouch", "keys", "--out", keys], check=True, stdout=subprocess.DEVNULL)
        for turn in range(ask.turns):
            for kind in kinds if turn % 2 == 0 else reversed(kinds):  # who comes second finds the machine as the first left it
                rounds[kind].append(measure(ask, keys, kind))
            print(f"turn {turn + 1}, load {os.getloadavg()[0]:.1f}: " + ", ".join(f"{kind} {rounds[kind][-1][0]:.0f}/{rounds[kind][-1][1]:.0f}" for kind in kinds) + " us", flush=True)
    plain = rounds["plain"]
    for kind, figures in rounds.items():
        p50, p99 = (statistics.median(f[n] for f in figures) for n in (0, 1))
        pairs = sorted(f[0] / p[0] for f, p in zip(figures, plain))
        print(f"figure: {kind}: p50 {p50:.0f} us, p99 {p99:.0f} us, a hop {(p50 - statistics.median(p[0] for p in plain)) / 3:+.1f} us; p50 over plain {p50 / statistics.median(p[0] for p in plain):.2f}, "
              f"by turns {pairs[0]:.2f} to {pairs[-1]:.2f}, median {statistics.median(pairs):.2f}")


if __name__ == "__main__":
    main()
