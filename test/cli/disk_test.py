"""Full disks, folders that cannot be written, and two runs that write to one folder."""

import contextlib
import fcntl
import json
import os
import pathlib
import resource
import shutil
import subprocess
import unittest

from cli_tool import FAST, SANITIZER, TOOL, strict_json
from faults import (
    BATCH,
    EVALUATE,
    GROWING,
    POSE_GRAPH,
    SIMULATE,
    TRACK,
    TRANSFORM,
    TWO_RUNS,
    VIEWER,
    FaultTest,
    call,
    limited,
    lock,
    wait_for,
    waits_for_a_lock,
)

PROGRAMS = [TOOL, BATCH, EVALUATE, POSE_GRAPH, SIMULATE, TRACK, TRANSFORM]
PROGRAMS += [VIEWER] if VIEWER else []


class FullDisk(FaultTest):
    def check(self, tool, output, **options):
        """A tool has no room for its files in \\p output, where there is an old one."""
        (output / "old.txt").write_text("old")
        command, _ = self.invocations(output)[tool]
        reason = self.refusal(command, **options)
        self.assertIn(str(output), reason)
        self.assertIn("cannot be written", reason)
        self.assertTrue(self.names_in(output) <= {"old.txt", *GROWING})
        self.assertEqual((output / "old.txt").read_text(), "old")

    @unittest.skipIf(SANITIZER, "libomp, Clang's, needs a file of shared memory that is larger")
    def test_limit_on_the_size_of_files(self):
        """Its signal would kill a program that does not expect it."""
        for tool in self.invocations(self.folder):
            with self.subTest(tool=tool):
                # The graph of two scans is small, and so are the tables of the studies.
                is_small = tool.endswith("pose graph") or tool in ("coverage", "sbc")
                size = 100 if is_small else 1000
                self.check(
                    tool, self.new_folder(), preexec_fn=limited(resource.RLIMIT_FSIZE, size)
                )

    def test_disk_without_room(self):
        for tool in self.invocations(self.folder):
            with self.subTest(tool=tool):
                with self.small_disk() as output:
                    command, _ = self.invocations(output)[tool]
                    self.fill(output)
                    self.check_small_disk(command, output)

    def test_report_on_a_disk_without_room(self):
        """There is room for the rows, but not for the pictures."""
        with self.small_disk() as output:
            command = [EVALUATE, "sbc", *TWO_RUNS, "--output", output / "sbc.csv"]
            self.check_small_disk([*command, "--report"], output)
            self.assertGreater(len((output / "sbc.csv").read_text().splitlines()), 1)

    @contextlib.contextmanager
    def small_disk(self):
        """The folder of a file system in memory of three pages, two of which hold
        something."""
        output = self.new_folder()
        mount = ["mount", "-t", "tmpfs", "-o", "size=12k", "tmpfs", str(output)]
        if os.geteuid() != 0 or subprocess.run(mount, capture_output=True).returncode:
            self.skipTest("only root can make a small disk")
        try:
            (output / "filler").write_bytes(bytes(8192))
            yield output
        finally:
            subprocess.run(["umount", str(output)], check=True)

    @staticmethod
    def fill(output):
        with open(output / "more", "wb", buffering=0) as more:
            try:
                while more.write(bytes(512)):
                    pass
            except OSError:
                pass

    def check_small_disk(self, command, output):
        self.assertIn("cannot be written", self.refusal(command))
        self.assertTrue(self.names_in(output) <= {"filler", "more", *GROWING})

    def test_standard_output(self):
        table = [TOOL, *self.small_pair(), *FAST]
        for command in [table, *([program, "--help"] for program in PROGRAMS)]:
            with self.subTest(command=command):
                with open("/dev/full", "w", encoding="ascii") as full:
                    reason = self.refusal(command, stdout=full)
                self.assertIn("standard output: cannot be written", reason)


