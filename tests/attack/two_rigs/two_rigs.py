#!/usr/bin/env python3
"""Two rigs on one host: on one DDS domain with different names, or on two domains. Neither may
disturb the other.

    tests/attack/two_rigs/two_rigs.py                       # ten minutes, both forms
    tests/attack/two_rigs/two_rigs.py --duration 8          # short form, as in the test

Both are in contact with the cup. Half-way the rendering of the left one is killed. The left one
must then end with status 1 and report it, while the right one continues: its bag has one session,
no foreign command, no sample without force, and no message of the left one on its topics. Its
verdict must follow from its own figures: each problem that it reports is one of its figures (for
example a busy machine) and never the other rig. Exit status 1 if a check failed.

A virtual machine stalls occasionally, and no ring answers meanwhile: after 24 ms the guard removes
the force, as it should. Therefore one witness per CPU, with a higher real-time priority than the
rigs if permitted, wakes every millisecond and records when it could not. Force is lost by one long
stall or by several short ones with a late answer after each. A loss of force is attributed to the
machine if one CPU was stalled for 20 of the last 80 ms in total.
"""

import argparse
import json
import os
import pathlib
import signal
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parents[3]
FORCE_ON = 4
LATE_S = 0.003  # a witness that wakes this late reports a stall of its CPU
# A CPU stalled for this long within WINDOW_S explains a lost force: the guard waits 24 ms.
STILL_S = 0.02
WINDOW_S = 0.08  # the guard's time, and that in which the loop catches up, some 20 samples
STATE = struct.Struct("<QQq7d6dII")  # DeviceState, as in its .msg


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--build", type=pathlib.Path, default=HERE / "build", help="build folder")
    parser.add_argument("--duration", type=float, default=300.0, help="seconds of each form")
    parser.add_argument(
        "--domains",
        type=int,
        nargs=2,
        default=[66, 67],
        help="the first for one domain, both for two",
    )
    parser.add_argument(
        "--forms",
        choices=["names", "domains", "both"],
        default="both",
        help="distinguished by rig names, by domains, or first so and then so",
    )
    return parser.parse_args()


class Machine:
    """Stalls of the machine: [(cpu, from, to)], Unix time."""

    WITNESS = """if 1:
        import os, sys, time
        os.sched_setaffinity(0, {int(sys.argv[1])})
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(90))
        except PermissionError:
            pass
        last = time.time()
        while os.getppid() == int(sys.argv[2]):
            time.sleep(0.001)
            now = time.time()
            if now - last > float(sys.argv[3]):
                os.write(1, f"{sys.argv[1]} {last} {now}\\n".encode())  # one write: the file is shared
            last = now
        """

    def __init__(self, folder):
        self.file = folder / "still"
        with open(self.file, "a") as file:
            self.witnesses = [
                subprocess.Popen(
                    [sys.executable, "-c", self.WITNESS, str(cpu), str(os.getpid()), str(LATE_S)],
                    stdout=file,
                )
                for cpu in os.sched_getaffinity(0)
            ]

    def end(self):
        for witness in self.witnesses:
            witness.kill()
            witness.wait()
        rows = (line.split() for line in self.file.read_text().splitlines())
        self.still = [(int(cpu), float(begin), float(end)) for cpu, begin, end in rows]

    def still_before(self, moment):
        """Longest stall of a CPU [s] within WINDOW_S before a moment."""
        by_cpu = {}
        for cpu, begin, end in self.still:
            by_cpu[cpu] = by_cpu.get(cpu, 0.0) + max(
                0.0, min(end, moment) - max(begin, moment - WINDOW_S)
            )
        return max(by_cpu.values(), default=0.0)

    def stood_still_before(self, moment):
        return self.still_before(moment) >= STILL_S


class Rig:
    def __init__(self, ask, name, domain, folder):
        self.name, self.bag = name, folder / name
        self.said, self.output = (
            open(folder / f"{name}.err", "w+"),
            open(folder / f"{name}.out", "w+"),
        )
        self.process = subprocess.Popen(
            [
                ask.build / "bin/voxtouch",
                "up",
                HERE / "deploy/scenes/cup.yaml",
                "--motion",
                "slide",
                "--duration",
                str(ask.duration),
                "--json",
                "--no-report",
                "--rig",
                name,
                "--domain",
                str(domain),
                "--record",
                self.bag,
                "--record-format",
                "sqlite3",
            ],
            stdout=self.output,
            stderr=self.said,
            stdin=subprocess.DEVNULL,
        )

    def lines(self):
        return pathlib.Path(self.said.name).read_text()

    def running(self):
        return " samples  force" in self.lines()

    def node(self, name):
        for entry in os.scandir("/proc"):
            if entry.name.isdigit():
                try:
                    command = pathlib.Path(entry.path, "cmdline").read_bytes().split(b"\0")
                    parent = int(
                        pathlib.Path(entry.path, "stat").read_text().rsplit(")", 1)[1].split()[1]
                    )
                except (OSError, IndexError):
                    continue
                if parent == self.process.pid and command[0].endswith(f"voxtouch_{name}".encode()):
                    return int(entry.name)
        raise RuntimeError(f"{self.name} has no {name}")

    def end(self, patience):
        self.status = self.process.wait(patience)
        self.summary = json.loads(pathlib.Path(self.output.name).read_text())

    def states(self):
        """(Unix time, session, force on) of each recorded sample."""
        found = []
        for file in sorted(self.bag.glob("*.db3")):
            with sqlite3.connect(f"file:{file}?mode=ro", uri=True) as database:
                rows = database.execute(
                    (
                        "select timestamp, data from messages join topics on topics.id = topic_id"
                        " where name = ? order by messages.id"
                    ),
                    (f"/{self.name}/device/state",),
                )
                for written_ns, data in rows:
                    session, *rest = STATE.unpack(data[4 : 4 + STATE.size])
                    found.append((written_ns * 1e-9, session, bool(rest[-1] & FORCE_ON)))
        return found


