#!/usr/bin/env python3
"""How accurately a part of yours is rendered: writes a scene for its mesh, measures every contact
model against the true force, and prints the recommended setting.

It calls `voxtouch new` and `voxtouch accuracy --json`, which measures for 10 s to minutes. Needs
the programs of voxtouch on PATH, or --voxtouch.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "part",
        help=("mesh (OBJ, STL, PLY, glTF/GLB, COLLADA), or an existing scene file (.yaml)"),
    )
    parser.add_argument(
        "--unit",
        help="unit of the mesh (m, mm, ...); default: guessed from the size",
    )
    parser.add_argument(
        "--models", default="adapted,field", help="contact models (default: adapted,field)"
    )
    parser.add_argument(
        "--contacts",
        type=int,
        default=200,
        help="contact poses, the same for each model (default: 200)",
    )
    parser.add_argument(
        "--voxel-sizes",
        help="voxel edges [m], separated by commas; default: the scene's edge times 2, 1 and 1/2",
    )
    parser.add_argument(
        "--voxtouch", default="voxtouch", help="path of the program, if it is not on PATH"
    )
    parser.add_argument(
        "--save", metavar="FILE", help="plots error over time into this file (.png, .svg, .pdf)"
    )
    return parser.parse_args()


def main():
    o = arguments()
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(o.part)
        if scene.suffix not in (".yaml", ".yml"):
            scene = pathlib.Path(folder) / "part.yaml"
            subprocess.run(
                [
                    o.voxtouch,
                    "new",
                    o.part,
                    "--out",
                    str(scene),
                    *(["--unit", o.unit] if o.unit else []),
                ],
                check=True,
            )
        words = [
            o.voxtouch,
            "accuracy",
            str(scene),
            "--json",
            "--models",
            o.models,
            "--contacts",
            str(o.contacts),
        ]
        words += ["--voxel-sizes", o.voxel_sizes] if o.voxel_sizes else []
        words += ["--plot", o.save] if o.save else []
        ran = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=False)
    if not ran.stdout:
        raise SystemExit("voxtouch accuracy measured nothing; see its message above.")
    summary = json.loads(ran.stdout)
    print(f"{'model':14} {'voxel':>9} {'direction':>10} {'frame':>9}")
    for row in summary["rows"]:
        if row["direction_mean_deg"] is None or row["median_us"] is None:
            print(
                f"{row['model']:14} {1e3 * row['voxel_m']:6.2f} mm "
                f" {row['refused'] or 'no figures'}"
            )
            continue
        direction, frame = row["direction_mean_deg"], row["median_us"]
        print(
            f"{row['model']:14} {1e3 * row['voxel_m']:6.2f} mm {direction:8.2f}°"
            f" {frame:6.1f} us{'  <- take this' if row['recommended'] else ''}"
        )
    print(summary["advice"]["sentence"])
    raise SystemExit(0 if summary["ok"] else 1)


if __name__ == "__main__":
    main()
