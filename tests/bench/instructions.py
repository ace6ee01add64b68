#!/usr/bin/env python3
"""instructions.py BUILD RESULT.json: instructions of a frame by place and step, counted by
callgrind (query_frames), which emulates a processor with AVX2 at most. The processor's
counters would be exact too, but virtual machines rarely have them."""

import json
import os
import re
import subprocess
import sys

POINTS, FRAMES = 10_000, 20


def instructions(build, place, what):
    end = subprocess.run(
        [
            "valgrind",
            "--tool=callgrind",
            "--callgrind-out-file=/dev/null",
            "--toggle-collect=counted_frame",
            f"{build}/bin/query_frames",
            place,
            str(POINTS),
            str(FRAMES),
            what,
        ],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "LC_ALL": "C"},
    )
    return int(re.search(r"Collected : (\d+)", end.stderr)[1]) / FRAMES


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    rows = [
        {
            "place": place,
            "what": what,
            "points": POINTS,
            "instructions": instructions(sys.argv[1], place, what),
        }
        for place in ("near", "light", "heavy")
        for what in ("find", "original", "adapted", "field")
    ]
    with open(sys.argv[2], "w", encoding="utf-8") as out:
        json.dump(rows, out, indent=1)


if __name__ == "__main__":
    main()
