"""pcl_bayesian_icp_batch: lines of JSON, failures, resuming after kills, MPI ranks."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import time
import unittest

import cloud_files
from cli_tool import FAST, ToolTest, call, run, strict_json
from config_test import AUTHORS_CONFIG
from faults import BATCH

# About 0.3 s a pair.
SLOW = ["--preset", "paper", "--samples", "200", "--chains", "2", "--thinning", "10"]
SLOW += ["--step-size", "1e-6"]
PAIR = {"source": "source.pcd", "target": "target.pcd"}


def run_batch(*arguments, launcher=()):
    return call(*launcher, BATCH, *arguments)


def results_of(text):
    """The lines by name; each name once, each line complete."""
    assert text == "" or text.endswith("\n"), text[-80:]
    lines = [strict_json(line) for line in text.splitlines()]
    results = {line["name"]: line for line in lines}
    assert len(results) == len(lines), [line["name"] for line in lines]
    return results


def without_times(results):
    return {
        name: {key: value for key, value in line.items() if key != "time"}
        for name, line in results.items()
    }


class BatchTest(ToolTest):
    program = "pcl_bayesian_icp_batch"

    def setUp(self):
        super().setUp()
        self.results = self.folder / "results.jsonl"

    def manifest(self, pairs):
        return self.file("manifest.json", json.dumps(pairs))

    def printed(self, manifest, *options):
        """The results of a run without --results."""
        return without_times(results_of(run_batch(manifest, *options).stdout))

    def written(self):
        return without_times(results_of(self.results.read_text()))

    def seeds(self, count):
        """A manifest of one small pair with several seeds."""
        self.small_pair()
        settings = [{"chains": {"seed": seed}} for seed in range(count)]
        return self.manifest([{"name": f"seed {k}", **PAIR, "settings": s} for k, s in enumerate(settings)])


class BatchResults(BatchTest):
    def test_a_line_says_what_the_single_program_says(self):
        source, target = self.small_pair()
        pose = [0.01, -0.02, 0.01, 0.05, -0.04, 0.08]
        manifest = self.manifest([{"name": "box", **PAIR, "guess": pose}])
        batch = run_batch(manifest, *FAST, "--seed", 7, "-o", self.output)
        guess = ",".join(map(str, pose))
        single = run(source, target, *FAST, "--seed", 7, "--guess", guess, "--json")
        self.assertEqual(batch.returncode, single.returncode, batch.stderr)
        line = results_of(batch.stdout)["box"]
        document = strict_json(single.stdout)
        self.assertEqual(line["status"], document["status"]["name"])
        self.assertEqual(line["message"], document["status"]["message"])
        self.assertEqual(line["mean"], document["posterior"]["mean"])
        parameters, _, _, right_se3 = document["posterior"]["covariances"]
        self.assertEqual(line["covariances"], [parameters, right_se3])
        for key in ("final_transformation", "icp", "source", "target"):
            self.assertEqual(line[key], document[key])
        self.assertEqual(line["seed"], 7)
        self.assertGreater(line["time"]["total_s"], line["time"]["icp_s"])
        self.output = self.output / "box"
        self.assertEqual(self.names_of_output(), ["posterior.json", "samples.csv"])
        written = strict_json((self.output / "posterior.json").read_text())
        self.assertEqual(written["posterior"], document["posterior"])
        self.assertEqual(written["options"], document["options"])

    def test_failures_are_of_their_pair_only(self):
        self.small_pair()
        self.file("broken.pcd", b"VERSION .7\nFIELDS x y z\nrubbish")
        self.pcd("two.pcd", [(0, 0, 0), (1, 0, 0)])
        self.file("matrix.txt", "1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 2")
        self.pcd("far.pcd", cloud_files.far_box())
        manifest = self.manifest(
            [
                {"name": "first", **PAIR},
                {"name": "missing", **PAIR, "source": "no_such.pcd"},
                {"name": "broken", **PAIR, "target": "broken.pcd"},
                {"name": "two points", **PAIR, "source": "two.pcd"},
                {"name": "bad guess", **PAIR, "guess": "matrix.txt"},
                {"name": "apart", **PAIR, "target": "far.pcd"},
                {"name": "last", **PAIR},
            ]
        )
        apart, missing = self.output / "apart", self.output / "missing"
        for folder in (apart, missing):
            folder.mkdir(parents=True)
            for name in ("posterior.json", "samples.csv"):
                (folder / name).write_text("of an older posterior")
        result = run_batch(manifest, *FAST, "-d", 0.5, "-o", self.output)
        self.assertEqual(result.returncode, 1, result.stderr)
        lines = results_of(result.stdout)
        self.assertEqual(len(lines), 7)
        for name, part in (
            ("missing", "no_such.pcd: no such file"),
            ("broken", "broken.pcd"),
            ("two points", "two.pcd"),
            ("bad guess", "matrix.txt: the last row"),
        ):
            self.assertEqual(lines[name]["status"], "error")
            self.assertIn(part, lines[name]["message"])
            self.assertIsNone(lines[name]["mean"])
            self.assertEqual(lines[name].keys(), lines["first"].keys())
        self.assertEqual(lines["apart"]["status"], "too_few_correspondences")
        self.assertIsNone(lines["apart"]["mean"]["x_m"])
        self.assertEqual([path.name for path in apart.iterdir()], ["posterior.json"])
        strict_json((apart / "posterior.json").read_text())
        self.assertEqual(list(missing.iterdir()), [])
        self.assertFalse((self.output / "broken").exists())
        self.assertEqual(lines["first"]["mean"], lines["last"]["mean"])
        self.assertGreater(lines["first"]["draws"], 0)
        self.assertEqual(len(result.stderr.splitlines()), 7)

    def test_threads_do_not_matter(self):
        manifest = self.seeds(5)
        runs = [self.printed(manifest, *FAST, "--threads", n) for n in (1, 3, 8)]
        self.assertEqual(len(runs[0]), 5)
        self.assertNotEqual(runs[0]["seed 0"]["mean"], runs[0]["seed 1"]["mean"])
        self.assertEqual(runs[0], runs[1])
        self.assertEqual(runs[0], runs[2])

    def test_a_data_set_with_its_guesses_and_priors(self):
        self.small_pair()
        self.file("T.txt", "1 0 0 0.01\n0 1 0 -0.02\n0 0 1 0.01\n0 0 0 1\n")
        manifest = self.manifest(
            [
                {
                    "name": "box",
                    "split": "public",
                    "files": {
                        "source": "source.pcd",
                        "target": "target.pcd",
                        "initial_guess": "T.txt",
                        "ground_truth": "not_read.txt",
                    },
                    "suggested_prior_sigma": {"translation_m": 0.03, "rotation_rad": 0.2},
                }
            ]
        )
        run_batch(manifest, *FAST, "--suggested-prior", "-o", self.output)
        options = strict_json((self.output / "box" / "posterior.json").read_text())["options"]
        self.assertEqual(options["registration"]["guess_matrix"][1][3], -0.02)
        self.assertEqual(options["prior"]["frame"], "source-centroid")
        expected = [0.03**2] * 3 + [0.2**2] * 3
        self.assert_close(options["prior"]["variance_m2_rad2"], expected, delta=1e-12)


class BatchRefused(BatchTest):
    def test_manifests(self):
        good = {"name": "a", **PAIR}
        for content, *parts in (
            ("[", "broken JSON"),
            ('[{"name": "a", "source": "s.pcd", "source": "t.pcd"}]', "'source' twice"),
            ("{}", "not a JSON list"),
            ([], "has no pairs"),
            ("[1]", "pair 1: is '1', but must be an object"),
            ([{**good, "name": "../up"}], "pair 1", "folder"),
            ([{**good, "name": ""}], "pair 1", "must be a string that is not empty"),
            ([good, good], "pair 2", "another pair"),
            ([{"name": "a", "source": "s.pcd"}], "'target' is missing"),
            ([{**good, "gues": "x"}], "unknown key 'gues'"),
            ([{**good, "guess": [1, 2]}], "six numbers"),
            ([{**good, "guess": [0, 0, 0, 0, 0, 90]}], "angles within a turn"),
            ([{**good, "settings": {"chains": {"sed": 1}}}], "chains.sed"),
            ([{**good, "settings": {"exact": {"kernel": "huber"}}}], "exact belongs to preset"),
            ([{**good, "settings": {"chains": {"num_draws": -1}}}], "num_draws", "-1"),
        ):
            with self.subTest(content=content):
                text = content if isinstance(content, str) else json.dumps(content)
                manifest = self.file("manifest.json", text)
                self.assert_refused(3, run_batch(manifest), manifest, *parts)
        self.assert_refused(3, run_batch(self.folder / "none"), "no such file")

    def test_lengths_in_two_units(self):
        """Those of the authors' file in units of the clouds, those of a pair in metres."""
        config = self.file("c.json", json.dumps({**AUTHORS_CONFIG, "normalize-cloud": True}))
        self.small_pair()
        pair = {"name": "a", **PAIR}
        for own in ({"guess": [0] * 6}, {"settings": {"registration": {"max_distance_m": 1}}}):
            manifest = self.manifest([{**pair, **own}])
            result = run_batch(manifest, "--config", config)
            self.assertEqual(result.returncode, 3, result.stderr)
            self.assertRegex(result.stderr, f"{manifest}: pair 1 .* are in units of the clouds")
        manifest = self.manifest([{**pair, "settings": {"chains": {"seed": 3}}}])
        self.assertIn(run_batch(manifest, "--config", config).returncode, (0, 1))

    def test_an_output_folder_that_cannot_be_made(self):
        """Before any pair is registered."""
        manifest = self.manifest([{"name": "a", **PAIR}])
        in_file = manifest / "files"
        self.assert_refused(3, run_batch(manifest, "-o", in_file), in_file, "cannot be made")

    def test_usage(self):
        manifest = self.seeds(1)
        cases = [
            ([], "expected a manifest"),
            ([manifest, "more"], "'more'"),
            ([manifest, "--sigma", "x"], "--sigma"),
            ([manifest, "--suggested-prior", "--prior-variance", "1"], "exclude"),
            ([manifest, "--suggested-prior", "--prior-frame", "origin"], "exclude"),
        ]
        self.assert_each_refused(2, [BATCH], cases)
        self.assert_refused(3, run_batch(manifest, "--suggested-prior"), "suggested_prior_sigma")


