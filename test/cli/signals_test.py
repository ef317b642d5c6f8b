"""SIGINT and SIGTERM in the middle: what there is is kept, the exit code is 130.

No test waits for a time: a signal is sent when the program has taken charge of it, and has
used the processor for long enough to have draws."""

import json
import os
import signal
import subprocess
import time
import unittest

from cli_tool import FAST, TOOL, strict_json
from faults import (
    BATCH,
    ENDLESS,
    POSE_GRAPH,
    SIMULATE,
    SIMULATED,
    TRANSFORM,
    MOTION,
    REGISTERED,
    FaultTest,
    catches,
    lock,
    processor_seconds,
    start,
    wait_for,
    waits_for_a_lock,
)

SIGNALS = (signal.SIGINT, signal.SIGTERM)
# A draw takes 50 ms of ENDLESS, after ICP and the reading of the files.
ENOUGH_SECONDS = 2.0


class EndedBySignal(FaultTest):
    def end(self, process, signal_number, seconds=ENOUGH_SECONDS):
        """(standard output, standard error) of a program that is sent a signal."""
        self.addCleanup(process.kill)
        wait_for(
            lambda: catches(process, signal_number) and processor_seconds(process) >= seconds,
            process,
        )
        process.send_signal(signal_number)
        return process.communicate(timeout=60)

    def test_draws_are_written(self):
        pair = self.small_pair()
        for number in SIGNALS:
            with self.subTest(signal=number.name):
                output = self.new_folder()
                process = start(TOOL, *pair, *ENDLESS, "-o", output, "--json")
                text, errors = self.end(process, number)
                self.assertRegex(errors, r"^pcl_bayesian_icp: interrupted: .*\n$")
                self.assertEqual(process.returncode, 130)
                document = strict_json(text)
                self.assertEqual(document["status"]["name"], "interrupted")
                num_draws = document["posterior"]["draws"]
                self.assertIn(num_draws, range(1, 4000))
                samples = (output / "samples.csv").read_text()
                self.assertEqual(len(samples.splitlines()), num_draws + 1)
                written = strict_json((output / "posterior.json").read_text())
                self.assertEqual(written, document)
                report = (output / "report.html").read_text()
                self.assertIn("Interrupted: do not trust the ±", report)
                self.names_in(output)

    def test_ignored_signal_stays_ignored(self):
        """As the shell wants it for jobs in the background."""
        pair = self.small_pair()
        words = [TOOL, *map(str, pair), *ENDLESS, "--quiet"]
        process = subprocess.Popen(
            words,
            stderr=subprocess.PIPE,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
            restore_signals=False,
        )
        self.addCleanup(process.kill)
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
            taken = lock(output)
            self.addCleanup(os.close, taken)
            process = start(TOOL, *self.small_pair(), *FAST, "--quiet", "-o", output)
            self.addCleanup(process.kill)
            wait_for(lambda: waits_for_a_lock(process), process)
            process.send_signal(number)
            wait_for(lambda: not catches(process, number), process)
            self.assertIsNone(process.poll())
            process.send_signal(number)
            process.communicate(timeout=60)
            self.assertEqual(process.returncode, -number)
            self.assertFalse({path.name for path in output.iterdir()} & REGISTERED)

    def test_batch_goes_on_where_it_was_ended(self):
        self.small_pair()
        pairs = [
            {
                "name": f"seed {seed}",
                "source": "source.pcd",
                "target": "target.pcd",
                "settings": {"chains": {"seed": seed}},
            }
            for seed in range(6)
        ]
        manifest = self.file("manifest.json", json.dumps(pairs))
        results = self.folder / "results.jsonl"
        words = [BATCH, manifest, *ENDLESS[:2], "--samples", 200, "--chains", 2]
        words += ["--thinning", 10, "--step-size", "1e-6", "--results", results]
        process = start(*words)
        self.addCleanup(process.kill)
        process.stderr.readline()  # of the first pair
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
        self.assertIn(process.returncode, (130, 1))  # 1: it had ended before
        first = results.read_text()
        self.assertTrue(first.endswith("\n"))
        again = start(*words)
        again.communicate(timeout=120)
        self.assertEqual(again.returncode, 1)  # so few draws do not mix
        text = results.read_text()
        self.assertTrue(text.startswith(first))
        names = [strict_json(line)["name"] for line in text.splitlines()]
        self.assertEqual(sorted(names), [pair["name"] for pair in pairs])

    def test_pose_graph_writes_nothing(self):
        for number in SIGNALS:
            with self.subTest(signal=number.name):
                output = self.new_folder()
                words = [POSE_GRAPH, *self.small_pair(), *ENDLESS, "-o", output / "g.g2o"]
                process = start(*words)
                self.end(process, number, seconds=0.0)
                self.assertEqual(process.returncode, 130)
                self.assertEqual(self.names_in(output), set())

    def test_simulator_and_transform_write_all_or_nothing(self):
        """Wherever the signal falls: before the writing it ends the program at once."""
        source, _ = self.big_pair(40000)
        simulate = [SIMULATE, "--scene", "mug", "-o"]
        transform = [TRANSFORM, source, "--pose", MOTION]
        for number in SIGNALS:
            for seconds in (0.0, 0.02, 0.05, 0.1, 0.2):
                output = self.new_folder()
                for words, whole in (
                    ([*simulate, output / "pair"], SIMULATED),
                    ([*transform, output / "moved.pcd"], {"moved.pcd"}),
                ):
                    process = start(*words)
                    self.addCleanup(process.kill)
                    time.sleep(seconds)
                    process.send_signal(number)
                    process.communicate(timeout=60)
                    folder = output / "pair" if whole == SIMULATED else output
                    names = self.names_in(folder) - {"pair"} if folder.exists() else set()
                    codes = (130, 0) if names else (-number,)
                    self.assertIn(process.returncode, codes)
                    self.assertIn(names, (set(), whole))


if __name__ == "__main__":
    unittest.main()
