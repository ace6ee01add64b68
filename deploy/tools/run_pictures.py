"""The pictures of a run's report, each as SVG text with the page's colours, light or dark. Two runs
are drawn next to each other on one scale.
"""

import io
import math
import re

import numpy
from bag_data import norm
from plot_style import (
    CONTACT,
    GREEN,
    INK,
    LINE,
    PURPLE,
    QUIET,
    RED,
    RETURNED,
    STRETCHES,
    STYLE,
    Figure,
    FuncFormatter,
    X,
    Y,
    Z,
    curve,
    legend_above,
    log_axis,
    mark_beyond,
    matplotlib,
    robust_limit,
)

DENSE_S = 60.0  # of a longer run dashes would melt into a surface
# Names of the drawn colours on the page, which has a light and a dark value for each.
THEME = {
    INK: "ink",
    QUIET: "quiet",
    LINE: "grid",
    RETURNED: "returned",
    CONTACT: "contact",
    Y: "y",
    GREEN: "z",
    PURPLE: "depth",
    RED: "bad",
}
ON_THE_PAGE = {
    **STYLE,
    "svg.fonttype": "none",
    "text.color": INK,
    "axes.edgecolor": QUIET,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "grid.color": LINE,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "axes.titlesize": 15,
}


def as_svg(figure, name, alt):
    """Without a fixed size, so that it uses the page's; its names begin with `name`, because the
    page has several.
    """
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    text = out.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.S)
    text = re.sub(
        r'^<svg[^>]*?viewBox="([^"]*)"[^>]*>',
        lambda m: f'<svg viewBox="{m[1]}" role="img" aria-label="{alt}">',
        text,
        count=1,
        flags=re.S,
    )
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = (
        text.replace("url(#", f"url(#{name}-")
        .replace('href="#', f'href="#{name}-')
        .replace("xlink:href", "href")
    )
    for colour, word in THEME.items():
        text = text.replace(colour, f"var(--{word})")
    return re.sub(r"font: ([\d.]+)px '[^;\"]*", r"font: \1px var(--font)", text)


def columns(runs, heights, shared_x=True, legend_lines=1):
    """A figure with a column for each run and a row for each height; over the first one's legend
    the name of each of two runs.
    """
    figure = Figure(
        figsize=(13 if len(runs) == 1 else 16, sum(heights) + 0.5), dpi=100, layout="constrained"
    )
    figure.get_layout_engine().set(w_pad=0.1, h_pad=0.06)
    axes = figure.subplots(
        len(heights), len(runs), squeeze=False, sharex=shared_x, sharey="row", height_ratios=heights
    )
    if len(runs) > 1:
        for run, axis in zip(runs, axes[0]):
            axis.set_title(run.name[:48], fontweight="bold", pad=8 + 22 * legend_lines, loc="left")
    return figure, axes


def time_axis(runs, axes):
    end = max(run.length_s for run in runs)
    for axis in axes[-1]:
        axis.set_xlim(0.0, max(end, 1e-3))
        axis.set_xlabel("device time [s]")
    return end


def gap_s(run, every=1.0):
    """Samples farther apart than this leave a gap: a command is repeated for three periods."""
    return 3.5 * every / (run.description.get("rate_hz") or 1000.0)


def legends(runs, axes):
    """Of every plane of a row; of two runs in as many lines as their half of the width takes."""
    for axis in axes:
        legend_above(axis, 5 if len(runs) == 1 else 3)


def percent_axis(axis, run, named):
    """The same force as a fraction of the device's largest, on the right."""
    if math.isfinite(run.limit_n):
        right = axis.secondary_yaxis(
            "right",
            functions=(lambda n: 100.0 * n / run.limit_n, lambda p: p * run.limit_n / 100.0),
        )
        right.set_ylabel("fraction of the\ndevice's limit [%]" if named else "")
        right.spines["right"].set_visible(False)