class BatchResume(BatchTest):
    def whole_lines(self):
        content = self.results.read_bytes() if self.results.exists() else b""
        return content[: content.rfind(b"\n") + 1]

    def resumed(self, manifest, *options):
        self.assert_ran(run_batch(manifest, *options, "--results", self.results))
        return self.written()

    def test_killed_again_and_again(self):
        """Nothing is lost and nothing there twice: each kill comes when there is a new line."""
        manifest = self.seeds(9)
        command = [BATCH, manifest, *SLOW, "--threads", "2", "--results", self.results, "--quiet"]
        kept = b""
        num_lines = []
        for _ in range(3):
            with subprocess.Popen(command) as process:
                while len(self.whole_lines()) <= len(kept) and process.poll() is None:
                    time.sleep(0.005)
                process.kill()
            self.assertTrue(self.whole_lines().startswith(kept))
            kept = self.whole_lines()
            num_lines.append(kept.count(b"\n"))
        self.assertGreaterEqual(len({n for n in num_lines if 0 < n < 9}), 2, num_lines)
        self.assertEqual(self.resumed(manifest, *SLOW), self.printed(manifest, *SLOW))
        self.assertTrue(self.whole_lines().startswith(kept))

    def test_line_that_was_cut_off(self):
        manifest = self.seeds(4)
        whole = self.resumed(manifest, *FAST)
        text = self.results.read_text()
        second_break = text.index("\n", text.index("\n") + 1)
        # Within the third line, and just before its line break.
        third_break = text.index("\n", second_break + 1)
        for size in (second_break + 40, third_break):
            self.results.write_text(text[:size])
            self.assertEqual(self.resumed(manifest, *FAST), whole)

    def test_finished_pairs_are_not_run_again(self):
        manifest = self.seeds(3)
        self.resumed(manifest, *FAST)
        text = self.results.read_bytes()
        result = run_batch(manifest, *FAST, "--results", self.results)
        self.assertIn("3 of 3 pairs", result.stderr)
        self.assertEqual(self.results.read_bytes(), text)
        self.assertEqual(result.returncode, 1)  # what it was in the first run
        self.assertNotIn("no files", result.stderr)
        result = run_batch(manifest, *FAST, "--results", self.results, "-o", self.output, "--quiet")
        self.assert_refused(1, result, f"3 pairs have a line in {self.results} but no files")

    def test_pairs_of_changed_files_are_run_again(self):
        source, _ = self.small_pair()
        names = ("source", "broken", "gone")
        manifest = self.manifest([{**PAIR, "name": n, "source": f"{n}.pcd"} for n in names])
        good = source.read_bytes()
        self.file("broken.pcd", b"rubbish")
        gone = self.file("gone.pcd", good)
        first = self.resumed(manifest, *FAST)
        self.assertEqual(first["broken"]["status"], "error")
        gone.unlink()
        self.file("broken.pcd", good)
        result = run_batch(manifest, *FAST, "--results", self.results, "-o", self.output)
        self.assertIn("1 pairs are registered again", result.stderr)
        again = self.written()
        self.assertEqual(self.names_of_output(), ["broken"])
        self.assertEqual(again["broken"]["mean"], first["source"]["mean"])
        for name in ("source", "gone"):
            self.assertEqual(again[name], first[name])

    def test_pairs_that_failed_miss_no_files(self):
        self.small_pair()
        manifest = self.manifest([{**PAIR, "name": n, "source": n} for n in ("source.pcd", "none")])
        self.resumed(manifest, *FAST)
        words = [manifest, *FAST, "--results", self.results, "-o", self.output]
        self.assertIn("1 pairs have a line", run_batch(*words, "--quiet").stderr)

    def test_a_guess_in_words_is_a_file_name(self):
        """In whatever folder the manifest is."""
        self.small_pair()
        manifest = self.manifest([{"name": "a", **PAIR, "guess": "0,0,0,0,0,0"}])
        for name, options in ((manifest, {}), (manifest.name, {"cwd": self.folder})):
            result = call(BATCH, name, *FAST, **options)
            self.assertEqual(result.returncode, 1)
            (line,) = results_of(result.stdout).values()
            self.assertIn("0,0,0,0,0,0: no such file", line["message"])

    def test_a_step_size_in_other_units(self):
        """A number of the authors' file is multiplied, the same number of an option is not."""
        manifest = self.seeds(2)
        config = self.file("c.json", json.dumps(AUTHORS_CONFIG))
        options = ["--config", config, "--samples", 40]
        self.resumed(manifest, *options)
        other = run_batch(manifest, *options, "--step-size", 0.003, "--results", self.results)
        self.assertEqual(other.returncode, 3, other.stderr)
        self.assertIn("with other settings", other.stderr)

    def test_without_a_standard_error(self):
        """Nothing of what goes there gets into the results."""
        manifest = self.seeds(1)
        command = [BATCH, manifest, *FAST, "--results", self.results]
        subprocess.run(command, preexec_fn=lambda: os.close(2), check=False)
        self.assertEqual(len(results_of(self.results.read_text())), 1)

    def test_results_of_something_else(self):
        manifest = self.seeds(2)
        self.resumed(manifest, *FAST)
        text = self.results.read_bytes()
        first = json.loads(text.splitlines()[0])["name"]
        self.file("T.txt", "1 0 0 0.01\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")
        pairs = json.loads(manifest.read_text())
        guessed = self.file("guessed.json", json.dumps([{**pair, "guess": "T.txt"} for pair in pairs]))
        for words in ([manifest, "--sigma", 2], [guessed]):
            other = run_batch(*words, *FAST, "--results", self.results)
            self.assert_refused(3, other, self.results, f"'{first}'", "other settings, files")
            self.assertEqual(self.results.read_bytes(), text)
        self.results.write_text("x,y\n1,2\n")
        other = run_batch(manifest, *FAST, "--results", self.results)
        self.assert_refused(3, other, self.results, "not a result")
        self.assertEqual(self.results.read_text(), "x,y\n1,2\n")

    def test_interrupt(self):
        manifest = self.seeds(9)
        command = [BATCH, manifest, *SLOW, "--results", self.results]
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
            process.stderr.readline()
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130)
        self.assertIn("pcl_bayesian_icp_batch: interrupted; the pairs under way", errors)
        self.assertIn(len(results_of(self.results.read_text())), range(1, 9))
        self.assertEqual(self.resumed(manifest, *SLOW), self.printed(manifest, *SLOW))


