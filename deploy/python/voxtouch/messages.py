"""CDR messages as numpy arrays and Python values, by the text of their .msg definitions."""

import functools
import re
import struct

import numpy

SCALARS = {
    "bool": "?",
    "byte": "u1",
    "char": "u1",
    "float32": "<f4",
    "float64": "<f8",
    **{f"{u}int{8 * n}": f"<{'u' if u else 'i'}{n}" for u in ("", "u") for n in (1, 2, 4, 8)},
}
FIELD = re.compile(
    r"^(?P<type>[\w/]+)(?:<=\d+)?(?P<array>\[(?:<=)?(?P<size>\d*)\])?"
    r"\s+(?P<name>\w+)\s*(?P<constant>=)?"
)
SEPARATOR = "=" * 80


class Definition:
    """A type and the types that it uses: `fields` maps a type's name to [(type, None, "fixed" or
    "list", count, field name)].
    """

    def __init__(self, name, text):
        self.name, self.fields = name, {}
        for part in text.split(SEPARATOR):
            owner = name
            part = part.lstrip("\n")
            if self.fields:
                head, _, part = part.partition("\n")
                owner = head.removeprefix("MSG:").strip()
                owner = owner if "/msg/" in owner else owner.replace("/", "/msg/")
            self.fields[owner] = [
                self.field(match, owner)
                for line in part.splitlines()
                if (match := FIELD.match(line.split("#", 1)[0].strip())) and not match["constant"]
            ]

    @staticmethod
    def field(match, owner):
        kind = match["type"]
        if kind not in SCALARS and kind not in ("string", "wstring"):
            kind = (
                kind
                if "/msg/" in kind
                else (
                    kind.replace("/", "/msg/")
                    if "/" in kind
                    else f"{owner.split('/')[0]}/msg/{kind}"
                )
            )
        fixed = match["array"] and match["size"] and "<=" not in match["array"]
        return (
            kind,
            "fixed" if fixed else "list" if match["array"] else None,
            int(match["size"] or 0),
            match["name"],
        )

    @functools.cache
    def layout(self, name=None, start=0):
        """(dtype, size) of a fixed-size type at offset `start` of a message, with the padding of
        CDR; None for a type with strings or lists."""
        names, formats, offsets, at = [], [], [], start
        for kind, array, count, field in self.fields[name or self.name]:
            if array == "list" or kind in ("string", "wstring"):
                return None
            if kind in SCALARS:
                one = numpy.dtype(SCALARS[kind])
                at += -at % one.itemsize
                here, size = at, one.itemsize * (count if array else 1)
            else:
                here = at = at + -at % self.alignment(kind)
                inner = self.layout(kind, at % 8)
                if inner is None or (array and count > 1 and inner[1] % 8):
                    return None
                one, size = inner[0], inner[1] * (count if array else 1)
            (
                names.append(field),
                formats.append((one, (count,)) if array else one),
                offsets.append(here - start),
            )
            at += size
        return (
            numpy.dtype(
                {
                    "names": names,
                    "formats": formats,
                    "offsets": offsets,
                    "itemsize": max(at - start, 1),
                }
            ),
            at - start,
        )

    @functools.cache
    def alignment(self, name):
        """Of the type's first number: CDR aligns numbers, not structures."""
        for kind, array, _, _ in self.fields[name]:
            return (
                numpy.dtype(SCALARS[kind]).itemsize
                if kind in SCALARS and array != "list"
                else 4
                if kind not in self.fields
                else self.alignment(kind)
            )
        return 1

    def decode(self, data):
        """A message, with its four bytes of encapsulation, as a dict."""
        return Decoder(self, data).message(self.name)


class Decoder:
    def __init__(self, definition, data):
        self.definition, self.data, self.at = definition, data, 4

    def number(self, code):
        size = struct.calcsize(code)
        self.at += -(self.at - 4) % size
        (value,) = struct.unpack_from("<" + code, self.data, self.at)
        self.at += size
        return value

    def numbers(self, kind, count):
        dtype = numpy.dtype(SCALARS[kind])
        if count:
            self.at += -(self.at - 4) % dtype.itemsize
        end = self.at + count * dtype.itemsize
        if end > len(self.data):
            raise struct.error("a sequence exceeds its message")
        out = (
            numpy.frombuffer(self.data, dtype, count, self.at).copy()
            if count
            else numpy.empty(0, dtype)
        )
        self.at = end
        return out

    def text(self, kind):
        size = self.number("I") * (4 if kind == "wstring" else 1)
        if self.at + size > len(self.data):
            raise struct.error("a string exceeds its message")
        self.at += size
        raw = bytes(self.data[self.at - size : self.at])
        return (
            raw.decode("utf-32-le", "replace")
            if kind == "wstring"
            else raw.rstrip(b"\0").decode(errors="replace")
        )

    def one(self, kind):
        if kind in SCALARS:
            return self.numbers(kind, 1)[0]
        return self.text(kind) if kind in ("string", "wstring") else self.message(kind)

    def message(self, name):
        out = {}
        for kind, array, count, field in self.definition.fields[name]:
            if not array:
                out[field] = self.one(kind)
                continue
            count = count if array == "fixed" else self.number("I")
            if count > len(self.data):
                raise struct.error("a sequence exceeds its message")
            out[field] = (
                self.numbers(kind, count)
                if kind in SCALARS
                else [self.one(kind) for _ in range(count)]
            )
        return out


def table(definition, times, messages):
    """A structured array: bag_time_ns [ns], then the message's fields. Messages of fixed size
    become nested numbers, without single copies; in others each text, list and inner message
    is a Python object: str, array or list, dict. struct.error if a message has another
    layout."""
    fields = definition.fields[definition.name]
    layout = definition.layout()
    if layout is not None:
        dtype, size = layout
        if any(len(data) != size + 4 or data[1] != 1 for data in messages):
            raise struct.error("wrong message size")
        rows = (
            numpy.frombuffer(b"".join(data[4:] for data in messages), dtype)
            if messages
            else numpy.empty(0, dtype)
        )
        out = numpy.empty(
            len(messages), [("bag_time_ns", "<i8"), *((name, dtype[name]) for name in dtype.names)]
        )
        for name in dtype.names:
            out[name] = rows[name]
    else:
        kinds = [
            (field, SCALARS[kind] if kind in SCALARS and not array else "O")
            for kind, array, _, field in fields
        ]
        out = numpy.empty(len(messages), [("bag_time_ns", "<i8"), *kinds])
        for row, data in enumerate(messages):
            for name, value in definition.decode(data).items():
                out[name][row] = value
    out["bag_time_ns"] = times
    return out
