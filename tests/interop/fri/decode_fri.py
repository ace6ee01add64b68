#!/usr/bin/env python3
"""Reads FRI 1.0 packets without the driver's code: the offsets below are written by hand.

usage: decode_fri.py FILE...            one packet per line, as JSON; FILE is a pcap (link type RAW)
                                        or consecutive packets
       decode_fri.py --brief FILE...    sequence, state, quality, request, positions and torques
                                        only
       decode_fri.py --check-fields FILE  every field has the values of field_values() for its name
       decode_fri.py --make-golden DIR  writes measurement.bin and command.bin, filled by
                                        field_values()
Exit code 1: a file could not be read or a check failed.
"""

import json
import struct
import sys

# name, offset, struct code, count
MSR = [
    ("sendSeqCount", 0, "H", 1),
    ("reflSeqCount", 2, "H", 1),
    ("packetSize", 4, "H", 1),
    ("datagramId", 6, "H", 1),
    ("krlReal", 8, "f", 16),
    ("krlInt", 72, "i", 16),
    ("krlBool", 136, "H", 1),
    ("fill", 138, "H", 1),
    ("timestamp", 140, "f", 1),
    ("state", 144, "H", 1),
    ("quality", 146, "H", 1),
    ("desiredMsrSampleTime", 148, "f", 1),
    ("desiredCmdSampleTime", 152, "f", 1),
    ("safetyLimits", 156, "f", 1),
    ("answerRate", 160, "f", 1),
    ("latency", 164, "f", 1),
    ("jitter", 168, "f", 1),
    ("missRate", 172, "f", 1),
    ("missCounter", 176, "I", 1),
    ("power", 180, "H", 1),
    ("control", 182, "H", 1),
    ("error", 184, "H", 1),
    ("warning", 186, "H", 1),
    ("temperature", 188, "f", 7),
    ("msrJntPos", 216, "f", 7),
    ("msrCartPos", 244, "f", 12),
    ("cmdJntPos", 292, "f", 7),
    ("cmdJntPosFriOffset", 320, "f", 7),
    ("cmdCartPos", 348, "f", 12),
    ("cmdCartPosFriOffset", 396, "f", 12),
    ("msrJntTrq", 444, "f", 7),
    ("estExtJntTrq", 472, "f", 7),
    ("estExtTcpFT", 500, "f", 6),
    ("jacobian", 524, "f", 42),
    ("massMatrix", 692, "f", 49),
    ("gravity", 888, "f", 7),
]
CMD = [
    ("sendSeqCount", 0, "H", 1),
    ("reflSeqCount", 2, "H", 1),
    ("packetSize", 4, "H", 1),
    ("datagramId", 6, "H", 1),
    ("krlReal", 8, "f", 16),
    ("krlInt", 72, "i", 16),
    ("krlBool", 136, "H", 1),
    ("fill", 138, "H", 1),
    ("cmdFlags", 140, "I", 1),
    ("jntPos", 144, "f", 7),
    ("cartPos", 172, "f", 12),
    ("addJntTrq", 220, "f", 7),
    ("addTcpFT", 248, "f", 6),
    ("jntStiffness", 272, "f", 7),
    ("jntDamping", 300, "f", 7),
    ("cartStiffness", 328, "f", 6),
    ("cartDamping", 352, "f", 6),
]
KINDS = {0x2006: ("MSR", 916, MSR), 0x1005: ("CMD", 376, CMD)}
STATES = {0: "OFF", 1: "MON", 2: "CMD"}
QUALITIES = {0: "UNACCEPTABLE", 1: "BAD", 2: "OK", 3: "PERFECT"}


class Unreadable(Exception):
    pass


def tables_are_whole():
    """No byte of a packet is left out or reported twice."""
    for kind, size, table in KINDS.values():
        at = 0
        for name, offset, code, count in table:
            if offset != at:
                raise Unreadable(f"{kind}.{name} is at {offset}, but the field before ends at {at}")
            at += struct.calcsize("<" + code) * count
        if at != size:
            raise Unreadable(f"{kind} has {at} bytes in the table, not {size}")


def decode(data):
    if len(data) < 8:
        raise Unreadable(f"{len(data)} bytes are no packet")
    size, ident = struct.unpack_from("<HH", data, 4)
    if ident not in KINDS:
        raise Unreadable(f"datagram id 0x{ident:04x} is unknown")
    kind, expected, table = KINDS[ident]
    if len(data) != expected or size != expected:
        raise Unreadable(f"{kind} of {len(data)} bytes says {size}; it has {expected}")
    packet = {"kind": kind}
    for name, offset, code, count in table:
        values = struct.unpack_from(f"<{count}{code}", data, offset)
        packet[name] = values[0] if count == 1 else list(values)
    return packet


