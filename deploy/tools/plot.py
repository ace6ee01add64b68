#!/usr/bin/python3 -I
"""Draws results of voxtouch; the suffix of PICTURE selects the format: .png, .svg or .pdf. Needs
python3-matplotlib.

  %(prog)s accuracy RUN.json PICTURE    cost of accuracy: error of every contact model
                                        and voxel size over the time of a frame
  %(prog)s costs RUN.json PICTURE       the same on one page: force, direction error and noise over
                                        depth, and the time of a frame
  %(prog)s design RUN.json PICTURE      stable region of a designed coupling: contact stiffness over
                                        the filter's cut-off
  %(prog)s forces BAG PICTURE           contact force, returned force, depth and gap of a recorded
                                        run over time
  %(prog)s compare BAG BAG PICTURE       force returned in runs of the same motion, over time and
                                        over the depth of the hand
  %(prog)s replay RUN.json PICTURE      forces of a recorded run and of its replay; voxtouch replay
                                        --plot calls it
  %(prog)s identify RUN.json PICTURE    strokes, residuals, friction and response of a measured
                                        device; PICTURE may end in .html; voxtouch identify --plots
                                        calls it
  %(prog)s report BAG PAGE.html         all of a recorded run on one page; voxtouch report calls it
  %(prog)s check PICTURE                draws nothing: exit status 0 if a picture can be drawn and
                                        written there

Sources of the data (see --help of each command):
  voxtouch accuracy deploy/scenes/cup.yaml --json > run.json         or at once: voxtouch accuracy
                                                                     deploy/scenes/cup.yaml --plot
                                                                     cup.png
  voxtouch design --scene deploy/scenes/cup.yaml --json > run.json   or at once: voxtouch design
                                                                     --scene deploy/scenes/cup.yaml
                                                                     --plot region.png
  voxtouch up deploy/scenes/cup.yaml --motion slide --duration 10 --lockstep --record bag

PNG is 1600 x 900 pixels. The same data give the same picture. Exit status 0 if the picture is
written; otherwise 1 and a sentence on stderr.
"""

import argparse
import base64
import io
import json
import math
import os
import pathlib
import subprocess
import sys
import warnings

sys.dont_write_bytecode = True  # only sources are stored next to the program
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from plot_accuracy import accuracy_figure, page_figure  # noqa: E402
from plot_design import design_figure  # noqa: E402
from plot_forces import comparison_figure, forces_figure, replay_figure  # noqa: E402
from plot_identify import identify_figure, identify_page  # noqa: E402
from plot_style import *  # noqa: E402, F403
from plot_style import NO_MATPLOTLIB  # noqa: E402

ENDINGS = {
    ".png": {"Software": None},
    ".svg": {"Date": None},
    ".pdf": {"CreationDate": None},
}  # metadata that would differ from run to run


# -------------------- files
def check_picture(picture, endings=tuple(ENDINGS)):
    """Exits with a sentence if a picture cannot be drawn or written there."""
    if picture.suffix.lower() not in endings:
        allowed = "{} or {}".format(", ".join(endings[:-1]), endings[-1]).removeprefix(" or ")
        sys.exit(f"{picture}: valid file extensions: {allowed}.")
    if NO_MATPLOTLIB:
        sys.exit(NO_MATPLOTLIB)
    if picture.is_dir() or not os.access(picture.parent, os.W_OK | os.X_OK):
        sys.exit(
            f"{picture} cannot be written. Check that its folder exists, the free space and the "
            f"permissions"
        )


def keep(file, write):
    """Under its own name only when it is whole."""
    part = file.with_name(file.name + ".part")
    try:
        write(part)
        os.replace(part, file)
    except OSError as error:
        sys.exit(f"{file} cannot be written: {error.strerror}.")
    finally:  # broken off by Ctrl-C too
        part.unlink(missing_ok=True)


def save(figure, picture):
    ending = picture.suffix.lower()

    def write(part):
        figure.savefig(part, format=ending[1:], metadata=ENDINGS[ending])
        if ending == ".png":  # matplotlib writes an opaque fourth channel, an eighth of the file
            with Image.open(part) as image:
                image.convert("RGB").save(part, "PNG", optimize=True)

    keep(picture, write)


def save_page(figure, data, page):
    """The report of an identification with its picture."""
    picture = io.BytesIO()
    figure.savefig(picture, format="png", metadata=ENDINGS[".png"])
    text = identify_page(data, base64.b64encode(picture.getvalue()).decode("ascii"))
    keep(page, lambda part: part.write_text(text, encoding="utf-8"))


def read_json(file, verb):
    try:
        data = json.load(sys.stdin if file == "-" else open(file, encoding="utf-8"))
    except OSError as error:
        sys.exit(f"{file} could not be read: {error.strerror}.")
    except ValueError as error:
        sys.exit(
            f"{file} is not JSON ({error}); write it with: voxtouch {verb} ... --json > {file}"
        )
    if (
        not isinstance(data, dict)
        or {"accuracy": "rows", "design": "region", "replay": "curves", "identify": "axes"}[verb]
        not in data
    ):
        sys.exit(
            f"{file} has no result of `voxtouch {verb} --json`"
            + (
                ": " + " ".join(data["problems"])
                if isinstance(data, dict) and data.get("problems")
                else "."
            )
        )
    return data


# -------------------- report
def report_progress(fraction):
    """Progress for the calling program: not part of the final output."""
    print(f"progress {100.0 * fraction:.0f}", file=sys.stderr, flush=True)


