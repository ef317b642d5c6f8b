"""What is printed, and what is written."""

import math
import os
import pty
import re
import select
import shutil
import signal
import subprocess
import time

import numpy as np

import cloud_files
from cli_tool import DATA, FAST, TOOL, WRITTEN, ToolTest, run, scans, strict_json
from faults import ENDLESS

NAMES = ["x", "y", "z", "roll", "pitch", "yaw"]
UNITS = ["m"] * 3 + ["rad"] * 3


class Files(ToolTest):
    def test_samples_csv(self):
        options = ["--preset=paper", "--samples=61", "--chains=2", "--step-size=1e-6"]
        samples, document = self.run_to_files(*self.small_pair(), *options)
        header, *lines = samples.splitlines()
        self.assertEqual(header, "chain,draw,x_m,y_m,z_m,roll_rad,pitch_rad,yaw_rad")
        indices = [tuple(line.split(",")[:2]) for line in lines]
        expected = [("0", str(i)) for i in range(31)] + [("1", str(i)) for i in range(30)]
        self.assertEqual(indices, expected)
        for line in lines:
            for text in line.split(",")[2:]:
                self.assertEqual(text, format(float(text), ".17g"))
        counts = [chain["draws"] for chain in document["posterior"]["chains"]]
        self.assertEqual(counts, [31, 30])

    def test_posterior_json_agrees_with_the_draws(self):
        samples, document = self.run_to_files(*self.small_pair(), *FAST)
        posterior = document["posterior"]
        draws = np.loadtxt(samples.splitlines(), delimiter=",", skiprows=1)[:, 2:]
        mean = draws.mean(axis=0)
        # The circular mean of the angles.
        mean[3:] = np.arctan2(np.sin(draws).mean(axis=0), np.cos(draws).mean(axis=0))[3:]
        coordinates = posterior["coordinates"]
        self.assertEqual([(c["name"], c["unit"]) for c in coordinates], list(zip(NAMES, UNITS)))
        for key, values in {
            "mean": mean,
            "median": np.median(draws, axis=0),
            "standard_deviation": np.sqrt(((draws - mean) ** 2).sum(axis=0) / (len(draws) - 1)),
        }.items():
            self.assert_close([c[key] for c in coordinates], values, delta=1e-12)
        matrix = cloud_files.matrix_of(*list(posterior["mean"].values())[:6])
        self.assert_close(posterior["mean"]["T_target_source"], matrix, delta=1e-12)
        self.assertEqual(posterior["covariances"][0]["order"], NAMES)

    def test_posterior_json_describes_itself(self):
        _, document = self.run_to_files(*self.small_pair(), *FAST)
        self.assertEqual(document["schema"], "pcl_bayesian_icp/posterior")
        self.assertEqual(document["schema_version"], 1)
        self.assertEqual(document["source"]["points"], 300)
        self.assertIn("source points into the target frame", document["frame"])
        conventions = [c["convention"] for c in document["posterior"]["covariances"]]
        self.assertEqual(conventions, ["parameters", "r3xso3", "left_se3", "right_se3"])
        meanings = (
            ["translation in the target frame", "R = Rz(yaw) Ry(pitch) Rx(roll)"],
            ["translation in the target frame", "R = exp(w) R_mean"],
            ["in the target frame", "T = exp(xi) T_mean"],
            ["in the source frame", "T = T_mean exp(xi)"],
        )
        for covariance, words in zip(document["posterior"]["covariances"], meanings):
            self.assertEqual(covariance["units"], UNITS)
            for word in words:
                self.assertIn(word, covariance["meaning"])
            matrix = covariance["matrix"]
            self.assert_close(matrix, list(zip(*matrix)), delta=1e-15)

    def test_files_replace_older_ones_and_leave_nothing_else(self):
        self.output = self.folder / "deep" / "output"
        for seed in ("1", "2"):
            self.assert_ran(run(*self.small_pair(), *FAST, "-o", self.output, "--seed", seed))
        self.assertEqual(self.names_of_output(), WRITTEN)
        document = strict_json((self.output / "posterior.json").read_text())
        self.assertEqual(document["options"]["chains"]["seed"], 2)
        new_file = self.file("new", "")
        for path in self.output.iterdir():
            self.assertEqual(path.stat().st_mode, new_file.stat().st_mode)

    def test_links_are_followed_and_what_is_no_file_is_refused(self):
        self.output.mkdir()
        linked = self.file("elsewhere.csv", "old")
        samples = self.output / "samples.csv"
        samples.symlink_to(linked)
        self.run_to_files(*self.small_pair(), *FAST)
        self.assertTrue(samples.is_symlink())
        self.assertGreater(len(linked.read_text()), 100)
        samples.unlink()
        os.mkfifo(samples)
        result = run(*self.small_pair(), *FAST, "-o", self.output)
        self.assert_refused(3, result, samples, "is not a regular file")
        self.assertTrue(samples.is_fifo())

    def test_names_that_are_not_utf8(self):
        source, target = self.small_pair()
        odd = os.fsencode(self.folder) + b"/\xff\xfe.pcd"
        shutil.copyfile(source, odd)
        command = [TOOL, odd, target, "--json", *FAST]
        result = subprocess.run(command, stdout=subprocess.PIPE, check=False)
        self.assertEqual(strict_json(result.stdout.decode())["source"]["points"], 300)

    def test_input_is_not_replaced(self):
        source, target = self.small_pair()
        aligned = source.rename(self.folder / "aligned.pcd")
        content = aligned.read_bytes()
        for clouds in ([aligned, target], [target, aligned]):
            result = run(*clouds, *FAST, "-o", self.folder)
            self.assert_refused(2, result, "--output", f"has the input {aligned}")
        self.assertEqual(aligned.read_bytes(), content)
        self.assertFalse((self.folder / "posterior.json").exists())

    def test_no_draws_no_files(self):
        options = ["--preset=paper", "--step-size=10", "--samples=400", "-o", self.output]
        result = run(*self.small_pair(), *options)
        self.assertEqual(result.returncode, 1)
        self.assertIn("no files but posterior.json are written", result.stderr)
        self.assertIn("Status: diverged: 4 of 4 chains", result.stdout)
        self.assertEqual(self.names_of_output(), ["posterior.json"])

    def test_failure_replaces_an_older_result(self):
        self.run_to_files(*self.small_pair(), *FAST, "--export=csv,tum", "--export-unreliable")
        self.assertGreater(len(self.names_of_output()), 4)
        (self.output / "other.txt").write_text("mine")
        words = ["--guess=9,9,9,0,0,0", "-d1", "--json", "-o", self.output]
        result = run(*self.small_pair(), *words)
        self.assertEqual(result.returncode, 1)
        self.assertIn("too few correspondences", result.stderr)
        written = strict_json((self.output / "posterior.json").read_text())
        self.assertEqual(written, strict_json(result.stdout))
        self.assertEqual(written["status"]["name"], "too_few_correspondences")
        self.assertEqual(self.names_of_output(), ["other.txt", "posterior.json"])