class Unwritable(FaultTest):
    def rights_of_a_user(self):
        """What to begin a command line with: root may write everything, unless that right
        is taken away."""
        if os.geteuid() != 0:
            return []
        rights = ["setpriv", "--bounding-set=-dac_override", "--inh-caps=-all", "--"]
        if not shutil.which(rights[0]) or call(*rights, "true").returncode != 0:
            self.skipTest("the rights of root cannot be taken away here")
        return rights

    def test_places_that_are_no_folders(self):
        obstacle = self.file("obstacle", "")
        for place in (obstacle, pathlib.Path("/proc/no_such")):
            for tool, (command, _) in self.invocations(place).items():
                with self.subTest(tool=tool, place=place):
                    self.assertIn(str(place), self.refusal(command))
        self.assertEqual(obstacle.read_bytes(), b"")

    def test_folder_that_may_not_be_written(self):
        rights = self.rights_of_a_user()
        for tool in self.invocations(self.folder):
            with self.subTest(tool=tool):
                output = self.new_folder()
                command, _ = self.invocations(output)[tool]
                output.chmod(0o555)
                self.assertIn("Permission denied", self.refusal(command, rights))
                self.assertEqual(self.names_in(output), set())

    def test_read_only_inputs(self):
        """Nothing is written but the output: folder and files of the inputs are read-only,
        and it is there that the tools run."""
        rights = self.rights_of_a_user()
        outputs, inputs = self.new_folder(), self.new_folder()
        self.folder = inputs
        runs = {}
        for tool in self.invocations(outputs):
            (outputs / tool).mkdir()
            runs[tool] = self.invocations(outputs / tool)[tool]
        before = {path.name: path.read_bytes() for path in inputs.iterdir()}
        for path in [*inputs.iterdir(), inputs]:
            path.chmod(0o555)
        self.addCleanup(inputs.chmod, 0o755)
        self.assertNotEqual(call(*rights, "touch", inputs / "new").returncode, 0)
        for tool, (command, names) in runs.items():
            with self.subTest(tool=tool):
                result = call(*rights, *command, cwd=inputs)
                self.assertIn(result.returncode, (0, 1), result.stderr)
                self.assertEqual(self.names_in(outputs / tool), names)
        after = {path.name: path.read_bytes() for path in inputs.iterdir()}
        self.assertEqual(after, before)


class OneFolderForTwo(FaultTest):
    def test_files_wait_for_another_run_to_put_its_own(self):
        """A run that another one keeps from the folder has nothing there yet, and then all."""
        pair = self.small_pair()
        output = self.new_folder()
        taken = lock(output)
        process = self.start(TOOL, *pair, *FAST, "--quiet", "-o", output)
        wait_for(lambda: waits_for_a_lock(process), process)
        self.assertFalse({"posterior.json", "samples.csv"} & {p.name for p in output.iterdir()})
        os.close(taken)
        _, errors = process.communicate(timeout=60)
        self.assertIn(process.returncode, (0, 1), errors)
        self.assertIn("posterior.json", self.names_in(output))

    def test_the_files_are_of_one_run(self):
        pair = self.small_pair()
        draws = {}
        for seed in range(1, 5):
            alone = self.new_folder()
            call(TOOL, *pair, *FAST, "--quiet", "--no-report", "--seed", seed, "-o", alone)
            draws[seed] = (alone / "samples.csv").read_text()
        self.assertEqual(len(set(draws.values())), len(draws))
        output = self.new_folder()
        words = [TOOL, *pair, *FAST, "--quiet", "--no-report", "-o", output, "--seed"]
        processes = [self.start(*words, seed) for seed in draws]
        for process in processes:
            process.communicate(timeout=120)
            self.assertIn(process.returncode, (0, 1))
        document = strict_json((output / "posterior.json").read_text())
        seed = document["options"]["chains"]["seed"]
        self.assertEqual((output / "samples.csv").read_text(), draws[seed])
        self.assertEqual(self.names_in(output), {"aligned.pcd", "posterior.json", "samples.csv"})

    def test_a_file_of_results_is_for_one_run_at_a_time(self):
        self.small_pair()
        pair = {"name": "pair", "source": "source.pcd", "target": "target.pcd"}
        manifest = self.file("manifest.json", json.dumps([pair]))
        results = self.file("results", "")
        with open(results, "r+", encoding="ascii") as taken:
            fcntl.flock(taken, fcntl.LOCK_EX)
            for words in (
                [EVALUATE, "sbc", "--runs", 1, "--output", results],
                [BATCH, manifest, *FAST, "--results", results],
            ):
                self.assertIn("in use by another process", self.refusal(words))
        self.assertEqual(results.read_text(), "")
