#!/usr/bin/env python3
"""Runs clang-tidy over the C++ sources of core, devices and nodes.

usage: tidy.py BUILD [FILE or FOLDER ...]

BUILD has a compile_commands.json of clang. A unity file there is checked as a whole, which parses
its headers once. Prints each finding once, and one line of progress a command on stderr. Exit
status 1 with findings. CLANG_TIDY names another program. JOBS sets how many run at once (1).
"""

import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("core", "devices", "nodes", "qos")
# clang 14 cannot read std::expected of libstdc++. GCC reports the compiler's warnings.
# The sources of a unity file count like headers.
MORE = (
    f"--extra-arg-before=-isystem{ROOT / 'tests/fuzz/clang14'}",
    f"--config-file={ROOT / '.clang-tidy'}",
    "--extra-arg=-Wno-everything",
    f"--header-filter=^{re.escape(str(ROOT))}/({'|'.join(FOLDERS)})/[^.]*\\.(cpp|hpp|h)$",
    "--checks=-bugprone-suspicious-include",
)
UNITY = re.compile(r'^#include "(.*)"$', re.MULTILINE)
FINDING = re.compile(r"^(/[^:]+:\d+:\d+): (?:warning|error): (.*)$", re.MULTILINE)
# clang 14 refuses some templates of libstdc++ 12; GCC compiles each file.
COMPILER = "[clang-diagnostic-"


def contents(file):
    """The sources that a file of the compilation database compiles."""
    if file.parent.name != "Unity":
        return [file]
    return [pathlib.Path(name) for name in UNITY.findall(file.read_text())]


def sources(build, chosen):
    """(file of the compilation database, its sources) below FOLDERS, limited to those with a source
    in `chosen` if there are any."""
    below = [ROOT / name for name in FOLDERS]
    limits = [pathlib.Path(name).resolve() for name in chosen] or below
    files = {
        (pathlib.Path(entry["directory"]) / entry["file"]).resolve()
        for entry in json.loads((build / "compile_commands.json").read_text())
    }
    found = [(file, contents(file)) for file in files]
    return sorted(
        (file, inside)
        for file, inside in found
        if any(source.is_relative_to(folder) for source in inside for folder in below)
        and any(source.is_relative_to(limit) for source in inside for limit in limits)
    )


def check(build, file):
    """The findings of one file: {place: text}; its output as text if clang-tidy itself fails."""
    command = [os.environ.get("CLANG_TIDY", "clang-tidy"), "--quiet", "-p", str(build), *MORE]
    done = subprocess.run([*command, str(file)], capture_output=True, text=True)
    found = {place: text for place, text in FINDING.findall(done.stdout) if COMPILER not in text}
    if done.returncode and not found and COMPILER not in done.stdout:
        found[str(file)] = f"clang-tidy failed: {done.stdout}{done.stderr}"
    return found


def main(build, *chosen):
    build = pathlib.Path(build)
    files = sources(build, chosen)
    if not files:
        sys.exit("No source matches. Valid: files and folders of " + ", ".join(FOLDERS))
    printed = set()
    with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("JOBS", "1"))) as pool:
        results = pool.map(lambda one: check(build, one[0]), files)
        for number, ((_, inside), found) in enumerate(zip(files, results), 1):
            names = " ".join(str(source.relative_to(ROOT)) for source in inside)
            print(f"{number}/{len(files)} {names}", file=sys.stderr, flush=True)
            for place, text in found.items():
                if (place, text) not in printed:
                    print(f"{os.path.relpath(place, ROOT)}: {text}", flush=True)
                    printed.add((place, text))
    count = sum(len(inside) for _, inside in files)
    print(f"tidy: {count} files, {len(printed)} findings", file=sys.stderr)
    return 1 if printed else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
