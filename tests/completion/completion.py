#!/usr/bin/env python3
"""Completion of bash, asked as bash asks, against the programs of the build; man pages of all of
them; --version of each program.

usage: completion.py ROOT BIN VERSION
"""

import gzip
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time

PROGRAMS = (
    "voxtouch",
    "voxtouch_device",
    "voxtouch_rendering",
    "voxtouch_coupling",
    "voxtouch_logger",
    "voxtouch_validator",
    "voxtouch_fri_controller",
    "voxtouch_fci_robot",
    "voxtouch_import_mesh",
)
ASK = r"""
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=()
_voxtouch "$1"
printf '%s\n' "${COMPREPLY[@]}"
"""


def replies(root, binaries, *words):
    run = subprocess.run(
        ["bash", "-uc", ASK, "bash", root / "deploy/completion/voxtouch.bash", *words],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        env={**os.environ, "PATH": f"{binaries}:{os.environ['PATH']}"},
    )
    return set(run.stdout.split()), run.stderr


CASES = (
    (("voxtouch", ""), {"up", "doctor", "design", "--version"}, {"sim-phantom"}),
    (("voxtouch", "de"), {"design"}, {"up"}),
    (("voxtouch", "up", ""), {"cup", "block"}, {"up", "schema"}),
    (("voxtouch", "up", "cup_f"), {"cup_field", "cup_friction"}, {"cup"}),
    (("voxtouch", "up", "cup", "--"), {"--motion", "--device", "--lockstep"}, {"--voxel"}),
    (("voxtouch", "up", "cup", "--motion", ""), {"slide", "hit"}, {"path", "motions"}),
    (
        ("voxtouch", "up", "cup", "--device", "sim"),
        {"sim-phantom", "sim-lwr", "sim:touch", "sim:fr3"},
        {"phantom"},
    ),
    (
        ("voxtouch", "up", "cup", "--device", "sim", ":", "omega"),
        {"omega_3", "omega_6", "omega_7"},
        {"touch"},
    ),
    (("voxtouch", "up", "cup", "--device", "sim", ":"), {"omega_3", "touch"}, set()),
    (("voxtouch", "up", "cup", "--device", "sim", ":", "/et"), {"/etc"}, {"touch"}),
    (("voxtouch", "up", "cup", "--realtime", ""), {"ignore", "enforce"}, set()),
    (("voxtouch", "up", "cup", "--hand", "pen"), {"pen", "pen-firm"}, {"arm"}),
    (("voxtouch", "change", "--model", ""), {"original", "adapted", "field"}, set()),
    (("voxtouch", "change", "viscosity", "o"), {"on", "off"}, {"gain"}),
    (("voxtouch_device", "--du"), {"--duration"}, {"--device"}),
    (("voxtouch_device", "--scene", "cup", "--motion", ""), {"slide"}, set()),
)


def bad_completions(root, binaries):
    for words, expected, unwanted in CASES:
        given, err = replies(root, binaries, *words)
        if err or not expected <= given or unwanted & given:
            yield (
                f"{' '.join(words)}: wanted {sorted(expected)}, not {sorted(unwanted)}; got"
                f" {sorted(given)} {err}"
            )


def bad_in_zsh(root, binaries):
    """What a person sees who presses Tab in zsh, twice over: the first time loads it. Nothing where
    there is no zsh.
    """
    if not shutil.which("zsh"):
        print("zsh is not here: its completion is left out")
        return
    with tempfile.TemporaryDirectory() as home:
        zsh, terminal = pty.fork()
        if zsh == 0:
            os.execve(
                shutil.which("zsh"),
                ["zsh", "-f", "-i"],
                {
                    "PATH": f"{binaries}:/usr/bin:/bin",
                    "TERM": "dumb",
                    "HOME": home,
                    "COLUMNS": "120",
                },
            )
        seen = ""

        def waits_for(text, seconds=30.0):
            nonlocal seen
            end = time.monotonic() + seconds
            while text not in seen and time.monotonic() < end:
                if select.select([terminal], [], [], 0.1)[0]:
                    seen += os.read(terminal, 65536).decode(errors="replace")
            found, seen = text in seen, ""
            return found

        os.write(
            terminal,
            f"fpath=({root}/deploy/completion $fpath); autoload -Uz compinit; compinit -u -D; echo"
            " rea''dy\n".encode(),
        )
        if not waits_for("ready"):
            yield "zsh does not get ready"
        for typed, expected in (
            ("voxtouch sta\t", "status "),
            ("voxtouch up cup --motion sl\t", "slide "),
            ("voxtouch rec\t", "recover "),
        ):
            os.write(terminal, typed.encode())
            if not waits_for(expected):
                yield f"zsh makes no {expected!r} of {typed!r}"
            os.write(terminal, b"\x15")
        os.kill(zsh, signal.SIGKILL)
        os.waitpid(zsh, 0)
        os.close(terminal)


def bad_effects(root, binaries):
    """Those of a scene that a rendering runs: a process of that name with such a command line
    stands in for it.
    """
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "own.yaml"
        scene.write_text(
            (
                "scene: own\neffects:\n  - viscosity: {damping_ns_per_m: 1}\n  - magnet: {x: 1}\n "
                " - viscosity: {y: 2}\nmotions: {}\n"
            ),
            encoding="utf-8",
        )
        named = pathlib.Path(folder) / "voxtouch_rendering"
        with subprocess.Popen(
            [str(named), "-c", "import time; time.sleep(60)", "--scene", str(scene)],
            executable=sys.executable,
        ) as process:
            try:
                given, err = replies(root, binaries, "voxtouch", "change", "")
            finally:
                process.kill()
        if given != {"viscosity", "magnet", "viscosity2"}:
            yield f"effects: got {sorted(given)} {err}"


def bad_pages(root, binaries, version):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(
            [
                sys.executable,
                "-B",
                root / "deploy/tools/man_page.py",
                binaries,
                folder,
                *PROGRAMS[:7],
            ],
            check=True,
            timeout=120,
        )
        text = gzip.decompress((pathlib.Path(folder) / "voxtouch.1.gz").read_bytes()).decode()
        for expected in (
            f"voxtouch {version}",
            "VOXTOUCH UP",
            "VOXTOUCH DOCTOR",
            "\\-\\-lockstep",
            "/home/you/.local",
        ):
            if expected not in text:
                yield f"voxtouch.1 does not say '{expected}'"
        for file in sorted(pathlib.Path(folder).iterdir()):
            run = subprocess.run(
                ["man", "--warnings", "-l", file],
                capture_output=True,
                text=True,
                timeout=60,
                check=False,
                env={**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": "400"},
            )
            if run.returncode or re.search("warning|error", run.stderr) or "NAME" not in run.stdout:
                yield f"{file.name}: {run.stderr[:300]}"


def main(root, binaries, version):
    root, binaries = pathlib.Path(root), pathlib.Path(binaries)
    wrong = []
    for name in PROGRAMS:
        run = subprocess.run(
            [binaries / name, "--version"], capture_output=True, text=True, timeout=60, check=False
        )
        if (run.returncode, run.stdout) != (0, version + "\n"):
            wrong.append(f"{name} --version: {run.returncode} '{run.stdout}' {run.stderr}")
    wrong += [
        *bad_completions(root, binaries),
        *bad_in_zsh(root, binaries),
        *bad_effects(root, binaries),
        *bad_pages(root, binaries, version),
    ]
    print("\n".join(wrong) or f"{len(CASES) + 1} completions, {len(PROGRAMS)} versions, 7 pages")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