def has_mpi():
    return shutil.which("mpirun") and "with MPI" in run_batch("--version").stdout


@unittest.skipUnless(has_mpi(), "built without MPI, or no mpirun")
class BatchRanks(BatchTest):
    MPIRUN = ("mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2")

    def rank_files(self):
        return [path.name for path in self.folder.iterdir() if ".rank" in path.name]

    def test_two_ranks_share_the_pairs(self):
        manifest = self.seeds(7)
        alone = self.printed(manifest, *FAST)
        options = [manifest, *FAST, "--threads", 1, "--results", self.results]
        result = run_batch(*options, launcher=self.MPIRUN)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("rank 0: 4/4", result.stderr)
        self.assertIn("rank 1: 3/3", result.stderr)
        self.assertEqual(self.written(), alone)
        self.assertEqual(self.rank_files(), [])

    def test_killed_ranks_lose_nothing(self):
        manifest = self.seeds(16)
        options = [manifest, *SLOW, "--threads", "1", "--results", self.results]
        command = [*self.MPIRUN, BATCH, *map(str, options)]
        part = pathlib.Path(f"{self.results}.rank1")
        with subprocess.Popen(command, stderr=subprocess.DEVNULL, start_new_session=True) as job:
            deadline = time.monotonic() + 60
            while time.monotonic() < deadline and not (part.exists() and part.stat().st_size):
                time.sleep(0.02)
            children = pathlib.Path(f"/proc/{job.pid}/task/{job.pid}/children")
            for rank in children.read_text().split():
                os.kill(int(rank), signal.SIGKILL)
            job.wait(30)
        self.assertEqual(self.rank_files(), [part.name])
        saved = set(results_of(part.read_text()))
        self.assertTrue(saved)
        self.assertFalse(saved & set(results_of(self.results.read_text())))
        result = run_batch(*options)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(self.rank_files(), [])
        self.assertEqual(self.written(), self.printed(manifest, *SLOW))

    def test_standard_output_is_refused(self):
        result = run_batch(self.seeds(1), *FAST, launcher=self.MPIRUN)
        self.assertEqual(result.returncode, 2)
        self.assertIn("several processes need --results", result.stderr)
