"""The league's page and pictures, from result.json."""

import notes


def number(value):
    if 0 < abs(value) < 0.001:
        return "< 0.001"
    return f"{value:.0f}" if abs(value) >= 10 else f"{value:.2g}"


def cell(judge, a):
    if isinstance(a, str):
        return a.split(":")[0], "", ""
    us = a.get("us_median", float("nan"))
    time = f"{number(us)} µs" if us == us else "-"
    if judge == "rest":
        return f"{number(a['sink_mm'])} mm", f"{number(a['creep_mm'])} mm", time
    if judge == "loop":
        return f"{a['held']}; {a['released']}", a["warned"], time
    if judge == "hammer":
        thread = "held" if a["held"] else "skipped"
        return f"shifts {number(a['shift_mm'])} mm", thread, time
    if judge == "lock":
        return f"from {a['friction']:.3f} on", f"{a['expected']:.4f}", time
    if judge == "advance":
        return f"{a['advance_mm']:.3f} mm a turn", f"{a['expected_mm']:.3f} mm", time
    if judge in ("direction", "torque"):
        torque = f", torque {a['torque_ratio']:.3f}" if "torque_ratio" in a else ""
        return (
            f"{number(a['mean_deg'])}°, {number(a['p95_deg'])}°",
            f"{a['missed']} of {a['of']} missed{torque}",
            time,
        )
    if judge == "free":
        return f"{a['touched']} of {a['of']} touched", "", time
    kept = "passed through" if a["passed"] else f"{a['force_ratio']:.3f} of k d"
    inside = f"{number(a['penetration_mm'])} mm, {number(a['mean_deg'])}°"
    return kept, f"{inside}, {number(100 * a['noise'])} %", time


LEAST_DEG = 0.01
SLIDE = "C4 cup 371 N/m"  # of spring systems in the picture of errors
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v"]

HEADS = {
    "direction": "| direction error: mean, 95 % | missed | time, median |",
    "free": "| free poses with a force | | time, median |",
    "torque": "| torque's direction error: mean, 95 % | missed | time, median |",
    "spring": "| force | penetration, direction error, noise | time of a step, median |",
    "advance": "| nut moves along | pitch | time of a step, median |",
    "rest": "| sinks by | moves in the last 0.5 s | time of a step, median |",
    "loop": "| held; released | warned | time of a step, median |",
    "hammer": "| nut | thread | time of a step, median |",
    "lock": "| locks | ideal helix | time of a step, median |",
}


def own_first(item):
    return not item[0].startswith("voxtouch"), item[0]


def refusals(answers):
    """Lines with the reasons of all systems that have no figures."""
    by_reason = {}
    for system, answer in sorted(answers.items(), key=own_first):
        if isinstance(answer, str):
            by_reason.setdefault(answer, []).append(system)
    lines = []
    for reason, systems in by_reason.items():
        lines += notes.paragraph(f"{', '.join(systems)}: {reason}.")
    return lines


def reproduction(found):
    """Paragraphs about a second run on this machine, and one on another."""
    texts = []
    if again := found.get("again"):
        texts.append(f"Second run on this machine: {of_differences(again)}")
    if against := found.get("against"):
        texts.append(f"Run on {against['machine']}: {of_differences(against)}")
    if not texts:
        texts.append("Played once.")
    return [line for text in texts for line in ["", *notes.paragraph(text)[:-1]]]


def of_differences(found):
    differ = found["differ"]
    text = f"of {found['figures']} errors that both have, {len(differ)} differ by more than 10 %"
    return text + (f": {'; '.join(differ)}." if differ else ".")


