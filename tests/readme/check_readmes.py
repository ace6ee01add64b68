#!/usr/bin/env python3
"""Names in READMEs must exist: links, pictures, paths, commands and their options.

usage: check_readmes.py ROOT BIN       BIN: the build's folder of programs, with `voxtouch` in it

Checks every .md file below ROOT except in build folders. In code and in backticks, a word that
begins with a folder of the top level is a path; `voxtouch VERB --option` and `build/bin/X --option`
are looked up in --help; `build/bin/X` may also be a target that is not built yet. Times of
`deploy/demo` and `deploy/test` in the top README are compared with deploy/results/times.md, if it
exists. Prints one sentence for each fault; exit status 1 if there is one.
"""

import functools
import glob
import pathlib
import re
import subprocess
import sys

TOP = ("core", "deploy", "devices", "idl", "nodes", "qos", "tests")
TOP_README_LINES = 200
README_LINES = 150
COLUMNS = 100
CELL = 120
WORDS = 30_000  # of all pages together
GENERATED = ("deploy/scenes/README.md", "deploy/results/", "deploy/CHANGELOG.md")


def readmes(root):
    return sorted(
        f
        for f in root.rglob("*.md")
        if not any(p.startswith((".", "build")) for p in f.relative_to(root).parts)
    )


def code_of(text):
    """Commands and words in code, one at a time: each line of a fenced block, and each span in
    backticks.
    """
    fenced = re.compile(r"^ *```.*?\n(.*?)^ *```", re.DOTALL | re.MULTILINE)
    for block in fenced.findall(text):
        yield from (
            line.split(" # ")[0].strip().removeprefix("$ ")
            for line in block.replace("\\\n", " ").splitlines()
        )
    for span in re.findall(r"`([^`]+)`", fenced.sub("", text)):
        yield " ".join(span.split())


def anchors(text):
    return {
        re.sub(r"[^\w\- ]", "", line.lstrip("# ")).strip().lower().replace(" ", "-")
        for line in text.splitlines()
        if line.startswith("#")
    }


def bad_links(file, text):
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        aim = file.parent / path if path else file
        if not aim.exists():
            yield f"the link '{target}' leads nowhere"
        elif anchor and anchor not in anchors(aim.read_text(encoding="utf-8")):
            yield f"the link '{target}' names no heading of {aim.name}"


def bad_paths(root, folder, words):
    for word in words:
        word = word.rstrip(".,:;)").split("::")[0]
        if "/" in word and word.split("/")[0] in TOP:
            pattern = re.sub(
                r"<[^>]*>|(?<![A-Za-z])[A-Z](?![A-Za-z])", "*", word
            )  # <effect>, X: any
            if not glob.glob(glob.escape(str(root)) + "/" + pattern):
                yield f"the path '{word}' does not exist"
        elif re.fullmatch(r"[\w/]+\.(hpp|cpp|py|cmake)", word) and not list(folder.rglob(word)):
            yield f"there is no file '{word}' below {folder.relative_to(root) or 'the top folder'}"


def bad_script_options(root, words):
    """Options of a script of the repository: its text must contain them."""
    script = root / words[0] if words else root
    if script.is_file() and words[0].split("/")[0] in TOP:
        text = script.read_text(encoding="utf-8", errors="replace")
        for option in re.findall(r"(?<!\S)\[?(--[a-z][a-z-]*)", " ".join(words[1:])):
            if option not in text:
                yield f"'{words[0]}' has no option '{option}'"


class Programs:
    """Built programs, or targets, and their --help."""

    def __init__(self, folder):
        self.folder = folder
        rules = folder.parent / "build.ninja"
        self.rules = rules.read_text(encoding="utf-8") if rules.exists() else ""

    def built(self, name):
        return (self.folder / name).is_file()

    def known(self, name):
        return self.built(name) or f"build bin/{name}:" in self.rules

    @functools.cache
    def help(self, *words):
        run = subprocess.run(
            [self.folder / words[0], *words[1:], "--help"],
            capture_output=True,
            text=True,
            timeout=60,
        )
        return run.stdout + run.stderr

    @functools.cached_property
    def verbs(self):
        listed = self.help("voxtouch").split("Subcommands:", 1)[-1]
        return set(re.findall(r"^  ([a-z]+) ", listed, re.MULTILINE))


