#!/usr/bin/env python3
"""A shipped device file runs: `voxtouch up --device sim:NAME --lockstep` for a stylus and for an
arm, and for a user's file, also at 4 kHz.

usage: shipped_devices.py VOXTOUCH DOMAIN
"""

import json
import pathlib
import subprocess
import sys
import tempfile

SMALLEST = """device: mine
rate_hz: 1000
max_force_n: 5
max_torque_nm: 0
max_stiffness_n_per_m: 900
mass_kg: 0.25
position_resolution_m: 2e-5
grip: pen
"""
FAST = """device: a stylus at 4 kHz
rate_hz: 4000
max_force_n: 8.5
max_torque_nm: 0
max_stiffness_n_per_m: 3500
mass_kg: 0.045
position_resolution_m: 3e-5
grip: pen
delay_s: 0.00025
"""


def up(program, domain, device, *more):
    command = [
        program,
        "up",
        "cup",
        "--device",
        device,
        "--motion",
        "slide",
        "--duration",
        "3",
        "--lockstep",
        "--no-record",
        "--json",
        "--domain",
        domain,
        *more,
    ]
    run = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    return run, json.loads(run.stdout) if run.stdout else {}


def main(program, domain):
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        mine = pathlib.Path(folder) / "mine.yaml"
        mine.write_text(SMALLEST, encoding="utf-8")
        for device, says in (
            ("sim:touch", ""),
            ("sim:fr3", ""),
            (f"sim:{mine}", "assumed values of a stylus: delay_s 0.001"),
        ):
            run, summary = up(program, domain, device)
            if run.returncode != 0 or not summary.get("ok"):
                wrong.append(f"{device}: {run.stderr} {summary.get('problems')}")
            elif summary["contact_samples"] < 100 or summary["max_force_n"] < 0.05:
                wrong.append(
                    f"{device}: hardly a touch, {summary['contact_samples']} samples,"
                    f" {summary['max_force_n']} N"
                )
            if says not in run.stderr:
                wrong.append(f"{device}: '{says}' is not said: {run.stderr}")
        mine.write_text(
            SMALLEST.replace("grip: pen\n", "grip: pen\nworkspace_m: [0.02, 0.02, 0.02]\n"),
            encoding="utf-8",
        )
        run, _ = up(program, domain, f"sim:{mine}")
        if "Increase position_scale" not in run.stderr:
            wrong.append(f"a workspace that is too small is not said: {run.stderr}")
        mine.write_text(FAST, encoding="utf-8")
        run, summary = up(program, domain, f"sim:{mine}", "--one-process")
        if (
            run.returncode != 0
            or not summary["samples"] == summary["answered"] == 12000
            or summary["rate_hz"] != 4000
            or summary["contact_samples"] < 400
        ):
            wrong.append(f"4 kHz in one process: {run.stderr} {summary}")
        for device, says in (
            (
                "sim:nonsense",
                "is neither a file nor a shipped device file. Shipped device files: delta_6, ",
            ),
            (f"sim:{folder}", "This is a folder"),
        ):
            run, summary = up(program, domain, device)
            if run.returncode != 1 or says not in " ".join(summary.get("problems", [])):
                wrong.append(f"{device}: {run.stdout} {run.stderr}")
    print("\n".join(wrong) or "a stylus, an arm and a file of one's own run")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
