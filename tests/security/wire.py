#!/usr/bin/env python3
"""Data of a ring visible on the wire: names of topics and types, words of messages, unencrypted
samples.

    tests/security/wire.py BUILD DOMAIN

Captures loopback while a secured ring runs, and while a plain one does, which must show plenty.
Exit status 1: something passed in clear text, or the plain ring showed nothing; 77: this user may
not capture.
"""

import base64
import pathlib
import re
import socket
import struct
import subprocess
import sys
import tempfile
import threading

HERE = pathlib.Path(__file__).resolve().parents[2]
WORDS = [
    b"rt/haptic",
    b"device/state",
    b"rendering/contact",
    b"coupling/command",
    b"node_status",
    b"ros_discovery_info",
    b"voxtouch_msgs",
    b"foreign_commands",
    b"refused_statuses",
    b"sim-phantom",
    b"shaping_filter",
]  # topics, types; words of NodeStatus, DeviceDescription, CouplingDesign
DATA, DATA_FRAG, SECURE_PREFIX = 0x15, 0x16, 0x31


class Capture:
    def __init__(self, domain):
        self.first = 7400 + 250 * domain
        self.socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x0800))
        self.socket.bind(("lo", 0))
        self.socket.setsockopt(socket.SOL_SOCKET, 33, 32 << 20)  # SO_RCVBUFFORCE
        self.socket.settimeout(0.2)
        self.seen = {
            "packets": 0,
            "with our words": 0,
            "with a sample in clear text": 0,
            "enciphered": 0,
            "with signed permissions": 0,
        }
        self.over = threading.Event()
        self.thread = threading.Thread(target=self.poll)
        self.thread.start()

    def poll(self):
        while not self.over.is_set():
            try:
                frame, address = self.socket.recvfrom(70000)
            except TimeoutError:
                continue
            if (
                address[2] == socket.PACKET_OUTGOING or len(frame) < 42 or frame[23] != 17
            ):  # each passes lo twice; UDP
                continue
            udp = 14 + 4 * (frame[14] & 15)
            if self.first <= struct.unpack("!H", frame[udp + 2 : udp + 4])[0] < self.first + 250:
                self.judge(frame[udp + 8 :])

    def judge(self, message):
        self.seen["packets"] += 1
        self.seen["with our words"] += any(word in message for word in WORDS)
        self.seen["with signed permissions"] += b"x-pkcs7-mime" in message
        at, clear, secure = 20, False, False
        while message[:4] == b"RTPS" and at + 4 <= len(message):
            size = struct.unpack("<H" if message[at + 1] & 1 else ">H", message[at + 2 : at + 4])[0]
            if message[at] in (DATA, DATA_FRAG) and at + 16 <= len(message):
                clear = (
                    clear or message[at + 15] & 0xC0 == 0
                )  # the writer's kind: a user's, not of discovery
            secure = secure or message[at] == SECURE_PREFIX
            at = at + 4 + size if size else len(message)
        self.seen["with a sample in clear text"] += clear
        self.seen["enciphered"] += secure

    def end(self):
        self.over.set()
        self.thread.join()
        self.socket.close()
        return self.seen


def listen_to(build, domain, more):
    capture = Capture(domain)
    try:
        up = subprocess.run(
            [
                build / "bin/voxtouch",
                "up",
                HERE / "deploy/scenes/cup.yaml",
                "--motion",
                "slide",
                "--duration",
                "3",
                "--no-record",
                "--domain",
                str(domain),
                *more,
            ],
            capture_output=True,
            text=True,
            timeout=90,
            check=False,
        )
    finally:
        seen = capture.end()
    if "answered ratio" not in up.stdout:
        sys.exit(f"the ring did not run: {up.stdout[-300:]} {up.stderr[-600:]}")
    return seen


def main():
    build, domain = pathlib.Path(sys.argv[1]), int(sys.argv[2])
    try:
        socket.socket(socket.AF_PACKET, socket.SOCK_RAW, 0).close()
    except PermissionError:
        print("SKIPPED: to capture loopback needs CAP_NET_RAW, which this user has not.")
        return 77
    with tempfile.TemporaryDirectory(prefix="voxtouch_test_wire_") as folder:
        keys = str(pathlib.Path(folder, "keys"))
        subprocess.run(
            [build / "bin/voxtouch", "keys", "--out", keys], check=True, stdout=subprocess.DEVNULL
        )
        secured = listen_to(build, domain, ["--security", keys])
        body = re.search(
            rb"\n\n(.*)\n", pathlib.Path(keys, "device/permissions.p7s").read_bytes(), re.DOTALL
        ).group(1)
        named = b"rt/haptic/device/state" in base64.b64decode(body)
    plain = listen_to(build, domain, [])
    for name, seen in (("secured", secured), ("plain", plain)):
        print(f"figure: {name}: " + ", ".join(f"{count} {what}" for what, count in seen.items()))
    print(
        f"figure: the handshake's permissions {'name' if named else 'do not name'} topics to who"
        " decodes them"
    )
    good = (
        secured["with our words"] == secured["with a sample in clear text"] == 0
        and secured["enciphered"] > 1000
        and plain["with our words"] > 10
        and plain["with a sample in clear text"] > 1000
        and plain["enciphered"] == 0
    )
    print("PASSED" if good else "FAILED")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
