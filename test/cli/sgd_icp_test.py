"""--method sgd-icp: a pose without a posterior, and the options it has and has not."""

import math

import numpy as np

import cloud_files
from cli_tool import SMALL_PAIR_POSE, TOOL, ToolTest, run, strict_json
from cloud_files import read_xyz

SGD = ["--method", "sgd-icp"]


class SgdIcp(ToolTest):
    def json_of(self, *arguments):
        result = run(*arguments, *SGD, "--json")
        document = strict_json(result.stdout)
        self.assertEqual(result.returncode, 0 if document["has_converged"] else 1, result.stderr)
        self.assertEqual(document["has_converged"], document["end"] == "converged")
        return document

    def test_the_matrix_is_that_of_the_pose(self):
        document = self.json_of(*self.small_pair())
        expected = cloud_files.matrix_of(*document["pose"].values())
        self.assert_close(document["T_target_source"], expected, delta=1e-14)

    def test_the_guess_is_where_it_starts(self):
        guess = ",".join(map(str, SMALL_PAIR_POSE))
        words = ["--optimizer", "fixed", "--step-size", "1e-12", "--iterations", "1"]
        document = self.json_of(*self.small_pair(), "--guess", guess, *words)
        self.assert_close(list(document["pose"].values()), SMALL_PAIR_POSE, delta=1e-11)
        self.assertEqual((document["iterations"], document["end"]), (1, "max_iterations"))

    def test_every_option_arrives(self):
        given = {
            "optimizer": ("optimizer", "momentum"),
            "step-size": ("step_size", 0.5),
            "batch-size": ("batch_size", 31),
            "iterations": ("max_iterations", 17),
            "max-distance": ("max_distance_m", 0.75),
            "translation-epsilon": ("translation_epsilon_m", 0.002),
            "rotation-epsilon": ("rotation_epsilon_rad", 0.003),
            "still-iterations": ("still_iterations", 4),
            "seed": ("seed", 18446744073709551615),
        }
        words = [f"--{name}={value}" for name, (_, value) in given.items()]
        options = self.json_of(*self.small_pair(), *words, "--keep-duplicates")["options"]
        for key, value in given.values():
            self.assertEqual(options[key], value)
        self.assertIs(options["is_one_to_one"], False)
        defaults = self.json_of(*self.small_pair())["options"]
        self.assertIs(defaults["is_one_to_one"], True)
        self.assertEqual((defaults["optimizer"], defaults["step_size"]), ("adam", 0.1))

    def test_table(self):
        result = run(*self.small_pair(), *SGD, "--translation-epsilon=1", "--rotation-epsilon=9")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for part in ("no posterior", " m\n", " rad", " deg", "converged after 5 iterations"):
            self.assertIn(part, result.stdout)

    def test_files(self):
        source, target = self.small_pair()
        result = run(source, target, *SGD, "-o", self.output, "--quiet")
        self.assertEqual(result.stdout, "")
        self.assertEqual(self.names_of_output(), ["aligned.pcd", "sgd_icp.json"])
        document = strict_json((self.output / "sgd_icp.json").read_text())
        expected = cloud_files.moved(document["T_target_source"], read_xyz(source))
        self.assert_close(read_xyz(self.output / "aligned.pcd"), expected, delta=1e-7)
        aligned, target = (np.array(read_xyz(path)) for path in (self.output / "aligned.pcd", target))
        squares = ((aligned[:, None] - target[None]) ** 2).sum(axis=2).min(axis=1)
        self.assertAlmostEqual(document["mean_squared_distance_m2"] / squares.mean(), 1.0, delta=1e-4)

    def test_no_pairs_within_the_gate(self):
        pair = self.small_pair()
        run(*pair, *SGD, "-o", self.output, "--quiet")
        words = ["--guess", "9,0,0,0,0,0", "-d", "0.1", "--json", "-o", self.output]
        result = run(*pair, *SGD, *words)
        self.assertEqual(result.returncode, 1)
        document = strict_json(result.stdout)
        self.assertEqual(document["end"], "too_few_correspondences")
        self.assertEqual((document["iterations"], document["pose"]["x_m"]), (0, 9))
        self.assertIn("no files but sgd_icp.json are written", result.stderr)
        self.assertEqual(self.names_of_output(), ["sgd_icp.json"])
        self.assertEqual(strict_json((self.output / "sgd_icp.json").read_text()), document)

    def test_a_scan_with_holes(self):
        holed = self.pcd("holed.pcd", cloud_files.box_surface(seed=1) + [(math.nan, 0.0, 0.0)])
        source, _ = self.small_pair()
        document = self.json_of(source, holed)
        self.assertEqual(document["target"]["finite_points"], 300)
        self.assertEqual(document["pose"], self.json_of(*self.small_pair())["pose"])
        self.assertEqual(self.json_of(holed, source)["source"]["points"], 301)


