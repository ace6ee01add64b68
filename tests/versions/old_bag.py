#!/usr/bin/env python3
"""A bag of a version with other layouts is refused with a sentence by `voxtouch view` and `report`;
one without hashes is read.

usage: old_bag.py VOXTOUCH DOMAIN
"""

import json
import pathlib
import subprocess
import sys
import tempfile

HASH = "RIHS01_" + 64 * "0"


def run(*words, patience=60):
    """(exit status, or None if it had to be ended; all output)."""
    with subprocess.Popen(
        [str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as process:
        try:
            said, _ = process.communicate(timeout=patience)
            return process.returncode, said
        except subprocess.TimeoutExpired:
            process.terminate()
            return None, process.communicate()[0]


def main(program, domain):
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        bag = pathlib.Path(folder) / "bag"
        status, said = run(
            program,
            "up",
            "cup",
            "--motion",
            "slide",
            "--duration",
            "1",
            "--lockstep",
            "--record",
            bag,
            "--no-report",
            "--domain",
            domain,
            patience=120,
        )
        recording_file = bag / "voxtouch_recording.json"
        reported = json.loads(recording_file.read_text())
        if status != 0 or reported.get("voxtouch", "").count(".") != 2:
            wrong.append(f"the bag does not state its version: {reported.get('voxtouch')} {said}")
        hashed = [
            one
            for one in reported["topics"]
            if one.get("type_hash", "").startswith("RIHS01_") and one.get("type")
        ]
        if len(hashed) != len(reported["topics"]):
            wrong.append(
                f"only {len(hashed)} of {len(reported['topics'])} topics state their layout"
            )
        for one in hashed:
            if one["type"].endswith("/ContactState"):
                one["type_hash"] = HASH
        reported["voxtouch"] = "0.0.9"
        recording_file.write_text(json.dumps(reported))
        for verb in ("view", "report"):
            status, said = run(program, verb, bag)
            for words in (
                "was recorded by voxtouch 0.0.9",
                "voxtouch_msgs/msg/ContactState is laid out differently",
            ):
                if status != 1 or words not in said:
                    wrong.append(f"{verb}: '{words}' is not said ({status}): {said}")
        for one in reported["topics"]:
            one.pop("type_hash", None)
        del reported["voxtouch"]
        recording_file.write_text(json.dumps(reported))
        status, said = run(program, "view", bag, patience=4)
        if status is not None:
            wrong.append(f"a bag that reports no hashes is not shown: {status} {said}")
    print("\n".join(wrong) or "another layout is refused, an untold one is read")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
