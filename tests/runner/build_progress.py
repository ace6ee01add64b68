#!/usr/bin/env python3
"""Builds targets of a CMake build folder with Ninja; prints the number of steps and the remaining
time. `deploy/build` calls it.

usage: build_progress.py BUILD TARGET...

The remaining time follows from the rate of the compile steps and the number left. Links and copies
are excluded, since they take a fiftieth of it. Exit status: that of the build.
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
STEP = re.compile(r"^\[(\d+)/(\d+)\] ")


def is_compiling(line):
    """Whether a step compiles a unit."""
    return bool(STEP.match(line)) and " Building C" in line


def duration(seconds):
    """Text of a time: '40 s' or '3 min 20 s', in steps of 10 s."""
    tens = 10 * max(1, round(seconds / 10.0))
    return f"{tens} s" if tens < 60 else f"{tens // 60} min {tens % 60} s"


def remaining(elapsed, done, total):
    """Seconds that the rest takes at the mean rate; None before the first step."""
    return elapsed * (total - done) / done if done else None


def units_to_compile(build, targets):
    """How many units a build would compile. A dry run of build.ninja itself ends before CMake's
    check of folders.
    """
    ninja = ["ninja", "-C", build]
    subprocess.run(ninja + ["build.ninja"], stdout=subprocess.DEVNULL)
    copy = pathlib.Path(build) / "progress.ninja"
    shutil.copyfile(copy.with_name("build.ninja"), copy)
    text = subprocess.run(
        ninja + ["-f", copy.name, "-n", *targets], capture_output=True, text=True
    ).stdout
    return sum(is_compiling(line) for line in text.splitlines())


def main(build, *targets):
    total = units_to_compile(build, targets)
    if total:
        print(
            (
                f"building {' '.join(targets)}: {total} units to compile on"
                f" {os.cpu_count()} processors"
            ),
            file=sys.stderr,
            flush=True,
        )
    begin, last, done = time.monotonic(), FIRST - PERIOD, 0
    ninja = subprocess.Popen(
        ["ninja", "-C", build, *targets], stdout=subprocess.PIPE, text=True, errors="replace"
    )
    for line in ninja.stdout:
        if not STEP.match(line) and not line.startswith("ninja: "):
            sys.stdout.write(line)
        done += is_compiling(line)
        elapsed = time.monotonic() - begin
        rest = remaining(elapsed, done, total)
        if rest and elapsed - last >= PERIOD:
            last = elapsed
            print(
                f"  {done} of {total} units, {duration(elapsed)}; about {duration(rest)} left",
                file=sys.stderr,
                flush=True,
            )
    return ninja.wait()


if __name__ == "__main__":
    if len(sys.argv) < 3 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
