"""Runs the real pcl_bayesian_icp; the environment says where it and the scans are."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import cloud_files

PROGRAMS = os.environ["PCL_BAYESIAN_ICP_PROGRAMS"]
TOOL = f"{PROGRAMS}/pcl_bayesian_icp"
DATA = pathlib.Path(os.environ["PCL_BAYESIAN_ICP_DATA"])
# What the tools are built with: a sanitizer needs more address space than can be limited.
SANITIZER = os.environ.get("PCL_BAYESIAN_ICP_SANITIZER")

# The pose that brings the source of small_pair() onto its target.
SMALL_PAIR_POSE = (0.01, -0.02, 0.015, 0.05, -0.04, 0.08)
CALIBRATED = ["--preset=calibrated", "--prior-frame=source-centroid"]
FAST = ["--preset", "paper", "--samples", "60", "--chains", "2", "--step-size", "1e-6"]


def call(*words, **options):
    """The completed process; nothing may take longer than two minutes."""
    options = {"stdout": subprocess.PIPE, "timeout": 120, **options}
    return subprocess.run(
        list(map(str, words)), stderr=subprocess.PIPE, text=True, check=False, **options
    )


def run(*arguments, **options):
    return call(TOOL, *arguments, **options)


def strict_json(text):
    """NaN and Infinity are no JSON."""

    def refuse(constant):
        raise ValueError(f"{constant} in JSON")

    return json.loads(text, parse_constant=refuse)


def scans(name):
    """Source and target of a committed pair."""
    return [DATA / name / "source.pcd", DATA / name / "target.pcd"]


def true_translation(folder):
    """Of a pair of scans, [x, y, z]."""
    return list(map(float, (folder / "T_target_source.txt").read_text().split()))[3:12:4]


class ToolTest(unittest.TestCase):
    """A folder of its own for every test, and what is asked of all runs."""

    # The one that assert_refused() expects to speak.
    program = "pcl_bayesian_icp"
    # Of run_to_files(): a report takes longer to draw than most runs take.
    writing = ["--quiet", "--no-report"]

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def start(self, *words, **options):
        """A program that goes with the test at the latest."""
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, **options}
        process = subprocess.Popen(list(map(str, words)), **options)
        self.addCleanup(process.kill)
        return process

    def small_pair(self, **writing):
        """A box and the same box moved, as two PCD files."""
        target = cloud_files.box_surface(seed=1)
        matrix = cloud_files.matrix_of(*SMALL_PAIR_POSE)
        source = [
            tuple(map(cloud_files.as_float32, cloud_files.inverse_moved(matrix, point)))
            for point in cloud_files.box_surface(seed=2)
        ]
        return (
            self.file("source.pcd", cloud_files.pcd_bytes(source, **writing)),
            self.file("target.pcd", cloud_files.pcd_bytes(target, **writing)),
        )

    def assert_refused(self, exit_code, result, *parts):
        """One line on standard error that has all \\p parts, and nothing else."""
        self.assertEqual(result.returncode, exit_code, result.stderr)
        self.assertEqual(result.stdout, "")
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertTrue(lines[0].startswith(f"{self.program}: "), result.stderr)
        for part in parts:
            self.assertIn(str(part), lines[0])

    def assert_close(self, found, expected, delta):
        """Numbers, or lists of the same shape of these, that differ by \\p delta at most."""
        if isinstance(expected, (int, float)):
            self.assertAlmostEqual(found, expected, delta=delta)
            return
        self.assertEqual(len(found), len(expected))
        for a, b in zip(found, expected):
            self.assert_close(a, b, delta)

    def assert_ran(self, result):
        """A posterior was sampled, whatever is to be thought of it."""
        self.assertIn(result.returncode, (0, 1), result.stderr)

    def assert_holds_truth(self, document, folder):
        """The true translation is within four standard deviations of the mean."""
        coordinates = document["posterior"]["coordinates"]
        for coordinate, true_value in zip(coordinates, true_translation(folder)):
            error = abs(coordinate["mean"] - true_value)
            self.assertLess(error, 4 * coordinate["standard_deviation"], coordinate["name"])

    def run_to_files(self, *arguments):
        """Run with -o; (samples.csv as text, posterior.json parsed)."""
        output = self.folder / "output"
        result = run(*arguments, "-o", output, *self.writing)
        self.assert_ran(result)
        self.assertEqual(result.stdout, "")
        samples = (output / "samples.csv").read_text()
        return samples, strict_json((output / "posterior.json").read_text())