def datagrams(data):
    """(time, bytes) of each record of a pcap, or of each packet in a plain file."""
    if data[:4] == b"\xd4\xc3\xb2\xa1":
        if struct.unpack_from("<I", data, 20)[0] != 101:
            raise Unreadable("the pcap's link type is not RAW (101)")
        at = 24
        while at < len(data):
            seconds, micros, kept, original = struct.unpack_from("<IIII", data, at)
            record = data[at + 16 : at + 16 + kept]
            at += 16 + kept
            words = (record[0] & 15) * 4
            if sum(struct.unpack(f">{words // 2}H", record[:words])) % 0xFFFF != 0:
                raise Unreadable("an IPv4 header has a wrong checksum")
            ip_length, udp_length = (
                struct.unpack_from(">H", record, 2)[0],
                struct.unpack_from(">H", record, words + 4)[0],
            )
            if record[9] != 17 or ip_length != original or udp_length != original - words:
                raise Unreadable("a record is no UDP datagram of its length")
            yield seconds + 1e-6 * micros, record[words + 8 :]
        return
    at = 0
    while at < len(data):
        if len(data) - at < 8:
            raise Unreadable(f"{len(data) - at} bytes are left over at the end")
        size = struct.unpack_from("<H", data, at + 4)[0]
        if size < 8:
            raise Unreadable(f"the packet at byte {at} says it has {size} bytes")
        yield None, data[at : at + size]
        at += size


def field_values(kind, name, code, count):
    """Different values for all fields: a number from the name, plus an eighth per element."""
    fixed = {
        "packetSize": {"MSR": 916, "CMD": 376},
        "datagramId": {"MSR": 0x2006, "CMD": 0x1005},
        "state": {"MSR": 2},
        "quality": {"MSR": 3},
        "control": {"MSR": 2},
    }
    if name in fixed:
        return [fixed[name][kind]]
    base = sum((i + 1) * ord(letter) for i, letter in enumerate(name)) % 4001
    if code == "i":
        return [-base - i for i in range(count)]
    return [base + i / 8 if code == "f" else base + i for i in range(count)]


def make_golden(folder):
    for _ident, (kind, size, table) in KINDS.items():
        data = bytearray(size)
        for name, offset, code, count in table:
            struct.pack_into(
                f"<{count}{code}", data, offset, *field_values(kind, name, code, count)
            )
        with open(f"{folder}/{'measurement' if kind == 'MSR' else 'command'}.bin", "wb") as file:
            file.write(data)


def check_fields(packet):
    kind = packet["kind"]
    table = MSR if kind == "MSR" else CMD
    for name, _, code, count in table:
        got = packet[name] if count > 1 else [packet[name]]
        if got != field_values(kind, name, code, count):
            raise Unreadable(
                f"{kind}.{name} is {got}, expected {field_values(kind, name, code, count)}"
            )


def brief(packet):
    numbers = lambda values: " ".join(f"{value:8.4f}" for value in values)
    head = f"{packet['kind']} seq {packet['sendSeqCount']:5} refl {packet['reflSeqCount']:5}"
    if packet["kind"] == "MSR":
        return (
            f"{head} t {packet['timestamp']:9.4f} {STATES.get(packet['state'], '?')}"
            f" {QUALITIES.get(packet['quality'], '?'):12} power"
            f" {packet['power']:02x} error {packet['error']:02x} echo {packet['krlInt'][1]:2} q"
            f" {numbers(packet['msrJntPos'])}"
        )
    return (
        f"{head} strategy {packet['krlInt'][0]} run {packet['krlInt'][1]} flags"
        f" {packet['cmdFlags']:04x} q {numbers(packet['jntPos'])} tau"
        f" {numbers(packet['addJntTrq'])}"
    )


def main(arguments):
    tables_are_whole()
    if len(arguments) == 2 and arguments[0] == "--make-golden":
        make_golden(arguments[1])
        return 0
    modes = [a for a in arguments if a.startswith("--")]
    files = [a for a in arguments if not a.startswith("--")]
    if not files or any(m not in ("--brief", "--check-fields") for m in modes):
        print(__doc__, file=sys.stderr)
        return 1
    count = 0
    for name in files:
        with open(name, "rb") as file:
            data = file.read()
        for time, record in datagrams(data):
            packet = decode(record)
            count += 1
            if "--check-fields" in modes:
                check_fields(packet)
            elif "--brief" in modes:
                print("" if time is None else f"{time:.6f}", brief(packet))
            else:
                print(json.dumps({"time": time, **packet}))
    if "--check-fields" in modes:
        if count == 0:
            raise Unreadable("the file holds no packet")
        print(f"{count} packets, every field where it belongs")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (Unreadable, OSError, struct.error) as error:
        print(f"decode_fri.py: {error}", file=sys.stderr)
        sys.exit(1)
