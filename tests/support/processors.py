"""Processor time of other programs: a test checks times only if it is small, and otherwise prints
them with the fraction.
"""

import os
import pathlib
import time

QUIET = 0.1  # the fraction that programs of others may take


class Processors:
    """Fraction of the processors used by other programs from now on: all busy time except that of
    this program and its children.
    """

    def __init__(self):
        self.begin = self.now()

    @staticmethod
    def now():
        user, nice, system, *_, steal = (
            int(ticks)
            for ticks in pathlib.Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:9]
        )  # not interrupts: none's
        processes = {}
        for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
            try:
                fields = stat.read_text().rpartition(")")[2].split()
            except OSError:
                continue  # it has just ended
            processes[int(stat.parent.name)] = int(fields[1]), int(fields[11]) + int(fields[12])
        own = os.getpid()

        def is_ours(pid):
            while pid in processes and pid != own:
                pid = processes[pid][0]
            return pid == own

        ended = os.times()
        ours = sum(ticks for pid, (_, ticks) in processes.items() if is_ours(pid)) + (
            ended.children_user + ended.children_system
        ) * os.sysconf("SC_CLK_TCK")
        return time.monotonic(), user + nice + system + steal - ours

    def taken_by_others(self):
        (begin_s, before), (end_s, after) = self.begin, self.now()
        return max(after - before, 0.0) / (
            os.sysconf("SC_CLK_TCK") * os.cpu_count() * (end_s - begin_s)
        )
