"""Common parts of the page's tests: rings and pages as child processes, and a plain HTTP and
WebSocket client of the standard library."""

import base64
import contextlib
import json
import os
import pathlib
import re
import select
import socket
import struct
import subprocess
import tempfile
import time
import urllib.parse

BIN = pathlib.Path(os.environ["VOXTOUCH_BIN"])
DEPLOY = pathlib.Path(os.environ["VOXTOUCH_DEPLOY"])
DOMAIN = "38"


def scene(name):
    return str(DEPLOY / "scenes" / f"{name}.yaml")


def write_block(path, n):
    """A block of 0.24 x 0.24 x 0.02 m with its top at z = 0, of 12 n n triangles, as binary STL."""
    side = lambda u, v: [((u, v), (u + 1, v), (u + 1, v + 1)), ((u, v), (u + 1, v + 1), (u, v + 1))]
    faces = [
        (lambda a, b: (a, b, 1)),
        (lambda a, b: (b, a, 0)),
        (lambda a, b: (1, a, b)),
        (lambda a, b: (0, b, a)),
        (lambda a, b: (b, 1, a)),
        (lambda a, b: (a, 0, b)),
    ]
    with open(path, "wb") as file:
        file.write(b" " * 80 + struct.pack("<I", 12 * n * n))
        for face in faces:
            for u in range(n):
                for v in range(n):
                    for corners in side(u, v):
                        xyz = [face(a / n, b / n) for a, b in corners]
                        flat = [
                            c
                            for x, y, z in xyz
                            for c in (0.24 * x - 0.12, 0.24 * y - 0.12, 0.02 * z - 0.02)
                        ]
                        file.write(struct.pack("<12fH", 0, 0, 0, *flat, 0))


def fine_scene(folder, n):
    """The shipped plane's scene with a block of 12 n n triangles."""
    mesh, scene_file = pathlib.Path(folder) / "fine.stl", pathlib.Path(folder) / "fine.yaml"
    write_block(mesh, n)
    text = pathlib.Path(scene("plane")).read_text()
    scene_file.write_text(
        text.replace("../meshes/plane.obj", str(mesh)).replace("../meshes", str(DEPLOY / "meshes"))
    )
    return scene_file


def until(holds, patience_s, what):
    """The first true value of holds(); fails with a sentence after so long. `what`: the words, or a
    function that gives them then.
    """
    end = time.monotonic() + patience_s
    while time.monotonic() < end:
        value = holds()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError(f"not within {patience_s} s: {what() if callable(what) else what}")


class Process:
    """A verb of voxtouch; `reported` is its output so far on stdout and stderr."""

    def __init__(self, *arguments):
        self.file = tempfile.NamedTemporaryFile(suffix=".log")
        self.process = subprocess.Popen(
            [BIN / "voxtouch", *arguments], stdout=self.file, stderr=subprocess.STDOUT
        )

    def output(self):
        return pathlib.Path(self.file.name).read_text(errors="replace")

    def address(self):
        return until(
            lambda: re.search(r"http://\S+", self.output()), 20, f"an address in: {self.output()}"
        ).group()

    def end(self):
        self.process.terminate()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()


def until_it_runs(up):
    """A ring in real time has begun to answer samples."""

    def runs():
        if up.process.poll() is not None:
            raise AssertionError(f"the ring has ended:\n{up.output()}")
        return " samples  force" in up.output()

    until(runs, 60, lambda: f"a ring that runs:\n{up.output()}")


def ring(name, *more, motion="slide"):
    """A ring in real time that a busy machine does not end, without a bag."""
    return Process("up", scene(name), "--motion", motion, "--domain", DOMAIN, "--no-record", *more)


def page(*more):
    return Process("view", "--domain", DOMAIN, "--port", "0", *more)


def request(address, path=None, host=None, headers=()):
    """Status and body of one GET."""
    parts = urllib.parse.urlsplit(address)
    path = path if path is not None else f"{parts.path}?{parts.query}"
    with socket.create_connection((parts.hostname, parts.port), 10) as s:
        lines = [
            f"GET {path} HTTP/1.1",
            f"Host: {host or parts.netloc}",
            "Connection: close",
            *headers,
            "",
            "",
        ]
        s.sendall("\r\n".join(lines).encode())
        answer = b""
        with contextlib.suppress(ConnectionError):
            while part := s.recv(65536):
                answer += part
    head, _, body = answer.partition(b"\r\n\r\n")
    return (int(head.split()[1]) if head else 0), head.decode(), body


