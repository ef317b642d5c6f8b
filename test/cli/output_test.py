"""What is printed, and what is written."""

import math
import os
import re
import shutil
import subprocess
import unittest

import numpy as np

import cloud_files
import robot_formats
from cli_tool import DATA, FAST, TOOL, ToolTest, run, scans, strict_json

NAMES = ["x", "y", "z", "roll", "pitch", "yaw"]


def second_moments(errors):
    return (errors**2).sum(axis=0) / (len(errors) - 1)


class Files(ToolTest):
    def test_samples_csv(self):
        options = ["--preset=paper", "--samples=61", "--chains=2", "--step-size=1e-6"]
        samples, document = self.run_to_files(*self.small_pair(), *options)
        lines = samples.splitlines()
        self.assertEqual(lines[0], "chain,draw,x_m,y_m,z_m,roll_rad,pitch_rad,yaw_rad")
        indices = [tuple(line.split(",")[:2]) for line in lines[1:]]
        expected = [("0", str(i)) for i in range(31)] + [("1", str(i)) for i in range(30)]
        self.assertEqual(indices, expected)
        for line in lines[1:]:
            for text in line.split(",")[2:]:
                self.assertEqual(float(text), float(format(float(text), ".17g")))
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
        errors = robot_formats.parameter_error(mean, draws)
        coordinates = posterior["coordinates"]
        units = ["m"] * 3 + ["rad"] * 3
        self.assertEqual([c["name"] for c in coordinates], NAMES)
        self.assertEqual([c["unit"] for c in coordinates], units)
        expected = {
            "mean": mean,
            "median": mean + np.median(errors, axis=0),
            "standard_deviation": np.sqrt(second_moments(errors)),
        }
        for key, values in expected.items():
            self.assert_close([c[key] for c in coordinates], values, delta=1e-12)
        keys = [f"{name}_{unit}" for name, unit in zip(NAMES, units)]
        pose = np.array([posterior["mean"][key] for key in keys])
        covariance = posterior["covariances"][0]
        self.assertEqual(covariance["order"], NAMES)
        # The covariance is about the mean pose.
        variances = second_moments(robot_formats.parameter_error(pose, draws))
        self.assert_close(np.diag(covariance["matrix"]), variances, delta=1e-12)
        twists = np.hstack(robot_formats.right_twist(pose, draws))
        self.assert_close(twists.mean(axis=0), np.zeros(6), delta=1e-11)
        matrix = cloud_files.matrix_of(*pose)
        self.assert_close(posterior["mean"]["T_target_source"], matrix, delta=1e-12)

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
            self.assertEqual(covariance["units"], ["m"] * 3 + ["rad"] * 3)
            for word in words:
                self.assertIn(word, covariance["meaning"])
            matrix = covariance["matrix"]
            self.assert_close(matrix, list(zip(*matrix)), delta=1e-15)

    def test_files_replace_older_ones_and_leave_nothing_else(self):
        output = self.folder / "deep" / "output"
        for seed in ("1", "2"):
            self.assert_ran(run(*self.small_pair(), *FAST, "-o", output, "--seed", seed))
        names = sorted(path.name for path in output.iterdir())
        self.assertEqual(names, ["aligned.pcd", "posterior.json", "report.html", "samples.csv"])
        document = strict_json((output / "posterior.json").read_text())
        self.assertEqual(document["options"]["chains"]["seed"], 2)
        new_file = self.file("new", "")
        for name in names:
            self.assertEqual((output / name).stat().st_mode, new_file.stat().st_mode)

    def test_links_are_followed_and_what_is_no_file_is_refused(self):
        output = self.folder / "output"
        output.mkdir()
        linked = self.file("elsewhere.csv", "old")
        (output / "samples.csv").symlink_to(linked)
        self.run_to_files(*self.small_pair(), *FAST)
        self.assertTrue((output / "samples.csv").is_symlink())
        self.assertGreater(len(linked.read_text()), 100)
        (output / "samples.csv").unlink()
        os.mkfifo(output / "samples.csv")
        result = run(*self.small_pair(), *FAST, "-o", output)
        self.assert_refused(3, result, output / "samples.csv", "is not a regular file")
        self.assertTrue((output / "samples.csv").is_fifo())

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
        output = self.folder / "output"
        options = ["--preset=paper", "--step-size=10", "--samples=400", "-o", output]
        result = run(*self.small_pair(), *options)
        self.assertEqual(result.returncode, 1)
        self.assertIn("no files but posterior.json are written", result.stderr)
        self.assertIn("Status: diverged: 4 of 4 chains", result.stdout)
        self.assertEqual([path.name for path in output.iterdir()], ["posterior.json"])

    def test_failure_replaces_an_older_result(self):
        output = self.folder / "output"
        exports = ["--export=csv,tum", "--export-unreliable"]
        self.assert_ran(run(*self.small_pair(), *FAST, *exports, "-o", output))
        self.assertGreater(len(list(output.iterdir())), 4)
        other = self.file("other.txt", "mine").rename(output / "other.txt")
        result = run(*self.small_pair(), "--guess=9,9,9,0,0,0", "-d1", "--json", "-o", output)
        self.assertEqual(result.returncode, 1)
        written = (output / "posterior.json").read_text()
        self.assertEqual(strict_json(written), strict_json(result.stdout))
        self.assertEqual(strict_json(written)["status"]["name"], "too_few_correspondences")
        self.assertEqual(sorted(output.iterdir()), [other, output / "posterior.json"])


