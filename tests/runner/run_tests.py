#!/usr/bin/env python3
"""Runs the tests of a build, and those that fail once more, alone. `deploy/test` calls it.

usage: run_tests.py BUILD [arguments of ctest]
       run_tests.py BUILD --case FILTER     the cases of this name of every test program, by a
                                            filter of GoogleTest such as 'Guard.*'

A test of the ring in real time needs processor time; on a machine of unknown load one failure is
not conclusive, two are. Up to MOST failed tests therefore run once more, one after the other, and
the end of the output lists which failed again and which passed. Both outputs of each are stored in
BUILD/failed. Exit status 1 if a test fails twice, or if more than MOST failed.

Tests find the programs of the packages in deploy/packages.txt and no others: PATH is
BUILD/listed_programs (listed_programs.py).
"""

import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as xml

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import build_progress  # noqa: E402
import listed_programs  # noqa: E402

MOST = 5  # more have a cause that is not the machine's load


def listing(build):
    """All tests, from ctest."""
    command = ["ctest", "--test-dir", str(build), "--show-only=json-v1"]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)[
        "tests"
    ]


def cases_of(program):
    """Suite.Case of each test case of a program of GoogleTest; none of any other."""
    if not program.name.endswith("_test"):
        return []
    names, suite = [], ""
    for line in subprocess.run(
        [program, "--gtest_list_tests"], check=True, capture_output=True, text=True
    ).stdout.splitlines():
        word = line.split("#")[0].strip()
        if line.startswith("  "):
            names.append(suite + word)
        elif word.endswith("."):
            suite = word
    return names


def all_cases(build):
    """The cases of each test program that is built, and under None the tests that are no such
    program.
    """
    tests = [
        (pathlib.Path(test["command"][0]), test["name"])
        for test in listing(build)
        if "command" in test
    ]
    programs = sorted(
        {program for program, _ in tests if program.name.endswith("_test") and program.exists()}
    )
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        found = dict(zip(programs, pool.map(cases_of, programs)))
    found[None] = [name for program, name in tests if program not in found]
    return found


def run_cases(build, expected):
    """Runs the cases of a GoogleTest filter, in every program that has them. True if something ran
    and nothing failed.
    """
    parts = [
        re.compile("".join({"*": ".*", "?": "."}.get(c, re.escape(c)) for c in part))
        for part in expected.split("-")[0].split(":")
    ]
    with_it = [
        program
        for program, cases in all_cases(build).items()
        if program and any(part.fullmatch(case) for part in parts for case in cases)
    ]
    good = [
        subprocess.run([program, f"--gtest_filter={expected}"]).returncode == 0
        for program in with_it
    ]
    if not with_it:
        print(
            (
                f"No test program has a case '{expected}'. 'Suite.*' are all cases of a suite,"
                " '*/Suite.*' those of one with parameters."
            ),
            file=sys.stderr,
        )
    return all(good) and bool(good)


def named_in(output):
    """Cases of GoogleTest that failed according to a program's output; if it ended early, the case
    that ran then.
    """
    failed = list(
        dict.fromkeys(re.findall(r"^\[  FAILED  \] ([\w/]+\.[\w/]+)", output, re.MULTILINE))
    )
    begun = re.findall(r"^\[ +(RUN|OK|FAILED|SKIPPED) +\] ([\w/]+\.[\w/]+)", output, re.MULTILINE)
    if begun and begun[-1][0] == "RUN":
        failed.append(
            begun[-1][1]
            + " (it was running when the program ended; the cases after it did not run)"
        )
    return failed


def failures(junit):
    """Name and output of each test that failed or was not run because of one that failed."""
    if not junit.exists():
        return {}
    cases = xml.parse(junit).getroot().iter("testcase")
    out = {}
    for case in cases:
        skipped = case.find("skipped")
        if case.get("status") == "fail" or (
            case.get("status") == "notrun"
            and skipped is not None
            and "SKIP" not in (skipped.get("message") or "")
        ):
            out[case.get("name")] = case.findtext("system-out") or ""
    return out


def known_seconds(build):
    """Seconds of each test in earlier runs of this build folder, from ctest."""
    file = build / "Testing/Temporary/CTestCostData.txt"
    lines = file.read_text(encoding="utf-8").split("\n---")[0].splitlines() if file.exists() else []
    found = (re.fullmatch(r"(.*) (\d+) ([\d.eE+-]+)", line) for line in lines)
    return {one[1]: float(one[3]) for one in found if one and int(one[2]) > 0}


