"""The stable region of a designed coupling: the contact's stiffness over the filter's cut-off, from
a result of `voxtouch design --json`.
"""

import math

from plot_layout import *  # noqa: F403

LAWS = {
    "shaping_filter": "shaping filter",
    "spring_damper": "spring-damper",
    "direct": "direct force",
}


def draw_region(axis, x, curves, low, high):
    """Two areas and their upper edges; `curves`: (values, colour, label). None: always stable; 0 is
    below the plane.
    """
    for values, colour, label in curves:
        values = [min(high * 10 if k is None else k, high * 10) for k in values]
        axis.fill_between(x, low, values, color=colour, alpha=0.14, lw=0)
        axis.plot(x, values, color=colour, lw=2.5, label=label)


def design_figure(data):
    region, coupling, axis_design, paper = (
        data["region"],
        data["coupling"],
        data["translation"],
        data["paper_recipe"],
    )
    x, law, kind = region["cutoff_hz"], region.get("law"), coupling["kind"]
    undamped, limit = region["critical_undamped_n_per_m"], region["device_limit_n_per_m"]
    displayed = axis_design["displayed_stiffness"]
    lowest = min([displayed or 100.0] + [k for k in undamped if k])
    low = 10.0 ** math.floor(math.log10(min(max(lowest, 0.01), 100.0)))
    high = 2.0 * max(limit or 0.0, axis_design["critical_stiffness"] or 0.0, 100.0)
    window = axis_design["velocity_window"]
    velocity = (
        f"velocity from a window of {3 * window} samples"
        if window
        else f"velocity filter {axis_design['velocity_filter_hz']:.3g} Hz"
    )
    suffix = "" if law else f", damping ratio {coupling['damping_ratio']:.3g}"
    note = (
        f"Device {data['device']}; hand: {data['hand']}.\nWorst"
        f" case{suffix}; injected"
        f" damping {axis_design['injected_damping']:.3g} Ns/m, {velocity}."
    )
    law_name = LAWS.get(kind, kind)
    if not displayed:
        title = "No stable coupling"
    elif data["status"] == "infeasible":
        title = f"Stable stiffness {displayed:.4g} N/m with a {law_name}: too small for use"
    else:
        title = f"Certified stiffness {displayed:.4g} N/m with a {law_name}"
    figure, axes = new_figure(
        title,
        note,
        1,
        2 if law else 1,
        sharey=True,
    )
    axis = axes[0][0]
    log_axis(axis.xaxis, x[0], x[-1])
    log_axis(axis.yaxis, low, high)
    certified = f"certified limit\n(gain margin {region['gain_margin']:.3g})"
    draw_region(
        axis,
        x,
        (
            (region["critical_n_per_m"], BLUE, "stability limit"),
            (region["certified_n_per_m"], GREEN, certified),
        ),
        low,
        high,
    )
    if axis_design["injected_damping"] > 0:
        axis.plot(
            x,
            [min(k or 10 * high, 10 * high) if k != 0 else 0 for k in undamped],
            color=BLUE,
            lw=1.8,
            ls="--",
            label="stability limit without\ninjected damping",
        )
    if any(k is None or k > low for k in region["passive_n_per_m"]):
        axis.plot(
            x,
            [10 * high if k is None else min(k, 10 * high) for k in region["passive_n_per_m"]],
            color=PURPLE,
            lw=1.8,
            ls="-.",
            label="passivity limit (any passive\nhand), without injected\ndamping",
        )
    if paper["stiffness_n_per_m"]:
        axis.plot(
            [paper["cutoff_hz"]],
            [paper["stiffness_n_per_m"]],
            "s",
            ms=14,
            mfc="white",
            mec=RED,
            mew=2.5,
            ls="none",
            zorder=4,
            label=f"paper: {paper['cutoff_hz']:g} Hz,\n{paper['stiffness_n_per_m']:.4g} N/m",
        )
    place, word = (
        (axis, f"designed: {coupling['cutoff_hz']:.3g} Hz")
        if not law
        else (axes[0][1], f"designed: {law['chosen']:.3g} {law['unit']}")
    )
    if law:
        axis.set_title("shaping filter with the same damping: not chosen", loc="left")
        place.set_title(f"chosen law: {LAWS.get(kind, kind)}", loc="left", fontweight="bold")
        log_axis(place.xaxis, law["x"][0], law["x"][-1])
        draw_region(
            place,
            law["x"],
            ((law["critical_n_per_m"], BLUE, None), (law["certified_n_per_m"], GREEN, None)),
            low,
            high,
        )
        place.set_xlabel(f"{law['over']} [{law['unit']}]")
    if displayed and (law["chosen"] > 0 if law else kind == "shaping_filter"):
        place.plot(
            [law["chosen"] if law else coupling["cutoff_hz"]],
            [displayed],
            "o",
            ms=14,
            color="#111111",
            ls="none",
            zorder=4,
            label=f"{word},\n{displayed:.4g} N/m",
        )
    for one in axes[0]:
        if limit:
            one.axhline(
                limit,
                color=GREY,
                lw=1.8,
                ls=":",
                label=f"device limit:\n{limit:.4g} N/m" if one is axis else None,
            )
    axis.set_xlabel("cut-off frequency of the shaping filter [Hz]")
    axis.set_ylabel("contact stiffness at the hand [N/m]")
    handles, labels = (
        sum(pair, []) for pair in zip(*(one.get_legend_handles_labels() for one in axes[0]))
    )
    axes[0][-1].legend(
        handles,
        labels,
        loc="upper left",
        bbox_to_anchor=(1.005, 1.0),
        borderaxespad=0.0,
        labelspacing=0.9,
    )
    return figure, f"plots the stable region with a {LAWS.get(kind, kind)}"
