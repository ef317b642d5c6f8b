"""Preset calibrated: what it reports, and its options."""

import re

from cli_tool import CALIBRATED, ToolTest, run, scans, strict_json
from cloud_files import read_xyz


class CalibratedScans(ToolTest):
    def test_posterior_can_be_trusted_and_holds_the_truth(self):
        document = self.trusted_run("mug", *CALIBRATED)
        for coordinate in document["posterior"]["coordinates"][:3]:
            self.assertLess(coordinate["standard_deviation"], 0.002)

    def test_a_table_top_slides_on_the_table(self):
        """In its plane a bare plate is held by the prior alone: two translations and the turn
        about the normal are the last three directions."""
        directions = self.run_to_json(*scans("table_top"), *CALIBRATED)["data"]["directions"]
        self.assertEqual(len(directions), 6)
        deviations = [direction["standard_deviation_m"] for direction in directions]
        self.assertEqual(deviations, sorted(deviations))
        self.assertLess(deviations[2], 0.002)
        worst = directions[-1]
        self.assertEqual(worst["observability"], "prior_only")
        ratio = worst["standard_deviation_m"] / worst["prior_standard_deviation_m"]
        self.assertGreater(ratio, 0.8)


class DataSection(ToolTest):
    KEYS = """noise_scale_m noise_scale_in_units_of_the_target effective_patches
        correlation_factor active_fraction active_fraction_of_target
        basin_distance_in_standard_deviations other_start_cost_ratio degrees_of_freedom flags
        flag_messages centre_m prior_probability directions directions_note""".split()

    def test_table_and_json_agree(self):
        result = run(*scans("can"), *CALIBRATED)
        data = self.run_to_json(*scans("can"), *CALIBRATED)["data"]
        self.assertEqual(sorted(data), sorted(self.KEYS))
        pattern = r"^ +(\S+) +(\S+) +(\S+)  (data|weak|prior) +(\w+ (?:along|about) .*)$"
        rows = re.findall(pattern, result.stdout, re.MULTILINE)
        self.assertEqual(len(rows), 6, result.stdout)
        holders = {"observed": "data", "weak": "weak", "prior_only": "prior"}
        for row, direction in zip(rows, data["directions"]):
            deviation, angle, prior, holder, words = row
            metres = direction["standard_deviation_m"]
            self.assertAlmostEqual(float(deviation), 1e3 * metres, delta=0.6e-3)
            self.assertAlmostEqual(
                float(prior), 1e3 * direction["prior_standard_deviation_m"], delta=0.06
            )
            self.assertEqual(holder, holders[direction["observability"]])
            self.assertEqual(words, direction["description"])
            turn = sum(w * w for w in direction["twist"][3:]) ** 0.5
            if words.startswith("translation"):
                self.assertEqual(angle, "-")
            else:
                self.assertAlmostEqual(float(angle), 1e3 * metres * turn, delta=0.6e-3)
        self.assertIn(f"Noise:   {1e3 * data['noise_scale_m']:.3f}"[:-1], result.stdout)
        self.assertIn(f"about {data['effective_patches']:.0f} independent", result.stdout)
        self.assertIn(f"Support: {100 * data['active_fraction']:.0f} %", result.stdout)

    def test_other_presets_have_none(self):
        _, document = self.run_to_files(*self.small_pair(), "--preset=paper", "--samples=60")
        self.assertIsNone(document["data"])

    def test_flags_are_doubt(self):
        """More than three quarters of each cloud are where the other one was not seen."""
        source, target = map(read_xyz, scans("mug"))
        mugs = [(x + far, y, z) for x, y, z in source for far in (1, 2, 3)]
        board = [(0.005 * i, 1 + 0.005 * j, 0) for i in range(70) for j in range(70)]
        files = [self.pcd("source.pcd", [*source[::2], *mugs]), self.pcd("target.pcd", [*target, *board])]
        result = run(*files, *CALIBRATED, "--json")
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"^pcl_bayesian_icp: doubtful: .*, but only \d+ % of .*\n$")
        document = strict_json(result.stdout)
        self.assertEqual(document["status"]["name"], "doubtful")
        self.assertTrue(document["data"]["flags"]["low_support"])
        self.assertEqual(len(document["data"]["flag_messages"]), 1)
        table = run(*files, *CALIBRATED).stdout
        self.assertIn("Flags:   low support\n", table)


class CalibratedOptions(ToolTest):
    def test_options_are_obeyed(self):
        pair = scans("mug")
        plain, _ = self.run_to_files(*pair, *CALIBRATED)
        words = ["--calibrated-points=1000", "--mode-points=200", "--seed=2"]
        words += ["--prior-variance=0.01", "--chains=3", "--samples=1000"]
        for word in words:
            samples, _ = self.run_to_files(*pair, *CALIBRATED, word)
            self.assertNotEqual(samples, plain, word)
