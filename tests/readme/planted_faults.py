#!/usr/bin/env python3
"""The check of READMEs finds each fault planted in a small tree, and none in the tree without
faults.

usage: planted_faults.py BIN
"""

import pathlib
import sys
import tempfile

import check_readmes

GOOD = """# A project

See [core](core/README.md#law) and ![forces](deploy/force.svg), `core/law.cpp`, `law.cpp`, `core/<name>.cpp` and `voxtouch build`.
```
$ voxtouch up SCENE --duration 10      # ten seconds
build/bin/voxtouch design --device NAME
deploy/run --fast
```

**`deploy/demo`** takes about 4 minutes.

| a | b |
|---|---|
| `voxtouch schema` | short |
"""
PLANTED = {  # fault: (original text, planted text, a word of the sentence)
    "link": ("core/README.md#law", "core/README.txt", "leads nowhere"),
    "anchor": ("README.md#law", "README.md#lore", "no heading"),
    "picture": ("deploy/force.svg", "deploy/farce.svg", "leads nowhere"),
    "path": ("`core/law.cpp`", "`core/lore.cpp`", "does not exist"),
    "pattern": ("core/<name>.cpp", "core/<name>.hpp", "does not exist"),
    "file": ("`law.cpp`", "`lore.cpp`", "no file"),
    "verb in backticks": ("`voxtouch build`", "`voxtouch biuld`", "no verb"),
    "verb in a table": ("voxtouch schema", "voxtouch scheme", "no verb"),
    "verb in a block": ("voxtouch up", "voxtouch upp", "no verb"),
    "option of a verb": ("--duration", "--druation", "no option"),
    "option of a script": ("--fast", "--slow", "no option"),
    "program": ("build/bin/voxtouch", "build/bin/vextouch", "no program"),
    "time": ("about 4 minutes", "about 7 minutes", "says 4.2"),
    "cell": ("short", "long " * 30, "table cell"),
    "line": ("**`deploy/demo`** takes", "word " * 30 + "**`deploy/demo`** takes", "columns"),
    "word": ("takes about", "is felt, somebody says, after about", "pages do not use"),
    "length": ("# A project\n", "# A project\n" + "\n" * 200, "lines"),
}


def sentences(text, binaries):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, content in {
            "README.md": text,
            "core/README.md": "# Core\n\n## Law\n",
            "core/law.cpp": "",
            "deploy/force.svg": "",
            "deploy/demo": "",
            "deploy/results/times.md": "| `deploy/demo` from nothing | 4.2 min | a note |\n",
            "deploy/run": "case $1 in --fast) ;; esac\n",
        }.items():
            (root / name).parent.mkdir(exist_ok=True, parents=True)
            (root / name).write_text(content, encoding="utf-8")
        return list(check_readmes.faults(root, check_readmes.Programs(pathlib.Path(binaries))))


def main(binaries):
    wrong = [f"without a fault: {sentence}" for sentence in sentences(GOOD, binaries)]
    for fault, (good, bad, expected) in PLANTED.items():
        assert good in GOOD, fault
        found = sentences(GOOD.replace(good, bad, 1), binaries)
        if not any(expected in sentence for sentence in found):
            wrong.append(f"planted fault '{fault}' was not found; found: {found}")
    print("\n".join(wrong) or f"{len(PLANTED)} planted faults, all found")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
