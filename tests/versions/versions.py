#!/usr/bin/env python3
"""One version everywhere, and the layouts of its messages are those that deploy/CHANGELOG.md names.

usage: versions.py ROOT              compares
       versions.py ROOT --write      writes the table of hashes into the changelog's newest version
"""

import pathlib
import re
import sys

OWN = "voxtouch_msgs"
HEAD = "| message | layout |\n|---|---|\n"


def hashes(root):
    """Type hash of each message of ours, from the .msg files."""
    sys.path.insert(0, str(root / "idl"))
    from generate_idl import parse
    from type_hash import type_hash

    messages = {
        (package, file.stem): parse(file, package)
        for package, folder in (
            (OWN, root / "idl/msg"),
            *((one.name, one / "msg") for one in (root / "idl/ros").iterdir()),
        )
        for file in folder.glob("*.msg")
    }
    return {
        name: type_hash(messages, package, name)
        for package, name in sorted(messages)
        if package == OWN
    }


def table(root):
    return HEAD + "".join(f"| {name} | `{value}` |\n" for name, value in hashes(root).items())


def faults(root):
    build = re.search(
        r"project\(voxtouch VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text(encoding="utf-8")
    )[1]
    if not re.fullmatch(r"\d+\.\d+\.\d+", build):
        yield f"CMakeLists.txt: {build} is no semantic version"
    package = re.search(
        r"<version>(.*)</version>", (root / "idl/package.xml").read_text(encoding="utf-8")
    )[1]
    if package != build:
        yield f"idl/package.xml has version {package}, CMakeLists.txt {build}"
    log = (root / "deploy/CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.search(r"^## ([\d.]+).*?(?=^## \d|\Z)", log, re.MULTILINE | re.DOTALL)
    if newest[1] != build:
        yield f"deploy/CHANGELOG.md begins with version {newest[1]}, CMakeLists.txt has {build}"
    reported = dict(re.findall(r"^\| (\w+) \| `(RIHS01_\w+)` \|$", newest[0], re.MULTILINE))
    now = hashes(root)
    for name in sorted(now.keys() | reported.keys()):
        if now.get(name) != reported.get(name):
            yield (
                f"deploy/CHANGELOG.md: {name} has another layout than version {build} reports, so"
                f" bags and nodes of before do not fit: say so there as BREAKING, raise the version"
                f" once that one is released, and write the table by tests/versions/versions.py"
                f" --write"
            )


def main(root, *options):
    root = pathlib.Path(root)
    if "--write" in options:
        log = root / "deploy/CHANGELOG.md"
        text, count = re.subn(
            re.escape(HEAD) + r"(\|.*\n)*",
            table(root).replace("\\", "\\\\"),
            log.read_text(encoding="utf-8"),
            count=1,
        )
        log.write_text(text, encoding="utf-8")
        return 0 if count else "there is no table to be written anew"
    wrong = list(faults(root))
    print("\n".join(wrong) or f"one version, {len(hashes(root))} layouts")
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    sys.exit(main(*sys.argv[1:]))
