#!/usr/bin/python3
"""draw_map.py MAP.csv PICTURE: draws what `build/bin/stability_map --out MAP.csv` measured, in the
style of deploy/tools/plot.py.
"""

import csv
import math
import pathlib
import statistics
import sys

import matplotlib
from matplotlib.colors import LogNorm
from matplotlib.ticker import NullLocator

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "deploy" / "tools"))
from plot import check_picture, save  # noqa: E402
from plot_layout import legend_at_side, new_figure  # noqa: E402
from plot_style import BLUE, ORANGE, STYLE  # noqa: E402

SHOWN_RADIUS, FLOOR = (
    5.0,
    1e-6,
)  # of the upper row: the ball's radius over the voxel edge, and the lowest share that has a colour
BOUND = {
    "original": 0.15,
    "adapted": 0.15,
    "field": None,
}  # times e/R: what sliding_test holds the models to


def draw_heat(axis, rows, model):
    rows = {
        (r["depth_voxels"], r["tilt_deg"]): r
        for r in rows
        if r["model"] == model and r["radius_voxels"] == SHOWN_RADIUS
    }
    depths, tilts = sorted({d for d, _ in rows}), sorted({t for _, t in rows})
    grid = [
        [
            max(rows[d, t]["energy_share"], FLOOR) if rows[d, t]["mean_force_n"] > 0 else math.nan
            for d in depths
        ]
        for t in tilts
    ]
    image = axis.imshow(
        grid, origin="lower", aspect="auto", norm=LogNorm(FLOOR, 0.1), cmap="viridis"
    )
    axis.set_facecolor("0.85")
    axis.set_xticks(range(len(depths)), [f"{d:g}" for d in depths], fontsize=12, rotation=60)
    axis.set_yticks(range(len(tilts)), [f"{t:g}" for t in tilts], fontsize=12)
    axis.grid(False)
    axis.set_title(model, fontweight="bold", fontsize=16)
    axis.set_xlabel("depth [voxel edges]")
    return image


def draw_largest(axis, rows, model):
    """Largest and median share over the voxel's size, and the bound. Shares under the plane leave
    it at its lower edge.
    """
    rows = [r for r in rows if r["model"] == model and r["mean_force_n"] > 0]
    sizes = sorted({r["radius_voxels"] for r in rows})
    x, of = (
        [1 / s for s in sizes],
        {
            s: [max(r["energy_share"], 1e-14) for r in rows if r["radius_voxels"] == s]
            for s in sizes
        },
    )
    axis.loglog(x, [max(of[s]) for s in sizes], "o-", ms=9, lw=2, color=ORANGE, label="largest")
    axis.loglog(
        x, [statistics.median(of[s]) for s in sizes], "s-", ms=9, lw=2, color=BLUE, label="median"
    )
    held = [v for v in x if BOUND[model] or v <= 0.2]
    axis.loglog(
        held,
        [BOUND[model] * v if BOUND[model] else 1e-6 for v in held],
        "--",
        color="black",
        lw=1.8,
        label="bound",
    )
    axis.set_title(f"bound: {BOUND[model]:g} e/R" if BOUND[model] else "bound: 1e-6 for R ≥ 5 e")
    axis.set_xticks(x, [f"1/{s:g}" for s in sizes])
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set_ylim(1e-11, 1)
    axis.set_xlabel("e / R [1]")


def stability_figure(file):
    try:
        with open(file, encoding="utf-8") as lines:
            rows = [
                {k: v if k == "model" else float(v) for k, v in row.items()}
                for row in csv.DictReader(lines)
            ]
    except (OSError, ValueError, TypeError) as error:
        sys.exit(
            f"{file} could not be read ({error}); write it with: build/bin/stability_map --out"
            f" {file}"
        )
    if not rows or "energy_share" not in rows[0]:
        sys.exit(
            f"{file} holds no stability map; write it with: build/bin/stability_map --out {file}"
        )
    note = (
        "A ball of radius R slides over a plane of voxels of edge e; the worst of several loops."
        f" Above: R = {SHOWN_RADIUS:g} e; below: all depths and tilts.\n0.01: as much as a friction"
        " coefficient of 0.01 would take. Darkest: next to none, or energy taken; grey: no"
        " contact. A line that leaves its plane below: less than 1e-11."
    )
    worst = max(rows, key=lambda r: r["energy_share"] if r["mean_force_n"] > 0 else -1.0)
    title = (
        f"Sliding round a closed loop gives the hand at most {100 * worst['energy_share']:.2g} % of"
        f" force × way ({worst['model']})"
    )
    figure, axes = new_figure(title, note, 2, len(BOUND), sharey="row")
    for column, model in enumerate(BOUND):
        image = draw_heat(axes[0][column], rows, model)
        draw_largest(axes[1][column], rows, model)
    axes[0][0].set_ylabel("tilt against the grid [deg]")
    axes[1][0].set_ylabel("energy given / (force × way) [1]")
    figure.colorbar(image, ax=list(axes[0]), pad=0.01).set_label("energy given / (force × way) [1]")
    legend_at_side(axes[1][-1])
    return figure, f"shows {len(rows)} loops' energies"


def main(table, picture):
    check_picture(picture)
    with matplotlib.rc_context(STYLE):
        figure, caption = stability_figure(table)
        save(figure, picture)
    print(f"{picture} {caption}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], pathlib.Path(sys.argv[2]))
