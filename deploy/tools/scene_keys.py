#!/usr/bin/env python3
"""Writes deploy/scenes/README.md: the shipped scenes, and the manual of scene keys, from the schema
that `voxtouch schema` prints.

usage: scene_keys.py           writes deploy/scenes/README.md
       scene_keys.py --check   compares instead; exit status 1 if the file differs
"""

import json
import pathlib
import re
import sys
import textwrap

SCENES = pathlib.Path(__file__).resolve().parents[1] / "scenes"
HEAD = """# Scenes

`deploy/tools/scene_keys.py` generates this file from `scene.schema.json` and from the first
line of each scene's comment. Edit those instead of this file.

A scene is a YAML file. The reader is strict: an unknown, missing, duplicate or non-finite key is an
error that names file, line, column and the valid values. Lengths are m, forces N, quaternions
w x y z. Paths are relative to the folder of the scene file. Editors with a YAML language server
complete and check scenes because of their first line,
`# yaml-language-server: $schema=scene.schema.json`; `voxtouch schema` prints that schema. The
reader also checks what a schema cannot express: files exist, quaternions have unit length, names
differ.

## Shipped scenes

| scene | what it is | motions |
|---|---|---|
"""
TOP = "A scene"
KEYS = """
## Keys

A key in **bold** is required. "One of" means that exactly one of these keys must be present. The
last column is the default; a dash means that there is none.
"""


def scenes():
    """(file name, first line of its comment, names of motions) of each scene."""
    for file in sorted(SCENES.glob("*.yaml")):
        text = file.read_text(encoding="utf-8")
        comment = re.match(r"# yaml-language-server.*\n((?:#.*\n)+)", text)
        summary = comment.group(1).splitlines()[0].lstrip("# ") if comment else ""
        motions = text.split("\nmotions:", 1)[1] if "\nmotions:" in text else ""
        yield file.name, summary, re.findall(r"^  ([A-Za-z0-9_-]+):", motions, re.MULTILINE)


def value(number):
    return json.dumps(number) if not isinstance(number, str) else number


