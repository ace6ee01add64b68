"""Cost of accuracy, from a result of `voxtouch accuracy --json`: the errors over the time of a
frame, and all of it on one page.
"""

import math

from plot_layout import *  # noqa: F403

LEAST_DIRECTION_DEG, LEAST_NOISE_PERCENT = (
    1e-3,
    1e-2,
)  # lowest displayed value, ten times below perception


def size_word(row):
    edge, shell = row["voxel_m"] * 1e3, row["shell_voxel_m"] * 1e3
    return f"{edge:.4g}" if edge == shell else f"{edge:.4g}/{shell:.4g}"


def lines_of(rows):
    """Rows that one thin line joins: of the same model, weights and density of the shell."""
    out = {}
    for row in rows:
        out.setdefault(
            (row["model"], row["weights"], round(row["voxel_m"] / row["shell_voxel_m"], 6)), []
        ).append(row)
    return out


def draw_points(axis, rows, value, labelled):
    """The marks, and for `labelled` their legend and sizes: filled for area weights, hollow for
    unit weights."""
    named, marks = set(), []
    for (model, weights, _), line in lines_of(rows).items():
        colour, mark = MODELS.get(model, (PURPLE, "v"))
        new = labelled and (model, weights) not in named
        named.add((model, weights))
        axis.plot(
            [r["median_us"] for r in line],
            [value(r) for r in line],
            "-",
            marker=mark,
            color=colour,
            lw=1.2,
            ms=11,
            mew=2.2,
            zorder=3,
            mfc=colour if weights == "area" else "white",
            label=f"{model}, weight {weights}" if new else None,
        )
        marks += [(r["median_us"], value(r), size_word(r), colour) for r in line]
    return marks


def choice_word(advice):
    return (
        "knee"
        if advice["met"] is None and advice["knee"] is not None
        else {None: "best", True: "advised", False: "nearest"}[advice["met"]]
    )


def timed_note(rows):
    queries = [r["queries_per_frame"] for r in rows if r["model"] == "virtual_tool"]
    return (
        f"; virtual tool: the hand slides 1/40 e a frame, {queries[0]:.2g} queries each"
        if queries
        else ""
    )


def accuracy_title(data, direction):
    if data["advice"]["row"] is None:
        return "Accuracy and time: no setting chosen"
    row = data["rows"][data["advice"]["row"]]
    return (
        f"Accuracy and time; {choice_word(data['advice'])}: {row['model']} at"
        f" {size_word(row)} mm, {direction(row):.2g} deg error in {row['median_us']:.2g} µs a frame"
    )


