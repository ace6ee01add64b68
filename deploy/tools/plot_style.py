"""Style of all pictures: colours, fonts, axes, and the reduction of many samples. Without
matplotlib, NO_MATPLOTLIB has the message.
"""

import logging
import os
import sys

os.environ.pop("MPLBACKEND", None)  # no window is opened, and an unknown name would end the import
logging.getLogger("matplotlib").setLevel(
    logging.CRITICAL
)  # faults of the user's matplotlibrc, which is not used
try:
    import matplotlib

    matplotlib.rcdefaults()  # the user's matplotlibrc changes no picture
    from matplotlib import patheffects
    from matplotlib.figure import Figure
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
    from matplotlib.transforms import Bbox
    from PIL import Image  # matplotlib depends on it

    NO_MATPLOTLIB = ""
except ImportError as error:
    NO_MATPLOTLIB = (
        f"Plots need matplotlib, which {sys.executable} does not have ({error}): "
        "install python3-matplotlib (deploy/setup does)."
    )

# Colours that stay apart for colour-blind eyes (after Okabe and Ito), on an opaque white ground. A
# model has one colour and one mark in every picture.
GREY, BLUE, ORANGE, GREEN, PALE_GREEN, PURPLE, RED = (
    "#6b6b6b",
    "#0072b2",
    "#c44e00",
    "#00805f",
    "#8fd0b5",
    "#8e24aa",
    "#b3261e",
)
RETURNED, CONTACT = (
    ORANGE,
    BLUE,
)  # force returned to the hand, and force of the contact: as on the page of voxtouch view
X, Y, Z = BLUE, "#a85400", GREEN
INK, QUIET, LINE = "#17202a", "#51606e", "#e3e3e3"
MODELS = {"original": (GREY, "s"), "adapted": (BLUE, "o"), "field": (GREEN, "D")}
STYLE = {
    "font.size": 16,
    "axes.titlesize": 14,
    "axes.labelsize": 15,
    "legend.fontsize": 14,
    "xtick.labelsize": 14,
    "ytick.labelsize": 14,
    "figure.titlesize": 20,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e3e3e3",
    "legend.frameon": False,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "svg.hashsalt": "voxtouch",
    "agg.path.chunksize": 20000,
}


def log_axis(axis, low, high):
    """Logarithmic from `low` to `high`, with plain numbers at 1, 2 and 5, or at decades if there
    are many."""
    (axis.axes.set_xscale if axis.axis_name == "x" else axis.axes.set_yscale)("log")
    (axis.axes.set_xlim if axis.axis_name == "x" else axis.axes.set_ylim)(low, high)
    axis.set_major_locator(LogLocator(subs=(1,) if high / low > 2000 else (1, 2, 5), numticks=20))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(NullLocator())


# ------------------------------------------------------------------------------------------------
# many samples, gaps and spikes Along a picture; of more samples than twice that each stretch keeps
# its smallest and its largest.
STRETCHES = 1500


def curve(t, y, gap_s, begin=None, end=None):
    """Reduces many samples for drawing: the smallest and the largest of each of STRETCHES
    between `begin` and `end`, in their order, so that no peak is lost; nothing between two
    samples more than `gap_s` apart."""
    import numpy

    t, y = numpy.asarray(t, float), numpy.asarray(y, float)
    keep = numpy.isfinite(y)
    order = numpy.argsort(t[keep], kind="stable")
    t, y = t[keep][order], y[keep][order]
    if not len(t):
        return t, y
    begin, end = t[0] if begin is None else begin, t[-1] if end is None else end
    piece = numpy.r_[0, numpy.cumsum(numpy.diff(t) > gap_s)]
    if len(t) > 2 * STRETCHES:
        stretch = numpy.floor((t - begin) / max(end - begin, 1e-9) * STRETCHES).astype(int)
        starts = numpy.flatnonzero(
            numpy.r_[True, (numpy.diff(stretch) != 0) | (numpy.diff(piece) != 0)]
        )
        group = numpy.repeat(numpy.arange(len(starts)), numpy.diff(numpy.r_[starts, len(t)]))
        kept = []
        for least in (numpy.minimum, numpy.maximum):
            places = numpy.flatnonzero(y == least.reduceat(y, starts)[group])
            kept.append(places[numpy.unique(group[places], return_index=True)[1]])
        kept = numpy.unique(numpy.concatenate(kept))
        t, y, piece = t[kept], y[kept], piece[kept]
    breaks = numpy.flatnonzero(numpy.diff(piece)) + 1
    return numpy.insert(t, breaks, t[breaks - 1]), numpy.insert(y, breaks, numpy.nan)


def robust_limit(*values):
    """As far as an axis from 0 has to go for the sizes of `values`: to the largest, unless that is
    one spike far beyond the rest.
    """
    import numpy

    sizes = numpy.abs(
        numpy.concatenate([numpy.asarray(v, float).ravel() for v in values] or [numpy.empty(0)])
    )
    sizes = sizes[numpy.isfinite(sizes) & (sizes > 1e-12)]
    if not len(sizes):
        return 1.0
    most, usual = float(sizes.max()), float(numpy.quantile(sizes, 0.998, method="lower"))
    return 1.08 * most if most <= 2.5 * usual else 1.4 * usual


def mark_beyond(axis, t, y, limit, unit, colour, below=False):
    """A triangle at the edge of the plane for each stretch in which a curve leaves it, and its size
    at the largest. How many there are.
    """
    import numpy

    t, y = numpy.asarray(t, float), numpy.asarray(y, float)
    beyond = numpy.flatnonzero(numpy.isfinite(y) & ((y > limit) | (below & (y < -limit))))
    if not len(beyond):
        return 0
    apart = (axis.get_xlim()[1] - axis.get_xlim()[0]) / 100.0
    groups = numpy.split(beyond, numpy.flatnonzero(numpy.diff(t[beyond]) > apart) + 1)
    peaks = [group[numpy.abs(y[group]).argmax()] for group in groups]
    for sign, mark in ((1, "^"), (-1, "v")):
        places = [p for p in peaks if y[p] * sign > 0]
        axis.plot(
            t[places],
            [0.98 * sign * limit] * len(places),
            mark,
            ms=9,
            color=colour,
            ls="none",
            zorder=6,
        )
    most = max(peaks, key=lambda p: abs(y[p]))
    left = t[most] > sum(axis.get_xlim()) / 2
    axis.annotate(
        f"up to {abs(y[most]):.3g} {unit} at {t[most]:.2f} s, outside the plot"
        + (f" ({len(peaks)} places)" if len(peaks) > 1 else ""),
        (t[most], 0.96 * limit * (1 if y[most] > 0 else -1)),
        xytext=(-10 if left else 10, 0),
        textcoords="offset points",
        ha="right" if left else "left",
        va="top" if y[most] > 0 else "bottom",
        fontsize=13,
        color=colour,
        zorder=7,
    )
    return len(peaks)


def legend_above(axis, side_by_side=5, **more):
    """Above the plane, outside the data; nothing without a name."""
    if axis.get_legend_handles_labels()[0]:
        axis.legend(
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            borderaxespad=0.2,
            ncol=side_by_side,
            columnspacing=1.6,
            handlelength=1.8,
            **more,
        )
