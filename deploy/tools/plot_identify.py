"""Measurements of `voxtouch identify`: strokes with the fitted model, its residual, friction over
speed, and the response to the dense tones.
"""

import html
import math

from plot_layout import *  # noqa: F403

LONGEST_STROKES = 3
RESPONSE_BANDS = 60
LOWEST_HZ, HIGHEST_HZ = 4.0, 220.0


def strokes_plot(axis, strokes):
    """The longest strokes: position measured, and the model dashed on it."""
    longest = sorted(strokes, key=lambda s: -abs(s["position_m"][-1]))[:LONGEST_STROKES]
    for number, stroke in enumerate(longest):
        measured = [1e3 * x for x in stroke["position_m"]]
        model = [1e3 * (x - r) for x, r in zip(stroke["position_m"], stroke["residual_m"])]
        axis.plot(
            stroke["time_s"],
            measured,
            color=BLUE,
            lw=4,
            alpha=0.45,
            label=("measured", None)[number > 0],
        )
        axis.plot(
            stroke["time_s"], model, color=INK, lw=1.3, ls="--", label=("model", None)[number > 0]
        )


def residual_plot(axis, one):
    """Measured less modelled of all strokes, with half an encoder step to both sides."""
    import numpy

    rests = [1e6 * numpy.asarray(s["residual_m"]) for s in one["strokes"]]
    for stroke, rest in zip(one["strokes"], rests):
        axis.plot(stroke["time_s"], rest, color=BLUE, lw=0.7, alpha=0.5)
    half = 0.5e6 * one["encoder_step_m"]
    limit = robust_limit(*rests, [half])
    axis.set_ylim(-limit, limit)
    if half > 0:
        axis.axhspan(-half, half, color=GREEN, alpha=0.15, lw=0, label="half an encoder step")


def friction_plot(axis, one):
    """The force of each stroke that neither mass nor bias explains, over the speed, both weighted
    with p = (1 - s^2)^4, s from -1 to 1 over the stroke (weak form, Shinbrot 1957):

        Ff = (int p u + c int p - m int p'' x) / int p,  v = -int p' x / int p
    """
    import numpy

    record = {key: numpy.asarray(one["record"][key]) for key in ("time_s", "force_n")}
    mass, bias, delay = one["mass_kg"][0], one["bias_n"][0], one["delay_s"][0]
    speeds, forces = [], []
    for stroke in one["strokes"]:
        t, x = (numpy.asarray(stroke[key]) for key in ("time_s", "position_m"))
        half = 0.5 * (t[-1] - t[0])
        s = (t - t[0]) / half - 1.0
        q = 1.0 - s**2
        p, p1 = q**4, -8.0 * s * q**3 / half
        p2 = (-8.0 * q**3 + 48.0 * s**2 * q**2) / half**2
        last = numpy.searchsorted(record["time_s"], stroke["start_s"] + t - delay, "right") - 1
        u = record["force_n"][numpy.clip(last, 0, None)]
        whole = numpy.trapz(p, t)
        speeds.append(-numpy.trapz(p1 * x, t) / whole)
        forces.append(bias + (numpy.trapz(p * u, t) - mass * numpy.trapz(p2 * x, t)) / whole)
    most = 1.15 * max(map(abs, speeds), default=0.1)
    line = numpy.linspace(0.0, most, 50)
    coulomb, viscous = one["coulomb_n"][0], one["viscous_ns_per_m"][0]
    for sign in (1, -1):
        axis.plot(
            1e3 * sign * line,
            1e3 * sign * (coulomb + viscous * line),
            color=INK,
            lw=1.5,
            label="fitted" if sign > 0 else None,
        )
    axis.plot(
        1e3 * numpy.array(speeds),
        1e3 * numpy.array(forces),
        "o",
        color=ORANGE,
        ms=6,
        label="strokes",
    )