NAMES = {
    "contact": "force of the contact",
    "returned": "force returned to the hand",
    "x": "x",
    "y": "y",
    "z": "z",
}
# Colour, dashes, width and order: the thin line is on top of the wide one.
STYLES = {
    "contact": (CONTACT, "-", 1.1, 4),
    "returned": (RETURNED, "-", 2.6, 3),
    "x": (X, "-", 1.4, 3),
    "y": (Y, "--", 1.4, 3),
    "z": (Z, "-.", 1.6, 3),
}


def forces(runs, times, values, end, axes, limit, unit, below=False):
    """Curves of one row, every run in its column; values outside the plane are marked."""
    for run, axis in zip(runs, axes):
        for key in values(run):
            t, y = times(run, key), values(run)[key]
            axis.plot(
                *curve(t, y, gap_s(run), 0.0, end),
                color=STYLES[key][0],
                ls=STYLES[key][1],
                lw=STYLES[key][2],
                zorder=STYLES[key][3],
                label=NAMES[key],
            )
            mark_beyond(axis, t, y, limit, unit, STYLES[key][0], below)
        axis.set_ylim(-limit if below else 0.0, limit)
        if below:
            axis.axhline(0.0, color=QUIET, lw=0.8)


def force_picture(runs):
    figure, axes = columns(runs, (3.6, 2.4, 2.4))
    end = time_axis(runs, axes)

    def sizes(run):
        return {"contact": norm(run.contact_force), "returned": norm(run.returned)}

    def parts(of):
        return lambda run: dict(zip("xyz", getattr(run, of).T))

    rows = (
        (sizes, "force magnitude [N]", None, False),
        (parts("returned"), "returned, device\naxes [N]", "returned", True),
        (parts("contact_force"), "contact, world\naxes [N]", "contact", True),
    )
    for row, (values, label, which, below) in enumerate(rows):
        limit = robust_limit(*(v for run in runs for v in values(run).values()))
        forces(
            runs,
            lambda run, key: run.t_command if (which or key) == "returned" else run.t_contact,
            values,
            end,
            axes[row],
            limit,
            "N",
            below,
        )
        axes[row][0].set_ylabel(label)
    limits(runs, axes[0])
    for row in axes:
        legends(runs, row)
    return figure


def limits(runs, axes):
    """The devices' largest force, as a second scale and, if within the plane, as a line."""
    for run, axis in zip(runs, axes):
        percent_axis(axis, run, run is runs[-1])
        if axis.get_ylim()[1] > run.limit_n:
            axis.axhline(run.limit_n, color=RED, lw=1.6, ls=":", label="the device's limit")


def peak_picture(runs):
    """A second before and after the largest force returned, every sample."""
    figure, axes = columns(runs, (3.0,), shared_x=False)
    values = [{"contact": norm(run.contact_force), "returned": norm(run.returned)} for run in runs]
    limit = 1.08 * max(
        [
            v
            for of in values
            for v in (float(numpy.nanmax(numpy.r_[0.0, one])) for one in of.values())
        ]
        + [1e-3]
    )
    for run, of, axis in zip(runs, values, axes[0]):
        peak = run.figures["max_force_at_s"] or 0.0
        begin, end = max(0.0, peak - 1.0), peak + 1.0
        for key, t in (("contact", run.t_contact), ("returned", run.t_command)):
            near = (t >= begin) & (t <= end)
            axis.plot(
                *curve(t[near], of[key][near], gap_s(run), begin, end),
                color=STYLES[key][0],
                lw=STYLES[key][2],
                zorder=STYLES[key][3],
                label=NAMES[key],
            )
        axis.set_xlim(begin, end)
        axis.set_ylim(0.0, limit)
        axis.set_xlabel("device time [s]")
    axes[0][0].set_ylabel("force magnitude [N]")
    limits(runs, axes[0])
    legends(runs, axes[0])
    return figure


def torque_picture(runs):
    figure, axes = columns(runs, (3.0,))
    end = time_axis(runs, axes)

    def parts(run):
        return dict(zip("xyz", run.torque.T))

    limit = robust_limit(*(v for run in runs for v in parts(run).values()))
    forces(runs, lambda run, key: run.t_command, parts, end, axes[0], limit, "Nm", True)
    axes[0][0].set_ylabel("torque returned,\ndevice axes [Nm]")
    legends(runs, axes[0])
    return figure


