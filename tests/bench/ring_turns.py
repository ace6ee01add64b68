#!/usr/bin/env python3
"""ring_turns.py --build BUILD --out RESULT.json: our ring next to bare rings of Cyclone DDS
(ring_bench), in turns, so that the machine's load affects all equally. Times are of a whole
round, which is three hops. Results depend on the machine and are only printed."""

import argparse
import datetime
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "deploy/scenes/cup.yaml"


def bare(ask, *more):
    end = subprocess.run(
        [
            ask.build / "bin/ring_bench",
            "--seconds",
            str(ask.seconds),
            "--domain",
            str(ask.domain),
            *more,
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(end.stdout)


def ours(ask, *more):
    """The whole ring with its taps: logger and validator."""
    with tempfile.TemporaryDirectory(prefix="voxtouch_bench_") as folder:
        end = subprocess.run(
            [
                ask.build / "bin/voxtouch",
                "up",
                SCENE,
                "--motion",
                "slide",
                "--duration",
                str(ask.seconds + 2),
                "--domain",
                str(ask.domain),
                "--json",
                "--record",
                f"{folder}/bag",
                "--no-report",
                *more,
            ],
            capture_output=True,
            text=True,
            check=False,
        )
        latency = json.loads(end.stdout)["ring_latency_us"]
    return {"p50_us": latency["p50"], "p99_us": latency["p99"]}


def without_taps(ask, *more):
    """Device, rendering and coupling alone."""
    common = ["--scene", SCENE, "--domain", str(ask.domain), *more]
    null = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    others = [
        subprocess.Popen([ask.build / f"bin/voxtouch_{name}", *common], **null)
        for name in ("rendering", "coupling")
    ]
    watch = subprocess.Popen(
        [ask.build / "bin/ring_bench", "--watch", "haptic", "--domain", str(ask.domain)],
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        time.sleep(2)  # the scene is built
        subprocess.run(
            [
                ask.build / "bin/voxtouch_device",
                *common,
                "--motion",
                "slide",
                "--duration",
                str(ask.seconds + 2),
            ],
            check=False,
            **null,
        )
        return json.loads(watch.communicate(timeout=20)[0])
    finally:
        watch.kill()
        for other in others:
            other.terminate()
        for other in others:
            other.wait()


KINDS = {
    "bare, wait sets": lambda ask: bare(ask),
    "bare, listeners answer": lambda ask: bare(ask, "--way", "listener_answers"),
    "ours": ours,
    "ours without taps": without_taps,
    "bare in one process, wait sets": lambda ask: bare(ask, "--one-process"),
    "bare in one process, listeners answer": lambda ask: bare(
        ask, "--one-process", "--way", "listener_answers"
    ),
    "ours in one process": lambda ask: ours(ask, "--one-process"),
    "bare, wait sets, one CPU": lambda ask: bare(ask, "--cpu", "0"),
    "ours, one CPU": lambda ask: ours(ask, "--cpu", "0"),
    "ours in one process, one CPU": lambda ask: ours(ask, "--one-process", "--cpu", "0"),
}


def calls_in_a_second(pid):
    """System calls of the thread that answers samples, by name, as strace counts them for a
    second.
    """
    end = subprocess.run(
        ["timeout", "-s", "INT", "1", "strace", "-c", "-p", str(pid)],
        capture_output=True,
        text=True,
        check=False,
    )
    rows = re.findall(r"^\s*[\d.]+\s+[\d.]+\s+\d+\s+(\d+)\s+(?:\d+\s+)?(\w+)$", end.stderr, re.M)
    return {name: int(calls) for calls, name in rows if name != "total"}


def system_calls(ask):
    """{ring: {role: {name: calls in a second}}}, ours and the bare one with wait sets; empty if
    strace is missing or not permitted.
    """
    if not shutil.which("strace"):
        return {}
    out = {}
    for ring, words in {
        "bare": [ask.build / "bin/ring_bench", "--seconds", "8", "--domain", str(ask.domain)],
        "ours": [
            ask.build / "bin/voxtouch",
            "up",
            SCENE,
            "--motion",
            "slide",
            "--duration",
            "12",
            "--domain",
            str(ask.domain),
            "--no-record",
            "--json",
        ],
    }.items():
        with subprocess.Popen(
            words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as ring_process:
            time.sleep(6 if ring == "ours" else 3)
            for pid in (
                pathlib.Path(f"/proc/{ring_process.pid}/task/{ring_process.pid}/children")
                .read_text()
                .split()
            ):
                words = pathlib.Path(f"/proc/{pid}/cmdline").read_text().split("\0")
                role = next(
                    (
                        r
                        for r in ("rendering", "coupling")
                        if words[0].endswith(f"voxtouch_{r}") or r in words
                    ),
                    None,
                )
                if role:
                    out.setdefault(ring, {})[role] = calls_in_a_second(pid)
    return out


def write(ask, rounds, calls):
    medians = {
        kind: {
            name: statistics.median(turn[name] for turn in all_of) for name in ("p50_us", "p99_us")
        }
        for kind, all_of in rounds.items()
    }
    ask.out.write_text(
        json.dumps(
            {
                "turns": len(next(iter(rounds.values()))),
                "seconds": ask.seconds,
                "date": str(datetime.date.today()),
                "load": os.getloadavg()[0],
                "rounds": rounds,
                "calls": calls,
                "medians": medians,
            },
            indent=1,
        )
    )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build", help="build folder")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--domain", type=int, default=71)
    parser.add_argument("--turns", type=int, default=9)
    parser.add_argument("--seconds", type=float, default=3.0, help="of each in a turn")
    ask = parser.parse_args()
    rounds = {kind: [] for kind in KINDS}
    for turn in range(ask.turns):
        for kind in (
            KINDS if turn % 2 == 0 else reversed(KINDS)
        ):  # the second one finds the machine as the first left it
            rounds[kind].append(KINDS[kind](ask))
        print(
            f"turn {turn + 1}, load {os.getloadavg()[0]:.1f}: "
            + ", ".join(f"{kind} {rounds[kind][-1]['p50_us']:.0f}" for kind in KINDS)
            + " us",
            flush=True,
        )
        write(ask, rounds, {})  # an aborted run keeps its turns
    write(ask, rounds, system_calls(ask))


if __name__ == "__main__":
    main()