class AlignedCloud(ToolTest):
    """transform_test has that aligned.pcd is the source, moved, with all its fields."""

    def test_viewpoint_is_the_targets(self):
        source, _ = self.small_pair()
        seen = self.pcd("seen.pcd", cloud_files.box_surface(), viewpoint="1 2 3 0 1 0 0")
        self.run_to_files(source, seen, *FAST)
        header, _ = cloud_files.read_pcd(self.output / "aligned.pcd")
        self.assertEqual(list(map(float, header["VIEWPOINT"])), [1, 2, 3, 0, 1, 0, 0])

    def test_mean_in_place_of_icp(self):
        pair = self.small_pair()
        for options in ([], ["--mean"]):
            document = self.run_to_json(*pair, *FAST, *options)
            expected = document["posterior"]["mean"] if options else document["icp"]
            final = document["final_transformation"]["T_target_source"]
            self.assertEqual(final, expected["T_target_source"])


class FinalTransformation(ToolTest):
    def final_of(self, *options):
        """final_transformation, and the rms distance [m] of what it and the mean move."""
        _, document = self.run_to_files(*scans("mug"), *options)
        final = document["final_transformation"]
        mean = document["posterior"]["mean"]["T_target_source"]
        difference = np.subtract(final["T_target_source"], mean)
        moved = cloud_files.moved(difference, cloud_files.read_xyz(DATA / "mug" / "source.pcd"))
        return final, math.sqrt(np.nanmean((moved**2).sum(axis=1)))

    def test_says_where_it_is_in_the_posterior(self):
        wide = ["--preset=exact", "--sigma=0.005", "--effective-points=300"]
        # Without pairs within 0.1 mm, ICP stays at the guess.
        for options, is_within in ((wide, True), (["-d0.0001"], False), (["--mean"], True)):
            with self.subTest(options=options):
                final, distance = self.final_of(*options)
                self.assertIs(final["is_within_posterior"], is_within)
                self.assertAlmostEqual(final["distance_from_mean_m"], distance, delta=1e-9)
                self.assertEqual(distance == 0, options == ["--mean"])

    def test_says_nothing_without_a_posterior_to_rely_on(self):
        final, _ = self.final_of(*FAST)
        self.assertIsNone(final["is_within_posterior"])
        self.assertIsNone(final["distance_from_mean_m"])


