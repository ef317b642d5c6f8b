"""SIGINT and SIGTERM in the middle: what there is is kept, the exit code is 130.

No test waits for a time: a signal is sent when the program has taken charge of it, and has
used the processor for long enough to have draws."""

import os
import shutil
import signal
import time

from cli_tool import FAST, TOOL, strict_json
from faults import EVALUATE, POSE_GRAPH, SIMULATE, TRACK, TRANSFORM
from faults import ENDLESS, MOTION, ONE_CASE, OPTIMIZED, REGISTERED, SIMULATED, TRACKED, WRITES
from faults import FaultTest, call, catches, processor_seconds, rows_of, wait_for

SIGNALS = (signal.SIGINT, signal.SIGTERM)
# A draw takes 50 ms of ENDLESS, after ICP and the reading of the files.
ENOUGH_SECONDS = 2.0
# Work for many seconds by every preset, and what ends it.
DRAWING = {
    "paper": (ENDLESS, signal.SIGINT),
    "exact": (["--preset", "exact", "--samples", "1000000"], signal.SIGTERM),
    "calibrated": (["--samples", "1000000"], signal.SIGINT),
}


class EndedBySignal(FaultTest):
    def end(self, process, signal_number, seconds=ENOUGH_SECONDS):
        """(standard output, standard error) of a program that is sent a signal."""
        wait_for(
            lambda: catches(process, signal_number) and processor_seconds(process) >= seconds,
            process,
        )
        process.send_signal(signal_number)
        return process.communicate(timeout=60)

    def test_draws_are_written(self):
        for preset, (options, number) in DRAWING.items():
            with self.subTest(preset=preset, signal=number.name):
                self.check_draws(preset, options, number)

    def check_draws(self, preset, options, number):
        pair = self.small_pair()
        output = self.new_folder()
        process = self.start(TOOL, *pair, *options, "-o", output, "--json")
        text, errors = self.end(process, number)
        self.assertRegex(errors, r"^pcl_bayesian_icp: interrupted: .*\n$")
        self.assertEqual(process.returncode, 130)
        document = strict_json(text)
        self.assertEqual(document["options"]["posterior"]["preset"], preset)
        self.assertEqual(document["status"]["name"], "interrupted")
        num_draws = document["posterior"]["draws"]
        self.assertIn(num_draws, range(1, int(options[options.index("--samples") + 1])))
        self.assertEqual(self.names_in(output), REGISTERED)
        header, *draws = (output / "samples.csv").read_text().splitlines()
        self.assertEqual(len(draws), num_draws)
        self.assertEqual({line.count(",") for line in draws}, {header.count(",")})
        written = strict_json((output / "posterior.json").read_text())
        self.assertEqual(written, document)
        report = (output / "report.html").read_text()
        self.assertIn("Interrupted: do not trust the ±", report)
        self.assertTrue(report.endswith("</html>\n"))
        # What another tool reads of them.
        moved = self.folder / "moved.pcd"
        result = call(TRANSFORM, output / "aligned.pcd", moved, "--pose", output / "posterior.json")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_nothing_is_written_before_the_first_draw(self):
        """During ICP, which takes its time on large clouds from a guess far off, and ends."""
        pair = self.big_pair(20000)
        far_off = ["-i", 1000, "--guess", "0.3,0.3,0.3,1,1,1"]
        for preset, (options, number) in DRAWING.items():
            with self.subTest(preset=preset):
                output = self.new_folder()
                words = [*pair, *options, *far_off, "--quiet", "-o", output]
                process = self.start(TOOL, *words)
                _, errors = self.end(process, number, seconds=0.0)
                self.assertEqual(process.returncode, 130)
                self.assertIn("there are no draws, so no files are written", errors)
                self.assertEqual(self.names_in(output), set())

    def test_report_is_drawn_after_ctrl_c(self):
        """Which at a terminal goes to all programs there, here from a gnuplot that draws."""
        script = f"""#!/bin/sh
            [ "$1" = --version ] || kill -s INT -- "-$PPID"
            exec {shutil.which("gnuplot")} "$@"\n"""
        self.file("gnuplot", script).chmod(0o755)
        output = self.new_folder()
        command = [TOOL, *self.small_pair(), *FAST, "--quiet", "-o", output]
        path = f"{self.folder}{os.pathsep}{os.environ['PATH']}"
        result = call(*command, env={**os.environ, "PATH": path}, start_new_session=True)
        self.assertEqual(result.returncode, 130, result.stderr)
        self.assertEqual(self.names_in(output), REGISTERED)

    def test_sgd_icp_writes_the_pose(self):
        """Where the descent has come to, which never rests."""
        output = self.new_folder()
        words = ["--method", "sgd-icp", "--iterations", 1000000000, "--translation-epsilon", 0]
        process = self.start(TOOL, *self.small_pair(), *words, "--quiet", "-o", output)
        _, errors = self.end(process, signal.SIGTERM, seconds=0.5)
        self.assertEqual(process.returncode, 130, errors)
        self.assertEqual(self.names_in(output), {"aligned.pcd", "sgd_icp.json"})
        document = strict_json((output / "sgd_icp.json").read_text())
        self.assertEqual(document["end"], "interrupted")

    def test_ignored_signal_stays_ignored(self):
        """As the shell wants it for jobs in the background."""
        pair = self.small_pair()
        ignore = lambda: signal.signal(signal.SIGINT, signal.SIG_IGN)
        words = [TOOL, *pair, *ENDLESS, "--quiet"]
        process = self.start(*words, preexec_fn=ignore, restore_signals=False)
        wait_for(lambda: catches(process, signal.SIGTERM), process)
        self.assertFalse(catches(process, signal.SIGINT))
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)

    def test_second_signal_kills(self):
        """Also where the program waits for something: here, for its turn to write."""
        for number in SIGNALS:
            output = self.new_folder()
            process, taken = self.start_locked_out(output, self.invocations(output)["register"])
            self.addCleanup(os.close, taken)
            process.send_signal(number)
            wait_for(lambda: not catches(process, number), process)
            self.assertIsNone(process.poll())
            process.send_signal(number)
            process.communicate(timeout=60)
            self.assertEqual(process.returncode, -number)
            self.assertFalse({path.name for path in output.iterdir()} & REGISTERED)

    def test_pose_graph_writes_nothing(self):
        for number in SIGNALS:
            with self.subTest(signal=number.name):
                output = self.new_folder()
                words = [POSE_GRAPH, *self.small_pair(), *ENDLESS, "-o", output / "g.g2o"]
                words += ["--optimize", output / "new" / "optimized"]
                process = self.start(*words)
                _, errors = self.end(process, number, seconds=0.0)
                self.assertEqual(process.returncode, 130)
                self.assertIn("pcl_bayesian_icp_pose_graph: interrupted; nothing", errors)
                self.assertEqual(self.names_in(output), set())

    def test_track_goes_on_where_it_was_ended(self):
        scans = [*self.small_pair()] * 3
        alone = self.new_folder()
        self.assert_ran(call(TRACK, *scans, "-o", alone))
        for number in SIGNALS:
            with self.subTest(signal=number.name):
                output = self.new_folder()
                edges = output / "edges.jsonl"
                process = self.start(TRACK, *scans, "-o", output)
                wait_for(lambda: self.num_lines(edges) > 1, process)
                _, errors = self.end(process, number, seconds=0.0)
                self.assertEqual(process.returncode, 130)
                self.assertIn("pcl_bayesian_icp_track: interrupted; the same command", errors)
                self.assertEqual(self.names_in(output), TRACKED)
                num_poses = self.num_lines(output / "trajectory_tum.txt")
                self.assertEqual(num_poses, self.num_lines(edges) + 1)
                self.assertLess(num_poses, len(scans))
                self.assert_ran(call(TRACK, *scans, "-o", output))
                for name in OPTIMIZED - {"report.html"}:
                    self.assertEqual((output / name).read_text(), (alone / name).read_text())

    def test_study_goes_on_where_it_was_ended(self):
        """Its signal ends it at once; rows that there are stay, and are not made again."""
        coverage = [*ONE_CASE[:-2], "--seeds", 5]
        sbc = ["--sampler", "exact-metropolis", "--runs", 5]
        for number, command, words in (
            (signal.SIGINT, "coverage", coverage),
            (signal.SIGTERM, "sbc", sbc),
        ):
            with self.subTest(command=command):
                results = self.folder / f"{command}.csv"
                study = [EVALUATE, command, *words, "--threads", 1, "--output"]
                process = self.start(*study, results)
                wait_for(lambda: self.num_lines(results) > 1, process)
                process.send_signal(number)
                process.communicate(timeout=60)
                self.assertEqual(process.returncode, -number)
                kept = results.read_text()
                self.assertIn(len(kept.splitlines()), range(2, 6))
                alone = self.folder / f"{command}_alone.csv"
                self.assertEqual([call(*study, file).returncode for file in (results, alone)], [0, 0])
                self.assertTrue(results.read_text().startswith(kept))
                self.assertEqual(rows_of(results), rows_of(alone))

    @staticmethod
    def num_lines(file):
        return file.read_bytes().count(b"\n") if file.exists() else 0

    def test_simulator_and_transform_finish_what_they_write(self):
        """A signal that comes when the files are there but for their names."""
        for number in SIGNALS:
            for tool in ("simulate", "transform"):
                with self.subTest(tool=tool, signal=number.name):
                    output = self.new_folder()
                    command = self.invocations(output)[tool]
                    process, taken = self.start_locked_out(output, command)
                    self.assertTrue(catches(process, number))
                    process.send_signal(number)
                    wait_for(lambda: not catches(process, number), process)
                    os.close(taken)
                    _, errors = process.communicate(timeout=60)
                    self.assertEqual(process.returncode, 130, errors)
                    self.assertEqual(self.names_in(output), WRITES[tool])

    def test_simulator_and_transform_write_all_or_nothing(self):
        """Wherever the signal falls: before the writing it ends the program at once."""
        source, _ = self.big_pair(40000)
        simulate = [SIMULATE, "--scene", "mug", "-o"]
        transform = [TRANSFORM, source, "--pose", MOTION]
        for number in SIGNALS:
            for seconds in (0.0, 0.05, 0.2):
                output = self.new_folder()
                for words, whole in (
                    ([*simulate, output / "pair"], SIMULATED),
                    ([*transform, output / "moved.pcd"], {"moved.pcd"}),
                ):
                    process = self.start(*words)
                    time.sleep(seconds)
                    process.send_signal(number)
                    process.communicate(timeout=60)
                    folder = output / "pair" if whole == SIMULATED else output
                    names = self.names_in(folder) - {"pair"} if folder.exists() else set()
                    codes = (130, 0) if names else (-number,)
                    self.assertIn(process.returncode, codes)
                    self.assertIn(names, (set(), whole))
