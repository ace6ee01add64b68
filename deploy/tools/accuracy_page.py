#!/usr/bin/env python3
"""Writes a page of results from the output of `voxtouch accuracy SCENE --json`.

usage: voxtouch accuracy cup --json | accuracy_page.py > deploy/results/contact_accuracy.md

One row per model, voxel size and shell density. The page names the command, date, machine and
version, so a reader can repeat it.
"""

import argparse
import datetime
import json
import sys


def number(value, digits=2):
    return "–" if value is None else f"{value:.{digits}g}"


def row(r):
    shell = (
        "" if r["shell_voxel_m"] == r["voxel_m"] else f", shell {1e3 * r['shell_voxel_m']:.3g} mm"
    )
    return (
        f"| `{r['model']}`, per {'area' if r['weights'] == 'area' else 'point'} "
        f"| {1e3 * r['voxel_m']:.3g} mm{shell} | {number(r['direction_mean_deg'])}° "
        f"| {number(r['direction_p95_deg'])}° | {number(r['force_ratio'])} "
        f"| {100 * r['magnitude_noise']:.2g} % | {r['missed']} of {r['contacts']} "
        f"| {number(r['median_us'])} µs | {number(r['p95_us'])} µs | {1e-6 * r['bytes']:.2g} MB |"
    )


def page(result):
    condition, options = result["conditions"], result["options"]
    lines = [
        "# Contact accuracy and its time",
        "",
        f"Command: `voxtouch accuracy {result['scene']} --json | deploy/tools/accuracy_page.py`",
        "",
        (
            f"{datetime.date.today()}, voxtouch {condition['version']}, {condition['processor']}, "
            f"{condition['cpus']} processors, load {condition['load_before']:.1f} before and"
        ),
        (
            f"{condition['load_after']:.1f} after, {condition['compiler']}. CPU time of one thread:"
            " compare ratios, not figures."
        ),
        "",
        (
            f"{options['contacts']} random places on the scene, {options['depth_edges']:g} voxels"
            f" deep, seed {options['seed']}. The reference is the law's integral over the tool's "
            f"triangles."
        ),
        (
            "A missed contact counts as 180° of direction error. `force` is the mean force over the"
            " true one;"
        ),
        "`noise` is its relative standard deviation. These are errors of a model against its law.",
        "The [league](league.md) uses other places (row A5); its reference is the nearest point "
        "of the mesh.",
        "",
        (
            "| model | voxel | direction, mean | 95 % | force | noise | missed | time, median | 95"
            " % | memory |"
        ),
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    lines += [row(r) for r in result["rows"]]
    lines += ["", f"Chosen setting: {result['advice']['sentence']}.", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    ).parse_args()
    print(page(json.load(sys.stdin)), end="")
