"""Runs the real pcl_bayesian_icp; the environment says where it and the scans are."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

import cloud_files

PROGRAMS = os.environ["PCL_BAYESIAN_ICP_PROGRAMS"]
TOOL = f"{PROGRAMS}/pcl_bayesian_icp"
DATA = pathlib.Path(os.environ["PCL_BAYESIAN_ICP_DATA"])
# What the tools are built with: a sanitizer needs more address space than can be limited.
SANITIZER = os.environ.get("PCL_BAYESIAN_ICP_SANITIZER")

# What a run writes into its folder, in order.
WRITTEN = ["aligned.pcd", "posterior.json", "report.html", "samples.csv"]
WITHOUT_REPORT = [name for name in WRITTEN if name != "report.html"]
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
        self.output = self.folder / "output"

    @classmethod
    def holder(cls):
        """One with a folder for what the tests of a class share."""
        holder = cls()
        ToolTest.setUp(holder)
        cls.addClassCleanup(holder.doCleanups)
        return holder

    def file(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def pcd(self, name, points, *fields, **writing):
        return self.file(name, cloud_files.pcd_bytes(points, *fields, **writing))

    def start(self, *words, **options):
        """A program that goes with the test at the latest."""
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, **options}
        process = subprocess.Popen(list(map(str, words)), **options)
        self.addCleanup(process.kill)
        return process

    def small_pair(self, **writing):
        """A box and the same box moved, as two PCD files."""
        to_source = np.linalg.inv(cloud_files.matrix_of(*SMALL_PAIR_POSE))
        source = np.float32(cloud_files.moved(to_source, cloud_files.box_surface(seed=2)))
        return (
            self.pcd("source.pcd", source.tolist(), **writing),
            self.pcd("target.pcd", cloud_files.box_surface(seed=1), **writing),
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

    def assert_each_refused(self, exit_code, command, cases):
        """As assert_refused(), for all (words, part, ...) that go with the command."""
        for words, *parts in cases:
            with self.subTest(words=words):
                self.assert_refused(exit_code, call(*command, *words), *parts)

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

    def assert_rows(self, document, rows):
        """{"x [m]": texts of mean, deviation, two quantiles, R-hat, ...} of posterior.json."""
        for coordinate in document["posterior"]["coordinates"]:
            name, unit = coordinate["name"], coordinate["unit"]
            keys = ["standard_deviation", "quantile_2.5_percent", "quantile_97.5_percent"]
            values = [document["posterior"]["mean"][f"{name}_{unit}"], *map(coordinate.get, keys)]
            numbers = list(map(float, rows[f"{name} [{unit}]"][:5]))
            self.assert_close(numbers[:4], values, delta=0.6e-6)
            self.assertAlmostEqual(numbers[4], coordinate["rhat"], delta=0.6e-3)

    def names_of_output(self):
        return sorted(path.name for path in self.output.iterdir())

    def assert_holds_truth(self, document, folder):
        """The true translation is within four standard deviations of the mean."""
        coordinates = document["posterior"]["coordinates"]
        for coordinate, true_value in zip(coordinates, true_translation(folder)):
            error = abs(coordinate["mean"] - true_value)
            self.assertLess(error, 4 * coordinate["standard_deviation"], coordinate["name"])

    def trusted_run(self, name, *arguments):
        """The document of a run on a committed pair: nothing to complain of, and the truth."""
        result = run(*scans(name), *arguments, "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        document = strict_json(result.stdout)
        self.assertEqual(document["status"]["name"], "ok")
        self.assert_holds_truth(document, DATA / name)
        return document

    def run_to_files(self, *arguments):
        """Run with -o; (samples.csv as text, posterior.json parsed)."""
        result = run(*arguments, "-o", self.output, *self.writing)
        self.assert_ran(result)
        self.assertEqual(result.stdout, "")
        samples = (self.output / "samples.csv").read_text()
        return samples, strict_json((self.output / "posterior.json").read_text())

    def run_to_json(self, *arguments):
        """What a run with --json prints."""
        result = run(*arguments, "--json")
        self.assert_ran(result)
        return strict_json(result.stdout)
