#!/usr/bin/env python3
"""check_code_words.py finds each word planted in a small tree, and none in a tree without one."""

import pathlib
import sys
import tempfile

import check_code_words

GOOD = {
    "core/law.cpp": '// The displayed force.\nint displayed = 1;\nauto text = "it reports";\n',
    "idl/msg/Law.msg": "float64 force # displayed\n",
    "deploy/tool": "#!/usr/bin/env bash\nx=1  # reported\n",
    "core/CMakeLists.txt": "add(law)  # displayed\n",
    "deploy/tool.py": '"""Prints the force."""\nreported = 1  # once\n',
    "tests/law.cpp": "// It is displayed.\n",
    "tests/readme/words.py": "# felt\n",
}
PLANTED = {  # fault: (file, text, part of the sentence)
    "comment": ("core/law.cpp", "// It is felt.\n", "core/law.cpp:1 has 'felt'"),
    "second line": ("core/law.cpp", "int a;\n// It told.\n", "core/law.cpp:2 has 'told'"),
    "string": ("core/law.cpp", 'const char* a = "nobody reads";\n', "has 'nobody'"),
    "identifier": ("core/law.cpp", "int force_felt;\n", "has 'felt'"),
    "camel case": ("core/law.cpp", "struct FeltForce;\n", "has 'Felt'"),
    "constant": ("core/law.cpp", "int kFelt;\n", "has 'Felt'"),
    "message": ("idl/msg/Law.msg", "float64 wanted_force\n", "has 'wanted'"),
    "comment of a message": ("idl/msg/Law.msg", "float64 a # beside b\n", "has 'beside'"),
    "docstring": ("deploy/tool.py", '"""As told before."""\n', "has 'told'"),
    "Python": ("deploy/tool.py", "told = 1\n", "has 'told'"),
    "shell": ("deploy/tool", "#!/usr/bin/env bash\nx=1  # told\n", "has 'told'"),
    "CMake": ("core/CMakeLists.txt", "add(law)  # beside it\n", "has 'beside'"),
    "test": ("tests/law.cpp", "// It is felt.\n", "tests/law.cpp:1 has 'felt'"),
    "whole identifier": ("core/law.cpp", "void lose_tool();\n", "has 'lose_tool'"),
}


def sentences(files):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, content in files.items():
            (root / name).parent.mkdir(exist_ok=True, parents=True)
            (root / name).write_text(content, encoding="utf-8")
        return list(check_code_words.faults(root, check_code_words.WORDS.read_text()))


def main():
    wrong = [f"without a fault: {sentence}" for sentence in sentences(GOOD)]
    for fault, (name, text, expected) in PLANTED.items():
        found = sentences({**GOOD, name: text})
        if not any(expected in sentence for sentence in found):
            wrong.append(f"planted fault '{fault}' was not found; found: {found}")
    print("\n".join(wrong) or f"{len(PLANTED)} planted words, all found")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