def accuracy_figure(data):
    rows = [
        r
        for r in data["rows"]
        if r.get("median_us") is not None and r.get("direction_mean_deg") is not None
    ]
    requested, advice, missing = data["request"], data["advice"], len(data["rows"]) - len(rows)

    def direction(row):
        return max(row["direction_mean_deg"], LEAST_DIRECTION_DEG)

    def noise(row):
        return max(100.0 * (row["magnitude_noise"] or 0.0), LEAST_NOISE_PERCENT)

    shells = any(r["voxel_m"] != r["shell_voxel_m"] for r in rows)
    load = data["conditions"]["load_after"]
    note = (
        f"Scene {data['scene']}: {data['options']['contacts']} random contacts,"
        f" {data['options']['depth_edges']:g} e deep, seed "
        f"{data['options']['seed']}{f'; {missing} settings not measured' if missing else ''}. Lower"
        " left is better. "
        "Shell points have weight one or their area. A missed contact counts as 180 deg.\n"
        f"At the marks: voxel edge e{' / the shell' if shells else ''} [mm]. Time: one thread of"
        f" {processor_name(data)}"
        f"{'' if load is None else f', load average {load:.1f}'}{timed_note(rows)}"
    )
    figure, axes = new_figure(
        accuracy_title(data, direction), note, 2, sharex=True, height_ratios=(2.3, 1)
    )
    top, bottom = axes[0][0], axes[1][0]
    marks = draw_points(top, rows, direction, True)
    draw_points(bottom, rows, noise, False)
    log_axis(
        bottom.xaxis,
        *decade_round(
            [r["median_us"] for r in rows]
            + ([requested["within_us"]] if requested["within_us"] else [])
        ),
    )
    log_axis(
        top.yaxis,
        *decade_round(
            [direction(r) for r in rows]
            + ([requested["direction_deg"]] if requested["direction_deg"] else [])
        ),
    )
    log_axis(
        bottom.yaxis,
        *decade_round(
            [noise(r) for r in rows] + ([100 * requested["noise"]] if requested["noise"] else [])
        ),
    )
    front = [data["rows"][i] for i in advice["front"]]
    if front:  # from the top edge to the fastest, along the Pareto front, to the right edge
        x, y = [r["median_us"] for r in front], [direction(r) for r in front]
        top.step(
            [x[0]] + x + [top.get_xlim()[1]],
            [top.get_ylim()[1]] + y + [y[-1]],
            where="post",
            color="#222222",
            lw=1.8,
            zorder=2,
            label="Pareto front: least\nerror within each time",
        )
    if advice["row"] is not None:
        row = data["rows"][advice["row"]]
        top.plot(
            [row["median_us"]],
            [direction(row)],
            "o",
            ms=23,
            mfc="none",
            mec=RED,
            mew=2.2,
            ls="none",
            zorder=4,
            label=f"{choice_word(advice)}: {row['model']},\n{row['weights']}, {size_word(row)} mm",
        )
    if requested["direction_deg"]:
        top.axhline(
            requested["direction_deg"],
            color=RED,
            ls="--",
            label=f"requested: {requested['direction_deg']:.4g} deg",
        )
    if requested["noise"]:
        bottom.axhline(100 * requested["noise"], color=RED, ls="--")
    if requested["within_us"]:
        top.axvline(
            requested["within_us"],
            color=RED,
            ls="--",
            label=f"requested: within {requested['within_us']:.4g} µs",
        )
    if not rows:
        top.text(0.5, 0.5, "no measurement", transform=top.transAxes, ha="center")
    least = any(direction(r) <= LEAST_DIRECTION_DEG for r in rows)
    top.set_ylabel(
        "direction error, mean [deg]"
        + (f"\nlowest: {LEAST_DIRECTION_DEG:g} or less" if least else "")
    )
    least = any(noise(r) <= LEAST_NOISE_PERCENT for r in rows)
    bottom.set_ylabel(
        "noise, std / mean [%]" + (f"\nlowest: {LEAST_NOISE_PERCENT:g} or less" if least else "")
    )
    bottom.set_xlabel("CPU time of one frame, median [µs]")
    if top.get_legend_handles_labels()[0]:
        legend_at_side(top, labelspacing=0.8)
    label_marks(
        top,
        marks,
        (
            []
            if advice["row"] is None
            else [
                (data["rows"][advice["row"]]["median_us"], direction(data["rows"][advice["row"]]))
            ]
        ),
    )
    return figure, f"plots the errors of {len(rows)} settings over their times"


# -------------------- all on one page
def page_rows(data):
    """At the scene's voxel size, one row per model: area weights, the shell as dense as the
    voxels."""
    out = {}
    for row in data["rows"]:
        own = (
            math.isclose(row["voxel_m"], data["scene_voxel_m"])
            and row["voxel_m"] == row["shell_voxel_m"]
            and row["weights"] == "area"
        )
        if own and row.get("median_us") is not None and row["depths"]:
            out.setdefault(row["model"], row)
    return list(out.values())


def worst_depth(row):
    """The depth at which the mean force differs most from the true one, by its ratio in either
    direction."""
    return max(row["depths"], key=lambda d: abs(math.log(max(d["force_ratio"], 1e-6))))


def page_title(rows):
    """The models that are best and worst at their worst depth: at a single depth a curve may cross
    1.
    """
    if not rows:
        return "Accuracy and time: no measurement at the scene's voxel edge"
    worst = {r["model"]: worst_depth(r) for r in rows}

    def said(model):
        percent = float(
            f"{100 * worst[model]['force_ratio']:.2g}"
        )  # two digits, and no exponent from 100 % on
        return f"{model.replace('_', ' ')} {percent:g} % ({worst[model]['edges']:g} e)"

    best, last = (
        choose(worst, key=lambda m: abs(math.log(max(worst[m]["force_ratio"], 1e-6))))
        for choose in (min, max)
    )
    title = f"Fraction of the true force at the worst depth: {said(best)}"
    return title if best == last else f"{title}, {said(last)}"


