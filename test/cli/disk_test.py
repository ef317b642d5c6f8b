"""Full disks, folders that cannot be written, and two runs that write to one folder."""

import contextlib
import fcntl
import os
import pathlib
import resource
import shutil
import subprocess
import unittest

from cli_tool import FAST, SANITIZER, TOOL, strict_json
from faults import ALL_PROGRAMS, EVALUATE, GROWING, TWO_RUNS, WRITES, FaultTest, call, limited


class FullDisk(FaultTest):
    @unittest.skipIf(SANITIZER, "libomp, Clang's, needs a file of shared memory that is larger")
    def test_limit_on_the_size_of_files(self):
        """Its signal would kill a program that does not expect it."""
        for tool in self.invocations(self.folder):
            with self.subTest(tool=tool):
                # The graph of two scans is small, and so are the tables of the studies.
                is_small = tool.endswith("pose graph") or tool in ("coverage", "sbc")
                limit = limited(resource.RLIMIT_FSIZE, 100 if is_small else 1000)
                output = self.new_folder()
                (output / "old.txt").write_text("old")
                reason = self.refusal(self.invocations(output)[tool], preexec_fn=limit)
                self.assertIn(str(output), reason)
                self.assertIn("cannot be written", reason)
                self.assertTrue(self.names_in(output) <= {"old.txt", *GROWING})
                self.assertEqual((output / "old.txt").read_text(), "old")

    def test_disk_without_room(self):
        for tool in self.invocations(self.folder):
            with self.subTest(tool=tool):
                with self.small_disk() as output:
                    call("dd", "if=/dev/zero", f"of={output}/more", "bs=512")
                    self.check_small_disk(self.invocations(output)[tool], output)

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

    def check_small_disk(self, command, output):
        self.assertIn("cannot be written", self.refusal(command))
        self.assertTrue(self.names_in(output) <= {"filler", "more", *GROWING})

    def test_standard_output(self):
        table = [TOOL, *self.small_pair(), *FAST]
        for command in [table, *([program, "--help"] for program in ALL_PROGRAMS)]:
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
            for tool, command in self.invocations(place).items():
                with self.subTest(tool=tool, place=place):
                    self.assertIn(str(place), self.refusal(command))
        self.assertEqual(obstacle.read_bytes(), b"")

    def test_folder_that_may_not_be_written(self):
        rights = self.rights_of_a_user()
        for tool in self.invocations(self.folder):
            with self.subTest(tool=tool):
                output = self.new_folder()
                command = self.invocations(output)[tool]
                output.chmod(0o555)
                self.assertIn("Permission denied", self.refusal(command, rights))
                self.assertEqual(self.names_in(output), set())

    def test_read_only_inputs(self):
        """Nothing is written but the output: folder and files of the inputs are read-only,
        and it is there that the tools run."""
        rights = self.rights_of_a_user()
        outputs, inputs = self.new_folder(), self.new_folder()
        self.folder = inputs
        runs = {tool: self.invocations(outputs / tool)[tool] for tool in self.invocations(outputs)}
        before = {path.name: path.read_bytes() for path in inputs.iterdir()}
        for path in [*inputs.iterdir(), inputs]:
            path.chmod(0o555)
        self.addCleanup(inputs.chmod, 0o755)
        self.assertNotEqual(call(*rights, "touch", inputs / "new").returncode, 0)
        for tool, command in runs.items():
            with self.subTest(tool=tool):
                (outputs / tool).mkdir()
                self.assert_ran(call(*rights, *command, cwd=inputs))
                self.assertEqual(self.names_in(outputs / tool), WRITES[tool])
        after = {path.name: path.read_bytes() for path in inputs.iterdir()}
        self.assertEqual(after, before)


class OneFolderForTwo(FaultTest):
    def test_files_wait_for_another_run_to_put_its_own(self):
        """A run that another one keeps from the folder has nothing there yet, and then all."""
        output = self.new_folder()
        process, taken = self.start_locked_out(output, self.invocations(output)["register"])
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
        output = self.new_folder()
        for tool, name in (("sbc", "sbc.csv"), ("batch", "results.jsonl")):
            with open(output / name, "w", encoding="ascii") as taken:
                fcntl.flock(taken, fcntl.LOCK_EX)
                reason = self.refusal(self.invocations(output)[tool])
                self.assertIn("in use by another process", reason)
            self.assertEqual((output / name).read_text(), "")
