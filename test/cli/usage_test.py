"""The command line: what is understood, and how the rest is refused."""

import re

import cloud_files
from cli_tool import DATA, FAST, SMALL_PAIR_POSE, TOOL, ToolTest, call, run, scans

# They need not be there: options are looked at first.
PAIR = ["a.pcd", "b.pcd"]


class Usage(ToolTest):
    def test_help_and_version_go_to_standard_output(self):
        for option in ("-h", "--help", "-help"):
            result = run(option)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertIn("Usage: pcl_bayesian_icp SOURCE TARGET", result.stdout)
        self.assertRegex(run("--version").stdout, r"^pcl_bayesian_icp \d+\.\d+\.\d+\n$")

    def test_help_fits_a_terminal(self):
        for line in run("--help").stdout.splitlines():
            self.assertLessEqual(len(line), 80, line)

    def test_help_has_the_default_of_every_kind_of_value(self):
        text = " ".join(run("--help").stdout.split())
        for word in """samples=2000 step-size=1e-04 prior-variance=0.125 max-distance=none
            preset=calibrated steps=automatic initial-spread=automatic""".split():
            name, default = word.split("=")
            pattern = rf"--{name}[ \]][^(]*(\([^)d]*\)[^(]*)*\(default {re.escape(default)}\)"
            self.assertRegex(text, pattern)

    def test_two_clouds_are_needed(self):
        for clouds in ([], ["a.pcd"]):
            self.assert_refused(2, run(*clouds), "expected a source and a target cloud")
        self.assert_refused(2, run(*PAIR, "c.pcd"), "third file: 'c.pcd'")
        self.assert_refused(3, run("", "b.pcd"), "empty file name: no such file")

    def test_unknown_and_incomplete_options(self):
        cases = [
            (["--sample", "9"], "'--sample'"),
            (["-x"], "'-x'"),
            (["--seed"], "--seed"),
            (["--seed=1", "--seed=2"], "--seed"),
            (["-o", ""], "output"),
            (["--quiet", "--json"], "--json", "--quiet"),
        ]
        self.assert_each_refused(2, [TOOL, *PAIR], cases)

    def test_scripts_refuse_words_that_they_do_not_know(self):
        for line in """analyze src nowhere; bootstrap --demo word; coverage word; demo word; make-data a b c
            make-doc-images a b; measure-sgd-icp a b; sanitize address --fuzzers word; sanitize thread --fuzzers
            test --all word; test-on --all""".replace("\n", ";").split(";"):
            with self.subTest(line=line):
                script, *words = line.split()
                result = call(DATA.parent / "scripts" / script, *words)
                self.assertEqual((result.returncode, result.stdout), (2, ""))
                self.assertIn(f"Usage: scripts/{script}", result.stderr)

    def test_malformed_values_name_option_and_value(self):
        self.assert_refused(2, run(*PAIR, "--preset=best"), "preset", "best")
        for word in """samples=many samples=1.5 samples=99999999999 seed=-1
            seed=18446744073709551616 max-distance=0,1 max-distance=1m step-size=
            guess=1,2,3,4,5 guess=1,2,3,4,5, guess=1,2,3,4,5,6,7 prior-mean=1 prior-variance=1,2
            initial-spread=0,0,0,0,0,a prior-frame=centroid batch-sampling=all""".split():
            with self.subTest(word=word):
                result = run(*PAIR, "--preset=paper", f"--{word}")
                self.assert_refused(2, result, *word.split("="))

    def test_values_out_of_range(self):
        """Each has its name on the command line, and that of the library: mostly the same."""
        alike = {
            "paper": """thinning=0 batch-size=0 step-size=nan decay-rate=1 lambda-rms=0
                noise-factor=-1 block-decay-factor=0 block-decay-interval=0 block-decay-start=2
                effective-points=0 initial-spread=-1""",
            "exact": "kernel-width=0 max-source-points=0 max-step-size=2",
        }
        cases = [(preset, word, None) for preset, words in alike.items() for word in words.split()]
        cases += [
            ("paper", "samples=0", "num_draws is 0"),
            ("paper", "samples=3", "at least the number of chains (one draw a chain)"),
            ("paper", "chains=0", "num_chains is 0"),
            ("paper", "burn-in=-1", "num_burn_in is -1"),
            ("paper", "sigma=0", "measurement_sigma is 0"),
            ("paper", "prior-mean=inf,0,0,0,0,0", "prior.mean is inf"),
            ("paper", "prior-variance=1,1,1,1,0,1", "prior.variance[pitch] is 0"),
            ("paper", "threads=-1", "num_threads is -1"),
            ("paper", "max-distance=0", "is 0"),
            ("paper", "max-distance=nan", "is nan"),
            ("paper", "iterations=0", "is 0"),
            ("paper", "guess=nan,0,0,0,0,0", "finite"),
            ("calibrated", "prior-variance=inf", "prior.variance[x] is inf, but must be finite"),
            ("calibrated", "calibrated-points=29", "max_source_points is 29, but must be at least 30"),
            ("calibrated", "mode-points=0", "num_mode_points is 0, but must be at least 30"),
        ]
        for preset, word, complaint in cases:
            name, value = word.split("=")
            with self.subTest(preset=preset, word=word):
                complaint = complaint or f"{name.replace('-', '_')} is {value}"
                result = run(*PAIR, f"--preset={preset}", f"--{name}", value)
                self.assert_refused(2, result, f"--{name}: ", complaint)

    def test_values_that_exclude_each_other(self):
        cases = [
            (["--steps=stein-newton", "--particles=7"], "--particles: num_particles is 7"),
            (["--steps=stein-newton", "--batch-size=9"], "--steps: steps is stein-newton"),
            (["--steps=metropolis", "--batch-size=9"], "--steps: steps is metropolis"),
            (["--residual=point-to-plane", "--one-to-one"], "--residual: ", "--one-to-one"),
            (["--residual=distribution-to-distribution", "--reciprocal"], "--residual: ", "--reciprocal"),
        ]
        self.assert_each_refused(2, [TOOL, *PAIR, "--preset=exact"], cases)


