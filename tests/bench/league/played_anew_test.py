#!/usr/bin/env python3
"""Plays the league with voxtouch alone and checks each figure by limits.csv.

usage: played_anew_test.py VOXTOUCH
"""

import pathlib
import subprocess
import sys
import tempfile

import figures

LEAGUE = pathlib.Path(__file__).parent / "league.py"


def main(voxtouch):
    with tempfile.TemporaryDirectory(prefix="voxtouch_league_") as out:
        subprocess.run(
            [sys.executable, "-B", LEAGUE, "--voxtouch", voxtouch, "--only", "voxtouch"]
            + ["--out", out],
            check=True,
        )
        faults = figures.check(figures.read(f"{out}/result.json"), figures.read_limits())
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
