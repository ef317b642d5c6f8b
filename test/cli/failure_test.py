"""The progress bar on a terminal, and registrations of real scans."""

import os
import pty
import re
import select
import signal
import subprocess
import time
import unittest

from cli_tool import DATA, TOOL, ToolTest
from faults import ENDLESS


class Progress(ToolTest):
    def standard_error_of(self, seconds, *options, until=None):
        """What a terminal shows within so many seconds, or until it shows this pattern."""
        try:
            controller, terminal = pty.openpty()
        except OSError as error:
            self.skipTest(f"no terminal to be had here: {error}")
        command = [TOOL, *self.small_pair(), *ENDLESS, *options]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=terminal) as process:
            os.close(terminal)
            shown = b""
            end = time.monotonic() + seconds
            while time.monotonic() < end and not (until and re.search(until, shown)):
                if select.select([controller], [], [], 0.1)[0]:
                    shown += os.read(controller, 4096)
            process.send_signal(signal.SIGINT)
            try:
                while chunk := os.read(controller, 4096):
                    shown += chunk
            except OSError:  # the other end is closed
                pass
            process.wait(timeout=30)
        os.close(controller)
        return shown.decode()

    def test_bar_on_a_terminal_after_two_seconds(self):
        bar = rb"\rsampling \[#*\.*\] +\d+ %"
        shown = self.standard_error_of(50.0, until=bar)
        self.assertRegex(shown.encode(), bar)
        self.assertTrue(shown.rstrip().endswith("\x1b[K"), shown)

    def test_no_bar_before_or_when_quiet(self):
        self.assertNotIn("sampling", self.standard_error_of(1.0))
        self.assertNotIn("sampling", self.standard_error_of(3.0, "--quiet"))


@unittest.skipUnless(
    os.environ.get("PCL_BAYESIAN_ICP_REAL_DATA"), "PCL_BAYESIAN_ICP_REAL_DATA is not set"
)
class RealScans(ToolTest):
    def test_every_pair_is_registered_from_its_guess(self):
        root = type(DATA)(os.environ["PCL_BAYESIAN_ICP_REAL_DATA"])
        guesses = sorted(root.glob("*/T_init.txt"))
        self.assertTrue(guesses, f"no scans in {root}")
        for guess in guesses:
            with self.subTest(pair=guess.parent.name):
                pair = [guess.parent / f"{role}.pcd" for role in ("source", "target")]
                options = ["--guess", guess, "-i", "10"]
                samples, document = self.run_to_files(*pair, *options)
                self.assertEqual(len(samples.splitlines()), document["posterior"]["draws"] + 1)
                self.assertGreater(document["posterior"]["draws"], 0)
