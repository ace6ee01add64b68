#!/usr/bin/env python3
"""Writes the table in deploy/devices/README.md: certified stiffness of each shipped device file.

usage: device_table.py VOXTOUCH             writes the table; VOXTOUCH: the program, such as
                                            build/bin/voxtouch
       device_table.py VOXTOUCH --check     compares instead; exit status 1 if the table differs,
                                            or a design fails
"""

import json
import pathlib
import re
import subprocess
import sys

DEVICES = pathlib.Path(__file__).resolve().parents[1] / "devices"
README = DEVICES / "README.md"
BEGIN, END = "<!-- what `deploy/tools/device_table.py` writes begins -->\n", "<!-- and ends -->\n"
HEAD = """| device | class | least mass | force | requested | certified | 10 mm deep | limited by | measured by |
|---|---|---|---|---|---|---|---|---|
"""


def figure(text, key):
    """The first number of a key in a device file."""
    return float(re.search(rf"^{key}:\s*\[?\s*([-+.\de]+)", text, re.MULTILINE).group(1))


def measured_by(text):
    """Command and date of the measurement, as `voxtouch identify` writes them."""
    found = re.search(
        r"^measured:\n  date: \"?([-\d]+)\"?\n  command: \"voxtouch (\w+)", text, re.M
    )
    return f"{found.group(2)}, {found.group(1)}" if found else "none"


def design(program, file):
    """Output of `voxtouch design --json`; exit status 1 means that nothing can be certified, which
    is a valid result too.
    """
    run = subprocess.run(
        [program, "design", "--device", file, "--json"],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if not run.stdout:
        raise SystemExit(f"{file.name}: {run.stderr.strip()}")
    return json.loads(run.stdout)


def row(program, file):
    text, answer = file.read_text(encoding="utf-8"), design(program, file)
    axis, force = answer["translation"], figure(text, "max_force_n")
    displayed = 0.0 if answer["status"] == "infeasible" else axis["displayed_stiffness"]
    grip = "arm" if re.search(r"^grip:\s*arm", text, re.MULTILINE) else "stylus"
    limit = (
        "device limit" if displayed >= 0.999 * axis["requested_stiffness"] else axis["worst_case"]
    )
    return (
        f"| [{file.stem}]({file.name}) | {grip} | {figure(text, 'mass_kg'):g} kg | {force:g} N |"
        f" {axis['requested_stiffness']:.0f} N/m | {displayed:.0f} N/m |"
        f" {min(force, 0.01 * displayed):.2g} N"
        f" | {limit} | {measured_by(text)} |\n"
    )


def main(program, *options):
    files = sorted(DEVICES.glob("*.yaml"))
    table = HEAD + "".join(row(pathlib.Path(program).resolve(), file) for file in files)
    text = README.read_text(encoding="utf-8")
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    new = before + BEGIN + table + END + after
    if "--check" in options:
        if new != text:
            raise SystemExit(
                f"{README.name} has a different table than the designer's; "
                f"`deploy/tools/device_table.py {program}` writes it:\n{table}"
            )
        print(f"{len(files)} devices: the table is what the designer certifies")
        return
    README.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    main(*sys.argv[1:])
