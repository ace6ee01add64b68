"""RIHS01 hashes of message types, as REP-2016 says: SHA-256 over the JSON of the type's description with all types that it uses."""
import hashlib
import json

TYPE_IDS = {"int8": 2, "uint8": 3, "char": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8, "uint64": 9, "float32": 10,
            "float64": 11, "bool": 15, "byte": 16, "string": 17}  # a char of a .msg is a uint8
NESTED = 1
ARRAYS = {None: 0, "fixed": 48, "bounded": 96, "sequence": 144}  # what is added to the id of an element


def described(messages, package, name):
    fields = [{"name": field, "type": {"type_id": (NESTED if owner else TYPE_IDS[kind]) + ARRAYS[array], "capacity": size,
                                       "string_capacity": 0, "nested_type_name": f"{owner}/msg/{kind}" if owner else ""}}
              for kind, owner, array, size, field in messages[package, name][0]]
    return {"type_name": f"{package}/msg/{name}", "fields": fields}


def used(messages, package, name):
    """All types that this one is made of, itself aside."""
    found, open_ends = set(), [(package, name)]
    while open_ends:
        for kind, owner, *_ in messages[open_ends.pop()][0]:
            if owner and (owner, kind) not in found:
                found.add((owner, kind))
                open_ends.append((owner, kind))
    return found


def type_hash(messages, package, name):
    parts = sorted((described(messages, *one) for one in used(messages, package, name)), key=lambda part: part["type_name"])
    text = json.dumps({"type_description": described(messages, package, name), "referenced_type_descriptions": parts})
    return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()
