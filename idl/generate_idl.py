#!/usr/bin/env python3
"""Writes DDS .idl files and C++ headers from ROS 2 .msg and .srv files.

usage: generate_idl.py OUT_DIR PACKAGE=DIR ...      (DIR holds msg and srv; the first package is the
                                                    project's own)

For `pkg/Name` it writes OUT_DIR/pkg/msg/Name_.idl with the type pkg::msg::dds_::Name_, ROS 2's
name on DDS. OUT_DIR/voxtouch_msgs/messages.hpp gives each type a short C++ name and
static_asserts on its layout; OUT_DIR/voxtouch_msgs/python_types.hpp has the same types as
Python text, OUT_DIR/voxtouch_msgs/definitions.hpp as .msg text. For a service it writes
OUT_DIR/pkg/srv/Name_.idl with request and response, and OUT_DIR/voxtouch_msgs/services.hpp.
"""

import pathlib
import re
import sys

import python_types
import type_hash

PRIMITIVES = {  # .msg name -> (idl name, bytes in CDR and in C)
    "bool": ("boolean", 1),
    "byte": ("octet", 1),
    "char": ("uint8", 1),
    "int8": ("int8", 1),
    "uint8": ("uint8", 1),
    "int16": ("int16", 2),
    "uint16": ("uint16", 2),
    "int32": ("int32", 4),
    "uint32": ("uint32", 4),
    "int64": ("int64", 8),
    "uint64": ("uint64", 8),
    "float32": ("float", 4),
    "float64": ("double", 8),
}
CONSTANT_TYPES = {
    "byte": "std::uint8_t",
    **{f"{u}int{n}": f"std::{u}int{n}_t" for u in ("", "u") for n in (8, 16, 32, 64)},
}
# Types that walk round the ring a thousand times a second: fixed size, no padding (padding bytes
# would reach the wire).
RING = ("DeviceState", "ContactState", "ForceCommand", "ExternalSample", "OperatorTarget")
FIELD = re.compile(
    r"^(?P<type>[\w/]+)(?P<array>\[(?P<bound><=)?(?P<size>\d*)\])?"
    r"\s+(?P<name>\w+)\s*(?P<const>=\s*(?P<value>\S+))?$"
)


def parse(path, package):
    """(fields, constants) of a .msg file, two of them of a .srv file; a field is (type, package or
    None, array kind, size, name).
    """
    lines = list(enumerate(path.read_text().splitlines(), 1))
    if path.suffix != ".srv":
        return parse_lines(path, package, lines)
    middle = next((n for n, (_, line) in enumerate(lines) if line.strip() == "---"), None)
    if middle is None:
        sys.exit(f"{path}: has no line '---' between request and response.")
    return parse_lines(path, package, lines[:middle]), parse_lines(
        path, package, lines[middle + 1 :]
    )


def parse_lines(path, package, lines):
    fields, constants = [], []
    for number, line in lines:
        text = line.split("#", 1)[0].strip()
        if not text:
            continue
        match = FIELD.match(text)
        if not match:
            sys.exit(
                f"{path}:{number}: cannot read '{text}'; expected 'type name' or 'type NAME=value'."
            )
        kind = match["type"]
        if match["const"]:
            constants.append((kind, match["name"], match["value"]))
            continue
        owner = None
        if kind not in PRIMITIVES and kind != "string":
            owner, kind = kind.split("/") if "/" in kind else (package, kind)
        array = None
        if match["array"]:
            array = "bounded" if match["bound"] else ("fixed" if match["size"] else "sequence")
        fields.append((kind, owner, array, int(match["size"] or 0), match["name"]))
    return fields, constants


def idl_type(kind, owner):
    if owner:
        return f"{owner}::msg::dds_::{kind}_"
    return "string" if kind == "string" else PRIMITIVES[kind][0]


def idl_text(package, name, fields, constants):
    body = []
    if constants:
        body.append(f"  module {name}_Constants {{")
        body += [
            f"    const {PRIMITIVES[kind][0]} {constant} = {value};"
            for kind, constant, value in constants
        ]
        body.append("  };")
    return idl_file(package, "msg", name, fields, body + struct_lines(name, fields))


def service_idl_text(package, name, request, response):
    """Request and response after the header that rmw_cyclonedds adds to both: the client's id
    and its request number."""
    header = [("uint64", None, None, 0, "client_guid"), ("int64", None, None, 0, "request_number")]
    body = []
    for half, fields in (("Request", request), ("Response", response)):
        body += struct_lines(f"{name}_{half}", header + (fields or type_hash.EMPTY))
    return idl_file(package, "srv", name, request + response, body)


