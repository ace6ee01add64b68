#!/usr/bin/env python3
"""Measures the two commands of the README from scratch, and writes a page.

usage: times.py OUT

`deploy/demo` and `deploy/test`, each in a separate clone of the last commit, in a temporary folder
and without a compiler cache. For each the wall time, the processor time of all its processes, and
the accuracy of the remaining time that it prints after the first minute.
"""

import datetime
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "deploy/tools"))
from machine import machine  # noqa: E402

LEFT = re.compile(r"about (?:(\d+) min )?(\d+) s(?: left)?")
COMMANDS = ("deploy/demo", "deploy/test")


def foretold(lines):
    """Ratios of the time that was reported as left to the time that was left, after the first
    minute.

    `lines`: time [s] and text of each line, with the end of the part in which it was printed.
    """
    out = []
    for at, text, end in lines:
        found = LEFT.search(text)
        if found and at >= 60.0 and end - at >= 30.0:
            out.append((60 * int(found[1] or 0) + int(found[2])) / (end - at))
    return out


def parts(lines, end):
    """Each line with the end of its part: a build or a test run begins with a line of its own."""
    starts = [at for at, text in lines if text.startswith(("building ", "running "))] + [end]
    return [(at, text, min(s for s in starts if s > at)) for at, text in lines if at < end]


def run(clone, command, environment):
    """Runs a command; its wall time, processor time [s], exit status, and ratios foretold."""
    before, begin, lines = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic(), []
    process = subprocess.Popen(
        [clone / command],
        env=environment,
        cwd=clone,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    )
    for line in process.stdout:
        lines.append((time.monotonic() - begin, line.strip()))
        sys.stderr.write(line)
    status, wall = process.wait(), time.monotonic() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return wall, used, status, foretold(parts(lines, wall))


def page(rows, revision):
    """The page in Markdown."""
    out = [
        "# Times of deploy/demo and deploy/test",
        "",
        "Command: `deploy/bench times`",
        "",
        f"{datetime.date.today()}, {machine()}, commit {revision}, no compiler cache, packages",
        "installed. Each command ran once, in a separate clone. The last column compares the",
        "remaining time that it printed, from its second minute on, with the time that was left:",
        "least and largest ratio.",
        "",
        "| command | wall time | processor time | exit status | printed over true remaining time |",
        "|---|---|---|---|---|",
    ]
    for command, (wall, used, status, ratios) in rows.items():
        reported = f"{min(ratios):.2f} to {max(ratios):.2f}" if ratios else "-"
        out.append(
            f"| `{command}` | {wall / 60:.1f} min | {used / 60:.1f} min | {status} | {reported} |"
        )
    return "\n".join(out) + "\n"


def main(out):
    environment = dict(os.environ, CCACHE_DISABLE="1")
    revision = subprocess.run(
        ["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True
    ).stdout.strip()
    rows = {}
    for command in COMMANDS:
        with tempfile.TemporaryDirectory(prefix="voxtouch_times_") as folder:
            clone = pathlib.Path(folder) / "clone"
            subprocess.run(["git", "clone", "-q", ROOT, clone], check=True)
            rows[command] = run(clone, command, environment)
    print(page(rows, revision))
    if any(status != 0 for _, _, status, _ in rows.values()):  # below 0: ended by a signal
        print(f"{out} is not written: a command failed", file=sys.stderr)
        return 1
    pathlib.Path(out).write_text(page(rows, revision), encoding="utf-8")
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
