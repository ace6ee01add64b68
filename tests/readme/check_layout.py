#!/usr/bin/env python3
"""Checks the layout of every source file: clang-format, ruff, and lines of at most 100 columns.

usage: check_layout.py ROOT RUFF

C++ and C must pass `clang-format --dry-run -Werror`, Python must pass `ruff check` and
`ruff format --check`.
Lines of C++, Python, YAML, shell, CMake and Markdown have at most 100 columns. Markdown tables and
lines that hold one link only are exempt. `layout_exceptions.txt` lists the other exceptions.
Names of tests have at most 60 characters.
Prints one sentence for each fault; exit status 1 if there is one.
"""

import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys

COLUMNS = 100
NAME = 60
BATCH = 40  # files per process
LANGUAGES = {
    ".c": "c++",
    ".cpp": "c++",
    ".h": "c++",
    ".hpp": "c++",
    ".py": "python",
    ".pyi": "python",
    ".yaml": "yaml",
    ".yml": "yaml",
    ".sh": "shell",
    ".bash": "shell",
    ".cmake": "cmake",
    ".md": "markdown",
}
SHEBANGS = {"python": "python", "sh": "shell"}
TESTS = {
    "c++": re.compile(r"^(?:TYPED_)?TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", re.MULTILINE),
    "python": re.compile(r"^ *def (test_\w+)", re.MULTILINE),
}
EXCEPTIONS = pathlib.Path(__file__).parent / "layout_exceptions.txt"


def language_of(file):
    if file.name == "CMakeLists.txt":
        return "cmake"
    if file.suffix:
        return LANGUAGES.get(pathlib.Path(file.name.removesuffix(".in")).suffix)
    with file.open("rb") as stream:
        first = stream.readline(200)
    if first.startswith(b"# shellcheck shell="):
        return "shell"
    if not first.startswith(b"#!"):
        return None
    return next((name for word, name in SHEBANGS.items() if word.encode() in first), None)


def sources(root):
    """(language, file) of every source file outside build trees and hidden folders."""
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(
            f for f in folders if not f.startswith((".", "build")) and f != "__pycache__"
        )
        for name in sorted(names):
            file = pathlib.Path(folder) / name
            language = None if file.is_symlink() or name.startswith(".") else language_of(file)
            if language:
                yield language, file


def exceptions(text):
    """{path: number of long lines that it may have} from lines `path number | reason`."""
    allowed = {}
    for line in text.splitlines():
        if line and not line.startswith("#"):
            entry, reason = line.split(" | ", 1)
            path, lines = entry.split()
            assert reason.strip(), f"{path}: an exception needs a reason"
            allowed[path] = int(lines)
    return allowed


def is_exempt(language, line):
    if language != "markdown":
        return False
    return line.startswith("|") or re.fullmatch(r"\s*(- )?!?\[[^]]*\]\([^)]*\)\S*", line)


def long_lines(root, files, allowed):
    for language, file in files:
        name = str(file.relative_to(root))
        if any(name.startswith(path) for path in allowed if path.endswith("/")):
            continue
        lines = file.read_text(encoding="utf-8").splitlines()
        found = [
            (number, len(line))
            for number, line in enumerate(lines, 1)
            if len(line) > COLUMNS and not is_exempt(language, line)
        ]
        if len(found) > allowed.get(name, 0):
            for number, columns in found:
                yield f"{name}:{number} has {columns} columns; the limit is {COLUMNS}."


def long_names(root, files):
    for language, file in files:
        if language in TESTS:
            for found in TESTS[language].finditer(file.read_text(encoding="utf-8")):
                name = ".".join(found.groups())
                if len(name) > NAME:
                    yield (
                        f"{file.relative_to(root)}: {name} has {len(name)} characters; "
                        f"the limit is {NAME}."
                    )


def batches(files):
    return [files[i : i + BATCH] for i in range(0, len(files), BATCH)]


def refused(root, command, files, pattern, remedy):
    """One sentence for each file that the formatter refuses."""

    def run(batch):
        return subprocess.run(
            [*command, *map(str, batch)], capture_output=True, text=True, cwd=root, timeout=600
        )

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for result in pool.map(run, batches(files)):
            names = dict.fromkeys(re.findall(pattern, result.stdout + result.stderr, re.MULTILINE))
            if result.returncode and not names:
                yield f"{command[0]} failed: {result.stderr.strip()[:300]}"
            for name in names:
                yield f"{os.path.relpath(name, root)} is not formatted; run {remedy} on it."


def faults(root, ruff, allowed):
    files = list(sources(root))
    cpp = [file for language, file in files if language == "c++"]
    python = [file for language, file in files if language == "python"]
    yield from long_lines(root, files, allowed)
    yield from long_names(root, files)
    yield from refused(
        root,
        ["clang-format", "--dry-run", "-Werror", "--ferror-limit=1"],
        cpp,
        r"^(.+?):\d+:\d+: error: ",
        "clang-format -i",
    )
    yield from refused(
        root,
        [ruff, "check", "--output-format", "concise"],
        python,
        r"^(.+?):\d+:\d+: ",
        "ruff check --fix",
    )
    yield from refused(
        root, [ruff, "format", "--check"], python, r"^ *--> (.+?):\d+:\d+$", "ruff format"
    )


def main(root, ruff):
    root = pathlib.Path(root).resolve()
    found = list(faults(root, ruff, exceptions(EXCEPTIONS.read_text(encoding="utf-8"))))
    print("\n".join(found) or "layout: no faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
