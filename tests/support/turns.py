"""Latency of a ring measured in turns, so that the machine's load affects all kinds equally."""

import json
import os
import pathlib
import subprocess

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]


def ring_latency(build, domain, seconds, *more):
    """p50 and p99 of a whole round, which is three hops, of a ring that runs so long [us]."""
    end = subprocess.run(
        [
            build / "bin/voxtouch",
            "up",
            REPOSITORY / "deploy/scenes/cup.yaml",
            "--motion",
            "slide",
            "--duration",
            str(seconds),
            "--no-record",
            "--json",
            "--domain",
            str(domain),
            *more,
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    latency = json.loads(end.stdout)["ring_latency_us"]
    return latency["p50"], latency["p99"]


def in_turns(turns, kinds, measure):
    """{kind: [(p50, p99) of each turn]}; measure(kind) gives one of them. Prints a line per
    turn."""
    rounds = {kind: [] for kind in kinds}
    for turn in range(turns):
        for kind in (
            kinds if turn % 2 == 0 else reversed(kinds)
        ):  # the second one finds the machine as the first left it
            rounds[kind].append(measure(kind))
        print(
            f"turn {turn + 1}, load {os.getloadavg()[0]:.1f}: "
            + ", ".join(
                f"{kind} {rounds[kind][-1][0]:.0f}/{rounds[kind][-1][1]:.0f}" for kind in kinds
            )
            + " us",
            flush=True,
        )
    return rounds