def play(ask, form, domains):
    faults = []
    with tempfile.TemporaryDirectory(prefix="voxtouch_test_two_rigs_") as folder:
        machine = Machine(pathlib.Path(folder))
        rigs = [
            Rig(ask, name, domain, pathlib.Path(folder))
            for name, domain in zip(("left", "right"), domains)
        ]
        try:
            until = time.monotonic() + 60
            while not all(rig.running() for rig in rigs):
                if time.monotonic() > until or any(rig.process.poll() is not None for rig in rigs):
                    return [
                        f"{form}: the rigs did not both start: "
                        + " | ".join(rig.lines()[-300:] for rig in rigs)
                    ]
                time.sleep(0.05)
            time.sleep(ask.duration / 2)
            os.kill(rigs[0].node("rendering"), signal.SIGKILL)
            for rig in rigs:
                rig.end(ask.duration + 60)
        finally:
            for rig in rigs:
                if rig.process.poll() is None:
                    rig.process.terminate()
                    rig.process.wait(30)
            machine.end()
        left, right = rigs
        if left.status != 1 or not any("rendering" in p for p in left.summary["problems"]):
            faults.append(
                f"the left rig lost its rendering and ends with {left.status}:"
                f" {left.summary['problems']}"
            )
        faults += [
            f"the right rig names the left: {p}"
            for p in right.summary["problems"]
            if "left" in p or "rendering ended" in p or "writer" in p
        ]
        if (right.status == 0) != (not right.summary["problems"]):
            faults.append(
                f"the right rig ends with {right.status} and these problems:"
                f" {right.summary['problems']}"
            )
        guard = right.summary["guard"]
        if (
            guard["refused"] > guard["refused_late"]
        ):  # late ones belong to the rig: its coupling was blocked for a while
            faults.append(
                f"the right guard refused {guard['refused'] - guard['refused_late']} commands that"
                " were not its coupling's or not in order"
            )
        for rig in rigs:
            states = rig.states()
            sessions = {session for _, session, _ in states}
            if len(sessions) != 1:
                faults.append(f"the bag of {rig.name} holds {len(sessions)} sessions")
            if rig is right:
                first = next((n for n, (_, _, on) in enumerate(states) if on), len(states))
                lost = [moment for moment, _, on in states[first:] if not on]
                by_machine = sum(map(machine.stood_still_before, lost))
                if first == len(states) or len(lost) > by_machine:
                    faults.append(
                        f"the right rig lost its force at {len(lost) - by_machine} of"
                        f" {len(states) - first} samples, with the machine running: its CPUs stood"
                        " still for"
                        f""
                        f" {', '.join(f'{1000 * machine.still_before(moment):.0f}' for moment in lost[:20])} ms"
                        f" of the {1000 * WINDOW_S:.0f} before"
                    )
        print("\n".join(right.summary["problems"]))
        longest = max((end - begin for _, begin, end in machine.still), default=0)
        print(
            f"figure: {form}: {right.summary['samples']} samples at"
            f" {right.summary['rate_hz']:.0f} Hz, {guard['refused']} commands refused"
            f" ({guard['refused_late']} as too late), {len(lost)} samples without force"
            f" ({by_machine} while a CPU stood still); CPUs stood still {len(machine.still)} times,"
            f" {1000 * longest:.0f} ms at most; exit status {left.status} and {right.status}"
        )
    return [f"{form}: {fault}" for fault in faults]


def main():
    ask = arguments()
    faults = []
    if ask.forms in ("names", "both"):
        faults += play(ask, "one domain, two names", [ask.domains[0], ask.domains[0]])
    if ask.forms in ("domains", "both"):
        faults += play(ask, "two domains", ask.domains)
    for fault in faults:
        print("FAULT:", fault)
    print("FAILED" if faults else "PASSED")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