def distribution_picture(runs):
    figure, axes = columns(runs, (3.6,), legend_lines=2)
    returned = [norm(run.returned) for run in runs]
    returned = [force[force > 1e-9] for force in returned]
    limit = robust_limit(*returned)
    edges = numpy.linspace(0.0, limit, 61)
    for run, force, axis in zip(runs, returned, axes[0]):
        period = 1.0 / (run.description.get("rate_hz") or 1000.0)
        axis.hist(force, edges, weights=numpy.full(len(force), period), color=RETURNED, rwidth=0.9)
        beyond = int((force > limit).sum())
        if beyond:
            axis.annotate(
                f"{beyond} samples beyond: up to {force.max():.3g} N",
                (0.99, 0.96),
                xycoords="axes fraction",
                ha="right",
                va="top",
                color=RED,
                fontsize=13,
            )
        if not len(force):
            axis.annotate(
                "no force returned",
                (0.5, 0.5),
                xycoords="axes fraction",
                ha="center",
                color=QUIET,
            )
        if math.isfinite(run.limit_n):
            top = axis.secondary_xaxis(
                "top",
                functions=(
                    lambda n, of=run.limit_n: 100.0 * n / of,
                    lambda p, of=run.limit_n: p * of / 100.0,
                ),
            )
            top.set_xlabel("fraction of the device's limit [%]")
            top.spines["top"].set_visible(False)
        axis.set_xlabel("magnitude of the force returned to the hand [N]")
        axis.set_xlim(0.0, limit)
    if any(len(force) for force in returned):
        axes[0][0].set_yscale("log")
        axes[0][0].yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes[0][0].set_ylabel("time at that force [s]")
    return figure


def depth_picture(runs):
    figure, axes = columns(runs, (3.6,))
    end = time_axis(runs, axes)
    deep = max(
        0.5,
        (
            robust_limit(
                *(d for run in runs for d in (run.depth_mm, numpy.minimum(run.gap_mm, 0.0)))
            )
            if any((run.depth_mm > 0).any() for run in runs)
            else 0.5
        ),
    )
    for run, axis in zip(runs, axes[0]):
        axis.axhline(0.0, color=QUIET, lw=0.8)
        axis.set_ylim(-deep, 2.0 * deep)
        axis.plot(
            *curve(run.t_contact, run.depth_mm, gap_s(run), 0.0, end),
            color=PURPLE,
            lw=1.4,
            label="depth (rendering)",
        )
        every = (
            float(numpy.median(numpy.diff(run.t_validation)))
            * (run.description.get("rate_hz") or 1000.0)
            if len(run.t_validation) > 2
            else 1.0
        )
        axis.plot(
            *curve(run.t_validation, run.gap_mm, gap_s(run, max(every, 1.0)), 0.0, end),
            color=INK,
            lw=1.5 if end < DENSE_S else 0.7,
            ls="--" if end < DENSE_S else "-",
            label="gap, < 0: overlap (validator)",
        )
        mark_beyond(axis, run.t_contact, run.depth_mm, 2.0 * deep, "mm", PURPLE)
    legends(runs, axes[0])
    axes[0][0].set_ylabel("distance [mm]")
    return figure


