"""Builds the package `voxtouch` from this tree: `pip install deploy/python`, or with
--no-build-isolation without a network.

C++ parts come from the tree's build, which CMake runs first: build/, or the folder in
VOXTOUCH_BUILD. deploy/setup installs the requirements.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BUILD = pathlib.Path(os.environ.get("VOXTOUCH_BUILD", ROOT / "build"))
SCRATCH = BUILD / "python_package"  # nothing is left in the tree
VERSION = re.search(
    r"project\(voxtouch VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
)[1]


def run(*words):
    try:
        subprocess.run(list(map(str, words)), check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(
            f"{words[0]} failed ({error}). deploy/setup installs what the build needs; deploy/build"
            " shows what it says."
        )


def definitions():
    """The text of every message with its used types, and its hash, by ROS name."""
    sys.path.insert(0, str(ROOT / "idl"))
    import generate_idl
    from type_hash import type_hash

    messages, texts = {}, {}
    for folder in [ROOT / "idl/msg", *sorted((ROOT / "idl/ros").glob("*/msg"))]:
        package = "voxtouch_msgs" if folder.parent.name == "idl" else folder.parent.name
        for path in sorted(folder.glob("*.msg")):
            messages[package, path.stem] = generate_idl.parse(path, package)
            texts[package, path.stem] = path.read_text(encoding="utf-8")
    return {
        f"{p}/msg/{n}": (generate_idl.definition(messages, texts, p, n), type_hash(messages, p, n))
        for p, n in messages
    }


class Build(build_py):
    """Copies files of the tree's build next to the Python files."""

    def run(self):
        super().run()
        if not (BUILD / "build.ninja").exists():
            run("cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja")
        run("cmake", "--build", BUILD, "--target", "voxtouch_python_package")
        package = pathlib.Path(self.build_lib) / "voxtouch"
        modules = list((BUILD / "python_module").glob("_core.*"))
        if not modules:
            sys.exit(
                f"{BUILD} built no Python module. Install pybind11-dev and python3-dev "
                f"(deploy/setup does)."
            )
        for module in modules:
            shutil.copy2(module, package)
        shutil.copy2(BUILD / "bin/voxtouch_import_mesh", package)
        shutil.copy2(ROOT / "deploy/tools/bag_files.py", package / "_bag_files.py")
        (package / "_definitions.py").write_text(
            (
                '"""Messages by ROS name: (definition, hash); written by setup.py."""\nDEFINITIONS'
                f" = {definitions()!r}\n"
            ),
            encoding="utf-8",
        )
        run(BUILD / "bin/voxtouch", "types", "--python", package)
        shutil.rmtree(package / "types", ignore_errors=True)
        (package / "voxtouch_types").rename(package / "types")
        for name in ("scenes", "meshes", "devices"):
            shutil.copytree(
                ROOT / "deploy" / name,
                package / "share" / name,
                dirs_exist_ok=True,
                ignore=shutil.ignore_patterns("*.py", "*.md"),
            )


class Compiled(Distribution):
    def has_ext_modules(self):
        return True


SCRATCH.mkdir(parents=True, exist_ok=True)
setup(
    options={"build": {"build_base": str(SCRATCH)}, "egg_info": {"egg_base": str(SCRATCH)}},
    name="voxtouch",
    version=VERSION,
    description="Bags, topics, contacts and couplings of voxtouch",
    packages=["voxtouch"],
    distclass=Compiled,
    cmdclass={"build_py": Build},
    python_requires=">=3.10",
    install_requires=["numpy>=1.24", "zstandard>=0.20"],
    extras_require={
        "pandas": ["pandas>=1.5"],
        "dds": ["cyclonedds==11.0.1"],
        "plot": ["matplotlib>=3.6"],
    },
)