class WebSocket:
    """RFC 6455 as far as a page needs it. `status` is that of the handshake: 101 if it was
    accepted."""

    def __init__(self, address, token=None, host=None, origin=None, path=None):
        parts = urllib.parse.urlsplit(address)
        if path is None:
            token = token if token is not None else urllib.parse.parse_qs(parts.query)["token"][0]
            path = f"/ring?token={token}"
        self.socket = socket.create_connection((parts.hostname, parts.port), 10)
        self.buffer, self.closed = b"", None
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [
            f"GET {path} HTTP/1.1",
            f"Host: {host or parts.netloc}",
            "Upgrade: websocket",
            "Connection: Upgrade",
            f"Sec-WebSocket-Key: {key}",
            "Sec-WebSocket-Version: 13",
            "Sec-WebSocket-Protocol: voxtouch-view",
        ]
        if origin:
            lines.append(f"Origin: {origin}")
        self.socket.sendall("\r\n".join([*lines, "", ""]).encode())
        while b"\r\n\r\n" not in self.buffer:
            if not self._more():
                break
        head, _, self.buffer = self.buffer.partition(b"\r\n\r\n")
        self.status = int(head.split()[1]) if head else 0

    def _more(self):
        try:
            part = self.socket.recv(1 << 20)
        except (TimeoutError, ConnectionError):
            return False
        self.buffer += part
        return bool(part)

    def _bytes(self, n):
        while len(self.buffer) < n:
            if not self._more():
                raise EOFError
        taken, self.buffer = self.buffer[:n], self.buffer[n:]
        return taken

    def send(self, text):
        data = text.encode()
        mask = os.urandom(4)
        if len(data) < 126:
            length = struct.pack("!B", 0x80 | len(data))
        elif len(data) < 65536:
            length = struct.pack("!BH", 0x80 | 126, len(data))
        else:
            length = struct.pack("!BQ", 0x80 | 127, len(data))
        self.socket.sendall(
            b"\x81" + length + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data))
        )

    def order(self, **words):
        self.send(json.dumps(words))

    def receive(self):
        """The next message as JSON; None once the server has closed, with its code in `closed`."""
        text = b""
        while True:
            try:
                first, second = self._bytes(2)
                length = second & 127
                if length > 125:
                    length = int.from_bytes(self._bytes(2 if length == 126 else 8), "big")
                data = self._bytes(length)
            except EOFError:
                self.closed = self.closed or 1006
                return None
            if first & 15 == 8:
                self.closed = int.from_bytes(data[:2], "big")
                return None
            if first & 15 == 9:  # a ping of at most 125 bytes; the mask is 0
                self.socket.sendall(bytes([0x8A, 0x80 | len(data), 0, 0, 0, 0]) + data)
            if first & 15 in (0, 1):
                text += data
                if first & 128:
                    return json.loads(text)

    def wait_for(self, holds, patience_s, what):
        """The first message that holds(message) is true of."""
        end = time.monotonic() + patience_s
        while time.monotonic() < end:
            message = self.receive()
            assert message is not None, f"the server closed ({self.closed}) before {what}"
            if holds(message):
                return message
        raise AssertionError(f"not within {patience_s} s: {what}")

    def catch_up(self):
        """Reads what waits to be read, however long ago it was sent."""
        while self.buffer or select.select([self.socket], [], [], 0)[0]:
            assert self.receive() is not None, f"the server closed ({self.closed})"

    def facts(self, holds, patience_s, what):
        return self.wait_for(lambda m: m["type"] == "facts" and holds(m), patience_s, what)

    def frame(self, holds, patience_s, what):
        return self.wait_for(lambda m: m["type"] == "frame" and holds(m), patience_s, what)

    def code_of_the_end(self, patience_s):
        """The server's closing code within so long; None without one."""
        end = time.monotonic() + patience_s
        while time.monotonic() < end and self.receive() is not None:
            pass
        return self.closed

    def close(self):
        self.socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def size(force):
    return sum(x * x for x in force) ** 0.5 if force else 0.0


def state_of(facts, node):
    return next((n["state"] for n in facts["nodes"] if n["node"] == node), None)


def pid_of(facts, node):
    return next(n["pid"] for n in facts["nodes"] if n["node"] == node)
