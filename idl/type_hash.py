"""RIHS01 hashes of message and service types, after REP-2016: SHA-256 over the JSON of the
type's description with all types that it uses."""

import hashlib
import json

TYPE_IDS = {
    "int8": 2,
    "uint8": 3,
    "char": 3,
    "int16": 4,
    "uint16": 5,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float32": 10,
    "float64": 11,
    "bool": 15,
    "byte": 16,
    "string": 17,
}  # a char of a .msg is a uint8
NESTED = 1
ARRAYS = {
    None: 0,
    "fixed": 48,
    "bounded": 96,
    "sequence": 144,
}  # added to the id of an element
EMPTY = [
    ("uint8", None, None, 0, "structure_needs_at_least_one_member")
]  # a struct of DDS has a member


def full_name(package, name, services):
    return f"{package}/{'srv' if (package, name) in services else 'msg'}/{name}"


def described(messages, package, name, services):
    fields = [
        {
            "name": field,
            "type": {
                "type_id": (NESTED if owner else TYPE_IDS[kind]) + ARRAYS[array],
                "capacity": size,
                "string_capacity": 0,
                "nested_type_name": full_name(owner, kind, services) if owner else "",
            },
        }
        for kind, owner, array, size, field in messages[package, name][0]
    ]
    return {"type_name": full_name(package, name, services), "fields": fields}


def used(messages, package, name):
    """All types that this one is made of, itself aside."""
    found, open_ends = set(), [(package, name)]
    while open_ends:
        for kind, owner, *_ in messages[open_ends.pop()][0]:
            if owner and (owner, kind) not in found:
                found.add((owner, kind))
                open_ends.append((owner, kind))
    return found


def type_hash(messages, package, name, services=()):
    """`services`: the types in their package's srv folder."""
    parts = sorted(
        (described(messages, *one, services) for one in used(messages, package, name)),
        key=lambda part: part["type_name"],
    )
    text = json.dumps(
        {
            "type_description": described(messages, package, name, services),
            "referenced_type_descriptions": parts,
        }
    )
    return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()


def service_hash(messages, package, name, request, response):
    """Of a service as a whole, which ROS describes as a type of its request, its response and the
    event of both.
    """

    def part(kind, field, array=None, owner=package):
        return kind, owner, array, 1 if array else 0, field

    own = {
        (package, f"{name}_Request"): (request or EMPTY, []),
        (package, f"{name}_Response"): (response or EMPTY, []),
        (package, f"{name}_Event"): (
            [
                part("ServiceEventInfo", "info", owner="service_msgs"),
                part(f"{name}_Request", "request", "bounded"),
                part(f"{name}_Response", "response", "bounded"),
            ],
            [],
        ),
        (package, name): (
            [
                part(f"{name}_{half.capitalize()}", f"{half}_message")
                for half in ("request", "response", "event")
            ],
            [],
        ),
    }
    return type_hash({**messages, **own}, package, name, set(own))