def idl_file(package, folder, name, fields, body):
    includes = sorted(
        {f'#include "{owner}/msg/{kind}_.idl"' for kind, owner, *_ in fields if owner}
    )
    guard = f"{package}_{folder}_{name}_".upper()
    return "\n".join(
        [
            f"// Written by generate_idl.py from {name}.{folder}.",
            f"#ifndef {guard}",
            f"#define {guard}",
            *includes,
            f"module {package} {{ module {folder} {{ module dds_ {{",
            *body,
            "}; }; };",
            "#endif",
            "",
        ]
    )


def struct_lines(name, fields):
    out = [f"  @final @topic struct {name}_ {{"]
    for kind, owner, array, size, field in fields:
        base = idl_type(kind, owner)
        if array == "fixed":
            out.append(f"    {base} {field}[{size}];")
        elif array:
            out.append(f"    sequence<{base}{f', {size}' if array == 'bounded' else ''}> {field};")
        else:
            out.append(f"    {base} {field};")
    return [*out, "  };"]


def packed_size(messages, package, name):
    """Bytes of a fixed-size type without padding; None for other types."""
    total = 0
    for kind, owner, array, size, _ in messages[package, name][0]:
        if kind == "string" or array in ("sequence", "bounded"):
            return None
        one = packed_size(messages, owner, kind) if owner else PRIMITIVES[kind][1]
        if one is None:
            return None
        total += one * (size if array == "fixed" else 1)
    return total


def header_text(messages, own):
    out = [
        "#pragma once",
        (
            "/// Written by generate_idl.py: short names of the wire types, and what their layout"
            " must be."
        ),
        "#include <cstddef>",
        "#include <cstdint>",
        "#include <string_view>",
        "#include <dds/dds.h>",
    ]
    out += [f'#include "{package}/msg/{name}_.h"' for package, name in messages]
    out += [
        "namespace voxtouch::msg {",
        "/// Descriptor and names of a wire type.",
        "template <class T> struct Type;",
        (
            "/// The same as a value. `hash` is the type's RIHS01 hash, which ROS 2 tools compare"
            " from Iron on."
        ),
        "struct AnyType {",
        "  std::string_view ros_name;",
        "  const dds_topic_descriptor_t* descriptor;",
        "  std::string_view hash;",
        "};",
        (
            "template <class T> inline constexpr AnyType kAnyType{Type<T>::ros_name,"
            " Type<T>::descriptor, Type<T>::hash};"
        ),
        "",
    ]
    for package, name in messages:
        c_name = f"{package}_msg_dds__{name}_"
        short = name if package == own else f"{package}_{name}"
        out += [
            f"using {short} = {c_name};",
            f"template <> struct Type<{short}> {{",
            f"  static constexpr const dds_topic_descriptor_t* descriptor = &{c_name}_desc;",
            f'  static constexpr std::string_view ros_name = "{package}/msg/{name}";',
            f'  static constexpr std::string_view dds_name = "{package}::msg::dds_::{name}_";',
            (
                "  static constexpr std::string_view hash ="
                f' "{type_hash.type_hash(messages, package, name)}";'
            ),
            "};",
        ]
        constants = [c for c in messages[package, name][1] if c[0] in CONSTANT_TYPES]
        if constants:
            snake = re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()
            out.append(f"namespace {snake if package == own else f'{package}_{name}_constants'} {{")
            out += [
                "inline constexpr"
                f" {CONSTANT_TYPES[kind]} k{''.join(w.capitalize() for w in constant.split('_'))} ="
                f" {value};"
                for kind, constant, value in constants
            ]
            out.append("}")
    out.append("")
    for name in RING:
        size = packed_size(messages, own, name)
        if size is None or size % 8:
            sys.exit(
                f"{name}.msg: a ring type must be fixed-size and a multiple of 8 bytes; add or"
                " remove a reserved field."
            )
        out.append(
            f'static_assert(sizeof({name}) == {size}, "{name} holds padding; reorder its fields");'
        )
    out += ["}  // namespace voxtouch::msg", ""]
    return "\n".join(out)


