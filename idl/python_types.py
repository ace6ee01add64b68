"""Python classes of the messages for PyPI `cyclonedds`, and the header by which a program carries
their text.
"""

INIT = '''"""Message types and topics of voxtouch for PyPI's cyclonedds 11; written by `voxtouch types --python`.

voxtouch announces no types on the network, so tools that look types up there find none: take them from here.
The device's state, printed as it comes:

    from cyclonedds.util import duration
    from voxtouch_types import TOPICS, join

    participant = join(domain=0, interface="lo")            # the domain and network card that `voxtouch up` runs on
    reader = TOPICS["device/state"].reader(participant, rig="haptic")  # topic rt/haptic/device/state
    for state in reader.take_iter(timeout=duration(seconds=5)):
        print(state.session_id, state.sequence_number, state.pose.position)

`print(TOPICS)` lists every topic. Types stand in modules named as their ROS packages (`voxtouch_types.geometry_msgs.Pose`),
constants in their classes (`voxtouch_msgs.ContactState.MODEL_ADAPTED`); a field that is not given is 0 or empty, as in ROS.
"""
from .topics import TOPICS, join

__all__ = ["TOPICS", "join"]
'''
SCALARS = {
    "bool": "False",
    "string": '""',
    "float32": "0.0",
    "float64": "0.0",
}  # default of a missing field; otherwise 0


def field_line(package, kind, owner, array, size, field):
    own_types = {"bool": "bool", "string": "str", "char": "types.uint8"}
    if owner:
        base = one = kind if owner == package else f"{owner}.{kind}"
        one += "()"
    else:
        base, one = own_types.get(kind, f"types.{kind}"), SCALARS.get(kind, "0")
    if array == "fixed" and base == "types.uint8":
        return f"    {field}: types.array[{base}, {size}] = bytes({size})"
    if array == "fixed":
        return (
            f"    {field}: types.array[{base}, {size}] = field(default_factory=lambda: [{one} for _"
            f" in range({size})])"
        )
    if array:
        return (
            f"    {field}: types.sequence[{base}{f', {size}' if array == 'bounded' else ''}] ="
            " field(default_factory=list)"
        )
    return f"    {field}: {base} = " + (f"field(default_factory={base})" if owner else one)


def class_text(package, name, fields, constants):
    out = [
        "",
        "",
        "@dataclass",
        "@annotate.final",
        "@annotate.cdrv0",
        f'class {name}(IdlStruct, typename="{package}::msg::dds_::{name}_"):',
    ]
    out += [f"    {constant} = {value}" for _, constant, value in constants]
    return "\n".join(out + [field_line(package, *f) for f in fields])


def module_text(package, own):
    """One package's module; `own` maps its names to (fields, constants). Classes follow the ones
    that they use."""
    others = sorted(
        {owner for fields, _ in own.values() for _, owner, *_ in fields if owner} - {package}
    )
    out = [
        f'"""Messages of {package}; written by `voxtouch types --python`."""',
        "from dataclasses import dataclass, field",
        "",
        "from cyclonedds.idl import IdlStruct, annotations as annotate, types",
    ]
    out += ["", f"from . import {', '.join(others)}"] if others else []
    done = set()

    def add(name):
        if name in done:
            return
        done.add(name)
        fields, constants = own[name]
        for kind, owner, *_ in fields:
            if owner == package:
                add(kind)
        out.append(class_text(package, name, fields, constants))

    for name in own:
        add(name)
    return "\n".join(out) + "\n"


def header_text(messages):
    """A C++ header with every file's name and text; `messages` maps (package, name) to (fields,
    constants).
    """
    files = {"__init__.py": INIT}
    for package in {package: None for package, _ in messages}:
        files[f"{package}.py"] = module_text(
            package, {n: m for (p, n), m in messages.items() if p == package}
        )
    out = [
        "#pragma once",
        (
            "/// Written by generate_idl.py: the Python package of `voxtouch types`, but for its"
            " topics."
        ),
        "#include <string_view>",
        "namespace voxtouch::msg {",
        "struct PythonFile {",
        "  std::string_view name, text;",
        "};",
        "inline constexpr PythonFile kPythonFiles[] = {",
    ]
    out += [f'    {{"{name}", R"py({text})py"}},' for name, text in files.items()]
    return "\n".join([*out, "};", "}  // namespace voxtouch::msg", ""])