class Printed(ToolTest):
    def test_a_result_of_icp_that_the_posterior_excludes_is_told(self):
        # Without pairs within 0.1 mm, ICP stays at the guess.
        pair = scans("mug")
        words = "ICP did not converge; the posterior excludes it; it moves the points"
        result = run(*pair, "-d", "0.0001")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        printed = " ".join(result.stdout.split())
        self.assertIn(words, printed)
        final = self.run_to_json(*pair, "-d", "0.0001")["final_transformation"]
        millimetres = float(re.search(r"moves the points ([\d.e+]+) mm", printed)[1])
        self.assertAlmostEqual(millimetres / final["distance_from_mean_m"], 1e3, delta=5.0)
        files = ["-d", "0.0001", "-o", self.output, "--no-report"]
        for option in ("--json", "--quiet"):
            result = run(*pair, *files, option)
            self.assertEqual(result.returncode, 0)
            self.assertRegex(result.stderr, f"^pcl_bayesian_icp: warning: .*{words}.*\n$")
        self.assertEqual(run(*pair, *files, "--quiet", "--mean").stderr, "")
        self.assertNotIn("Note:", run(*pair, "-d", "0.0001", "--mean").stdout)

    def test_presets_with_a_stated_scale_say_so(self):
        words = "Note: Preset paper takes the scale of the standard deviations from"
        self.assertIn(words, run(*self.small_pair(), *FAST).stdout)
        self.assertNotIn("takes the scale", run(*scans("mug")).stdout)

    def test_table_has_units_status_and_matrices(self):
        pair = self.small_pair()
        text = run(*pair, *FAST).stdout
        document = self.run_to_json(*pair, *FAST)
        rows = re.findall(r"^(\w+ \[(?:m|rad)\])(.*)", text, re.MULTILINE)
        self.assert_rows(document, {label: numbers.split() for label, numbers in rows})
        for name, mean in list(document["posterior"]["mean"].items())[3:6]:
            row = re.search(rf"^{name[:-4]} \[deg\] +(\S+)", text, re.MULTILINE)
            self.assertAlmostEqual(float(row[1]), math.degrees(mean), delta=0.6e-4)
        self.assertIn("R-hat  bulk ESS  tail ESS", text)
        self.assertIn("Status: not mixed", text)
        self.assertIn("ICP:    converged", text)

    def test_good_posterior_has_exit_code_0(self):
        options = ["--preset=paper", "--step-size=5e-6", "--effective-points=60000"]
        options += ["--prior-variance=0.01", "--batch-size=20", "--burn-in=1000", "--thinning=50", "--samples=4000"]
        result = run(*self.small_pair(), *options, "--block-decay-factor=1")
        self.assertIn("Status: ok", result.stdout)
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_quiet_and_json(self):
        pair = self.small_pair()
        result = run(*pair, *FAST, "--quiet")
        self.assertEqual(result.stdout, "")
        self.assertRegex(result.stderr, r"^pcl_bayesian_icp: not mixed: .*\n$")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(self.run_to_json(*pair, *FAST)["status"]["name"], "not_mixed")

    def test_matrix_is_that_of_pcl_transform_point_cloud(self):
        # Its option -matrix takes the rows of the matrix, with commas between the numbers.
        source, target = self.small_pair()
        text = run(source, target, *FAST, "-o", self.output).stdout
        option, numbers = text.splitlines()[-1].split()
        self.assertEqual(option, "-matrix")
        matrix = np.array(numbers.split(","), float).reshape(4, 4)
        expected = cloud_files.moved(matrix, cloud_files.read_xyz(source))
        self.assert_close(cloud_files.read_xyz(self.output / "aligned.pcd"), expected, delta=1e-6)


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
