"""What the tests of faults share: every tool, ways to hurt it, and what must stay whole."""

import csv
import fcntl
import json
import os
import pathlib
import re
import resource
import shutil
import tempfile
import time
import unittest.mock

import cloud_files
import x_server
from cli_tool import FAST, TOOL, ToolTest, call

BATCH = f"{TOOL}_batch"
EVALUATE = f"{TOOL}_evaluate"
POSE_GRAPH = f"{TOOL}_pose_graph"
SIMULATE = f"{TOOL}_simulate"
TRACK = f"{TOOL}_track"
TRANSFORM = f"{TOOL}_transform"
VIEWER = shutil.which(f"{TOOL}_viewer")  # None where it is not built

MOTION = "0.1,-0.2,0.3,0.02,-0.01,0.5"
REGISTERED = {"aligned.pcd", "posterior.json", "report.html", "samples.csv"}
TRACKED = {
    "edges.jsonl",
    "graph.g2o",
    "report.html",
    "trajectory_covariance.txt",
    "trajectory_tum.txt",
}
SIMULATED = {"T_target_source.txt", "scene.json", "source.pcd", "target.pcd"}
ONE_CASE = ["--methods", "calibrated", "--scenes", "can", "--conditions", "same", "--seeds", "1"]
TWO_RUNS = ["--sampler", "exact-langevin", "--runs", "2"]
# A temporary file of an output on its way.
TEMPORARY = re.compile(r"\.[A-Za-z0-9]{6}$")
# What a tool has finished stays in these, whatever becomes of the rest.
GROWING = {"coverage.csv", "edges.jsonl", "results.jsonl", "sbc.csv"}
# Minutes of work, of which each chain keeps a draw about every 50 ms.
ENDLESS = ["--preset", "paper", "--samples", "4000", "--thinning", "1000", "--step-size", "1e-6"]


def catches(process, signal_number):
    """Whether the program has taken charge of a signal."""
    for line in pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines():
        if line.startswith("SigCgt:"):
            return bool(int(line.split()[1], 16) >> (signal_number - 1) & 1)
    return False


def processor_seconds(process):
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def lock(folder):
    """A descriptor that keeps others from putting files into the folder until it is
    closed."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    fcntl.flock(descriptor, fcntl.LOCK_EX)
    return descriptor


def waits_for_a_lock(process):
    locks = pathlib.Path("/proc/locks").read_text().splitlines()
    return any("->" in line and f" {process.pid} " in line for line in locks)


def wait_for(condition, process):
    """Until it holds; how long that takes is the machine's affair."""
    while not condition():
        if process.poll() is not None:
            raise AssertionError(f"ended early: {process.communicate()}")
        time.sleep(0.01)


def rows_of(results):
    """The rows of a study's file, in order, without times."""
    with open(results, encoding="ascii", newline="") as file:
        rows = [{k: v for k, v in row.items() if k != "seconds"} for row in csv.DictReader(file)]
    return sorted(rows, key=lambda row: list(row.values()))


class FaultTest(ToolTest):
    @classmethod
    def has_display(cls):
        """Whether the viewer is built and has an X server to draw with, which is started."""
        if "display" not in cls.__dict__:
            cls.display = x_server.start(cls) if VIEWER else None
            if cls.display:
                variables = unittest.mock.patch.dict(os.environ, DISPLAY=cls.display)
                variables.start()
                cls.addClassCleanup(variables.stop)
        return cls.display is not None

    def invocations(self, output, pair=None):
        """{name: (command line, names that it writes)} of every tool, each with its output
        in the folder \\p output."""
        source, target = pair or self.small_pair()
        clouds = {"source": source.name, "target": target.name}
        manifest = self.file("manifest.json", json.dumps([{"name": "pair", **clouds}]))
        picture = ["--screenshot", output / "picture.png", "--size", "300x200"]
        viewer = {
            "viewer": ([VIEWER, source, target, *FAST, "--quiet", *picture], {"picture.png"})
        }
        study = ["--threads", "1", "--output"]
        return {
            "register": (
                [TOOL, source, target, *FAST, "--quiet", "-o", output],
                REGISTERED,
            ),
            "register by SGD-ICP": (
                [TOOL, "--method", "sgd-icp", source, target, "--quiet", "-o", output],
                {"aligned.pcd", "sgd_icp.json"},
            ),
            "simulate": (
                [SIMULATE, "--scene", "can", "--width", "64", "--height", "48", "-o", output],
                SIMULATED,
            ),
            "transform": (
                [TRANSFORM, source, output / "moved.pcd", "--pose", MOTION],
                {"moved.pcd"},
            ),
            "transform to PLY": (
                [TRANSFORM, source, output / "moved.ply", "--pose", MOTION],
                {"moved.ply"},
            ),
            "batch": (
                [BATCH, manifest, *FAST, "--quiet", "--results", output / "results.jsonl"],
                {"results.jsonl"},
            ),
            "pose graph": (
                [POSE_GRAPH, source, target, *FAST, "--weak-edges", "--quiet", "-o", output / "g.g2o"],
                {"g.g2o"},
            ),
            "optimized pose graph": (
                [POSE_GRAPH, source, target, *FAST, "--weak-edges", "--quiet", "--optimize", output],
                TRACKED - {"edges.jsonl"},
            ),
            "track": ([TRACK, target, source, *FAST, "--quiet", "-o", output], TRACKED),
            "coverage": (
                [EVALUATE, "coverage", *ONE_CASE, *study, output / "coverage.csv"],
                {"coverage.csv"},
            ),
            "sbc": (
                [EVALUATE, "sbc", *TWO_RUNS, *study, output / "sbc.csv", "--report"],
                {"report.html", "report.md", "sbc.csv", "sbc_ranks.png", "sbc_ranks.svg"},
            ),
            **(viewer if self.has_display() else {}),
        }

    def run_whole(self, tool, output, **options):
        """Runs a tool, which writes all that it should; its command line."""
        command, names = self.invocations(output)[tool]
        result = call(*command, **options)
        self.assertIn(result.returncode, (0, 1), result.stderr)
        self.assertEqual(self.names_in(output), names)
        return command

    def big_pair(self, num_points):
        """Two large boxes: numbers in memory, where small_pair() has none to speak of."""
        return tuple(
            self.file(f"big{seed}.pcd", cloud_files.pcd_bytes(cloud_files.box_surface(num_points, seed)))
            for seed in (1, 2)
        )

    def new_folder(self):
        return pathlib.Path(tempfile.mkdtemp(dir=self.folder))

    def names_in(self, folder):
        names = {path.name for path in folder.iterdir()}
        self.assertFalse([name for name in names if TEMPORARY.search(name)], names)
        return names

    def refusal(self, command, launcher=(), **options):
        """What a program itself said last that cannot read or write a file."""
        result = call(*launcher, *command, **options)
        self.assertEqual(result.returncode, 3, result.stderr)
        last = result.stderr.splitlines()[-1]
        self.assertTrue(last.startswith(f"{pathlib.Path(command[0]).name}: "), result.stderr)
        return last


def limited(kind, size):
    """For preexec_fn: no more than so many bytes, and no core file."""

    def limit():
        resource.setrlimit(kind, (size, size))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    return limit
