#!/usr/bin/env python3
"""Builds targets of a CMake build folder with Ninja; prints the number of steps and the remaining
time. `deploy/build` calls it.

usage: build_progress.py BUILD TARGET...

The remaining time follows from the time of the units compiled so far, by weight. A unit weighs the
bytes of its sources, and 9,000 for the headers of every unit: a fit to the log of a build. Links
and copies are excluded, since they take a fiftieth of the time. Exit status: that of the build.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

PERIOD = 30.0  # [s] between two reports
FIRST = 15.0  # [s] until the first one
KNOWN = 0.03  # fraction of the work from which on its rate is known
STEP = re.compile(r"^\[(\d+)/(\d+)\] ")
COMPILES = re.compile(STEP.pattern + r"Building C(?:XX)? object (\S+)")
ROOT = pathlib.Path(__file__).parents[2]
HEADERS = 9000.0  # [bytes] weight of a unit without sources


def compiled(line):
    """The object that a step compiles, or None."""
    match = COMPILES.match(line)
    return match and match[3]


def size(source):
    """Bytes of a source; of those that it includes if it joins several."""
    if not source.is_file():
        return 0
    if source.parent.name != "Unity":
        return source.stat().st_size
    joined = re.findall(r'#include "([^"]+)"', source.read_text())
    return sum(size(pathlib.Path(name)) for name in joined)


def weight(build, unit):
    """Weight of an object's unit, by the names that CMake gives to both."""
    source = pathlib.PurePath(unit).with_suffix("")
    in_build = pathlib.Path(build) / source
    if "Unity" not in source.parts:
        folder, _, name = str(source).partition("/CMakeFiles/")
        in_build = ROOT / folder / name.partition("/")[2]
    return HEADERS + size(in_build)


def duration(seconds):
    """Text of a time: '40 s' or '3 min 20 s', in steps of 10 s."""
    tens = 10 * max(1, round(seconds / 10.0))
    return f"{tens} s" if tens < 60 else f"{tens // 60} min {tens % 60} s"


def remaining(elapsed, done, total):
    """Seconds that the rest takes at the mean rate; None before KNOWN of the work is done."""
    return elapsed * (total - done) / done if done > KNOWN * total else None


def units_to_compile(build, targets):
    """The objects that a build would compile. A dry run of build.ninja itself ends before CMake's
    check of folders.
    """
    ninja = ["ninja", "-C", build]
    subprocess.run(ninja + ["build.ninja"], stdout=subprocess.DEVNULL)
    copy = pathlib.Path(build) / "progress.ninja"
    shutil.copyfile(copy.with_name("build.ninja"), copy)
    text = subprocess.run(
        ninja + ["-f", copy.name, "-n", *targets], capture_output=True, text=True
    ).stdout
    return [unit for unit in map(compiled, text.splitlines()) if unit]


def main(build, *targets):
    units = units_to_compile(build, targets)
    weights = {unit: weight(build, unit) for unit in units}
    if units:
        print(
            (
                f"building {' '.join(targets)}: {len(units)} units to compile on"
                f" {os.cpu_count()} processors"
            ),
            file=sys.stderr,
            flush=True,
        )
    begin, last, done, whole = time.monotonic(), FIRST - PERIOD, [], sum(weights.values())
    ninja = subprocess.Popen(
        ["ninja", "-C", build, *targets], stdout=subprocess.PIPE, text=True, errors="replace"
    )
    for line in ninja.stdout:
        if not STEP.match(line) and not line.startswith("ninja: "):
            sys.stdout.write(line)
        if unit := compiled(line):
            done.append(weights.get(unit, 0.0))
        elapsed = time.monotonic() - begin
        rest = remaining(elapsed, sum(done), whole)
        if unit and elapsed - last >= PERIOD:
            last = elapsed
            print(
                (
                    f"  {len(done)} of {len(units)} units, {duration(elapsed)}"
                    f"{f'; about {duration(rest)} left' if rest else ''}"
                ),
                file=sys.stderr,
                flush=True,
            )
    return ninja.wait()


if __name__ == "__main__":
    if len(sys.argv) < 3 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
