#!/usr/bin/env python3
"""Names in the units of systemd, deploy/compose.yaml and deploy/Containerfile exist: options of
programs, settings, folders.

usage: check_services.py ROOT BIN       BIN: the build's folder of programs
"""

import pathlib
import re
import subprocess
import sys


def options(text):
    return re.findall(r"(?<![\w-])--[a-z][a-z-]*", text)


def calls(root):
    """(file, program, the text after it) of every started program, with its values in rig.conf."""
    settings = dict(
        re.findall(
            r"^#?([A-Z_]+)=(.*)", (root / "deploy/services/rig.conf").read_text(), re.MULTILINE
        )
    )
    for unit in sorted((root / "deploy/services").glob("voxtouch-*@.service")):
        text = re.search(r"^ExecStart=.*?/usr/bin/(\w+)(.*)$", unit.read_text(), re.MULTILINE)
        for name in re.findall(r"\$\{?([A-Z_]+)", text[2]):
            if name not in settings and name != "STATE_DIRECTORY":
                yield unit.name, text[1], f"--no-setting-{name.lower()}-in-rig.conf"
            yield unit.name, text[1], settings.get(name, "")
        yield unit.name, text[1], text[2]
    compose = root / "deploy/compose.yaml"
    for program, text in re.findall(
        r"entrypoint:.*?(voxtouch_\w+)(.*\n.*?command:.*)$", compose.read_text(), re.MULTILINE
    ):
        yield compose.name, program, text


def faults(root, binaries):
    found = list(calls(root))
    if {program for _, program, _ in found} != {
        f"voxtouch_{n}" for n in ("device", "rendering", "coupling", "validator", "logger")
    }:
        yield "not each node is started"
    for file, program, text in found:
        said = subprocess.run(
            [binaries / program, "--help"], capture_output=True, text=True, timeout=60
        ).stdout
        yield from (
            f"{file}: '{program}' has no option '{option}'"
            for option in options(text)
            if not re.search(rf"(^|[\s,]){option}\b", said)
        )
    for line in re.findall(
        r"^COPY (?!--from)(.*) \S+$", (root / "deploy/Containerfile").read_text(), re.MULTILINE
    ):
        yield from (
            f"Containerfile: '{path}' does not exist"
            for path in line.split()
            if not (root / path).exists()
        )
    if "Restart=no\n" not in (root / "deploy/services/voxtouch-device@.service").read_text():
        yield "a device would begin again by itself under systemd"
    if (
        'restart: "no"'
        not in re.search(
            r"  device:\n(.*?)\n  rendering:", (root / "deploy/compose.yaml").read_text(), re.DOTALL
        )[1]
    ):
        yield "a device would begin again by itself in its container"


def main(root, binaries):
    wrong = list(dict.fromkeys(faults(pathlib.Path(root), pathlib.Path(binaries))))
    print("\n".join(wrong) or "units, containers and programs agree")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
