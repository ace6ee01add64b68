#!/usr/bin/env python3
"""Prints the time of a build and of its tests: seconds of compiling and linking by target, and the
slowest tests.

usage: time_report.py BUILD [--tests JUNIT_XML] [--rows N]

The time of a target is the sum over its steps in BUILD/.ninja_log, each at its last run. Steps run
in parallel, so on two cores the sum is about twice the wall time. JUNIT_XML is the output of `ctest
--output-junit`.
"""

import argparse
import collections
import pathlib
import re
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


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--tests", type=pathlib.Path, metavar="JUNIT_XML")
    parser.add_argument("--rows", type=int, default=20)
    ask = parser.parse_args()
    if not (ask.build / ".ninja_log").exists():
        sys.exit(f"{ask.build} holds no .ninja_log: nothing has been built there with Ninja.")
    compiling(ask.build, ask.rows)
    if ask.tests and ask.tests.exists():
        testing(ask.tests, ask.rows)


if __name__ == "__main__":
    main()