def write_report(bag, page, compared=None, rig="", progress=lambda fraction: None):
    """Writes a run's page; prints its content. Errors are sentences, for any content of the bag."""
    progress(0.0)
    import run_page
    from bag_data import BagError
    from run_data import Run

    bags = [bag] + ([compared] if compared else [])
    try:
        runs = [
            Run(one, rig, lambda fraction, done=i: progress(0.4 * (done + fraction) / len(bags)))
            for i, one in enumerate(bags)
        ]
        text = run_page.page(runs, lambda fraction: progress(0.4 + 0.6 * fraction))
    except BagError as error:
        sys.exit(str(error))
    except Exception as error:  # a bag may hold anything
        sys.exit(
            f"{' or '.join(map(str, bags))} has unexpected data ({type(error).__name__}: {error})."
        )
    keep(page, lambda part: part.write_text(text, encoding="utf-8", errors="replace"))
    return (
        f"shows {' next to '.join(run.name for run in runs)}:"
        f" {max(run.length_s for run in runs):.3f} s"
    )


# -------------------- command
class Version(argparse.Action):
    """The name of the program next to this tool."""

    def __call__(self, parser, *unused):
        program = pathlib.Path(sys.argv[0]).parent / "voxtouch"
        try:
            subprocess.run([program, "--version"], stderr=subprocess.DEVNULL, check=True)
            parser.exit()
        except (OSError, subprocess.CalledProcessError):
            parser.exit(1, f"{program} not found\n")


def main(arguments=None):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--version", action=Version, nargs=0, help="prints the version")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)

    def command(name, data, what):
        one = commands.add_parser(name, help=what, description=what)
        if data:
            one.add_argument("data", metavar=data[0], help=data[1])
        if name == "compare":
            one.add_argument("data", metavar="BAG", nargs=2, help="folders of the recordings")
        one.add_argument(
            "picture",
            metavar="PICTURE",
            type=pathlib.Path,
            help="file to write (.png, .svg or .pdf)",
        )
        return one

    for verb in ("accuracy", "costs", "design", "replay", "identify"):
        given = {"replay": "replay ... --plot", "identify": "identify ... --plots"}.get(verb)
        printed = (
            f"input from `voxtouch {given}`"
            if given
            else f"output of `voxtouch {'accuracy' if verb == 'costs' else verb} ... --json`"
        )
        command(
            verb,
            ("RUN.json", printed + "; - reads standard input"),
            (
                "plots a result of voxtouch accuracy on one page"
                if verb == "costs"
                else f"plots a result of voxtouch {verb}"
            ),
        )
    forces = command(
        "forces",
        ("BAG", "folder of the recording (voxtouch up ... --record BAG)"),
        "plots the forces of a recorded run",
    )
    forces.add_argument("--rig", default="haptic", help="rig name (default: haptic)")
    forces.add_argument(
        "--from",
        dest="begin",
        type=float,
        default=0.0,
        metavar="S",
        help="start of the plot [s]; 0 is the first contact message",
    )
    forces.add_argument(
        "--to", dest="end", type=float, default=math.inf, metavar="S", help="end of the plot [s]"
    )
    forces.add_argument("--note", default="", help="subtitles; default: the recordings' names")
    compared = command("compare", None, "plots the forces of runs of the same motion side by side")
    compared.add_argument("--rig", default="haptic", help="rig name (default: haptic)")
    report = commands.add_parser(
        "report",
        help="writes the page of a recorded run",
        description="writes the page of a recorded run",
    )
    report.add_argument("data", metavar="BAG", help="folder of the recording")
    report.add_argument("picture", metavar="PAGE.html", type=pathlib.Path, help="file to write")
    report.add_argument(
        "--compare-with",
        dest="compared",
        metavar="BAG",
        help="second run, next to the first",
    )
    report.add_argument("--rig", default="", help="rig name (default: the only one)")
    report.add_argument("--progress", action="store_true", help="prints its progress on stderr")
    check = command("check", None, "plots nothing; prints missing packages")
    check.add_argument("--page", action="store_true", help="the picture may be an .html page")
    a = parser.parse_args(None if arguments is None else [str(word) for word in arguments])
    warnings.simplefilter("ignore")  # a user cannot act on the warnings of matplotlib
    endings = (".html",) if a.command == "report" else tuple(ENDINGS)
    if a.command == "identify" or (a.command == "check" and a.page):
        endings += (".html",)
    check_picture(a.picture, endings)
    if a.command == "report":
        progress = report_progress if a.progress else lambda fraction: None
        return print(f"{a.picture} {write_report(a.data, a.picture, a.compared, a.rig, progress)}")
    if a.command == "check":
        return
    with matplotlib.rc_context(STYLE):
        if a.command == "forces":
            figure, caption = forces_figure(a.data, a.rig, a.begin, a.end, a.note)
        elif a.command == "compare":
            figure, caption = comparison_figure(a.data, a.rig)
        else:
            data = read_json(a.data, "accuracy" if a.command == "costs" else a.command)
            try:
                figure, caption = {
                    "accuracy": accuracy_figure,
                    "costs": page_figure,
                    "design": design_figure,
                    "replay": replay_figure,
                    "identify": identify_figure,
                }[a.command](data)
            except (KeyError, TypeError) as error:
                sys.exit(
                    f"{a.data} is not as this version of `voxtouch {a.command} --json` prints it:"
                    f" {type(error).__name__} {error}."
                )
        if a.picture.suffix.lower() == ".html":
            save_page(figure, data, a.picture)
        else:
            save(figure, a.picture)
    print(f"{a.picture} {caption}")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("stopped before the plot was written")
    except ModuleNotFoundError as error:
        sys.exit(
            f"{pathlib.Path(__file__).resolve()} must be in voxtouch's tree, with its modules: "
            f"{error}."
        )