def page_figure(data):
    rows, edge = page_rows(data), 1e3 * data["scene_voxel_m"]
    judged = max((d["contacts"] + d["missed"] for r in rows for d in r["depths"]), default=0)
    note = (
        f"Scene {data['scene']}, {judged} random contacts, pressed slowly; points have area "
        f"weight; missed contacts count as 180 deg. Time: one thread of {processor_name(data)},"
        f" compare ratios{timed_note(rows)}.\nTruth: the law integrated over the exact tool; for "
        f"the virtual tool a reference tool that follows the hand."
    )
    figure, axes = new_figure(page_title(rows), note, 2, 2)
    force, direction, noise, cost = axes[0][0], axes[0][1], axes[1][0], axes[1][1]
    for n, row in enumerate(rows):
        colour, mark = MODELS.get(row["model"], (PURPLE, "v"))
        look = {"color": colour, "marker": mark, "ms": 9, "lw": 2.0, "zorder": 3}
        x = [d["edges"] for d in row["depths"]]
        force.plot(x, [d["force_ratio"] for d in row["depths"]], **look)
        direction.plot(
            x,
            [max(d["direction_mean_deg"], LEAST_DIRECTION_DEG) for d in row["depths"]],
            label=row["model"].replace("_", " "),
            **look,
        )
        noise.plot(
            x, [max(100 * d["magnitude_noise"], LEAST_NOISE_PERCENT) for d in row["depths"]], **look
        )
        cost.plot(
            [row["median_us"], row["worst_us"]],
            [n, n],
            "-",
            color=colour,
            lw=3,
            solid_capstyle="butt",
        )
        cost.plot([row["p95_us"]], [n], "|", color=colour, ms=22, mew=3)
        cost.plot([row["median_us"]], [n], mark, color=colour, ms=12)
        cost.annotate(
            f"{row['median_us']:.2g}",
            (row["median_us"], n),
            textcoords="offset points",
            xytext=(0, 10),
            ha="center",
            fontsize=13,
            color=colour,
        )
    force.axhline(1.0, color=INK, ls="--", lw=1.6, zorder=2)
    depths = sorted({d["edges"] for r in rows for d in r["depths"]}) or [0.5, 1.0]
    for axis in (force, direction, noise):
        log_axis(axis.xaxis, depths[0] / 1.15, depths[-1] * 1.15)
        axis.set_xticks(depths)
    force.set_ylim(0.0, 1.1 * max([1.2] + [d["force_ratio"] for r in rows for d in r["depths"]]))
    force.set_ylabel("force over the true one [1]")
    log_axis(
        direction.yaxis,
        *decade_round(
            [max(d["direction_mean_deg"], LEAST_DIRECTION_DEG) for r in rows for d in r["depths"]]
        ),
    )
    direction.set_ylabel("direction error, mean [deg]")
    log_axis(
        noise.yaxis,
        *decade_round(
            [
                max(100 * d["magnitude_noise"], LEAST_NOISE_PERCENT)
                for r in rows
                for d in r["depths"]
            ]
        ),
    )
    noise.set_ylabel("noise, std / mean [%]")
    for axis in (force, direction, noise):
        axis.set_xlabel(f"depth [e]; 1 e = {edge:g} mm")
    log_axis(cost.xaxis, *decade_round([r[key] for r in rows for key in ("median_us", "worst_us")]))
    cost.set_yticks(range(len(rows)), [r["model"].replace("_", " ") for r in rows])
    cost.set_ylim(len(rows) - 0.4, -0.7)
    cost.set_xlabel("CPU time of one frame: median, 95 % and worst [µs]")
    if rows:
        legend_at_side(direction)
    return figure, f"plots accuracy and time of {len(rows)} models"
