#!/usr/bin/env python3
"""Fails if a name has two definitions in the built code: the linker silently takes one of them.

usage: one_definition.py headers BUILD   quick, a test: all headers of core, devices, nodes and qos
                                         compiled as one unit, which finds a type or an inline
                                         function that two headers define; and every function that
                                         is inline in a header but also defined in a source file
                                         (the unit's symbols against BUILD's objects), or defined in
                                         two source files.
       one_definition.py objects BUILD   thorough, for a BUILD made with -O0 -g1 -flto
                                         -ffat-lto-objects (deploy/sanitize odr): types by -Wodr
                                         over all objects, functions by nm: a name that is strong in
                                         one and weak in another, strong in two source files, or
                                         weak from two source files. This also covers names
                                         defined in source files only.
Exit status 1 and a sentence for each finding.
"""

import argparse
import collections
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile

PRODUCTION = ("core", "devices", "nodes", "qos")
STRONG, WEAK = "TDBRG", "WVu"
NOT_OURS = {"main", "_init", "_fini"}


def run(command, **more):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, **more)


def readable(names):
    return dict(zip(names, run(["c++filt"], input="\n".join(names)).stdout.splitlines()))


class Build:
    """A build folder: its sources of production with their objects, and how they are compiled."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder).resolve()
        cache = (self.folder / "CMakeCache.txt").read_text().splitlines()
        self.root = pathlib.Path(
            next(line.split("=", 1)[1] for line in cache if line.startswith("CMAKE_HOME_DIRECTORY"))
        )
        self.compiler = next(
            line.split("=", 1)[1] for line in cache if line.startswith("CMAKE_CXX_COMPILER:")
        )
        self.together = set()  # (source, unit of the build folder that includes it)
        self.entries = []  # (source relative to the root, object, flags)
        for entry in json.loads((self.folder / "compile_commands.json").read_text()):
            source = pathlib.Path(entry["file"])
            # Files compiled together are in one unit of the build folder; the unit then counts as
            # the source.
            home = self.folder if source.is_relative_to(self.folder) else self.root
            if source.suffix not in (".cpp", ".cxx") or not source.is_relative_to(home):
                continue
            relative = source.relative_to(home)
            if home == self.folder:
                self.together |= {
                    (str(pathlib.Path(line.split('"')[1]).relative_to(self.root)), str(relative))
                    for line in source.read_text().splitlines()
                    if line.startswith("#include") and str(self.root) in line
                }
            words = shlex.split(entry["command"])
            if relative.parts[0] in PRODUCTION:
                self.entries.append(
                    (str(relative), self.folder / words[words.index("-o") + 1], words)
                )
        if not self.entries:
            sys.exit(
                f"{self.folder} has no compiled sources of {', '.join(PRODUCTION)}: configure it"
                " first (deploy/build)."
            )

    def objects(self):
        return {o: s for s, o, _ in self.entries if o.exists()}

    def flags(self):
        """Include folders and definitions of all production sources together."""
        kept = {}
        for _, _, words in self.entries:
            for word, following in zip(words, words[1:] + [""]):
                if word == "-isystem":
                    kept[("-isystem", following)] = None
                elif word.startswith(("-I", "-D")):
                    kept[(word,)] = None
        return [w for pair in kept for w in pair]


def symbols(objects, *options):
    """(object, letter, name, location) of each symbol that these objects define."""
    for begin in range(0, len(objects), 200):
        out = run(["nm", "-A", "--defined-only", *options, *objects[begin : begin + 200]]).stdout
        for line in out.splitlines():
            path, rest = line.split(":", 1)
            words = rest.split(None, 3)
            if len(words) >= 3 and words[2] not in NOT_OURS:
                yield path, words[1], words[2], (words[3].split(":")[0] if len(words) > 3 else "")


def mixed(strong, weak):
    """Sentences for names with definitions in several places; both: name -> set of places."""
    findings = {
        n: f"is defined in {' and in '.join(sorted(p))}" for n, p in strong.items() if len(p) > 1
    }
    for name in strong.keys() & weak.keys():
        findings[name] = (
            f"is defined in {' and '.join(sorted(strong[name]))}, and inline in"
            f" {' and '.join(sorted(weak[name]))}"
        )
    findings |= {
        n: f"is defined inline in {' and in '.join(sorted(p))}"
        for n, p in weak.items()
        if len(p) > 1
    }
    name_of = readable(list(findings))
    return [f"{name_of[n]} {text}." for n, text in findings.items()]


def check_headers(build):
    objects = build.objects()
    if not objects:
        sys.exit(f"{build.folder} has no objects yet: build first (deploy/build).")
    headers = sorted(h for folder in PRODUCTION for h in (build.root / folder).rglob("*.hpp"))
    with tempfile.TemporaryDirectory() as folder:
        unit, unit_object = (
            pathlib.Path(folder, "all_headers.cpp"),
            pathlib.Path(folder, "all_headers.o"),
        )
        unit.write_text("".join(f'#include "{h}"\n' for h in headers))
        # -O0 and kept: every inline function leaves a symbol. (Templates do when they are used:
        # they cannot be strong.)
        made = run(
            [
                build.compiler,
                "-std=c++23",
                "-O0",
                "-w",
                "-g1",
                "-fkeep-inline-functions",
                *build.flags(),
                "-c",
                unit,
                "-o",
                unit_object,
            ],
            cwd=build.folder,
        )
        if made.returncode:
            lines = [
                line
                for line in made.stderr.splitlines()
                if ": error: " in line or ": note: previous" in line
            ]
            return [
                "All headers do not compile as one unit: "
                + "\n  ".join(lines or made.stderr.splitlines()[:20])
            ]
        strong = collections.defaultdict(set)
        for path, letter, name, _ in symbols(list(objects)):
            if letter in STRONG:
                strong[name].add(objects[pathlib.Path(path)])
        # A test may compile a source separately that is also in a unit: it is one definition.
        for places in strong.values():
            places -= {
                source for source, unit in build.together if source in places and unit in places
            }
        weak = {
            name: {"a header"} for _, letter, name, _ in symbols([unit_object]) if letter in WEAK
        }
        if strong.keys() & weak.keys():  # finding the header takes half a minute
            for _, _, name, place in symbols([unit_object], "-l"):
                weak[name] = {short(place, build.root) or "a header"}
    print(
        f"{len(headers)} headers, {len(objects)} of {len(build.entries)} objects,"
        f" {len(strong)} strong names, {len(weak)} inline ones"
    )
    return mixed(strong, weak)


def short(place, root):
    """The path below the root; empty for foreign files."""
    path = pathlib.Path(place)
    path = pathlib.Path(*[p for p in path.parts if p != "."])
    if not path.is_absolute() or not path.is_relative_to(root):
        return ""
    return str(path.relative_to(root))


def check_objects(build):
    objects = build.objects()
    if len(objects) < len(build.entries):
        sys.exit(
            f"{build.folder} has {len(objects)} of {len(build.entries)} objects: build its target"
            " `programs` first."
        )
    findings = []
    with tempfile.TemporaryDirectory() as folder:
        linked = run(
            [
                build.compiler,
                "-O0",
                "-flto",
                "-r",
                "-flinker-output=nolto-rel",
                "-flto-partition=one",
                "-Wodr",
                "-Wl,-z,muldefs",
                *objects,
                "-o",
                pathlib.Path(folder, "all.o"),
            ],
            cwd=build.folder,
        )
        if linked.returncode:
            sys.exit("The objects do not link together:\n" + linked.stderr)
        lines = linked.stderr.splitlines()
        for warning, other in zip(lines, lines[1:] + [""]):
            if "[-Wodr]" in warning:
                findings.append(
                    warning
                    + "\n  "
                    + next(
                        (
                            line
                            for line in lines[lines.index(warning) :]
                            if "different type" in line or "note" in line
                        ),
                        other,
                    )
                )
        plain = {}  # without the plugin's view: nm reads the symbols and lines of the machine code
        for number, (path, source) in enumerate(objects.items()):
            copy = pathlib.Path(folder, f"{number}.o")
            run(["objcopy", "-R", ".gnu.lto_*", "-R", ".gnu.debuglto_*", path, copy])
            plain[str(copy)] = source
        strong, weak = collections.defaultdict(set), collections.defaultdict(set)
        for path, letter, name, place in symbols(list(plain), "-l"):
            if letter in STRONG:
                strong[name].add(plain[path])
            elif letter in WEAK and short(place, build.root):
                weak[name].add(short(place, build.root))
    print(f"{len(objects)} objects, {len(strong)} strong names, {len(weak)} weak ones")
    return findings + mixed(strong, weak)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=["headers", "objects"])
    parser.add_argument("build")
    ask = parser.parse_args()
    build = Build(ask.build)
    findings = check_headers(build) if ask.what == "headers" else check_objects(build)
    for finding in findings:
        print(finding)
    print(
        f"{len(findings)} names have more than one definition."
        if findings
        else "Every name has one definition."
    )
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