def plan(build, arguments):
    """Name, seconds (None: unknown) and whether it holds the lock of real time, of each test that
    these arguments select.
    """
    command = ["ctest", "--test-dir", str(build), "--show-only=json-v1", *arguments]
    done = subprocess.run(command, capture_output=True, text=True)
    tests = (
        json.loads(done.stdout)["tests"]
        if done.returncode == 0 and done.stdout.startswith("{")
        else []
    )
    known, out = known_seconds(build), {}
    for test in tests:
        held = {one["name"]: one["value"] for one in test.get("properties", [])}
        locked = "real_time" in held.get("RESOURCE_LOCK", []) or bool(held.get("RUN_SERIAL"))
        out[test["name"]] = (known.get(test["name"]), locked)
    return out


def remaining(tests, workers=2):
    """Seconds that these tests still take: those with the lock of real time one after the other,
    all of them shared by the workers. Those of unknown time take the mean of the others; None if no
    time is known."""
    known = [seconds for seconds, _ in tests.values() if seconds is not None]
    if tests and not known:
        return None
    mean = sum(known) / len(known) if known else 0.0
    each = [(mean if seconds is None else seconds, locked) for seconds, locked in tests.values()]
    return max(
        sum(seconds for seconds, _ in each) / workers,
        sum(seconds for seconds, locked in each if locked),
    )


def ended_test(line):
    """Name and seconds of the test that ctest reports in this line; None of any other line."""
    found = re.match(r" *\d+/\d+ Test +#\d+: (.*?) \.{2,}[ *].* ([\d.]+) sec", line)
    return (found[1], float(found[2])) if found else None


def report_time(left, seen):
    """One line on stderr: how many tests are left, and for how long. `seen` holds seconds of those
    that have run.
    """
    unknown_as = sum(seen) / len(seen) if seen else None
    rest = remaining(
        {
            name: (unknown_as if seconds is None else seconds, locked)
            for name, (seconds, locked) in left.items()
        }
    )
    text = (
        f"about {build_progress.duration(rest)}"
        if rest is not None
        else "time unknown on this machine"
    )
    print(f"  {len(left)} tests left, {text}", file=sys.stderr, flush=True)


def ctest(build, junit, *arguments):
    """Runs ctest; prints the plan at once and every 30 s the remaining time."""
    junit.unlink(missing_ok=True)
    left, seen, last = plan(build, arguments), [], time.monotonic()
    print(f"running {len(left)} tests, two at a time", file=sys.stderr, flush=True)
    report_time(left, seen)
    command = [
        "ctest",
        "--test-dir",
        str(build),
        "--output-on-failure",
        "--output-junit",
        str(junit),
        *arguments,
    ]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, errors="replace") as run:
        for line in run.stdout:
            sys.stdout.write(line)
            sys.stdout.flush()
            ended = ended_test(line)
            if ended:
                left.pop(ended[0], None)
                seen.append(ended[1])
            if ended and time.monotonic() - last >= 30.0:
                last = time.monotonic()
                report_time(left, seen)
    return run.returncode, failures(junit)


def keep(folder, outputs, when):
    """Each output as a file, and, for the last lines of the output, a line for each test."""
    lines = []
    folder.mkdir(exist_ok=True)
    for name, output in outputs.items():
        file = folder / (re.sub(r"[^\w.]+", "_", name.split("#")[0].strip())[:150] + f".{when}.txt")
        file.write_text(output, encoding="utf-8")
        cases = [case for case in named_in(output) if case != name.split("#")[0].strip()]
        lines.append(
            "  "
            + name.split("#")[0].strip()
            + (": " + ", ".join(cases) if cases else "")
            + f"    ({file})"
        )
    return lines


def main(build, *arguments):
    build = pathlib.Path(build).resolve()
    if arguments and arguments[0] == "--case":
        return 0 if run_cases(build, arguments[1] if len(arguments) > 1 else "*") else 1
    junit, kept, end = build / "tests.xml", build / "failed", []
    shutil.rmtree(kept, ignore_errors=True)
    if listed_programs.link_programs(build / "listed_programs"):
        os.environ["PATH"] = str(build / "listed_programs")
    status, first = ctest(build, junit, "-j", "2", *arguments)
    if status and first:
        lines = keep(kept, first, "with_others")
        if len(first) > MOST:
            end = [
                (
                    f"{len(first)} tests failed, which are too many to blame the machine's load;"
                    " none was run once more:"
                ),
                *lines,
            ]
        else:
            print(f"{len(first)} failed and run once more, alone:", file=sys.stderr, flush=True)
            status, second = ctest(build, build / "tests_again.xml", "--rerun-failed", "-j", "1")
            again = keep(kept, second, "alone")
            passed = [line for line, name in zip(lines, first) if name not in second]
            if passed:
                end += ["these failed next to others and passed alone:", *passed]
            if second:
                end += ["these FAILED twice, next to others and alone:", *again]
    if junit.exists():
        subprocess.run(
            [sys.executable, HERE / "time_report.py", build, "--tests", junit, "--rows", "20"],
            stdout=sys.stderr,
        )
    if end:
        print("\n".join(end), file=sys.stderr)
    return 1 if status else 0


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
