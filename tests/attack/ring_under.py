#!/usr/bin/env python3
"""A ring in contact with the cup while a program attacks it.

    tests/attack/ring_under.py --build build --domain 64 -- build/bin/some_attack --domain 64
    --seconds 10

Starts `voxtouch up`, waits for contact, runs the program, waits for the end of the ring, and
checks: `up` ends by itself, no process is lost, the device never gets more force than the contact
gives, and exit status and reported problems agree. The program must end with 0. Exit status 1 if a
check failed.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parents[2]
FORCE_LINE = re.compile(r"samples\s+force\s+([\d.]+) N")


def arguments():
    own = sys.argv[1 : sys.argv.index("--")] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--build", type=pathlib.Path, default=HERE / "build", help="build folder")
    parser.add_argument("--domain", type=int, default=64)
    parser.add_argument(
        "--duration",
        type=float,
        default=15.0,
        help="of the ring [s]; the attack has to be over by then",
    )
    parser.add_argument(
        "--most",
        type=float,
        default=1.0,
        help="more force than this never reaches the device [N]; 0.32 is right",
    )
    ask = parser.parse_args(own)
    ask.attack = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    return ask


def figure(summary, key):
    """The first number of this name, anywhere in the summary."""
    for name, value in summary.items():
        if name == key and isinstance(value, (int, float)):
            return value
        if isinstance(value, dict) and (found := figure(value, key)) is not None:
            return found
    return None


def main():
    ask = arguments()
    faults = []
    with tempfile.TemporaryDirectory(prefix="voxtouch_test_under_") as folder:
        said, output = pathlib.Path(folder, "err"), pathlib.Path(folder, "out")
        with open(said, "w") as err, open(output, "w") as out:
            up = subprocess.Popen(
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
                    "--domain",
                    str(ask.domain),
                    "--record",
                    pathlib.Path(folder, "bag"),
                ],
                stdout=out,
                stderr=err,
                stdin=subprocess.DEVNULL,
            )
        try:
            until = time.monotonic() + 60
            while not any(float(f) > 0.05 for f in FORCE_LINE.findall(said.read_text())):
                if time.monotonic() > until or up.poll() is not None:
                    print("FAULT: the ring did not come into contact:", said.read_text()[-500:])
                    return 1
                time.sleep(0.05)
            if ask.attack:
                attack = subprocess.run(ask.attack, capture_output=True, text=True, timeout=600)
                print(attack.stdout.strip())
                if attack.returncode:
                    faults.append(
                        f"the attack itself ended with {attack.returncode}: {attack.stderr[-300:]}"
                    )
                if up.poll() is not None:
                    faults.append("`up` ended before the attack did")
            up.wait(ask.duration + 60)
        except subprocess.TimeoutExpired:
            faults.append("`up` does not end")
        finally:
            if up.poll() is None:
                up.terminate()
                up.wait(30)
        text = output.read_text()
        summary = json.loads(text) if text.startswith("{") else None
        if summary is None:
            faults.append(
                f"`up` ended with {up.returncode} and reported nothing: {said.read_text()[-500:]}"
            )
        else:
            problems, force = summary["problems"], figure(summary, "max_force_n")
            faults += [
                f"lost: {p}" for p in problems if "ended by signal" in p or "ended with status" in p
            ]
            if (up.returncode == 0) != (not problems):
                faults.append(f"`up` ends with {up.returncode} and these problems: {problems}")
            if force is None or not 0.05 < force <= ask.most:
                faults.append(f"{force} N reached the device, at most {ask.most} are right")
            print("\n".join(problems))
            print(
                f"figure: largest force {force:.3f} N, {summary['samples']} samples, `up` ended"
                f" with {up.returncode} and {len(problems)} problems"
            )
    for fault in faults:
        print("FAULT:", fault)
    print("FAILED" if faults else "PASSED")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
