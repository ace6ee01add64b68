#!/usr/bin/env python3
"""check_layout.py finds each fault planted in a small tree, and none in the tree without faults.

usage: planted_layout.py ROOT RUFF     ROOT: the source tree, whose .clang-format and .ruff.toml are
                                       used; RUFF: the program
"""

import pathlib
import shutil
import sys
import tempfile

import check_layout

LONG = "x" * 101
GOOD = {
    "core/law.cpp": "int law() { return 1; }\n",
    "core/law.hpp": "int law();\n",
    "tests/count.c": "int count(void) { return 0; }\n",
    "deploy/tool.py": "X = 1\n",
    "deploy/script": "#!/usr/bin/env bash\necho 1\n",
    "deploy/other": "#!/usr/bin/env python3\nX = 1\n",
    "deploy/cup.yaml": "scene: cup\n",
    "core/CMakeLists.txt": "add_library(law law.cpp)\n",
    "README.md": f"# A\n\n| {LONG} |\n\n![a]({LONG}.png)\n",
    "tests/mesh.cpp": f"// {LONG}\n",
    "deploy/results/times.md": f"{LONG}\n",
    "build/made.cpp": "int   made ;\n",
}
ALLOWED = "# comment\ntests/mesh.cpp 1 | a mesh as text\ndeploy/results/ 0 | generated\n"
PLANTED = {  # fault: (file, text, part of the sentence)
    "unformatted C++": ("core/law.cpp", "int  law(){return 1;}\n", "core/law.cpp is not formatted"),
    "unformatted header": ("core/law.hpp", "int law( );\n", "core/law.hpp is not formatted"),
    "unformatted C": ("tests/count.c", "int count(void){}\n", "tests/count.c is not formatted"),
    "unformatted Python": ("deploy/tool.py", "X=1\n", "deploy/tool.py is not formatted"),
    "unused import": ("deploy/tool.py", "import os\n", "deploy/tool.py is not formatted"),
    "invalid Python": ("deploy/tool.py", "X = = 1\n", "deploy/tool.py is not formatted"),
    "unformatted script": (
        "deploy/other",
        "#!/usr/bin/env python3\nX=1\n",
        "deploy/other is not formatted",
    ),
    "long C++": ("core/law.cpp", f"// {LONG}\n", "core/law.cpp:1 has 104 columns"),
    "long Python": ("deploy/tool.py", f"# {LONG}\n", "deploy/tool.py:1 has 103 columns"),
    "long shell": ("deploy/script", f"#!/bin/sh\n# {LONG}\n", "deploy/script:2 has 103 columns"),
    "long sourced shell": (
        "deploy/sourced",
        f"# shellcheck shell=bash\n# {LONG}\n",
        "deploy/sourced:2 has 103 columns",
    ),
    "long YAML": ("deploy/cup.yaml", f"scene: {LONG}\n", "deploy/cup.yaml:1 has 108 columns"),
    "long CMake": ("core/CMakeLists.txt", f"# {LONG}\n", "core/CMakeLists.txt:1 has 103 columns"),
    "long CMake module": (
        "deploy/install.cmake",
        f"# {LONG}\n",
        "deploy/install.cmake:1 has 103 columns",
    ),
    "long CMake template": (
        "deploy/config.cmake.in",
        f"# {LONG}\n",
        "deploy/config.cmake.in:1 has 103 columns",
    ),
    "long Markdown": ("README.md", f"a {LONG}\n", "README.md:1 has 103 columns"),
    "long test name": ("core/law.cpp", f"TEST(A, {LONG[:59]}) {{}}\n", "has 61 characters"),
    "long name of a Python test": (
        "deploy/tool.py",
        f"def test_{LONG[:56]}():\n    pass\n",
        "has 61 characters",
    ),
    "more than excepted": ("tests/mesh.cpp", f"// {LONG}\n" * 2, "tests/mesh.cpp:2 has"),
}


def sentences(source, ruff, files):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for settings in (".clang-format", ".ruff.toml"):
            shutil.copy(source / settings, root)
        for name, content in files.items():
            (root / name).parent.mkdir(exist_ok=True, parents=True)
            (root / name).write_text(content, encoding="utf-8")
        return list(check_layout.faults(root, ruff, check_layout.exceptions(ALLOWED)))


def main(source, ruff):
    source = pathlib.Path(source)
    wrong = [f"without a fault: {sentence}" for sentence in sentences(source, ruff, GOOD)]
    for fault, (name, text, expected) in PLANTED.items():
        found = sentences(source, ruff, {**GOOD, name: text})
        if len(found) < 1 or not any(expected in sentence for sentence in found):
            wrong.append(f"planted fault '{fault}' was not found; found: {found}")
    print("\n".join(wrong) or f"{len(PLANTED)} planted faults, all found")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