class Values(ToolTest):
    """Options arrive where they should: seen in the options that are reported."""

    def options(self, *arguments):
        return self.run_to_json(*self.small_pair(), *FAST, *arguments)["options"]

    def test_icp_uses_its_correspondences(self):
        ends = set()
        for words in ([], ["--reciprocal"], ["--one-to-one"]):
            icp = self.run_to_json(*scans("table"), *FAST, *words)["icp"]
            ends.add(str(icp["T_target_source"]))
        self.assertEqual(len(ends), 3)

    def test_dashes_and_separators(self):
        for words in """--max-distance 0.5; --max-distance=0.5; -max-distance 0.5;
            -max-distance=0.5; -d 0.5; -d0.5; -d +.5""".split(";"):
            with self.subTest(words=words):
                options = self.options(*words.split())
                self.assertEqual(options["registration"]["max_distance_m"], 0.5)

    def test_negative_numbers_and_lists(self):
        mean = [-0.1, 0, 0.2, 0, 0, -0.3]
        for words in (
            ["--prior-mean", "-0.1,0,0.2,0,0,-0.3"],
            ["--prior-mean=-0.1,0,0.2,0,0,-0.3"],
            ["-prior-mean", "-.1,0,+.2,0,0,-3e-1"],
        ):
            self.assertEqual(self.options(*words)["prior"]["mean_m_rad"], mean)

    def test_guess_as_pose_and_as_file(self):
        matrix = cloud_files.matrix_of(*SMALL_PAIR_POSE)
        text = "\n".join(" ".join(map(repr, map(float, row))) for row in matrix)
        for guess in (self.file("guess.txt", text), ",".join(map(str, SMALL_PAIR_POSE))):
            found = self.options("--guess", guess)["registration"]["guess_matrix"]
            self.assert_close(found, matrix, delta=1e-15)

    def test_one_number_for_all_and_no_prior(self):
        prior = self.options("--prior-variance", "2")["prior"]
        self.assertEqual(prior["variance_m2_rad2"], [2] * 6)
        prior = self.options("--prior-variance", "1,2,3,4,5,inf")["prior"]
        self.assertEqual(prior["variance_m2_rad2"], [1, 2, 3, 4, 5, None])

    SHARED = {
        "chains": ("chains", "num_chains", 3),
        "samples": ("chains", "num_draws", 61),
        "seed": ("chains", "seed", 18446744073709551615),
        "threads": ("chains", "num_threads", 2),
        "prior-frame": ("prior", "frame", "source-centroid"),
        "iterations": ("registration", "icp_iterations", 3),
        "burn-in": ("chains", "num_burn_in", 7),
        "thinning": ("chains", "thinning", 2),
    }
    SCALE = {
        "effective-points": ("posterior", "effective_points", 500),
        "sigma": ("posterior", "measurement_sigma_m", 0.5),
        "batch-size": ("mini_batch", "batch_size", 31),
        "initial-spread": ("chains", "initial_spread_m_rad", [0.25] * 6),
    }
    OF_PRESETS = {
        "paper": {
            **SCALE,
            "batch-sampling": ("mini_batch", "sampling", "shuffled-epochs"),
            "step-size": ("sgld", "step_size", 2e-6),
            "decay-rate": ("sgld", "decay_rate", 0.8),
            "lambda-rms": ("sgld", "lambda_rms", 1e-5),
            "noise-factor": ("sgld", "noise_factor", 0.5),
            "block-decay-factor": ("sgld", "block_decay_factor", 0.7),
            "block-decay-interval": ("sgld", "block_decay_interval", 5),
            "block-decay-start": ("sgld", "block_decay_start", 0.25),
        },
        "exact": {
            **SCALE,
            "max-step-size": ("exact", "max_step_size", 0.5),
            "steps": ("exact", "steps", "langevin"),
            "regularization": ("exact", "regularization", "frobenius"),
            "residual": ("exact", "residual", "distribution-to-distribution"),
            "kernel": ("exact", "kernel", "tukey"),
            "kernel-width": ("exact", "kernel_width_m", 0.125),
            "max-source-points": ("exact", "max_source_points", 77),
        },
        "calibrated": {
            "calibrated-points": ("calibrated", "max_source_points", 200),
            "mode-points": ("calibrated", "num_mode_points", 100),
        },
    }

    def test_every_option_arrives(self):
        for preset, own in self.OF_PRESETS.items():
            given = {**self.SHARED, **own, "preset": ("posterior", "preset", preset)}
            words = [
                f"--{name}={value[0] if isinstance(value, list) else value}"
                for name, (_, _, value) in given.items()
            ]
            # No pair is filtered where normals are needed.
            flags = ["use_mean"] if preset == "exact" else ["reciprocal", "one_to_one", "use_mean"]
            words += [f"--{name.replace('use_', '').replace('_', '-')}" for name in flags]
            options = self.run_to_json(*self.small_pair(), *words)["options"]
            for group, key, value in given.values():
                self.assertEqual(options[group][key], value)
            for key in flags:
                self.assertIs(options["registration"][key], True)
            groups = {group for group, _, _ in given.values()}
            self.assertEqual(set(options), groups)

    def test_options_that_would_have_no_effect_are_refused(self):
        stein = "--steps=stein-newton"
        for words, reason in (
            (["--kernel-width=0.05"], "without --kernel"),
            (["--regularization=frobenius", "--residual=point-to-plane"], "without --residual"),
            (["--particles=50"], "without Stein steps"),
            (["--samples=500", stein], "with Stein steps"),
            (["--burn-in=5", stein], "with Stein steps"),
            (["--thinning=5", stein], "with Stein steps"),
            (["--max-step-size=0.5", stein], "with Stein steps"),
            (["--max-step-size=0.5", "--steps=metropolis"], "with Metropolis steps"),
        ):
            result = run(*PAIR, "--preset=exact", *words)
            self.assert_refused(2, result, f"{words[0].split('=')[0]}: has no effect {reason}")

    def test_options_of_other_presets_are_refused(self):
        for preset, own in self.OF_PRESETS.items():
            for owner, options in self.OF_PRESETS.items():
                for name in options.keys() - own.keys():
                    result = run(*PAIR, f"--preset={preset}", f"--{name}=0.5")
                    belongs = f"--{name} belongs to preset"
                    self.assert_refused(2, result, belongs, owner, f", and the preset is {preset}")


class GuessFiles(ToolTest):
    def refuse(self, content, *reason):
        path = self.file("guess.txt", content)
        result = run(*self.small_pair(), "--guess", path)
        self.assert_refused(3, result, path, *reason)

    def test_bad_files(self):
        identity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
        self.refuse("", "is empty")
        self.refuse(identity[:-2], "15 numbers")
        self.refuse(identity.replace("1", "one"), "'one' is not a number")
        self.refuse("2" + identity[1:], "not a rotation")
        self.refuse("-1" + identity[1:], "not a rotation")
        self.refuse("nan" + identity[1:], "not finite")
        self.refuse(identity[:-2] + "2", "last row")

    def test_missing_file(self):
        self.assert_refused(3, run("a", "b", "--guess", "no_such.txt"), "no_such.txt: no such file")