def markdown(result):
    lines = [
        "# League: contact libraries on the same poses",
        "",
        "Command: `deploy/bench league`",
        "",
        f"{result['conditions']['date']}, {result['conditions']['machine']}, "
        f"load {result['conditions']['load']}.",
        "Times are CPU times of one thread next to other work: compare ratios only.",
        "Static rows: best of three. `tests/bench/league/README.md` explains rows and format.",
        "Why a system does worse than its documentation suggests: see [the systems](#the-systems).",
        *reproduction(result.get("reproduced", {})),
        "",
    ]
    for name, row in sorted(result["rows"].items()):
        lines += [
            f"## {name}: {row['title']}",
            "",
            "| system " + HEADS[row["judge"]],
            "|---|---|---|---|",
        ]
        for system, answer in sorted(row["answers"].items(), key=own_first):
            lines.append(f"| {system} | " + " | ".join(cell(row["judge"], answer)) + " |")
        lines.append("")
        lines += refusals(row["answers"])
        lines += notes.of_row(name)
    lines += notes.of_systems()
    lines += ["## Versions", "", "| system | version |", "|---|---|"]
    lines += [
        f"| {system} | {version} |"
        for system, version in sorted(result["versions"].items(), key=own_first)
    ]
    return "\n".join(lines) + "\n"


def pictures(result, folder):
    try:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        return
    styles = {
        system: (COLOURS[n % len(COLOURS)], MARKERS[n % len(MARKERS)])
        for n, system in enumerate(sorted(result["versions"]))
    }
    for draw, file, scale in (
        (error_over_time, "league_error_time.png", "log"),
        (time_over_size, "league_growth.png", "log"),
        (force_over_depth, "league_force_depth.png", "linear"),
    ):
        figure, axes = pyplot.subplots(figsize=(8.5, 4.6))
        draw(axes, result, styles)
        axes.set(xscale=scale, yscale=scale)
        axes.grid(True, alpha=0.3)
        axes.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
        figure.tight_layout()
        figure.savefig(folder / file, dpi=130)


def answers_of(result, row):
    return {
        system: a
        for system, a in result["rows"].get(row, {"answers": {}})["answers"].items()
        if isinstance(a, dict)
    }


def error_over_time(axes, result, styles):
    labelled = set()
    for row, fill in (("A5", "full"), ("A2", "none"), (SLIDE, "left")):
        for system, a in sorted(answers_of(result, row).items()):
            colour, marker = styles[system]
            axes.plot(
                a["us_median"],
                max(a["mean_deg"], LEAST_DEG),
                marker,
                color=colour,
                linestyle="",
                markersize=8,
                fillstyle=fill,
                label=None if system in labelled else system,
            )
            labelled.add(system)
    axes.set(
        xlabel="CPU time of a frame [µs]",
        ylabel=f"mean direction error [°], not below {LEAST_DEG:g}",
    )
    axes.set_title(
        "Ball on the cup (filled), on 5,000 triangles (open), pulled round the cup (half)",
        fontsize=10,
    )


def time_over_size(axes, result, styles):
    sizes = {"A2": 5e3, "A3": 5e4, "A4": 5e5}
    for system, (colour, marker) in styles.items():
        points = [
            (size, answers_of(result, row)[system]["us_median"])
            for row, size in sizes.items()
            if system in answers_of(result, row)
        ]
        if points:
            axes.plot(*zip(*points), marker=marker, color=colour, label=system)
    axes.set(xlabel="triangles of the cylinder", ylabel="CPU time of a frame [µs]")
    axes.set_title("Ball on a cylinder of more and more triangles", fontsize=10)


def force_over_depth(axes, result, styles):
    axes.plot([0, 19], [0, 1], color="lightgrey", linewidth=6, label="in proportion to depth")
    for row, line in (("E3d", "-"), ("E3s", "-.")):
        for system, a in sorted(answers_of(result, row).items()):
            colour, marker = styles[system]
            depth, force = zip(*a["curve"])
            most = max(abs(f) for f in force) or 1.0
            relative = [f / most for f in force]
            label = f"{system} (spring)" if row == "E3s" else system
            axes.plot(
                depth, relative, line, color=colour, marker=marker, markersize=3.5, label=label
            )
    axes.set(
        xlabel="depth of the hand [mm]",
        ylabel="force out of the cube over its largest value",
    )
    axes.set_title(
        "Cube pressed into a cube: poses (solid), pulled by a spring (dashed)", fontsize=10
    )