def kind(schema):
    """The type of a value, in words."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        return f"[{name}](#{name})"
    if "enum" in schema:
        return ", ".join(f"`{word}`" for word in schema["enum"])
    if "oneOf" in schema and "properties" not in schema:
        return " or ".join(dict.fromkeys(kind(choice) for choice in schema["oneOf"]))
    types = schema.get("type", "")
    if types == ["string", "number", "boolean"]:
        return "name"
    if types == "array":
        items, low, high = schema["items"], schema.get("minItems"), schema.get("maxItems")
        many = f"{low} " if low and low == high else f"at least {low} " if low else ""
        return f"list of {many}" + re.sub(r"^(number|map)\b", r"\1s", kind(items))
    if types == "object":
        return (
            "map"
            if "properties" in schema
            else f"map of names to {kind(schema['additionalProperties'])}"
        )
    limits = [
        f"{sign} {value(schema[key])}"
        for key, sign in (("exclusiveMinimum", ">"), ("minimum", ">="), ("maximum", "<="))
        if key in schema
    ]
    return " ".join([types] + ([", ".join(limits)] if limits else []))


def named(keys):
    return ", ".join(f"`{key}`" for key in keys)


def required_in(schemas):
    return [choice["required"][0] for choice in schemas if list(choice) == ["required"]]


def rules(schema):
    """Which keys go together and which do not, as sentences."""
    one_of = required_in(schema.get("oneOf", []))
    if one_of:
        yield f"One of {named(one_of)}."
    if "required" in schema.get("not", {}):
        yield f"Not together: {named(schema['not']['required'])}."
    for together in dict.fromkeys(
        tuple(keys) for keys in schema.get("dependentRequired", {}).values()
    ):
        yield f"All or none of {named(together)}."
    if "if" in schema:
        condition = schema["if"]
        where = f"`{condition['required'][0]}`"
        for key, inner in condition.get("properties", {}).items():
            where = f"`{key}` {' or '.join(f'`{word}`' for word in inner['enum'])}"
        for branch, word in (("then", "With"), ("else", "Without")):
            refused = required_in(schema.get(branch, {}).get("not", {}).get("anyOf", []))
            needed = schema.get(branch, {}).get("required", [])
            if refused:
                yield f"{word} {where} there is none of {named(refused)}."
            if needed:
                yield f"{word} {where} there must be {named(needed)}."


def row(key, schema, required):
    displayed = f"**`{key}`**" if key in required else f"`{key}`"
    standard = f"`{value(schema['default'])}`" if "default" in schema else "-"
    meaning = first_sentence(schema)[0]
    return f"| {displayed} | {kind(schema)} | {meaning} | {standard} |"


def first_sentence(schema):
    """(first sentence, the rest) of a description."""
    first, _, rest = schema.get("description", "").partition(". ")
    return (first + "." if rest else first, rest)


def paragraph(text):
    return "\n".join(textwrap.wrap(text, 100, break_long_words=False, break_on_hyphens=False))


TABLE = "| key | value | meaning | default |\n|---|---|---|---|"


def section(name, schema, level):
    """A map with its keys, then the maps within it."""
    maps = [choice for choice in schema.get("oneOf", []) if "properties" in choice]
    if "properties" not in schema and maps:  # a value, or a map that makes it
        schema = {**maps[0], "description": f"{kind(schema).capitalize()}. {schema['description']}"}
    yield f"\n{'#' * level} {name}\n"
    if "description" in schema:
        yield paragraph(schema["description"]) + ("\n" if "properties" in schema else "")
    for sentence in rules(schema):
        yield paragraph(sentence) + "\n"
    if "properties" not in schema:
        return
    yield TABLE
    for key, inner in schema["properties"].items():
        yield row(key, inner, schema.get("required", []))
    for key, inner in schema["properties"].items():
        if rest := first_sentence(inner)[1]:
            yield "\n" + paragraph(f"`{key}`: {rest}")
    for key, inner in schema["properties"].items():
        described = [choice for choice in inner.get("oneOf", []) if "description" in choice]
        for choice in [inner, inner.get("items", {})] + described:
            if "properties" in choice:
                yield from section(
                    f"{name}.{key}" if name != TOP else key, choice, min(level + 1, 5)
                )


def effects(schema):
    """The definition of an effect as one section a kind, then the keys that every kind may have."""
    kinds = {choice["required"][0] for choice in schema["oneOf"]}
    keys = schema["properties"]
    yield "\n### effect\n"
    links = ", ".join(f"[{k}](#{k})" for k in keys if k in kinds)
    yield paragraph(f"An entry of `effects` names one kind: {links}.") + "\n"
    yield "In addition to its kind an effect may have:\n"
    yield TABLE
    for key, inner in keys.items():
        if key not in kinds:
            yield row(key, inner, [])
    yield ""
    for choice in schema.get("allOf", []):
        yield (
            f"- `{choice['if']['required'][0]}` takes none of"
            f" {named(required_in(choice['then']['not']['anyOf']))}."
        )
    for key in keys:
        if key in kinds:
            yield from section(key, keys[key], 4)


def manual():
    schema = json.loads((SCENES / "scene.schema.json").read_text(encoding="utf-8"))
    rows = "".join(
        f"| [`{name}`]({name}) | {summary} | {', '.join(f'`{m}`' for m in motions)} |\n"
        for name, summary, motions in scenes()
    )
    lines = list(section(TOP, schema, 3))
    for name, definition in schema["$defs"].items():
        lines += effects(definition) if name == "effect" else section(name, definition, 3)
    return HEAD + rows + KEYS + "\n".join(lines) + "\n"


def main(arguments):
    target = SCENES / "README.md"
    text = manual()
    if arguments == ["--check"]:
        if target.exists() and target.read_text(encoding="utf-8") == text:
            return 0
        print(
            "deploy/scenes/README.md differs from the output of deploy/tools/scene_keys.py: run it"
            " script, and commit the file."
        )
        return 1
    if arguments:
        print(__doc__, file=sys.stderr)
        return 2
    target.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
