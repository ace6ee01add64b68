#!/usr/bin/env python3
"""Plants each kind of second definition in a small project and checks that it is found, and nothing
without one.

usage: planted_test.py COMPILER
"""

import json
import pathlib
import subprocess
import sys
import tempfile

CHECK = pathlib.Path(__file__).with_name("one_definition.py")
SOUND = {
    "core/one.hpp": (
        "#pragma once\nnamespace p { struct Step { int way; int go() const; }; bool clamp(double&"
        " v); }\n"
    ),
    "core/one.cpp": (
        '#include "core/one.hpp"\nbool p::clamp(double& v) { v = 1; return true; }\nint'
        " p::Step::go() const { return way; }\n"
    ),
    "devices/two.hpp": (
        "#pragma once\nnamespace p { struct Other { double x; }; inline int same() { return 1;"
        " } }\n"
    ),
    "devices/two.cpp": (
        '#include "devices/two.hpp"\nnamespace p { int use() { return same() + int(Other{1}.x);'
        " } }\n"
    ),
}
TWO_INCLUDES = '#include "devices/two.hpp"\n'
PLANTED = {  # name: (changed files, the checks that find it, reported names)
    "nothing": ({}, [], ""),
    "a type in two headers": (
        {
            "devices/two.hpp": (
                "#pragma once\nnamespace p { class Step { public: double x, y; }; inline int same()"
                " { return 1; } }\n"
            ),
            "devices/two.cpp": (
                TWO_INCLUDES + "namespace p { Step s; int use() { return same() + int(s.x); } }\n"
            ),
        },
        ["headers", "objects"],
        "Step",
    ),
    "a function inline in a header and strong in a source file": (
        {
            "devices/two.hpp": (
                "#pragma once\nnamespace p { struct Other { double x; }; inline int same() { return"
                " 1; }\ninline bool clamp(double& v) { if (v != v) v = 0; return false; } }\n"
            ),
            "devices/two.cpp": (
                TWO_INCLUDES
                + "namespace p { int use() { double v = 1; return same() + clamp(v); } }\n"
            ),
        },
        ["headers", "objects"],
        "p::clamp(double&)",
    ),
    "a function strong in two source files": (
        {
            "devices/two.cpp": (
                TWO_INCLUDES
                + "namespace p { bool clamp(double&) { return false; } int use() { return same();"
                " } }\n"
            )
        },
        ["headers", "objects"],
        "p::clamp(double&)",
    ),
    "a type in a source file": (
        {
            "devices/two.cpp": (
                TWO_INCLUDES
                + "namespace p { struct Step { double x[3]; }; Step s; int use() { return same() +"
                " int(s.x[0]); } }\n"
            )
        },
        ["objects"],
        "Step",
    ),
    "a function inline in two source files": (
        {
            "core/one.cpp": (
                SOUND["core/one.cpp"]
                + "namespace p { inline int twice() { return 1; } int a() { return twice(); } }\n"
            ),
            "devices/two.cpp": (
                TWO_INCLUDES
                + "namespace p { inline int twice() { return 2; } int use() { return same() +"
                " twice(); } }\n"
            ),
        },
        ["objects"],
        "p::twice()",
    ),
}


def make(root, files, compiler):
    build, commands = root / "build", []
    build.mkdir()
    for name, text in files.items():
        (root / name).parent.mkdir(exist_ok=True)
        (root / name).write_text(text)
    for name in files:
        if name.endswith(".cpp"):
            target = name.replace("/", "_") + ".o"
            command = [
                compiler,
                "-std=c++23",
                "-O0",
                "-g1",
                "-flto",
                "-ffat-lto-objects",
                f"-I{root}",
                "-o",
                target,
                "-c",
                str(root / name),
            ]
            subprocess.run(command, cwd=build, check=True)
            commands.append(
                {"directory": str(build), "file": str(root / name), "command": " ".join(command)}
            )
    (build / "CMakeCache.txt").write_text(
        f"CMAKE_HOME_DIRECTORY:INTERNAL={root}\nCMAKE_CXX_COMPILER:STRING={compiler}\n"
    )
    (build / "compile_commands.json").write_text(json.dumps(commands))
    return build


def main():
    failures = 0
    for fault, (changed, finders, name) in PLANTED.items():
        with tempfile.TemporaryDirectory() as folder:
            build = make(pathlib.Path(folder).resolve(), SOUND | changed, sys.argv[1])
            for check in ("headers", "objects"):
                output = subprocess.run(
                    [sys.executable, "-B", CHECK, check, build], capture_output=True, text=True
                )
                must_find = check in finders
                good = output.returncode == int(must_find) and (
                    not must_find or name in output.stdout
                )
                verdict, expected = "ok  " if good else "FAIL", "finds" if must_find else "passes"
                print(f"{verdict} {check:8} {expected} {fault}")
                if not good:
                    print(output.stdout, output.stderr)
                    failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