def latency_picture(runs):
    figure, axes = columns(runs, (3.6, 1.2), legend_lines=2)
    end = time_axis(runs, axes)
    largest, least = 1000.0, 100.0
    for run, axis, below in zip(runs, axes[0], axes[1]):
        t, spent = run.latency_us
        if len(t):
            cells = numpy.floor(
                t / max(end, 1e-9) * min(STRETCHES / 3, max(len(t) / 20.0, 1.0))
            ).astype(int)
            starts = numpy.flatnonzero(numpy.r_[True, numpy.diff(cells) != 0])
            middle = t[starts]
            most = numpy.maximum.reduceat(spent, starts)
            median = numpy.array([numpy.median(part) for part in numpy.split(spent, starts[1:])])
            apart = 4.0 * float(numpy.median(numpy.diff(middle))) if len(middle) > 2 else 1.0
            axis.plot(
                *curve(middle, most, apart, 0.0, end),
                color=CONTACT,
                lw=1.2,
                label="largest (logger)",
            )
            axis.plot(
                *curve(middle, median, apart, 0.0, end), color=INK, lw=1.6, label="median (logger)"
            )
            largest, least = max(largest, float(most.max())), min(least, float(median.min()))
        for figure_name, style, word in (
            ("latency_p99_us", "--", "99 % (device)"),
            ("latency_p50_us", ":", "50 % (device)"),
        ):
            rows = [
                (at, figures[figure_name])
                for at, figures in run.device_figures
                if figures.get(figure_name, 0.0) > 0.0
            ]
            if rows:
                axis.plot(
                    *curve([r[0] for r in rows], [r[1] for r in rows], 1.0, 0.0, end),
                    color=RETURNED,
                    lw=2.4,
                    ls=style,
                    label=word,
                )
                largest = max(largest, max(r[1] for r in rows))
        if run.lockstep:
            axis.annotate(
                "not measured in lockstep",
                (0.5, 0.5),
                xycoords="axes fraction",
                ha="center",
                color=QUIET,
            )
        period_us = 1e6 / (run.description.get("rate_hz") or 1000.0)
        axis.axhline(period_us, color=QUIET, lw=1.2, ls="-.", label="one period")
        over = run.overruns()
        below.bar(
            [at for at, _ in over], [n for _, n in over], width=max(end / 400.0, 0.05), color=RED
        )
        if not over:
            below.annotate(
                ("no skipped period" if run.device_figures else "skipped periods are not recorded"),
                (0.5, 0.4),
                xycoords="axes fraction",
                ha="center",
                color=QUIET,
            )
        below.set_ylim(0.0, max([4.0] + [1.15 * n for r in runs for _, n in r.overruns()]))
    legends(runs, axes[0])
    log_axis(axes[0][0].yaxis, 0.7 * max(least, 1.0), 1.3 * largest)
    axes[0][0].set_ylabel("latency [µs]")
    axes[1][0].set_ylabel("overruns\n[periods]")
    return figure


def energy_picture(runs):
    turned = any((numpy.abs(run.command["energy_rotation_j"]) > 1e-12).any() for run in runs)
    figure, axes = columns(runs, (3.0,), legend_lines=int(turned))
    end = time_axis(runs, axes)
    everything = [
        1e3 * run.command[key]
        for run in runs
        for key in (("energy_j", "energy_rotation_j") if turned else ("energy_j",))
    ]
    limit = robust_limit(*everything)
    lowest = min([0.0] + [float(numpy.nanmin(numpy.r_[0.0, e])) for e in everything])
    for column, run in enumerate(runs):
        axis = axes[0][column]
        for key, colour, style, name in (
            ("energy_j", CONTACT, "-", "of motion"),
            ("energy_rotation_j", RETURNED, "--", "of rotation"),
        ):
            if key == "energy_j" or turned:
                axis.plot(
                    *curve(run.t_command, 1e3 * run.command[key], gap_s(run), 0.0, end),
                    color=colour,
                    ls=style,
                    lw=1.5,
                    label=name,
                )
                mark_beyond(axis, run.t_command, 1e3 * run.command[key], limit, "mJ", colour, True)
        axis.axhline(0.0, color=QUIET, lw=0.8)
        axis.set_ylim(max(-limit, min(-0.06 * limit, 1.15 * lowest)), limit)
    if turned:
        legends(runs, axes[0])
    axes[0][0].set_ylabel("energy put in\nby the hand [mJ]")
    return figure


def drawn(picture, runs, name, alt):
    """One of the pictures above as SVG text."""
    with matplotlib.rc_context(ON_THE_PAGE):
        return as_svg(picture(runs), name, alt)
