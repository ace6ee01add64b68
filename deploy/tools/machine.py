"""The machine that a page of results was measured on."""

import os
import pathlib
import platform


def machine():
    """Name and number of its processors, such as "AMD EPYC, 2 processors"."""
    for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return f"{line.split(':')[1].strip()}, {os.cpu_count()} processors"
    return f"{platform.machine()}, {os.cpu_count()} processors"