def services_text(messages, services, own):
    """A C++ header with one tag type for each service."""
    out = [
        "#pragma once",
        "/// Written by generate_idl.py: services in the wire form of rmw_cyclonedds.",
        f'#include "{own}/messages.hpp"',
        *(f'#include "{package}/srv/{name}_.h"' for package, name in services),
        "namespace voxtouch::msg {",
    ]
    for (package, name), (request, response) in services.items():
        c_name = f"{package}_srv_dds__{name}"
        out += [
            f"struct {name if package == own else f'{package}_{name}'} {{",
            f"  using Request = {c_name}_Request_;",
            f"  using Response = {c_name}_Response_;",
            f'  static constexpr std::string_view ros_name = "{package}/srv/{name}";',
            (
                "  static constexpr std::string_view hash ="
                f' "{type_hash.service_hash(messages, package, name, request[0], response[0])}";'
            ),
            (
                f'  static constexpr AnyType request{{"{package}/srv/{name}_Request",'
                f" &{c_name}_Request__desc, hash}};"
            ),
            (
                f'  static constexpr AnyType response{{"{package}/srv/{name}_Response",'
                f" &{c_name}_Response__desc, hash}};"
            ),
            "};",
        ]
    return "\n".join([*out, "}  // namespace voxtouch::msg", ""])


def all_types_text(messages, own):
    """A C++ header with the descriptor of every type by its name, for code that handles any
    topic of the table."""
    shorts = [name if package == own else f"{package}_{name}" for package, name in messages]
    return "\n".join(
        [
            "#pragma once",
            "/// Written by generate_idl.py: every wire type by its ROS name.",
            f'#include "{own}/messages.hpp"',
            "namespace voxtouch::msg {",
            "inline constexpr AnyType kAllTypes[] = {",
            *(f"    kAnyType<{short}>," for short in shorts),
            "};",
            "}  // namespace voxtouch::msg",
            "",
        ]
    )


def definition(messages, texts, package, name):
    """The .msg with those of all types that it uses, as ROS 2 puts them together ("ros2msg"): so a
    bag explains itself.
    """
    parts = [texts[package, name]]
    parts += [
        f"MSG: {owner}/{kind}\n{texts[owner, kind]}"
        for owner, kind in sorted(type_hash.used(messages, package, name))
    ]
    return ("=" * 80 + "\n").join(part.rstrip("\n") + "\n" for part in parts)


def definitions_text(messages, texts):
    """A C++ header with the definition of every type by its ROS name, for bags."""
    out = [
        "#pragma once",
        (
            "/// Written by generate_idl.py: every type as the text of its .msg file and of those"
            " that it uses."
        ),
        "#include <string_view>",
        "namespace voxtouch::msg {",
        "struct Definition {",
        "  std::string_view ros_name, text;",
        "};",
        "inline constexpr Definition kDefinitions[] = {",
    ]
    out += [
        f'    {{"{package}/msg/{name}",'
        f' R"ros2msg({definition(messages, texts, package, name)})ros2msg"}},'
        for package, name in messages
    ]
    return "\n".join(
        [
            *out,
            "};",
            "/// Empty for a type that is not compiled in.",
            "constexpr std::string_view definition_of(std::string_view ros_name) noexcept {",
            "  for (const Definition& one : kDefinitions)",
            "    if (one.ros_name == ros_name) return one.text;",
            "  return {};",
            "}",
            "}  // namespace voxtouch::msg",
            "",
        ]
    )


def write(path, text):
    """Leaves a file with equal content unchanged, so that its dependents are not compiled again."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def require_known(messages, file, fields):
    for kind, owner, *_ in fields:
        if owner and (owner, kind) not in messages:
            sys.exit(f"{file} uses {owner}/{kind}, which none of the given folders holds.")


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    out = pathlib.Path(sys.argv[1])
    packages = dict(argument.split("=", 1) for argument in sys.argv[2:])
    own = next(iter(packages))
    messages, services, texts = {}, {}, {}
    for package, folder in packages.items():
        for found, kind in ((messages, "msg"), (services, "srv")):
            for path in sorted((pathlib.Path(folder) / kind).glob(f"*.{kind}")):
                found[package, path.stem] = parse(path, package)
                if kind == "msg":
                    texts[package, path.stem] = path.read_text()
    for (package, name), (fields, constants) in messages.items():
        require_known(messages, f"{package}/{name}.msg", fields)
        write(out / package / "msg" / f"{name}_.idl", idl_text(package, name, fields, constants))
    for (package, name), ((request, _), (response, _)) in services.items():
        require_known(messages, f"{package}/{name}.srv", request + response)
        write(
            out / package / "srv" / f"{name}_.idl",
            service_idl_text(package, name, request, response),
        )
    write(out / own / "messages.hpp", header_text(messages, own))
    write(out / own / "services.hpp", services_text(messages, services, own))
    write(out / own / "all_types.hpp", all_types_text(messages, own))
    write(out / own / "definitions.hpp", definitions_text(messages, texts))
    write(out / own / "python_types.hpp", python_types.header_text(messages))


if __name__ == "__main__":
    main()