class AlignedCloud(ToolTest):
    """transform_test has that aligned.pcd is the source, moved, with all its fields."""

    def test_viewpoint_is_the_targets(self):
        source, _ = self.small_pair()
        content = cloud_files.pcd_bytes(cloud_files.box_surface(), viewpoint="1 2 3 0 1 0 0")
        self.run_to_files(source, self.file("seen.pcd", content), *FAST)
        header, _ = cloud_files.read_pcd(self.folder / "output" / "aligned.pcd")
        self.assertEqual(list(map(float, header["VIEWPOINT"])), [1, 2, 3, 0, 1, 0, 0])

    def test_mean_in_place_of_icp(self):
        pair = self.small_pair()
        for option, key in (([], "icp"), (["--mean"], "posterior")):
            _, document = self.run_to_files(*pair, *FAST, *option)
            expected = document["icp"] if key == "icp" else document["posterior"]["mean"]
            final = document["final_transformation"]["T_target_source"]
            self.assertEqual(final, expected["T_target_source"])


class FinalTransformation(ToolTest):
    def final_of(self, *options):
        """final_transformation, and the rms distance [m] of what it and the mean move."""
        _, document = self.run_to_files(*scans("mug"), *options)
        final = document["final_transformation"]
        difference = np.subtract(
            final["T_target_source"], document["posterior"]["mean"]["T_target_source"]
        )
        _, rows = cloud_files.read_pcd(DATA / "mug" / "source.pcd")
        points = np.array([cloud_files.numbers(row, *"xyz") for row in rows])
        points = points[np.isfinite(points).all(axis=1)]
        moved = points @ difference[:3, :3].T + difference[:3, 3]
        return final, math.sqrt((moved**2).sum(axis=1).mean())

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
        pair = [DATA / "mug" / f"{name}.pcd" for name in ("source", "target")]
        words = "ICP did not converge; the posterior excludes it; it moves the points"
        result = run(*pair, "-d", "0.0001")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        printed = " ".join(result.stdout.split())
        self.assertIn(words, printed)
        final = strict_json(run(*pair, "-d", "0.0001", "--json").stdout)["final_transformation"]
        millimetres = float(re.search(r"moves the points ([\d.e+]+) mm", printed)[1])
        self.assertAlmostEqual(millimetres / final["distance_from_mean_m"], 1e3, delta=5.0)
        files = ["-d", "0.0001", "-o", self.folder / "output", "--no-report"]
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
        document = strict_json(run(*pair, *FAST, "--json").stdout)
        for coordinate in document["posterior"]["coordinates"]:
            label = f"{coordinate['name']} [{coordinate['unit']}]"
            row = next(line for line in text.splitlines() if line.startswith(label))
            numbers = row[len(label) :].split()
            mean = document["posterior"]["mean"][f"{coordinate['name']}_{coordinate['unit']}"]
            keys = ["standard_deviation", "quantile_2.5_percent", "quantile_97.5_percent"]
            for number, value in zip(numbers, [mean, *map(coordinate.get, keys)]):
                self.assertAlmostEqual(float(number), value, delta=0.6e-6)
            self.assertAlmostEqual(float(numbers[4]), coordinate["rhat"], delta=0.6e-3)
            if coordinate["unit"] == "rad":
                label = f"{coordinate['name']} [deg]"
                row = next(line for line in text.splitlines() if line.startswith(label))
                number = float(row[len(label) :].split()[0])
                self.assertAlmostEqual(number, math.degrees(mean), delta=0.6e-4)
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
        result = run(*pair, *FAST, "--json")
        self.assertEqual(strict_json(result.stdout)["status"]["name"], "not_mixed")

    def test_matrix_is_that_of_pcl_transform_point_cloud(self):
        # Its option -matrix takes the rows of the matrix, with commas between the numbers.
        source, target = self.small_pair()
        output = self.folder / "output"
        text = run(source, target, *FAST, "-o", output).stdout
        option, numbers = text.splitlines()[-1].split()
        self.assertEqual(option, "-matrix")
        matrix = np.array(numbers.split(","), float).reshape(4, 4)
        _, source_rows = cloud_files.read_pcd(source)
        _, moved_rows = cloud_files.read_pcd(output / "aligned.pcd")
        points, moved = (
            np.array([cloud_files.numbers(row, *"xyz") for row in rows]) for rows in (source_rows, moved_rows)
        )
        self.assert_close(points @ matrix[:3, :3].T + matrix[:3, 3], moved, delta=1e-6)
