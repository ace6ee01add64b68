#!/usr/bin/env python3
"""Draws deploy/pictures/stability_map.png: energy that the four contact models give on closed sliding loops.

One command from the repository's root, after `ninja -C build stability_map` (under two minutes on two cores):

    /usr/bin/python3 tests/experiments/stability_map/make_map.py

Needs python3-matplotlib. `--csv FILE` draws what was written before; `--loops`, `--seed` go to the program.
"""
import argparse
import csv
import pathlib
import statistics
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.colors import LogNorm

ROOT = pathlib.Path(__file__).resolve().parents[3]
MODELS = ["original", "adapted", "clustered", "field"]
SHOWN_RADIUS = 5.0  # of the upper row, in voxels
FLOOR = 1e-6
# The bound of core/coupling/passivity.hpp (kSlidingShare) and what sliding_test holds the models to.
BOUND = {"original": 0.15, "adapted": 0.15, "clustered": 0.06, "field": None}


def measured(args):
    if args.csv:
        return pathlib.Path(args.csv)
    program = pathlib.Path(args.program)
    if not program.exists():
        sys.exit(f"{program} is not there; build it with: ninja -C build stability_map")
    out = pathlib.Path(tempfile.mkdtemp()) / "stability_map.csv"
    subprocess.run([program, "--out", out, "--loops", str(args.loops), "--seed", str(args.seed)], check=True)
    return out


def heat(ax, rows, model):
    rows = [r for r in rows if r["model"] == model and r["radius_voxels"] == SHOWN_RADIUS]
    depths = sorted({r["depth_voxels"] for r in rows})
    tilts = sorted({r["tilt_deg"] for r in rows})
    share = {(r["depth_voxels"], r["tilt_deg"]): r for r in rows}
    grid = [[max(share[d, t]["energy_share"], FLOOR) if share[d, t]["mean_force_n"] > 0 else float("nan") for d in depths] for t in tilts]
    image = ax.imshow(grid, origin="lower", aspect="auto", norm=LogNorm(FLOOR, 0.1), cmap="viridis")
    ax.set_facecolor("0.85")
    ax.set_xticks(range(len(depths)), [f"{d:g}" for d in depths], fontsize=9, rotation=60)
    ax.set_yticks(range(len(tilts)), [f"{t:g}" for t in tilts], fontsize=9)
    ax.set_title(model, fontsize=13)
    ax.set_xlabel("depth [voxels]")
    return image


def lines(ax, rows, model):
    rows = [r for r in rows if r["model"] == model and r["mean_force_n"] > 0]
    sizes = sorted({r["radius_voxels"] for r in rows})
    of = {s: [max(r["energy_share"], 1e-12) for r in rows if r["radius_voxels"] == s] for s in sizes}
    x = [1 / s for s in sizes]
    ax.loglog(x, [max(of[s]) for s in sizes], "o-", color="C3", label="largest")
    ax.loglog(x, [statistics.median(of[s]) for s in sizes], "s-", color="C0", label="median")
    if BOUND[model]:
        ax.loglog(x, [BOUND[model] * v for v in x], "k--", label=f"bound {BOUND[model]:g} e/R")
    else:
        ax.loglog([v for v in x if v <= 0.2], [1e-6 for v in x if v <= 0.2], "k--", label="bound 1e-6 for R ≥ 5 e")
    ax.set_xticks(x, [f"1/{s:g}" for s in sizes], fontsize=9)
    ax.minorticks_off()
    ax.set_ylim(1e-11, 0.3 if BOUND[model] else 1e3)
    ax.set_xlabel("voxel edge e over the ball's radius R")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=9, loc="lower right" if BOUND[model] else "upper left")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=ROOT / "build" / "bin" / "stability_map")
    parser.add_argument("--csv", help="draw this instead of measuring")
    parser.add_argument("--out", default=ROOT / "deploy" / "pictures" / "stability_map.png")
    parser.add_argument("--loops", type=int, default=2)
    parser.add_argument("--seed", type=int, default=7)
    args = parser.parse_args()
    with open(measured(args), encoding="utf-8") as file:
        rows = [{k: v if k == "model" else float(v) for k, v in row.items()} for row in csv.DictReader(file)]

    figure, axes = plt.subplots(2, 4, figsize=(14, 7.2), constrained_layout=True)
    for column, model in enumerate(MODELS):
        image = heat(axes[0][column], rows, model)
        lines(axes[1][column], rows, model)
    axes[0][0].set_ylabel(f"tilt against the grid [degrees]\n(R = {SHOWN_RADIUS:g} e)")
    axes[1][0].set_ylabel("energy given / (force × way)\nover all depths and tilts")
    bar = figure.colorbar(image, ax=list(axes[0]), pad=0.01)
    bar.set_label("energy given / (force × way)")
    figure.suptitle(
        "Energy that the contact gives a hand on a closed loop, sliding a ball over a plane: the worst of several loops\n"
        "(0.01: as much as a friction coefficient of 0.01 would take; darkest: next to none, or energy taken)", fontsize=14)
    figure.savefig(args.out, dpi=100)
    print(args.out)


if __name__ == "__main__":
    main()
