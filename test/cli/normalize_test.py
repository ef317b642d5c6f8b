"""--normalize-cloud. A power of two loses no digits, so a normalised run of clouds four
times as large has exactly the draws of the plain run, four times as far apart."""

import json

import numpy as np

import cloud_files
from cli_tool import FAST, ToolTest, run
from config_test import AUTHORS_CONFIG

FACTOR = 4.0
FACTORS = np.array([FACTOR] * 3 + [1.0] * 3)


def draws_of(samples):
    return np.loadtxt(samples.splitlines(), delimiter=",", skiprows=1)[:, 2:]


class Normalize(ToolTest):
    def pair(self, factor):
        """A box that reaches out to exactly the factor [m], and the same box moved."""
        target = [*cloud_files.box_surface(seed=1), (1.0, 0.0, 0.0)]
        source = [(x + 0.03125, y, z) for x, y, z in cloud_files.box_surface(seed=2)]
        return [
            self.pcd(f"{name}_{factor}.pcd", np.multiply(points, factor))
            for name, points in (("source", source), ("target", target))
        ]

    def posteriors(self, plain, normalised):
        """(draws, document) of the small pair and of the large one."""
        small = self.run_to_files(*self.pair(1.0), *plain)
        large = self.run_to_files(*self.pair(FACTOR), *normalised)
        return draws_of(small[0]), small[1], draws_of(large[0]), large[1]

    def assert_scaled(self, small_draws, small, large_draws, large):
        np.testing.assert_array_equal(large_draws, small_draws * FACTORS)
        for name in ("final_transformation", "icp"):
            a, b = (np.array(document[name]["T_target_source"]) for document in (small, large))
            a[:3, 3] *= FACTOR
            np.testing.assert_array_equal(b, a)
        a, b = (document["icp"]["mean_squared_distance_m2"] for document in (small, large))
        self.assertEqual(FACTOR**2 * a, b)
        small, large = small["posterior"], large["posterior"]
        for a, b in zip(small["covariances"], large["covariances"]):
            np.testing.assert_array_equal(b["matrix"], a["matrix"] * np.outer(FACTORS, FACTORS))
        lengths = ["mean", "standard_deviation", "quantile_2.5_percent", "median"]
        lengths += ["quantile_97.5_percent", "mcse_of_mean"]
        for factor, a, b in zip(FACTORS, small["coordinates"], large["coordinates"]):
            self.assertEqual([factor * a[name] for name in lengths], [b[name] for name in lengths])
            self.assertEqual((a["rhat"], a["bulk_ess"]), (b["rhat"], b["bulk_ess"]))
        self.assertEqual(large["mean"]["x_m"], FACTOR * small["mean"]["x_m"])

    def test_lengths_on_the_command_line_are_in_metres(self):
        plain = [*FAST, "--guess=0.0625,0,0,0,0,0.1", "--prior-mean=0.125,0,0,0,0,0"]
        plain += ["--prior-variance=0.5", "--max-distance=0.5", "--initial-spread=0.015625"]
        normalised = [*FAST, "--normalize-cloud", "--guess=0.25,0,0,0,0,0.1"]
        normalised += ["--prior-mean=0.5,0,0,0,0,0", "--prior-variance=8,8,8,0.5,0.5,0.5"]
        normalised += ["--max-distance=2", "--initial-spread=0.0625,0.0625,0.0625" + 3 * ",0.015625"]
        posteriors = self.posteriors(plain, normalised)
        self.assert_scaled(*posteriors)
        self.assertIs(posteriors[3]["options"]["registration"]["normalize_cloud"], True)

    def test_points_that_are_not_finite_do_not_count(self):
        points = [*cloud_files.box_surface(seed=2), (np.nan, 1.0, 1.0), (np.inf, -np.inf, 0.0)]
        source = self.pcd("odd.pcd", points)
        clean = self.pcd("clean.pcd", points[:-2])
        target = self.pair(1.0)[1]
        runs = [self.run_to_files(c, target, *FAST, "--normalize-cloud") for c in (source, clean)]
        self.assertEqual(runs[0][0], runs[1][0])

    def configs(self):
        guess = {**AUTHORS_CONFIG["initial-guess"], "x": 0.0625}
        plain = {**AUTHORS_CONFIG, "initial-guess": guess}
        normalised = {**plain, "normalize-cloud": True}
        return [
            self.file(f"{name}.json", json.dumps(content))
            for name, content in (("plain", plain), ("normalised", normalised))
        ]

    def test_lengths_of_the_authors_file_are_in_scaled_units(self):
        plain, normalised = self.configs()
        posteriors = self.posteriors(["--config", plain], ["--config", normalised])
        self.assert_scaled(*posteriors)
        options = posteriors[3]["options"]
        self.assertEqual(options["registration"]["max_distance_m"], FACTOR)
        self.assertEqual(options["prior"]["mean_m_rad"], [2, 1, 0.5, 0.1, 0.2, 0.3])
        self.assertEqual(options["prior"]["variance_m2_rad2"], [12] * 3 + [0.75] * 3)

    def test_refusals(self):
        pair = self.pair(1.0)
        for preset in ("calibrated", "exact"):
            result = run(*pair, f"--preset={preset}", "--normalize-cloud")
            message = f"--normalize-cloud belongs to preset paper, and the preset is {preset}"
            self.assert_refused(2, result, message)
        result = run(*pair, "--config", self.configs()[1], "--max-distance=1")
        self.assert_refused(2, result, "--max-distance: is in metres")
