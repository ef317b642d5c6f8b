"""Configuration files in both layouts, and that a run can be repeated from what it wrote."""

import json
import math

import cloud_files
from cli_tool import DATA, FAST, TOOL, ToolTest, run, strict_json

# The file of the authors, as the fuzzers have it.
AUTHORS_CONFIG = json.loads((DATA.parent / "test/fuzz/corpus/configuration/authors").read_text())


class ConfigTest(ToolTest):
    def config(self, content):
        text = content if isinstance(content, (str, bytes)) else json.dumps(content)
        return self.file("config.json", text)

    def refuse(self, exit_code, content, *reason):
        path = self.config(content)
        result = run(*self.small_pair(), *FAST, "--config", path)
        self.assert_refused(exit_code, result, f"{path}: ", *reason)

    def refuse_with(self, words, content, reason):
        """A file and options that do not go together."""
        result = run(*self.small_pair(), "--config", self.config(content), *words)
        self.assert_refused(2, result, reason)

    def options(self, content, *arguments):
        path = self.config(content)
        result = run(*self.small_pair(), "--config", path, "--json", *arguments)
        self.assert_ran(result)
        return strict_json(result.stdout)["options"], result


class OwnLayout(ConfigTest):
    def test_null_is_no_gate_no_mean_no_prior(self):
        content = {
            "registration": {"max_distance_m": None},
            "prior": {"mean_m_rad": None, "variance_m2_rad2": [1, 1, None, 1, 1, 1]},
        }
        options, _ = self.options(content, *FAST)
        self.assertIsNone(options["registration"]["max_distance_m"])
        self.assertIsNone(options["prior"]["mean_m_rad"])
        self.assertEqual(options["prior"]["variance_m2_rad2"], [1, 1, None, 1, 1, 1])

    def test_command_line_comes_first(self):
        content = {"chains": {"num_draws": 44, "seed": 5}}
        options, _ = self.options(content, "--samples", "45")
        self.assertEqual(options["chains"]["num_draws"], 45)
        self.assertEqual(options["chains"]["seed"], 5)
        self.assertEqual(options["chains"]["num_chains"], 4)  # the default

    def test_guess_of_a_posterior(self):
        _, document = self.run_to_files(*self.small_pair(), *FAST)
        file = self.output / "posterior.json"
        repeated = self.run_to_json(*self.small_pair(), *FAST, "--guess", file)
        guess = repeated["options"]["registration"]["guess_matrix"]
        self.assertEqual(guess, document["posterior"]["mean"]["T_target_source"])
        no_posterior = self.file("no.json", "{}")
        result = run(*self.small_pair(), *FAST, "--guess", no_posterior)
        self.assert_refused(3, result, "no.json: is not a posterior.json")

    def test_broken_files(self):
        self.refuse(3, "", "is empty")
        self.refuse(3, '{\n  "chains": {"seed" 5}\n}', "broken JSON", "line 2, column 21")
        self.refuse(3, '{"chains": ', "broken JSON", "line 1")
        self.refuse(3, '{"chains": {"seed": NaN}}', "broken JSON")
        self.refuse(3, b'{"chains": "\xff"}', "broken JSON")
        self.refuse(3, '{"sgld": {"step_size": 1e999}}', "broken JSON")
        self.refuse(3, "[" * 100000, "broken JSON")
        self.refuse(2, "[]", "is not a JSON object")
        cases = [(["no_such.json"], "no_such.json: no such file"), ([self.folder], "is a directory")]
        self.assert_each_refused(3, [TOOL, *self.small_pair(), "--config"], cases)

    def test_unknown_keys(self):
        self.refuse(2, {"chain": {}}, "unknown key 'chain'")
        self.refuse(2, {"chains": {"sed": 5}}, "unknown key 'chains.sed'")

    def test_keys_of_another_preset(self):
        belongs = "exact belongs to preset exact, and the preset is "
        content = {"posterior": {"preset": "exact"}, "exact": {"kernel": "huber"}}
        self.refuse(2, {"exact": content["exact"]}, f"{belongs}paper")
        self.refuse_with(["--preset=calibrated"], content, f"config.json: {belongs}calibrated")
        scale = {"posterior": {"measurement_sigma_m": 0.1}}
        self.refuse_with([], scale, "posterior.measurement_sigma_m belongs to presets paper and exact")
        reason = "is for preset paper, and the preset is exact"
        self.refuse_with(["--preset=exact"], AUTHORS_CONFIG, reason)

    def test_the_preset_of_the_command_line_comes_before_the_files(self):
        for content in ({"mini_batch": {"batch_size": 9}}, {"posterior": {"preset": "exact"}}):
            options, _ = self.options(content, *FAST)
            self.assertEqual(options["posterior"]["preset"], "paper")

    def test_settings_of_former_versions(self):
        self.refuse(2, {"sgld": {}, "exact": {}, "calibrated": {}}, "as former versions wrote them")

    def test_automatic_values(self):
        content = {
            "posterior": {"preset": "exact"},
            "chains": {"num_burn_in": 5, "thinning": "automatic", "initial_spread_m_rad": "automatic"},
        }
        options, _ = self.options(content, "--samples=60")
        self.assertEqual(options["chains"]["num_burn_in"], 5)
        for group, key in (
            ("chains", "thinning"),
            ("chains", "initial_spread_m_rad"),
            ("mini_batch", "batch_size"),
        ):
            self.assertEqual(options[group][key], "automatic")
        self.refuse(2, {"chains": {"thinning": "automatic"}}, "chains.thinning is '\"automatic\"'")

    def test_automatic_frame_is_found_anew(self):
        options = ["--preset=calibrated", "--samples=60", "--json"]
        near, target = self.small_pair()
        far = self.pcd("far.pcd", cloud_files.far_box(9, seed=2))
        first = run(near, target, *options).stdout
        config = self.config(first)
        second = run(far, target, *options, "--guess=-9,0,0,0,0,0", "--config", config).stdout
        for document, frame in ((strict_json(first), "origin"), (strict_json(second), "source-centroid")):
            self.assertEqual(document["options"]["prior"]["frame"], "automatic")
            self.assertEqual(document["prior_frame"], frame)

    def test_malformed_values(self):
        bad = {
            "chains.num_draws": ["9", 9.5, 1e12],
            "chains.seed": [-1, None],
            "sgld.step_size": [None, [1]],
            "prior.frame": ["Origin"],
            "prior.mean_m_rad": [[1, 2, 3, 4, 5]],
            "prior.variance_m2_rad2": [1],
            "registration.reciprocal": [1],
            "registration.guess_matrix": [[[1, 0, 0, 0]] * 3, [[1, 0, 0, 0]] * 4],
        }
        for name, values in bad.items():
            group, key = name.split(".")
            for value in values:
                with self.subTest(name=name, value=value):
                    self.refuse(2, {group: {key: value}}, name)
        self.refuse(2, {"chains": 5}, "chains is '5'")

    def test_values_out_of_range(self):
        content = {"sgld": {"decay_rate": 2}}
        self.refuse_with(["--preset=paper"], content, "--decay-rate: decay_rate is 2")

    def test_other_schemas(self):
        self.refuse(2, {"schema": "pcl_bayesian_icp/posterior", "schema_version": 2}, "version '2'")
        self.refuse(2, {"schema": "x", "schema_version": 1}, "unknown schema '\"x\"'")
        same = {"schema": "pcl_bayesian_icp/posterior", "schema_version": 1}
        self.refuse(2, same, "'options' is missing")


