#!/usr/bin/env python3
"""Links the programs of Debian's minimal system and of deploy/packages.txt, and no others.

usage: listed_programs.py FOLDER [LIST]

Links each of them into FOLDER (emptied first) and prints their number. A test that starts a program
of another package passes on a machine that has it by chance and fails on a bare one. With FOLDER as
the only entry of PATH it fails everywhere. `run_tests.py` runs all tests so.
"""

import pathlib
import re
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
DPKG = pathlib.Path("/var/lib/dpkg")
BINARIES = ("/usr/local/sbin", "/usr/local/bin", "/usr/sbin", "/usr/bin", "/sbin", "/bin")
MINIMAL = (
    "required",
)  # the priority of packages that debootstrap's variant minbase installs, in addition to apt


def listed(text):
    """Names of the Debian packages of deploy/packages.txt that tests may rely on: all but those of
    benchmarks and PyPI's.
    """
    names = []
    for line in text.splitlines():
        name, _, comment = line.partition("#")
        if (
            name.strip()
            and not name.startswith("pip:")
            and not comment.strip().startswith("benchmarks")
        ):
            names.append(name.strip())
    return names


def installed(status):
    """Each installed package of a dpkg status file: the fields that this program reads."""
    packages = {}
    for block in status.split("\n\n"):
        fields = dict(re.findall(r"^([A-Za-z-]+): (.*)$", block, re.MULTILINE))
        if fields.get("Status", "").endswith(" installed"):
            packages[fields["Package"]] = fields
    return packages


def names_in(field):
    """For each dependency of a field: the names of its alternatives, without versions and
    architectures.
    """
    return [
        [re.split(r"[ (:\[]", name.strip())[0] for name in one.split("|")]
        for one in field.split(",")
        if one.strip()
    ]


def closure(packages, expected):
    """The minimal system, `requested`, and all dependencies, as far as they are installed."""
    provided = {}
    for name, fields in packages.items():
        for alternatives in names_in(fields.get("Provides", "")):
            provided.setdefault(alternatives[0], []).append(name)
    found = set()
    waiting = list(expected) + ["apt"]
    waiting += [
        name
        for name, fields in packages.items()
        if fields.get("Priority") in MINIMAL or fields.get("Essential") == "yes"
    ]
    while waiting:
        name = waiting.pop()
        if name in found or name not in packages:
            continue
        found.add(name)
        for field in ("Pre-Depends", "Depends"):
            for alternatives in names_in(packages[name].get(field, "")):
                present = [one for one in alternatives if one in packages]
                waiting += (
                    present[:1]
                    if present
                    else [one for name in alternatives for one in provided.get(name, [])[:1]]
                )
    return found


def files_of(names):
    """Every path that these packages own."""
    owned = set()
    for file in (DPKG / "info").glob("*.list"):
        if file.stem.split(":")[0] in names:
            owned.update(file.read_text(encoding="utf-8").splitlines())
    return owned


def programs(owned):
    """Name and path of each program in BINARIES whose file, after all links, is one of `owned`."""
    found = {}
    for folder in map(pathlib.Path, BINARIES):
        for file in sorted(folder.iterdir()) if folder.is_dir() else []:
            target = file.resolve()
            spellings = {
                str(target),
                str(target).removeprefix("/usr"),
            }  # /bin is a link to /usr/bin on some machines
            if target.is_file() and spellings & owned:
                found.setdefault(file.name, file)
    return found


def link_programs(folder, list_file=ROOT / "deploy/packages.txt"):
    """Fills `folder`, which is made anew, with links to the programs; returns their number. Without
    dpkg it stays empty.
    """
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    if not (DPKG / "status").exists():
        return 0
    packages = installed((DPKG / "status").read_text(encoding="utf-8"))
    found = programs(
        files_of(closure(packages, listed(pathlib.Path(list_file).read_text(encoding="utf-8"))))
    )
    for name, file in found.items():
        (folder / name).symlink_to(file)
    return len(found)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3) or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    print(link_programs(pathlib.Path(sys.argv[1]), *sys.argv[2:]))
