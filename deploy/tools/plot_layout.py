"""Layout of a picture: title and note, legend next to the plane, limits of logarithmic axes, names
next to their marks.
"""

import math
import textwrap

from plot_style import *  # noqa: F403

NOTE_WIDTH = 140  # characters


def new_figure(title, note, rows=1, columns=1, **more):
    """A figure of 16 x 9 and its axes in rows; the title states the quantity, the note under it the
    conditions, wrapped to fit.
    """
    note = "\n".join(textwrap.fill(line, NOTE_WIDTH) for line in note.splitlines())
    figure = Figure(figsize=(16, 9), dpi=100, layout="constrained")
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08)
    axes = figure.subplots(rows, columns, squeeze=False, **more)
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold")
    axes[0][0].annotate(
        note, (0.01, 0.945), xycoords="figure fraction", va="top", color="0.25", fontsize=14
    ).set_in_layout(False)
    figure.get_layout_engine().set(rect=(0, 0, 1, 0.955 - 0.03 * note.count("\n")))
    return figure, axes


def legend_at_side(axis, **more):
    """Right of the plane, outside the data."""
    return axis.legend(loc="upper left", bbox_to_anchor=(1.005, 1.0), borderaxespad=0.0, **more)


def decade_round(values):
    """Limits of a logarithmic axis round `values`, at least a decade apart."""
    low, high = min(values, default=1.0), max(values, default=1.0)
    spread = max(1.45, math.sqrt(10.0 * low / high))
    return low / spread, high * spread


# Candidate positions of a text next to its mark, best first: a front's steps leave space to the
# right and above.
SIDES = ((1, 0.75), (-1, -0.75), (0, 1), (0, -1), (1, 0), (-1, 0), (-1, 0.75), (1, -0.75))


def overlap(a, b):
    """Overlap of two boxes [pixels squared]."""
    return max(0.0, min(a.x1, b.x1) - max(a.x0, b.x0)) * max(0.0, min(a.y1, b.y1) - max(a.y0, b.y0))


def label_marks(axis, marks, ringed=(), radius=11.0):
    """Writes the text of each (x, y, text, colour) next to its mark, where it overlaps least
    with the marks, the rings around the marks at `ringed`, and the other texts. `radius`: of
    a mark [px]; a ring's is twice that."""
    axis.figure.draw_without_rendering()
    plane, taken, notes = axis.get_window_extent(), [], []
    for places, r in (([mark[:2] for mark in marks], radius), (ringed, 2.0 * radius)):
        taken += [
            Bbox.from_bounds(x - r, y - r, 2 * r, 2 * r)
            for x, y in map(axis.transData.transform, places)
        ]
    for x, y, text, colour in marks:
        note = axis.annotate(
            text,
            (x, y),
            textcoords="offset points",
            xytext=(0, 0),
            ha="center",
            va="center",
            color=colour,
            fontsize=13,
            path_effects=[patheffects.withStroke(linewidth=3, foreground="white")],
        )
        note.set_in_layout(False)
        size = note.get_window_extent()

        def cost(offset):
            note.set_position(offset)
            box = note.get_window_extent()
            return (
                box.width * box.height
                - overlap(box, plane)
                + sum(overlap(box, other) for other in taken)
            )

        points = 72.0 / axis.figure.dpi
        note.set_position(
            min(
                (
                    (
                        dx * points * (gap * radius + size.width / 2),
                        dy * points * (gap * radius + size.height / 2),
                    )
                    for gap in (1.1, 2.1)
                    for dx, dy in SIDES
                ),
                key=cost,
            )
        )
        taken.append(note.get_window_extent())
        notes.append(note)
    return notes


def processor_name(data):
    return (
        data["conditions"]["processor"]
        .replace("(R)", "")
        .replace("(TM)", "")
        .split(" CPU @")[0][:48]
    )