def bad_commands(programs, words):
    at = next(
        (n for n, word in enumerate(words) if word == "voxtouch" or word.startswith("build/bin/")),
        None,
    )
    if at is None and words and programs.known(words[0]):
        at = 0
    if at is None:
        return
    called, rest = [words[at].removeprefix("build/bin/")], words[at + 1 :]
    if not programs.known(called[0]):
        yield f"there is no program '{words[at]}'"
        return
    if called == ["voxtouch"] and rest and re.fullmatch(r"[a-z]+", rest[0]):
        called.append(rest.pop(0))
        if called[1] not in programs.verbs:
            yield f"voxtouch has no verb '{called[1]}'"
            return
    options = re.findall(r"(?<!\S)\[?(--[a-z][a-z-]*)", " ".join(rest))
    if not options or not programs.built(called[0]) or called[0].endswith("_test"):
        return
    said = programs.help(*called)
    for option in options:
        if not re.search(rf"(^|[\s,]){option}\b", said):
            yield f"'{' '.join(called)}' has no option '{option}'"


def bad_sizes(text, most_lines):
    """Lines of a page, and columns of its prose: tables, code and links may be longer."""
    lines, code = text.splitlines(), False
    if len(lines) > most_lines:
        yield f"it has {len(lines)} lines, {most_lines} are allowed"
    for number, line in enumerate(lines, 1):
        code ^= line.lstrip().startswith("```")
        if (
            len(line) > COLUMNS
            and not code
            and not line.startswith("|")
            and "](" not in line
            and "<!--" not in line
        ):
            yield f"line {number} has {len(line)} columns, {COLUMNS} are allowed"


def bad_cells(text):
    for number, line in enumerate(text.splitlines(), 1):
        for cell in re.split(r"(?<!\\)\|", line) if line.startswith("|") else []:
            if len(cell.strip()) > CELL:
                yield (
                    f"line {number} has a table cell of {len(cell.strip())} characters, {CELL} are"
                    " allowed"
                )


@functools.cache
def retired_words():
    """Pattern, word to use, and files that may use it: tests/readme/retired_words.txt."""
    lines, words = (
        (pathlib.Path(__file__).parent / "retired_words.txt").read_text().splitlines(),
        [],
    )
    for line in lines:
        if line and not line.startswith("#"):
            pattern, use = line.rsplit(" | ", 1)
            pattern, _, files = pattern.partition(" : ")
            words.append((re.compile(pattern, re.IGNORECASE), use, files.split()))
    return words


def retired_word_uses(name, text):
    """Words that the glossary replaces, outside code."""
    text = re.sub(
        r"^ *```.*?^ *```|`[^`]*`",
        lambda code: "\n" * code[0].count("\n"),
        text,
        flags=re.DOTALL | re.MULTILINE,
    )
    for number, line in enumerate(text.splitlines(), 1):
        for pattern, use, files in retired_words():
            if name not in files and (found := pattern.search(line)):
                yield f"line {number} has '{found[0]}', which pages do not use: {use}."


def times_of(page):
    """Minutes of each command, from the rows of deploy/results/times.md: | `deploy/demo` from
    nothing | 4.1 min | ...
    """
    return {
        command: float(minutes)
        for command, minutes in re.findall(
            r"^\| `(deploy/\w+)` from nothing \| ([\d.]+) min \|", page, re.MULTILINE
        )
    }


def bad_times(text, times):
    """Times in a paragraph that begins with the command in bold: within 30 % of the
    measured one.
    """
    for paragraph in text.split("\n\n"):
        command = re.match(r"\s*\*\*`(deploy/\w+)`\*\*", paragraph)
        for minutes in re.findall(r"(\d+) minutes", paragraph) if command else []:
            measured = times.get(command[1])
            if measured and not 0.7 <= float(minutes) / measured <= 1.3:
                yield (
                    f"it says {minutes} minutes for {command[1]}, deploy/results/times.md says"
                    f" {measured}"
                )


def faults(root, programs):
    times = root / "deploy/results/times.md"
    measured = times_of(times.read_text(encoding="utf-8")) if times.exists() else {}
    words_of_all = 0
    for file in readmes(root):
        text = file.read_text(encoding="utf-8")
        found = list(bad_links(file, text))
        for code in code_of(text):
            words = code.split()
            found += bad_paths(root, file.parent, words)
            found += bad_script_options(root, words)
            found += bad_commands(programs, words)
        is_top, name = file == root / "README.md", str(file.relative_to(root))
        if not name.startswith(GENERATED):
            found += (fault.rstrip(".") for fault in retired_word_uses(name, text))
            found += bad_sizes(text, TOP_README_LINES if is_top else README_LINES)
            words_of_all += len(text.split())
        if is_top:
            found += bad_cells(text)
            found += bad_times(text, measured)
        yield from (f"{file.relative_to(root)}: {fault}." for fault in dict.fromkeys(found))
    if words_of_all > WORDS:
        yield f"All pages have {words_of_all} words, {WORDS} are allowed."


def main(root, binaries):
    root = pathlib.Path(root)
    wrong = list(faults(root, Programs(pathlib.Path(binaries))))
    print("\n".join(wrong) or f"{len(readmes(root))} files: everything that they name is there")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