class AuthorsLayout(ConfigTest):
    def changed(self, **groups):
        content = dict(AUTHORS_CONFIG)
        for group, value in groups.items():
            content[group] = {**content[group], **value} if isinstance(value, dict) else value
        return content

    def test_what_it_becomes(self):
        options, result = self.options(AUTHORS_CONFIG)
        self.assertAlmostEqual(options["sgld"]["step_size"], 0.003 / 300, delta=1e-18)
        mean = [0.5, 0.25, 0.125, 0.1, 0.2, 0.3]
        for group, expected in {
            "posterior": {"effective_points": 300, "measurement_sigma_m": 1},
            "sgld": {"noise_factor": 3, "decay_rate": 0.95, "block_decay_factor": 1},
            "chains": {"num_chains": 1, "num_draws": 40, "num_burn_in": 0},
            "mini_batch": {"batch_size": 50, "sampling": "shuffled-epochs"},
            "prior": {"mean_m_rad": mean, "variance_m2_rad2": [0.75] * 6},
            "registration": {"max_distance_m": 1, "one_to_one": True},
        }.items():
            self.assertEqual({**options[group], **expected}, options[group])
        guess = cloud_files.matrix_of(0.01, 0, 0, 0, 0, 0.1)
        self.assert_close(options["registration"]["guess_matrix"], guess, delta=1e-15)
        self.assertIn("note: icp.convergence-steps, ", result.stderr)

    def test_finite_source_points_count(self):
        source = self.pcd("nan.pcd", cloud_files.box_surface(100) + [(math.nan,) * 3] * 50)
        pair = [source, self.small_pair()[1]]
        options = self.run_to_json(*pair, "--config", self.config(AUTHORS_CONFIG))["options"]
        self.assertEqual(options["posterior"]["effective_points"], 100)
        self.assertAlmostEqual(options["sgld"]["step_size"], 0.003 / 100, delta=1e-18)

    def test_command_line_comes_first(self):
        given = ["--step-size=1e-6", "--effective-points=77", "--samples=30", "--chains=2"]
        options, _ = self.options(AUTHORS_CONFIG, *given)
        self.assertEqual(options["sgld"]["step_size"], 1e-6)
        self.assertEqual(options["posterior"]["effective_points"], 77)
        self.assertEqual(options["chains"]["num_draws"], 30)
        self.assertEqual(options["chains"]["num_chains"], 2)

    def test_filter_as_number_and_none(self):
        for value in (0, False):
            options, _ = self.options(self.changed(icp={"filter": value}))
            self.assertIs(options["registration"]["one_to_one"], False)

    def test_quiet_silences_the_note(self):
        path = self.config(AUTHORS_CONFIG)
        result = run(*self.small_pair(), "--config", path, "--quiet")
        self.assertNotIn("note", result.stderr)

    def test_what_is_not_available(self):
        for method in ("preconditioned_sgld2", "fixed", "adam", "adadelta", "momentum", "rmsprop"):
            content = self.changed(method=method)
            self.refuse(2, content, f"'{method}' is not available in this version")

    def test_mistakes(self):
        self.refuse(2, self.changed(method="sgd"), "unknown method 'sgd'")
        self.refuse(2, self.changed(method=5), "method is '5'")
        self.refuse(2, self.changed(icp={"batchsize": 5}), "unknown key 'icp.batchsize'")
        self.refuse(2, self.changed(icp={"batch-size": "5"}), "icp.batch-size is '\"5\"'")
        self.refuse(2, self.changed(icp={"batch-size": 2.5}), "icp.batch-size is '2.5'")
        self.refuse(2, self.changed(icp={"filter": 2}), "icp.filter is '2'")
        self.refuse(2, self.changed(icp={"convergence-steps": "x"}), "icp.convergence-steps")
        self.refuse(2, self.changed(prior=5), "prior is '5'")
        self.refuse(2, dict(AUTHORS_CONFIG, optimiser={}), "unknown key 'optimiser'")
        for group, key in (("icp", "max-iterations"), ("prior", "mean-yaw")):
            others = {k: v for k, v in AUTHORS_CONFIG[group].items() if k != key}
            self.refuse(2, {**AUTHORS_CONFIG, group: others}, f"'{group}.{key}' is missing")
        result = run("a", "b", "--config", self.config(self.changed(prior={"variance": -1})))
        self.assert_refused(2, result, "prior.variance[x] is -1")


