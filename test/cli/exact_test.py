"""Preset exact: its options and what it reports."""

import functools
import math
import random
import re

from cli_tool import ToolTest, run, strict_json

SENSOR = ["--sigma=0.005", "--effective-points=300", "--prior-frame=source-centroid"]
NAMES = ["x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad"]
PERIOD = 0.1


class ExactTest(ToolTest):
    WITH_STEIN_STEPS = ["--preset=exact", "--sigma=0.01", "--effective-points=100"]
    SMALL = [*WITH_STEIN_STEPS, "--samples=200"]

    def ridges(self):
        """Ridges along x that repeat exactly, and a scan of ten of them: nothing tells by how
        many periods they are to be shifted."""
        generator = random.Random(95)

        def point_at(x):
            height = 0.02 * math.cos(2 * math.pi * x / PERIOD)
            return (x, generator.uniform(0, 1), height)

        one_ridge = [point_at(generator.uniform(0, PERIOD)) for _ in range(800)]
        target = [(x + k * PERIOD, y, z) for x, y, z in one_ridge for k in range(-5, 15)]
        source = [point_at(generator.uniform(0, 1)) for _ in range(400)]
        return self.pcd("source.pcd", source), self.pcd("target.pcd", target)


class Mug(ExactTest):
    def test_posterior_can_be_trusted_and_holds_the_truth(self):
        self.trusted_run("mug", "--preset", "exact", *SENSOR)


class Options(ExactTest):
    # Each changes the draws of the run without the last one.
    OBEYED = """--residual=point-to-plane; --residual=distribution-to-distribution;
        --residual=distribution-to-distribution --regularization=none;
        --kernel=huber; --kernel=tukey --kernel-width=0.02;
        --steps=metropolis; --steps=metropolis --max-source-points=100;
        --steps=stein-newton; --steps=stein-newton --particles=30; --steps=stein-gradient;
        --steps=langevin --max-step-size=0.3; --max-distance=0.02; --batch-size=100;
        --thinning=3; --burn-in=50"""

    def test_options_are_obeyed(self):
        pair = self.small_pair()

        @functools.lru_cache(maxsize=None)
        def draws(*words):
            has_stein_steps = words and words[0].startswith("--steps=stein")
            small = self.WITH_STEIN_STEPS if has_stein_steps else self.SMALL
            return self.run_to_files(*pair, *small, *words)[0]

        for words in map(str.split, self.OBEYED.split(";")):
            self.assertNotEqual(draws(*words), draws(*words[:-1]), words)


class Modes(ExactTest):
    OPTIONS = ["--preset=exact", "--sigma=0.003", "--effective-points=300", "--chains=8"]
    # Chains would travel between the modes with Metropolis steps.
    OPTIONS += ["--steps=langevin"]
    OPTIONS += ["--samples=400", "--initial-spread=0.08,0.01,0.01,0.01,0.01,0.01"]

    def test_one_mode_is_the_posterior(self):
        _, document = self.run_to_files(*self.small_pair(), *self.SMALL)
        posterior = document["posterior"]
        (mode,) = posterior["modes"]
        self.assertEqual((mode["weight"], mode["chains"]), (1, [0, 1, 2, 3]))
        self.assertEqual(mode["mean"], posterior["mean"])
        self.assertEqual(mode["covariance"], posterior["covariances"][0])

    def test_paper_looks_for_none(self):
        _, document = self.run_to_files(*self.small_pair(), "--preset=paper", "--samples=60")
        self.assertEqual(document["posterior"]["modes"], [])

    def test_several_modes_are_told_apart(self):
        pair = self.ridges()
        result = run(*pair, *self.OPTIONS, "--json")
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"^pcl_bayesian_icp: several modes: .*\n$")
        document = strict_json(result.stdout)
        self.assertEqual(document["status"]["name"], "several_modes")
        modes = document["posterior"]["modes"]
        self.assertGreater(len(modes), 1)
        self.assertAlmostEqual(sum(mode["weight"] for mode in modes), 1, delta=1e-9)
        self.assertEqual(sorted(sum((mode["chains"] for mode in modes), [])), list(range(8)))
        self.check_table(run(*pair, *self.OPTIONS), modes)

    def check_table(self, result, modes):
        """The table has a block for every mode: weight, chains, mean and deviation."""
        self.assertEqual(result.returncode, 1)
        self.assertIn("Status: several modes: ", result.stdout)
        blocks = re.split(r"^Mode \d+: ", result.stdout, flags=re.MULTILINE)[1:]
        self.assertEqual(len(blocks), len(modes))
        for block, mode in zip(blocks, modes):
            head, *rows = block.splitlines()[:4]
            chains = " ".join(map(str, mode["chains"]))
            self.assertEqual(head, f"weight {mode['weight']:.3f}, chains {chains}")
            cells = re.findall(r"(\w+) \[(m|rad)\] +(\S+) \+- +(\S+)", "\n".join(rows))
            self.assertEqual(len(cells), 6)
            for name, unit, mean, deviation in cells:
                key = f"{name}_{unit}"
                self.assertAlmostEqual(float(mean), mode["mean"][key], delta=0.6e-6)
                k = NAMES.index(key)
                variance = mode["covariance"]["matrix"][k][k]
                self.assertAlmostEqual(float(deviation), math.sqrt(variance), delta=0.6e-6)
