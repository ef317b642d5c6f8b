"""Too little memory, and clouds that need much: a reason and an exit code, never a signal,
never half a file."""

import functools
import os
import resource
import subprocess
import unittest

import numpy as np

import cloud_files
from cli_tool import SANITIZER
from faults import GROWING, MOTION, TOOL, TRANSFORM, WRITES, FaultTest, call, limited

MEBIBYTE = 1 << 20
# Above what the libraries alone need, to more than enough.
EXTRA = [size * MEBIBYTE for size in (0, 4, 8, 14, 22, 32, 45, 65, 230)]
# Measured, and a third more: of each point of both clouds, and of one cloud.
MOST_BYTES_A_POINT = {"register": 250, "transform": 160}
# The loader's, for a program whose libraries do not fit.
NOT_LOADED = 127


@unittest.skipIf(SANITIZER, "a sanitizer needs more address space than is left")
class OutOfMemory(FaultTest):
    @functools.lru_cache(maxsize=None)  # of programs that are several tools
    def least_limit(self, program):
        """Address space with which the program begins to run, to a mebibyte [bytes]."""
        too_little, enough = 0, 1024 * MEBIBYTE
        while enough - too_little > MEBIBYTE:
            limit = (too_little + enough) // 2
            runs = call(program, "--help", preexec_fn=limited(resource.RLIMIT_AS, limit))
            if runs.returncode == 0:
                enough = limit
            else:
                too_little = limit
        self.assertLess(enough, 1024 * MEBIBYTE)
        return enough

    def ran_out(self, tool, pair, limit):
        """Whether a tool that has so much address space [bytes] said that it is too little."""
        output = self.new_folder()
        result = call(*self.invocations(output, pair)[tool], preexec_fn=limited(resource.RLIMIT_AS, limit))
        found = self.names_in(output)
        if result.returncode == NOT_LOADED:
            self.assertEqual(found, set())
            return False
        self.assert_ran(result)
        # A batch tells in its file what became of a pair, a pose graph goes on without one.
        told = {"g.g2o", "graph.g2o", *GROWING}
        text = result.stderr
        if "results.jsonl" in found:
            text += (output / "results.jsonl").read_text()
        if "out of memory" in text or "libgomp" in text:
            self.assertEqual(result.returncode, 1)
            self.assertTrue(found <= told, found)
            return True
        self.assertEqual(found, WRITES[tool], text)
        return False

    def test_every_tool(self):
        pair = self.big_pair(20000)
        bigger = [self.pcd("bigger.pcd", cloud_files.box_surface(20000, 3) * 15)] * 2
        # OpenGL and Python have words and signals of their own.
        tools = [tool for tool in self.invocations(self.folder) if tool not in ("viewer", "sbc")]
        for tool in tools:
            its_pair = bigger if tool.startswith("transform") else pair
            with self.subTest(tool=tool):
                least = self.least_limit(self.invocations(self.folder, its_pair)[tool][0])
                ran_out = [self.ran_out(tool, its_pair, least + extra) for extra in EXTRA]
                self.assertIn(True, ran_out)
                self.assertFalse(ran_out[-1])


class LargeClouds(FaultTest):
    """Ten million points; minutes, and gigabytes on the disk."""

    NUM_POINTS = 10_000_000

    def large_cloud(self, seed):
        """A wavy floor of 100 x 100 m."""
        generator = np.random.default_rng(seed)
        points = generator.random((self.NUM_POINTS, 3), np.float32) * [100, 100, 0.01]
        points[:, 2] += points[:, 0] * points[:, 1] % 1.7
        head = cloud_files.pcd_header(cloud_files.XYZ, self.NUM_POINTS, "binary")
        return self.file(f"large{seed}.pcd", head + points.astype(np.float32).tobytes())

    def peak_of(self, *words):
        """Largest resident memory [bytes] of a run that ends well or with exit code 1."""
        with subprocess.Popen([str(word) for word in words], stdout=subprocess.DEVNULL) as process:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        self.assertIn(process.returncode, (0, 1))
        return usage.ru_maxrss * 1024

    def test_memory_is_bounded(self):
        source, target = self.large_cloud(1), self.large_cloud(2)
        per_point = {}
        words = [TOOL, source, target, "-i", "1", "--no-report", "--quiet", "-o", self.folder / "o"]
        per_point["register"] = self.peak_of(*words) / (2 * self.NUM_POINTS)
        self.assertTrue((self.folder / "o" / "posterior.json").exists())
        words = [TRANSFORM, source, self.folder / "moved.pcd", "--pose", MOTION]
        per_point["transform"] = self.peak_of(*words) / self.NUM_POINTS
        print({tool: round(size) for tool, size in per_point.items()}, "bytes a point")
        for tool, size in per_point.items():
            self.assertLess(size, MOST_BYTES_A_POINT[tool])
