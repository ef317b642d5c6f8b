"""What the tests of faults share: every tool, ways to hurt it, and what must stay whole."""

import csv
import fcntl
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import tempfile
import time
import unittest.mock

import cloud_files
from cli_tool import FAST, TOOL, WRITTEN, ToolTest, call

BATCH = f"{TOOL}_batch"
EVALUATE = f"{TOOL}_evaluate"
POSE_GRAPH = f"{TOOL}_pose_graph"
SIMULATE = f"{TOOL}_simulate"
TRACK = f"{TOOL}_track"
TRANSFORM = f"{TOOL}_transform"
VIEWER = shutil.which(f"{TOOL}_viewer")  # None where it is not built
ALL_PROGRAMS = [TOOL, BATCH, EVALUATE, POSE_GRAPH, SIMULATE, TRACK, TRANSFORM]
ALL_PROGRAMS += [VIEWER] if VIEWER else []

MOTION = "0.1,-0.2,0.3,0.02,-0.01,0.5"
REGISTERED = set(WRITTEN)
OPTIMIZED = {"graph.g2o", "report.html", "trajectory_covariance.txt", "trajectory_tum.txt"}
TRACKED = {"edges.jsonl", *OPTIMIZED}
SIMULATED = {"T_target_source.txt", "scene.json", "source.pcd", "target.pcd"}
# The names that every tool of FaultTest.invocations() writes.
WRITES = {
    "register": REGISTERED,
    "register by SGD-ICP": {"aligned.pcd", "sgd_icp.json"},
    "simulate": SIMULATED,
    "transform": {"moved.pcd"},
    "transform to PLY": {"moved.ply"},
    "batch": {"results.jsonl"},
    "pose graph": {"g.g2o"},
    "optimized pose graph": OPTIMIZED,
    "track": TRACKED,
    "coverage": {"coverage.csv"},
    "sbc": {"report.html", "report.md", "sbc.csv", "sbc_ranks.png", "sbc_ranks.svg"},
    "viewer": {"picture.png"},
}
SGD_ICP = ["--method", "sgd-icp"]
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


def start_x_server(test_class):
    """The display of an X server that draws into memory, for as long as the tests of a class
    run; None without Xvfb."""
    if not shutil.which("Xvfb"):
        return None
    reading, writing = os.pipe()
    screen = ["-screen", "0", "1280x1024x24", "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(writing), *screen],
        pass_fds=[writing],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    test_class.addClassCleanup(server.wait)
    test_class.addClassCleanup(server.terminate)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        return ":" + pipe.readline().strip()


class FaultTest(ToolTest):
    @classmethod
    def has_display(cls):
        """Whether the viewer is built and has an X server to draw with, which is started."""
        if "display" not in cls.__dict__:
            cls.display = start_x_server(cls) if VIEWER else None
            if cls.display:
                variables = unittest.mock.patch.dict(os.environ, DISPLAY=cls.display)
                variables.start()
                cls.addClassCleanup(variables.stop)
        return cls.display is not None

    def invocations(self, output, pair=None):
        """{name: command line} of every tool, each with its output in the folder \p output."""
        source, target = pair or self.small_pair()
        clouds = {"source": source.name, "target": target.name}
        manifest = self.file("manifest.json", json.dumps([{"name": "pair", **clouds}]))
        pair = [source, target, *FAST, "--quiet"]
        graph = [POSE_GRAPH, *pair, "--weak-edges"]
        picture = ["--screenshot", output / "picture.png", "--size", "300x200"]
        camera = ["--width", "64", "--height", "48"]
        study = ["--threads", "1", "--output"]
        commands = {
            "register": [TOOL, *pair, "-o", output],
            "register by SGD-ICP": [TOOL, *SGD_ICP, source, target, "--quiet", "-o", output],
            "simulate": [SIMULATE, "--scene", "can", *camera, "-o", output],
            "transform": [TRANSFORM, source, output / "moved.pcd", "--pose", MOTION],
            "transform to PLY": [TRANSFORM, source, output / "moved.ply", "--pose", MOTION],
            "batch": [BATCH, manifest, *FAST, "--quiet", "--results", output / "results.jsonl"],
            "pose graph": [*graph, "-o", output / "g.g2o"],
            "optimized pose graph": [*graph, "--optimize", output],
            "track": [TRACK, target, source, *FAST, "--quiet", "-o", output],
            "coverage": [EVALUATE, "coverage", *ONE_CASE, *study, output / "coverage.csv"],
            "sbc": [EVALUATE, "sbc", *TWO_RUNS, *study, output / "sbc.csv", "--report"],
            "viewer": [VIEWER, *pair, *picture],
        }
        if not self.has_display():
            del commands["viewer"]
        return commands

    def run_whole(self, tool, output, **options):
        """Runs a tool, which writes all that it should; its command line."""
        command = self.invocations(output)[tool]
        self.assert_ran(call(*command, **options))
        self.assertEqual(self.names_in(output), WRITES[tool])
        return command

    def big_pair(self, num_points):
        """Two large boxes: numbers in memory, where small_pair() has none to speak of."""
        return tuple(
            self.pcd(f"big{seed}.pcd", cloud_files.box_surface(num_points, seed)) for seed in (1, 2)
        )

    def start_locked_out(self, folder, command):
        """A program that waits for its turn to put files into the folder, and a descriptor
        that keeps it from that until it is closed."""
        taken = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        fcntl.flock(taken, fcntl.LOCK_EX)
        process = self.start(*command)
        wait_for(lambda: waits_for_a_lock(process), process)
        return process, taken

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
