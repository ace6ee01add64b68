#!/usr/bin/env python3
"""Builds and runs the unit tests that the changes of a work tree touch, on a tree that was built
before. `deploy/test --quick` calls it.

usage: quick_test.py [--since REV] [--minutes M] [--list]

These are the test programs that Ninja would rebuild: first those of the changed folders, then those
with the shortest compile time. Programs beyond the time limit are listed and skipped: `deploy/test`
runs everything. Tests of the ring, of timing and long ones are not units and not run. Exit status 1
if a test fails or nothing could be built.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("VOXTOUCH_BUILD", ROOT / "build"))


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def changed_files(since):
    """Paths under the root that differ from `since`, new ones too."""
    git = ("git", "-C", str(ROOT))
    names = output(*git, "diff", "--name-only", since) + output(
        *git, "ls-files", "--others", "--exclude-standard"
    )
    return [name for name in names.splitlines() if name]


def stale_programs():
    """Programs that Ninja would link anew, each with how many steps it needs by itself."""
    subprocess.run(
        ["ninja", "-C", str(BUILD), "build.ninja"], check=True, stdout=subprocess.DEVNULL
    )  # new files make new steps
    # A dry run ends before the first step if the file contains CMake's own check of folders, which
    # occurs in a file of this name only.
    copy = BUILD / "quick.ninja"
    copy.write_text((BUILD / "build.ninja").read_text())
    dry_run = ("ninja", "-C", str(BUILD), "-f", copy.name, "-n")
    links = re.findall(r"Linking CXX executable (bin/\S+)", output(*dry_run))
    return {link: output(*dry_run, link).count("Building ") for link in links}


def unit_tests():
    """Names of the unit tests of each program, from CTest."""
    listing = json.loads(
        output("ctest", "--test-dir", str(BUILD), "--show-only=json-v1", "-L", "unit")
    )
    tests = {}
    for test in listing["tests"]:
        if "command" in test:
            tests.setdefault(pathlib.Path(test["command"][0]).name, []).append(test["name"])
    return tests


def near(program, changed):
    """0 if a source of the program, or the code that its folder is named after, has changed;
    otherwise 1."""
    folders = {
        pathlib.PurePath(name).parts[i]
        for name in changed
        for i in (1, 2)
        if len(pathlib.PurePath(name).parts) > i + 1
    }
    return 0 if any(folder in program for folder in folders) else 1


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--since",
        default="HEAD",
        metavar="REV",
        help="what counts as changed: everything that differs from this commit (HEAD)",
    )
    parser.add_argument(
        "--minutes", type=float, default=3.0, help="no program is begun after this time (3)"
    )
    parser.add_argument(
        "--list", action="store_true", help="names the programs, builds and runs nothing"
    )
    ask = parser.parse_args()
    if not (BUILD / "build.ninja").exists():
        sys.exit(f"{BUILD} holds no build: run deploy/build once first.")
    begin, changed, failed, left = time.monotonic(), changed_files(ask.since), [], []
    stale, tests = stale_programs(), unit_tests()
    programs = [link for link in stale if pathlib.Path(link).name in tests or not tests]
    programs.sort(key=lambda link: (near(pathlib.Path(link).name, changed), stale[link]))
    print(
        f"{len(changed)} changed files touch {len(programs)} programs of unit tests",
        file=sys.stderr,
    )
    if ask.list:
        print("\n".join(programs))
        return 0
    for link in programs:
        name = pathlib.Path(link).name
        if time.monotonic() - begin > 60.0 * ask.minutes:
            left.append(name)
            continue
        good = (
            subprocess.run(["ninja", "-C", str(BUILD), link], stdout=subprocess.DEVNULL).returncode
            == 0
        )
        good = good and subprocess.run([BUILD / link, "--gtest_brief=1"]).returncode == 0
        print(
            f"{'passed' if good else 'FAILED'}  {name}  ({time.monotonic() - begin:.0f} s)",
            file=sys.stderr,
        )
        if not good:
            failed.append(name)
    if left:
        print(
            f"left out for want of time: {', '.join(left)}; deploy/test runs everything",
            file=sys.stderr,
        )
    print(
        f"{len(programs) - len(failed) - len(left)} passed, {len(failed)} failed,"
        f" {len(left)} skipped"
    )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