class Repeatability(ConfigTest):
    OPTIONS = [
        "--preset=paper --guess=0.001,0.002,0.003,0.01,0.02,0.03 --max-distance=0.5 --mean "
        "--prior-variance=0.1,0.2,0.3,0.4,0.5,inf --initial-spread=1e-3 --step-size=1.1e-6 "
        "--batch-sampling=shuffled-epochs --seed=12345678901234567890 --samples=99",
        "--preset=exact --residual=point-to-plane --kernel=tukey --kernel-width=0.0301 "
        "--steps=metropolis --max-source-points=250 --seed=18446744073709551615 --samples=200",
        "--preset=exact --residual=distribution-to-distribution --regularization=frobenius "
        "--steps=stein-gradient --particles=25",
        "--preset=exact --kernel=huber --guess=0.01,0,0,0,0,0.02 -d0.2 --samples=200",
        "--preset=calibrated --calibrated-points=200 --samples=300 --seed=5",
    ]

    def check(self, *options):
        pair = self.small_pair()
        expected, document = self.run_to_files(*pair, *options)
        for content in (document, document["options"]):
            samples, repeated = self.run_to_files(*pair, "--config", self.config(content))
            self.assertEqual(samples, expected)
            self.assertEqual(repeated["options"], document["options"])

    def test_a_run_is_repeated_from_its_posterior_json(self):
        for options in self.OPTIONS:
            with self.subTest(options=options):
                self.check(*options.split())

    def test_a_run_of_the_authors_config_is_repeated(self):
        for is_normalized in (False, True):
            content = {**AUTHORS_CONFIG, "normalize-cloud": is_normalized}
            self.check("--config", self.file("authors.json", json.dumps(content)))