def response(one):
    """Frequencies [Hz] and force over acceleration [kg], of bands in which the force has power."""
    import numpy

    t, x, u = (numpy.asarray(one["tones"][k]) for k in ("time_s", "position_m", "force_n"))
    if len(t) < 256:
        return [], []
    period = float(numpy.median(numpy.diff(t)))
    even = numpy.arange(t[0], t[-1], period)
    window = numpy.hanning(len(even))
    trend = numpy.polynomial.Polynomial.fit(t, x, 3)
    position = numpy.fft.rfft(window * numpy.interp(even, t, x - trend(t)))
    force = numpy.fft.rfft(window * (numpy.interp(even, t, u) - u.mean()))
    hz = numpy.fft.rfftfreq(len(even), period)
    edges = numpy.geomspace(LOWEST_HZ, min(HIGHEST_HZ, 0.4 / period), RESPONSE_BANDS + 1)
    powers = [(numpy.abs(force[(hz >= a) & (hz < b)]) ** 2).sum() for a, b in zip(edges, edges[1:])]
    found, masses = [], []
    for a, b, power in zip(edges, edges[1:], powers):
        band = (hz >= a) & (hz < b)
        if not band.any() or power < 0.02 * max(powers):
            continue
        acceleration = -((2.0 * math.pi * hz[band]) ** 2) * position[band]
        cross = abs((numpy.conj(force[band]) * acceleration).sum())
        found.append(math.sqrt(a * b))
        masses.append((numpy.abs(force[band]) ** 2).sum() / max(cross, 1e-300))
    return found, masses


def response_plot(axis, one):
    """Apparent mass over the frequency: power of the force over its cross power with the
    acceleration, which the noise of the encoder does not enter."""
    import numpy

    hz, masses = response(one)
    mass, viscous = one["mass_kg"][0], one["viscous_ns_per_m"][0]
    line = numpy.geomspace(LOWEST_HZ, HIGHEST_HZ, 100)
    model = [abs(complex(mass, -viscous / (2.0 * math.pi * f))) for f in line]
    log_axis(axis.xaxis, LOWEST_HZ, HIGHEST_HZ)
    axis.plot(hz, masses, "o", color=PURPLE, ms=5, label="tones")
    axis.plot(line, model, color=INK, lw=1.5, label="mass and viscous friction")
    axis.set_ylim(0.0, 2.5 * mass)
    if one["mode_hz"] > 0:
        axis.axvline(one["mode_hz"], color=RED, lw=1.5, ls=":", label="mode")


COLUMNS = (
    ("longest strokes", "time [s]", "path [mm]"),
    ("measured less model", "time [s]", "rest [um]"),
    ("friction", "speed [mm/s]", "force [mN]"),
    ("response", "frequency [Hz]", "mass [kg]"),
)
LEGENDS = ("lower left", "upper right", "center", "upper left")


def identify_figure(data):
    axes_of = data["axes"]
    figure, planes = new_figure(
        f"{data['device']}: strokes, residuals, friction and response",
        f"{data['command']}, {data['date']}",
        len(axes_of),
        len(COLUMNS),
    )
    for row, (name, one) in enumerate(axes_of.items()):
        strokes_plot(planes[row][0], one["strokes"])
        residual_plot(planes[row][1], one)
        friction_plot(planes[row][2], one)
        response_plot(planes[row][3], one)
        for column, (title, below, left) in enumerate(COLUMNS):
            plane = planes[row][column]
            plane.set_ylabel(f"{name}: {left}" if column == 0 else left)
            plane.tick_params(labelsize=12)
            if row == 0:
                plane.set_title(title, loc="left")
            if row == len(axes_of) - 1:
                plane.set_xlabel(below)
                plane.legend(fontsize=10, loc=LEGENDS[column], frameon=True, framealpha=0.8)
    return figure, f"shows {len(axes_of)} measured axes of {data['device']}"


def identify_page(data, picture):
    """The report and the picture (bytes as base64) in one file."""
    title = html.escape(f"{data['device']}: identification of {data['date']}")
    return (
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{title}</title>"
        "<style>body{font-family:sans-serif;margin:2em;max-width:1600px}img{width:100%}</style>"
        f"<h1>{title}</h1><pre>{html.escape(data['text'])}</pre>"
        '<img alt="strokes, residuals, friction and response"'
        f' src="data:image/png;base64,{picture}">\n'
    )
