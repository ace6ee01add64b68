#!/usr/bin/env python3
"""Programs in faulty environments: each ends, or continues, with a sentence and never by a signal.

    tests/attack/environment.py --build build --domain 68

Without root, rows that need it (no /proc, a removed address) are skipped and named. Exit status 1
if a check failed.
"""

import argparse
import contextlib
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parents[2]
NO_MULTICAST = (
    "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General></Domain>"
    "</CycloneDDS>"
)
NODES = ("device", "rendering", "coupling", "logger", "validator")
CARD = (
    ["ip", "link", "add", "d0", "type", "veth", "peer", "name", "d1"],
    ["ip", "link", "set", "d1", "up"],
    ["ip", "addr", "add", "10.9.9.1/24", "dev", "d0"],
    ["ip", "link", "set", "d0", "up", "multicast", "on"],
)


class Rows:
    def __init__(self, build, domain):
        self.bin, self.domain, self.faults = build.resolve() / "bin", domain, []

    def expect(self, holds, row, said=""):
        print(f"{'ok   ' if holds else 'FAULT'}  {row}{'' if holds else ': ' + said[-500:]}")
        if not holds:
            self.faults.append(row)

    def verb(self, *words, **more):
        end = subprocess.run(
            [self.bin / "voxtouch", *words],
            capture_output=True,
            text=True,
            timeout=120,
            stdin=subprocess.DEVNULL,
            **more,
        )
        return end.returncode, end.stdout + end.stderr

    def deleted_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            gone = pathlib.Path(folder, "gone")
            gone.mkdir()
            script = 'rmdir "$1"; shift; exec "$@"'
            end = subprocess.run(
                [
                    "/bin/sh",
                    "-c",
                    script,
                    "sh",
                    gone,
                    self.bin / "voxtouch",
                    "new",
                    HERE / "deploy/meshes/sphere.obj",
                ],
                cwd=gone,
                capture_output=True,
                text=True,
                timeout=60,
                check=False,
            )
            self.expect(
                end.returncode == 1 and "current folder is deleted" in end.stderr,
                "a deleted current folder",
                end.stderr,
            )

    def no_proc(self):
        if os.geteuid() != 0:
            return print("left out: no /proc (needs root)")
        for program in ("voxtouch", *(f"voxtouch_{node}" for node in NODES)):
            words = (
                ["status"]
                if program == "voxtouch"
                else (
                    ["--scene", HERE / "deploy/scenes/cup.yaml"]
                    if program != "voxtouch_logger"
                    else ["--bag", "/tmp/none"]
                )
            )
            end = subprocess.run(
                [
                    "unshare",
                    "-m",
                    "/bin/sh",
                    "-c",
                    'umount -l /proc && exec "$@"',
                    "sh",
                    "timeout",
                    "3",
                    self.bin / program,
                    *words,
                ],
                capture_output=True,
                text=True,
                timeout=60,
                check=False,
            )
            self.expect(
                0 <= end.returncode < 128 and "terminate called" not in end.stderr,
                f"{program} without /proc",
                end.stderr,
            )

    def start_faults(self):
        """Each fault of a DDS start names its own cause and remedy."""

        def uri(inner):
            return {"CYCLONEDDS_URI": f"<CycloneDDS><Domain>{inner}</Domain></CycloneDDS>"}

        rows = [
            (
                "shared memory",
                uri("<SharedMemory><Enable>true</Enable></SharedMemory>"),
                (),
                ("SharedMemory", "Set its Enable to false"),
            ),
            (
                "an unknown setting",
                uri("<General><Foo>1</Foo></General>"),
                (),
                ("Foo: unknown element", "correct CYCLONEDDS_URI"),
            ),
            (
                "a settings file that is not there",
                {"CYCLONEDDS_URI": "file:///nowhere.xml"},
                (),
                ("does not exist", "unset CYCLONEDDS_URI"),
            ),
            (
                "a settings file that is a folder",
                {"CYCLONEDDS_URI": "file:///tmp"},
                (),
                ("is a folder", "unset CYCLONEDDS_URI"),
            ),
            (
                "a receive buffer that is refused",
                uri('<Internal><SocketReceiveBufferSize min="900MB"/></Internal>'),
                (),
                ("receive buffer", "net.core.rmem_max"),
            ),
            (
                "ports out of range",
                uri("<Discovery><Ports><Base>65000</Base></Ports></Discovery>"),
                (),
                ("out of range", "smaller --domain"),
            ),
            (
                "a card that is not there",
                {},
                ("--interface", "nocard"),
                ("there is no network card", "`ip link` lists"),
            ),
        ]
        if (
            os.environ.get("VOXTOUCH_IN_NAMESPACE") == "1"
            and not subprocess.run(
                ["ip", "link", "add", "down0", "type", "veth", "peer", "name", "down1"], check=False
            ).returncode
        ):
            rows.append(
                (
                    "a card that is down",
                    {},
                    ("--interface", "down0"),
                    ("down or has no IPv4 address", "`ip link set down0 up`"),
                )
            )
        for row, settings, words, expected in rows:
            code, said = self.verb(
                "status", "--domain", str(self.domain), *words, env=os.environ | settings
            )
            self.expect(code == 1 and all(part in said for part in expected), row, said)

    def deaf(self):
        environment = os.environ | {"CYCLONEDDS_URI": NO_MULTICAST}
        code, said = self.verb("doctor", "--domain", str(self.domain), env=environment)
        self.expect(
            code == 1 and "do not receive each other" in said and "AllowMulticast" in said,
            "doctor names nodes that do not receive each other",
            said,
        )
        with tempfile.TemporaryFile("w+") as log:
            up = subprocess.Popen(
                [
                    self.bin / "voxtouch",
                    "up",
                    "cup",
                    "--lockstep",
                    "--no-record",
                    "--duration",
                    "1",
                    "--domain",
                    str(self.domain),
                ],
                stdout=log,
                stderr=subprocess.STDOUT,
                env=environment,
            )
            end, text = time.monotonic() + 40, ""
            while "nothing received from other nodes" not in text and time.monotonic() < end:
                time.sleep(0.2)
                log.seek(0)
                text = log.read()
            up.send_signal(signal.SIGINT)
            with contextlib.suppress(subprocess.TimeoutExpired):
                up.wait(30)
            if up.poll() is None:
                up.kill()
        self.expect(
            "for 3 s: CYCLONEDDS_URI disables multicast" in text,
            "nodes report that they receive nothing, and why",
            text,
        )

    def nohup(self):
        watch = subprocess.Popen(
            ["nohup", self.bin / "voxtouch", "status", "--watch", "--domain", str(self.domain)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            stdin=subprocess.DEVNULL,
        )
        time.sleep(1.5)
        watch.send_signal(signal.SIGHUP)
        time.sleep(1.5)
        self.expect(watch.poll() is None, "a hangup under nohup")
        watch.terminate()
        watch.wait(20)

    def address_gone(self):
        if os.geteuid() != 0 or os.environ.get("VOXTOUCH_IN_NAMESPACE") != "1":
            return print(
                "left out: an address that goes (needs root and a network namespace of its own)"
            )
        for command in (["ip", "link", "set", "lo", "up"], *CARD):
            if subprocess.run(command, check=False).returncode:
                return print("left out: an address that goes (no card can be made)")
        with tempfile.TemporaryFile("w+") as log, tempfile.TemporaryDirectory() as folder:
            up = subprocess.Popen(
                [
                    self.bin / "voxtouch",
                    "up",
                    "cup",
                    "--motion",
                    "slide",
                    "--duration",
                    "12",
                    "--domain",
                    str(self.domain),
                    "--no-report",
                    "--record",
                    pathlib.Path(folder, "bag"),
                ],
                stdout=log,
                stderr=subprocess.STDOUT,
            )
            time.sleep(5)
            subprocess.run(["ip", "addr", "del", "10.9.9.1/24", "dev", "d0"], check=True)
            subprocess.run(["ip", "addr", "add", "10.9.9.2/24", "dev", "d0"], check=True)
            up.wait(90)
            log.seek(0)
            text = log.read()
        self.expect(
            "address 10.9.9.1 of d0 was removed" in text, "an address that goes is named", text
        )
        self.expect(
            "ended by signal" not in text and "terminate called" not in text,
            "no node dies of an address that goes",
            text,
        )
        print(text[-1500:])


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--build", type=pathlib.Path, default=HERE / "build", help="build folder")
    parser.add_argument("--domain", type=int, default=68)
    parser.add_argument("--only", nargs="*", help="these rows")
    ask = parser.parse_args()
    if (
        os.geteuid() == 0
        and "VOXTOUCH_IN_NAMESPACE" not in os.environ
        and subprocess.run(["unshare", "-n", "true"], check=False).returncode == 0
    ):
        os.environ["VOXTOUCH_IN_NAMESPACE"] = "1"
        os.execvp("unshare", ["unshare", "-n", sys.executable, *sys.argv])
    if os.environ.get("VOXTOUCH_IN_NAMESPACE") == "1":
        subprocess.run(["ip", "link", "set", "lo", "up"], check=False)
    rows = Rows(ask.build, ask.domain)
    for name in ask.only or (
        "deleted_folder",
        "no_proc",
        "start_faults",
        "nohup",
        "deaf",
        "address_gone",
    ):
        getattr(rows, name)()
    print("FAILED" if rows.faults else "PASSED")
    return 1 if rows.faults else 0


if __name__ == "__main__":
    sys.exit(main())
