#!/usr/bin/env python3
"""An hour of ring time in lockstep: all processes of `voxtouch up`, observed externally.

    tests/experiments/long_runs/hour_of_ring.py                     # an hour of the cup: 10 min
    tests/experiments/long_runs/hour_of_ring.py --hours 2           # the soak of a release
    tests/experiments/long_runs/hour_of_ring.py --hours 24          # before a long session
    tests/experiments/long_runs/hour_of_ring.py --duration 20       # short form, as in the test

Reads resident memory and CPU time of every process of the ring once a second, and the output of
`up`. Exit status 1: the ring failed, samples are missing, a process grew by more than --growth-kb
after the first tenth, or the fraction of time in contact differs between the first and the last
tenth. Times are only reported.

Resident memory grows by a few MB in steps, up to a limit: each of Cyclone DDS's two receiving
threads fills a buffer of 1 MB, requests another, and frees the first, which the allocator keeps
(observed by interposing malloc: nn_rmsg_new in recv and recvUC, one free for each). Each process
may grow by two buffers per thread and the space between them, 5 MB as measured; with few samples it
fills page by page. --growth-kb permits this, so it misses a slower leak: read the table, which
reports memory after each tenth.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import threading

HERE = pathlib.Path(__file__).resolve().parents[3]
LINE = re.compile(r"^\s*(\d+) samples\s+force\s+([\d.]+) N.*contacts (\d+)")
CONTACT_RATIO_FROM_S = (
    600.0  # below that a tenth is too few rounds of the motion to be like another
)


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--build", type=pathlib.Path, default=HERE / "build", help="build folder")
    parser.add_argument("--scene", type=pathlib.Path, default=HERE / "deploy/scenes/cup.yaml")
    parser.add_argument("--motion", default="slide")
    parser.add_argument("--device", default="sim-phantom")
    length = parser.add_mutually_exclusive_group()
    length.add_argument("--duration", type=float, default=3600.0, help="ring time [s]")
    length.add_argument(
        "--hours",
        type=lambda hours: 3600.0 * float(hours),
        dest="duration",
        help="the same in hours",
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--record",
        type=pathlib.Path,
        help="folder for the bag (an hour is some GB); default: no bag",
    )
    parser.add_argument("--domain", type=int, default=int(os.environ.get("ROS_DOMAIN_ID", "0")))
    parser.add_argument(
        "--growth-kb",
        type=int,
        default=8192,
        help="most that a process may grow after the first tenth",
    )
    return parser.parse_args()


def family(root):
    """Process ids of `root` and all below it, with their names."""
    parents, names = {}, {}
    for entry in os.scandir("/proc"):
        if not entry.name.isdigit():
            continue
        try:
            text = pathlib.Path(entry.path, "stat").read_text()
        except OSError:
            continue  # ended meanwhile
        pid, rest = int(entry.name), text[text.rindex(")") + 2 :].split()
        parents[pid], names[pid] = int(rest[1]), text[text.index("(") + 1 : text.rindex(")")]
    found, grown = {root}, True
    while grown:
        grown = False
        for pid, parent in parents.items():
            if parent in found and pid not in found:
                found.add(pid)
                grown = True
    return {pid: names[pid] for pid in found if pid in names}


def poll(pid):
    """Resident memory [kB] and CPU time [s] of a process; None if it has ended."""
    try:
        pages = int(pathlib.Path(f"/proc/{pid}/statm").read_text().split()[1])
        text = pathlib.Path(f"/proc/{pid}/stat").read_text()
    except (OSError, IndexError):
        return None
    fields = text[text.rindex(")") + 2 :].split()
    cpu = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return pages * os.sysconf("SC_PAGE_SIZE") // 1024, cpu


def places(pid):
    """Resident memory by kind [kB]: the main heap; files; stack; the rest (the heaps of threads,
    buffers, threads' stacks).
    """
    sums = {}
    try:
        text = pathlib.Path(f"/proc/{pid}/smaps").read_text()
    except OSError:
        return sums
    place = ""
    for line in text.splitlines():
        words = line.split()
        if re.match(r"^[0-9a-f]+-[0-9a-f]+$", words[0]):
            name = words[5] if len(words) > 5 else ""
            place = (
                "heap"
                if name == "[heap]"
                else (
                    "files"
                    if name.startswith("/")
                    else "stack"
                    if name.startswith("[stack")
                    else "anonymous"
                )
            )
        elif words[0] == "Rss:":
            sums[place] = sums.get(place, 0) + int(words[1])
    return sums


class Watch:
    """State at each line of `up`: samples so far, force, contacts so far, and each process."""

    def __init__(self, root, samples):
        self.root, self.samples, self.rows, self.reported = root, samples, [], -1
        self.early = self.late = {}

    def line(self, text):
        match = LINE.match(text)
        if not match:
            if text.strip():
                print(text.rstrip(), file=sys.stderr)
            return
        seen = {f"{name} {pid}": poll(pid) for pid, name in family(self.root).items()}
        self.rows.append(
            (int(match[1]), float(match[2]), int(match[3]), {k: v for k, v in seen.items() if v})
        )
        percent = 100 * self.rows[-1][0] // self.samples
        if percent != self.reported:
            self.reported = percent
            kb = sum(v[0] for v in self.rows[-1][3].values())
            self.late = {name: places(int(name.split()[-1])) for name in seen}
            if percent >= 10 and not self.early:
                self.early = self.late
            print(
                f"\r{percent:3} %  {self.rows[-1][0]} samples, {kb} kB",
                end="",
                file=sys.stderr,
                flush=True,
            )

    def ends(self):
        """First and last row of the first tenth and of the last one; as much more as one line a
        second makes it.
        """
        early = [r for r in self.rows if r[0] >= self.samples / 10]
        late = [r for r in self.rows if r[0] <= self.samples * 9 / 10]
        if not early or not late or early[0][0] > late[-1][0] or self.rows[0] is early[0]:
            return None
        return (self.rows[0], early[0]), (late[-1], self.rows[-1])


def judge(watch, args):
    faults = []
    ends = watch.ends()
    if not ends:
        return ["too short to be judged: give it a longer --duration"]
    first, last = ends
    for name, (kb, _) in sorted(last[1][3].items()):
        if name not in first[1][3]:
            faults.append(f"{name} was not there in the first tenth")
            continue
        grown = kb - first[1][3][name][0]
        cpu = [
            (b[3][name][1] - a[3][name][1]) / (b[0] - a[0]) * 1e6
            for a, b in (first, last)
            if name in a[3] and b[0] > a[0]
        ]
        print(
            f"{name:32} {kb:7} kB, {grown:+5} kB since the first tenth; CPU a sample "
            + ", ".join(f"{c:.1f} us" for c in cpu)
            + (f" (ratio {cpu[1] / cpu[0]:.2f})" if len(cpu) == 2 and cpu[0] > 0 else "")
        )
        course = [
            next(
                (
                    r[3][name][0]
                    for r in watch.rows
                    if r[0] >= watch.samples * t / 10 and name in r[3]
                ),
                kb,
            )
            for t in range(1, 10)
        ]
        print(f"{'':32} kB after each tenth: " + " ".join(str(c) for c in [*course, kb]))
        where = {
            place: kb - watch.early.get(name, {}).get(place, 0)
            for place, kb in watch.late.get(name, {}).items()
        }
        print(
            f"{'':32} kB more since the first tenth: "
            + ", ".join(f"{place} {kb:+}" for place, kb in where.items() if kb)
        )
        if grown > args.growth_kb:
            faults.append(f"{name} grew by {grown} kB")
    fraction = [(b[2] - a[2]) / max(b[0] - a[0], 1) for a, b in (first, last)]
    print(
        f"in contact: {100 * fraction[0]:.1f} % of the first tenth, {100 * fraction[1]:.1f} % of"
        f" the last"
    )
    if args.duration >= CONTACT_RATIO_FROM_S and abs(fraction[1] - fraction[0]) > 0.03:
        faults.append(
            f"the tool touches {100 * fraction[1]:.1f} % of the time instead of"
            f" {100 * fraction[0]:.1f} %"
        )
    return faults


def main():
    args = arguments()
    command = [
        args.build / "bin/voxtouch",
        "up",
        args.scene,
        "--lockstep",
        "--json",
        "--motion",
        args.motion,
        "--device",
        args.device,
        "--duration",
        str(args.duration),
        "--seed",
        str(args.seed),
        "--domain",
        str(args.domain),
    ]
    command += ["--record", args.record] if args.record else ["--no-record"]
    up = subprocess.Popen(
        [str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    out = []
    reader = threading.Thread(target=lambda: out.append(up.stdout.read()))
    reader.start()
    watch = Watch(up.pid, round(args.duration * 1000))
    try:
        for text in up.stderr:
            watch.line(text)
    except KeyboardInterrupt:
        pass  # it gets the signal as well
    status = up.wait()
    reader.join()
    print(file=sys.stderr)
    faults = [] if status == 0 else [f"up ended with {status}"]
    summary = json.loads(out[0]) if out and out[0].strip() else {}
    faults += summary.get("problems", [])
    for key, expected in (
        ("ok", True),
        ("samples", watch.samples),
        ("answered", watch.samples),
        ("overruns", 0),
    ):
        if summary.get(key) != expected:
            faults.append(f"{key} is {summary.get(key)}, not {expected}")
    if summary.get("guard", {}).get("refused") != 0:
        faults.append(f"the guard refused {summary.get('guard', {}).get('refused')} commands")
    if summary.get("validator", {}).get("disagree") != 0:
        faults.append("the validator disagrees")
    print(
        f"{summary.get('samples')} samples, {summary.get('contact_samples')} with contact, largest"
        f" force {summary.get('max_force_n')} N, lowest energy"
        f" {summary.get('coupling', {}).get('lowest_energy_j')} J"
    )
    faults += judge(watch, args)
    for fault in faults:
        print("FAULT:", fault)
    print("FAILED" if faults else "PASSED")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