class SgdIcpRefusals(ToolTest):
    PAIR = [TOOL, "a.pcd", "b.pcd"]

    def refuse_with_sgd_icp(self, *cases):
        self.assert_each_refused(2, [*self.PAIR, *SGD], cases)

    def test_methods(self):
        repeated = ["--method=sgd-icp", "--method=sgd-icp"]
        cases = [(["--method", "icp"], "--method", "'icp'"), (["--method"], "--method")]
        self.assert_each_refused(2, self.PAIR, [*cases, (repeated, "--method")])

    def test_options_of_the_posterior(self):
        for word in """samples=1 preset=1 sigma=1 prior-mean=1 config=1 threads=1 mean reciprocal
            one-to-one""".split():
            reason = f"--{word.split('=')[0]}: has no effect with method sgd-icp"
            self.refuse_with_sgd_icp(([f"--{word}"], reason))
        self.refuse_with_sgd_icp((["--sampels", "9"], "'--sampels'"))

    def test_options_of_sgd_icp(self):
        for words in (
            ["--optimizer", "adam"],
            ["--still-iterations", "3"],
            ["--translation-epsilon", "1"],
            ["--rotation-epsilon", "1"],
            ["--keep-duplicates"],
        ):
            reason = f"{words[0]}: has no effect with method bayesian-icp"
            cases = [(words, reason), (["--method=bayesian-icp", *words], words[0])]
            self.assert_each_refused(2, self.PAIR, cases)
        reason = "--step-size: has no effect with optimizer adadelta"
        self.refuse_with_sgd_icp((["--optimizer=adadelta", "--step-size=1"], reason))

    def test_bad_values(self):
        for word in """optimizer=sgd step-size=0.1m step-size=nan step-size=-1 batch-size=0
            iterations=0 still-iterations=0 translation-epsilon=-1 rotation-epsilon=nan
            max-distance=0 guess=nan,0,0,0,0,0""".split():
            self.refuse_with_sgd_icp(([f"--{word}"], f"--{word.split('=')[0]}: "))

    def test_clouds_and_outputs(self):
        self.assert_refused(2, run("a.pcd", *SGD), "expected a source and a target cloud")
        self.assert_refused(2, run("a.pcd", "b.pcd", "c.pcd", *SGD), "'c.pcd'")
        self.refuse_with_sgd_icp((["--json", "--quiet"], "--json", "--quiet"), (["-o", ""], "output"))
        self.assert_refused(3, run("no.pcd", "such.pcd", *SGD), "no.pcd: no such file")
        result = run(*self.small_pair(), *SGD, "-o", self.file("file", "x"))
        self.assert_refused(3, result, "file")

    def test_help_and_version_come_first(self):
        for words in ([*SGD, "--help"], ["--help", "--optimizer", "adam"]):
            result = run(*words)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            for part in ("--method NAME", "--optimizer NAME", "sgd_icp.json", "rmsprop 0.01"):
                self.assertIn(part, result.stdout)
        self.assertEqual(run(*SGD, "--version").returncode, 0)
