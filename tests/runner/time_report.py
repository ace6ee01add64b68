#!/usr/bin/env python3
"""Prints the time of a build and of its tests: seconds of compiling and linking by target, and the
slowest tests.

usage: time_report.py BUILD [--tests JUNIT_XML] [--rows N] [--page FILE]

The time of a target is the sum over its steps in BUILD/.ninja_log, each at its last run. Steps run
in parallel, so on two cores the sum is about twice the wall time. JUNIT_XML is the output of `ctest
--output-junit`.
"""

import argparse
import collections
import datetime
import os
import pathlib
import platform
import re
import subprocess
import sys
import xml.etree.ElementTree as xml


def target_of(output):
    """The target that a built file belongs to: its CMake folder, or the program itself for
    a link.
    """
    found = re.search(r"([^/]+)\.dir/", output)
    return found.group(1) if found else pathlib.PurePath(output).stem.removeprefix("lib")


def steps(build):
    """Seconds of each step of the build, the last time that it was made."""
    made = {}
    for line in (build / ".ninja_log").read_text().splitlines()[1:]:
        begin, end, _, output, _ = line.split("\t")
        made[output] = (int(end) - int(begin)) * 1e-3
    return made


def compiling(build, rows):
    seconds, files = collections.Counter(), collections.Counter()
    for output, took in steps(build).items():
        seconds[target_of(output)] += took
        files[target_of(output)] += 1
    print(
        f"compiling and linking: {sum(seconds.values()):.0f} s in {sum(files.values())} steps; the"
        f" {rows} longest targets:"
    )
    for target, took in seconds.most_common(rows):
        print(f"  {took:7.1f} s  {files[target]:4d} steps  {target}")


def cases_in(output):
    """How many cases a program of GoogleTest has run, by its first lines; 1 of any other."""
    found = re.search(r"^\[=+\] Running (\d+) test", output or "", re.MULTILINE)
    return int(found.group(1)) if found else 1


def testing(junit, rows):
    all_cases = list(xml.parse(junit).getroot().iter("testcase"))
    cases = [(float(case.get("time", 0)), case.get("name")) for case in all_cases]
    count = sum(cases_in(case.findtext("system-out")) for case in all_cases)
    print(
        f"tests: {sum(time for time, _ in cases):.0f} s in {len(cases)} tests of {count} cases; the"
        f" {rows} slowest:"
    )
    for time, name in sorted(cases, reverse=True)[:rows]:
        print(f"  {time:7.1f} s  {name}")
    failed = sum(case.get("status") == "fail" for case in all_cases)
    skipped = sum(case.find("skipped") is not None for case in all_cases)
    print(f"{len(cases) - failed - skipped} passed, {failed} failed, {skipped} skipped")


def busy(intervals):
    """Seconds on the clock in which at least one of these (begin, end) runs."""
    total, until = 0.0, 0.0
    for begin, end in sorted(intervals):
        total += max(0.0, end - max(begin, until))
        until = max(until, end)
    return total


def intervals(build):
    """(begin, end) in seconds of each step of the build, by output, the last time that it
    was made.
    """
    rows = (line.split("\t") for line in (build / ".ninja_log").read_text().splitlines()[1:])
    return {output: (int(begin) * 1e-3, int(end) * 1e-3) for begin, end, _, output, _ in rows}


def inputs(build, target):
    """All files that a target of Ninja needs, made or not."""
    made = subprocess.run(
        ["ninja", "-C", build, "-t", "inputs", target], capture_output=True, text=True, check=True
    )
    return set(made.stdout.split())


def page(build, junit, suite_seconds):
    """deploy/results/times.md: from a folder that was built from nothing in one run, after
    deploy/test.
    """
    made = intervals(build)
    all_steps = sum(end - begin for begin, end in made.values())
    ring = inputs(build, "ring")
    ratio = sum(end - begin for output, (begin, end) in made.items() if output in ring) / all_steps
    compiling = busy(made.values())
    model = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text())
    tests = len(list(xml.parse(junit).getroot().iter("testcase")))
    return f"""# Times of deploy/demo and deploy/test

Written by `tests/runner/time_report.py BUILD --tests JUNIT_XML --page FILE` on {datetime.date.today()}: {os.cpu_count()} processors,
{model[1] if model else platform.machine()}, packages already installed, no compiler cache.

| what | time | note |
|---|---|---|
| `deploy/demo` from nothing | {(compiling * ratio + 12.0) / 60.0:.1f} min | {100.0 * ratio:.0f} % of all steps, and a run of 12 s |
| `deploy/test` from nothing | {(compiling + suite_seconds) / 60.0:.1f} min | {len(made)} steps, {tests} tests |
| compiling everything | {compiling / 60.0:.1f} min | the sum of its steps is {all_steps / 60.0:.1f} min |
| tests of `deploy/test` | {suite_seconds / 60.0:.1f} min | two at a time |
"""


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--tests", type=pathlib.Path, metavar="JUNIT_XML")
    parser.add_argument("--rows", type=int, default=20)
    parser.add_argument(
        "--page",
        type=pathlib.Path,
        metavar="FILE",
        help="writes deploy/results/times.md; needs --tests",
    )
    ask = parser.parse_args()
    if not (ask.build / ".ninja_log").exists():
        sys.exit(f"{ask.build} holds no .ninja_log: nothing has been built there with Ninja.")
    compiling(ask.build, ask.rows)
    if ask.tests and ask.tests.exists():
        testing(ask.tests, ask.rows)
        if ask.page:
            seconds = float(xml.parse(ask.tests).getroot().get("time") or 0.0)
            ask.page.write_text(page(ask.build, ask.tests, seconds), encoding="utf-8")


if __name__ == "__main__":
    main()
