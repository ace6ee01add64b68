#!/usr/bin/env python3
"""Comments, strings and identifiers of code hold no word that the glossary replaces.

usage: check_code_words.py ROOT

Reads C++, Python, message, CMake, YAML and shell files in the folders below, except this one, which
lists the words. code_words.txt holds them and the exceptions. Prints one sentence for each fault;
exit status 1 if there is one.
"""

import pathlib
import re
import sys

FOLDERS = ("core", "devices", "nodes", "idl", "qos", "deploy", "tests")
CPP = re.compile(
    r'R"(\w*)\(.*?\)\1"|//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\''
    r"|\d[\w.']*|\w+",
    re.DOTALL,
)
PYTHON = re.compile(
    r'"""(?:\\.|[^\\])*?"""|#[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|\w+', re.DOTALL
)
HASH = re.compile(r"#[^\n]*|\w+")  # languages with comments from # to the end of the line
TOKENS = {
    **dict.fromkeys((".cpp", ".hpp", ".h", ".inc"), CPP),
    ".py": PYTHON,
    **dict.fromkeys((".msg", ".srv", ".cmake", ".yaml", ".sh", ".bash", ".txt", ".conf"), HASH),
}
WORDS = pathlib.Path(__file__).parent / "code_words.txt"


def words(text):
    """(kind, pattern, word to use, files that may use it) of each line."""
    for line in text.splitlines():
        if line and not line.startswith("#"):
            pattern, use = line.rsplit(" | ", 1)
            pattern, _, files = pattern.partition(" : ")
            kind, pattern = pattern.split(" ", 1)
            full = pattern if kind == "comment" else rf"^(?:{pattern})$"
            yield kind, re.compile(full, re.IGNORECASE), use, files.split()


def parts(name):
    """Words of an identifier, whether snake case or camel case."""
    return re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", name)


def texts(tokens, content):
    """(kind, text, line) of comments and strings, and of identifiers and their words."""
    for match in tokens.finditer(content):
        token, line = match[0], content.count("\n", 0, match.start()) + 1
        if re.match(r"\w+$", token):
            yield "identifier", token, line
            yield from (("name", part, line) for part in parts(token))
        elif " " in token:
            yield "comment", re.sub(r"`[^`]*`", "", token), line


def tokens_of(file):
    """How to split a file, by its suffix, or by the first line of a script without one."""
    if file.suffix or not file.is_file():
        return TOKENS.get(file.suffix)
    with file.open("rb") as stream:
        first = stream.readline(200)
    if not first.startswith(b"#"):
        return None
    return PYTHON if b"python" in first else HASH


def faults(root, table):
    rows = list(words(table))
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            tokens, name = tokens_of(file), str(file.relative_to(root))
            if not tokens or name.startswith(("idl/ros/", "tests/readme/")):
                continue
            for kind, text, line in texts(tokens, file.read_text(encoding="utf-8")):
                for of, pattern, use, files in rows:
                    if of == kind and name not in files and (found := pattern.search(text)):
                        yield f"{name}:{line} has '{found[0]}', which code does not use: {use}."


def main(root):
    found = list(dict.fromkeys(faults(pathlib.Path(root), WORDS.read_text(encoding="utf-8"))))
    print("\n".join(found) or "code: no retired words")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
