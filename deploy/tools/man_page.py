#!/usr/bin/env python3
"""Writes the man page of each program from its --help: voxtouch.1 with a section for each verb, and
one for each node.

usage: man_page.py BIN OUT PROGRAM...

BIN: folder of the programs. OUT: folder for PROGRAM.1.gz.
"""

import gzip
import pathlib
import re
import subprocess
import sys


def said(*words):
    """Independent of the user: a default in the home folder is not that of the build."""
    return subprocess.run(
        words,
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
        env={"HOME": "/home/you", "LANG": "C.UTF-8"},
    ).stdout


def escaped(text):
    (
        r""
        r"""For troff: a backslash, a hyphen that is a minus, and a line that begins with a control
    character.
    """
    )
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^([.'])", r"\\&\1", text, flags=re.MULTILINE)


def parts(text):
    """The text before `Usage:`, the usage, and the titled lists after it."""
    about, _, rest = text.partition("\nUsage: ")
    usage, _, lists = rest.partition("\n")
    return (
        about.strip(),
        usage.split("/")[-1].strip() if "/" in usage.split(" ")[0] else usage.strip(),
        lists.strip("\n"),
    )


def prose(text):
    """Lines unchanged: their examples are indented by hand."""
    return ".nf\n" + escaped(text) + "\n.fi\n"


def rows(lists):
    """Titled lists of --help: `  --option WHAT   text` with continuation lines."""
    out = ""
    for line in lists.splitlines():
        if not line.strip():
            continue
        row = re.match(r"^  (\S.*?)(?:\s{2,}(\S.*))?$", line)
        if not line.startswith(" "):
            out += (
                f".PP\n.B {escaped(line.rstrip(':'))}\n"
                if line.endswith(":")
                else f"{escaped(line)}\n"
            )
        elif row:
            out += f".TP\n.B {escaped(row[1])}\n" + (escaped(row[2]) + "\n" if row[2] else "")
        else:
            out += escaped(line.strip()) + "\n"
    return out


def page(folder, name):
    program = str(folder / name)
    version, (about, usage, lists) = (
        said(program, "--version").strip(),
        parts(said(program, "--help")),
    )
    options, _, verbs = lists.partition("Subcommands:")
    first = re.split(r"(?<=[^A-Z])[.:]\s|\n|\.$", about)[0]
    first = re.sub(rf"^{name}\s+", "", first)
    text = (
        f'.TH {name.upper()} 1 "" "voxtouch {version}" "voxtouch"\n.SH NAME\n{name} \\-'
        f" {escaped(first)}\n"
    )
    text += (
        f".SH SYNOPSIS\n.B {escaped(usage)}\n.SH DESCRIPTION\n{prose(about)}.SH"
        f" OPTIONS\n{rows(options)}"
    )
    for verb in re.findall(r"^  ([a-z]+) ", verbs, re.MULTILINE):
        about, usage, lists = parts(said(program, verb, "--help"))
        text += (
            f".SH {escaped(name.upper() + ' ' + verb.upper())}\n.B"
            f" {escaped(usage)}\n{prose(about)}{rows(lists)}"
        )
    return text + ".SH SEE ALSO\nThe README files next to the sources: each folder has one.\n"


def main(binaries, out, *programs):
    out = pathlib.Path(out)
    out.mkdir(parents=True, exist_ok=True)
    for name in programs:
        (out / f"{name}.1.gz").write_bytes(
            gzip.compress(page(pathlib.Path(binaries).resolve(), name).encode(), mtime=0)
        )


if __name__ == "__main__":
    if len(sys.argv) < 4:
        raise SystemExit(__doc__)
    main(*sys.argv[1:])
