#!/usr/bin/env python3
"""A ring under --security next to each network attack, including forged GUIDs of its own nodes:
nothing reaches the loop, and no start fails.

    tests/attack/secured.py --build build --domain 68

For each attack: a ring runs in contact, the attack begins, the ring ends; a second ring starts
during the attack. Counts foreign samples received by any node, refused starts, and runs with a
problem. Finally the forger attacks a plain ring, which must fail: otherwise the test would prove
nothing. Exit status 1 if a check failed.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parents[2]
LIFTED = [
    "first_answer_s=inf",
    "answered_ratio=0",
    "rate_ratio=0",
    "overrun_ratio=inf",
    "deadline_miss_ratio=inf",
    "first_validation_s=inf",
    "validated_ratio=0",
    "compared_ratio=0",
    "first_recorded_s=inf",
    "recorded_ratio=0",
    "silence_s=inf",
    "force_losses=inf",
]  # effects of a busy machine


def attacks(ask):
    at = ["--domain", str(ask.domain), "--seconds"]
    return {
        "forge": ["forge", *at, "18"],
        "garbage": ["garbage_rtps", *at, "16", "--rate", "3000"],
        "flood": ["flood", *at, "0.8"],
    }


class Ring:
    def __init__(self, ask, duration, more):
        self.err = tempfile.TemporaryFile("w+")
        limits = [word for limit in LIFTED for word in ("--limit", limit)]
        self.process = subprocess.Popen(
            [
                ask.build / "bin/voxtouch",
                "up",
                HERE / "deploy/scenes/cup.yaml",
                "--motion",
                "slide",
                "--duration",
                str(duration),
                "--json",
                "--no-record",
                "--domain",
                str(ask.domain),
                *limits,
                *more,
            ],
            stdout=subprocess.PIPE,
            stderr=self.err,
            stdin=subprocess.DEVNULL,
            text=True,
        )

    def said(self):
        self.err.seek(0)
        return self.err.read()

    def in_contact(self):
        until = time.monotonic() + 30
        while time.monotonic() < until and self.process.poll() is None:
            if any(
                "force" in line and "force   0.00" not in line
                for line in self.said().splitlines()
                if " samples " in line
            ):
                return True
            time.sleep(0.05)
        return False

    def end(self):
        try:
            out, _ = self.process.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            self.process.kill()
            out, _ = self.process.communicate()
        return (
            json.loads(out)
            if out.startswith("{")
            else {"ok": False, "problems": ["reports nothing"]}
        )


def errors(*rings):
    return "; ".join(
        line for ring in rings for line in ring.said().splitlines() if line.startswith("error")
    )


def naming_unauthorised(ask, keys):
    """Nodes that report a refusal of foreign samples; None: no node is received."""
    status = subprocess.run(
        [
            ask.build / "bin/voxtouch",
            "status",
            "--json",
            "--domain",
            str(ask.domain),
            "--security",
            keys,
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    nodes = (
        json.loads(status.stdout).get("rigs", {}).get("haptic", [])
        if status.stdout.startswith("{")
        else []
    )
    return sum("refused" in node["sentence"] for node in nodes) if nodes else None


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--build", type=pathlib.Path, default=HERE / "build", help="build folder")
    parser.add_argument("--domain", type=int, default=68)
    parser.add_argument("--only", nargs="+", default=["forge", "garbage", "flood"])
    ask = parser.parse_args()
    faults, taken, refused, answered = [], 0, 0, []
    with tempfile.TemporaryDirectory(prefix="voxtouch_test_secured_") as folder:
        keys = str(pathlib.Path(folder, "keys"))
        subprocess.run(
            [ask.build / "bin/voxtouch", "keys", "--out", keys],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        for name, words in attacks(ask).items():
            if name not in ask.only:
                continue
            first = Ring(ask, 9, ["--security", keys])
            if not first.in_contact():
                faults.append(f"{name}: the ring did not come into contact: {first.said()[-300:]}")
            attack = subprocess.Popen(
                [ask.build / "bin" / words[0], *words[1:]], stdout=subprocess.PIPE, text=True
            )
            time.sleep(1.5)
            named = naming_unauthorised(ask, keys)
            runs = [first.end()]
            second = Ring(ask, 4, ["--security", keys])
            if not second.in_contact():
                refused += 1
                faults.append(f"{name}: a ring does not start: {second.said()[-300:]}")
            runs.append(second.end())
            print(
                attack.communicate(timeout=120)[0].strip().splitlines()[-1]
                if name != "flood"
                else attack.communicate(timeout=120)[0].strip().splitlines()[0]
            )
            had = sum(
                run["guard"]["refused"] - run["guard"]["refused_late"]
                for run in runs
                if "guard" in run
            )
            taken += had
            if had or named != 0:
                faults.append(
                    f"{name}: {had} foreign commands reached the device, {named} nodes name"
                    " unauthorised participants"
                )
            for run in runs:
                faults += [
                    f"{name}: {problem} ({errors(first, second)})" for problem in run["problems"]
                ]
                answered.append(100.0 * run.get("answered", 0) / max(1, run.get("samples", 1)))
            print(
                f"figure: {name}: {had} foreign commands, {named} nodes name an unauthorised"
                " participant, answered "
                + " and ".join(f"{fraction:.1f} %" for fraction in answered[-2:])
            )
        print(f"figure: {taken} foreign samples reached the loop, {refused} starts were refused")
        if "forge" in ask.only:
            plain = Ring(ask, 9, [])
            plain.in_contact()
            attack = subprocess.Popen(
                [ask.build / "bin/forge", "--domain", str(ask.domain), "--seconds", "5"],
                stdout=subprocess.DEVNULL,
            )
            run = plain.end()
            attack.wait(60)
            print("\n".join(run["problems"]))
            print(
                "figure: the same forgeries next to a ring without security:"
                f" {len(run['problems'])} problems"
            )
            if run["ok"]:
                faults.append("a plain ring does not suffer either: the forger proves nothing")
    for fault in faults:
        print("FAULT:", fault)
    print("FAILED" if faults else "PASSED")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
