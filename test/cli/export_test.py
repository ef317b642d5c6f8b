"""--export: each format is read back and compared with the draws of the same run, moved
through the coordinates of the software it is for."""

import csv
import math
import shutil
import unittest

import robot_formats as formats
from cli_tool import DATA, FAST, ToolTest, run, strict_json

MUG = [DATA / "mug" / "source.pcd", DATA / "mug" / "target.pcd"]
GOOD = [*MUG, "--preset=exact", "--sigma=0.005", "--effective-points=300"]
GOOD += ["--prior-frame=source-centroid"]
TIME = "1700000000.123456789"
OPTIONS = ["--timestamp", TIME, "--target-frame=map/0", "--source-frame=scan_1", "--vertices=3,8"]
# What there is without an export.
WRITTEN = ["aligned.pcd", "posterior.json", "report.html", "samples.csv"]
FILES = ["pose.csv", "pose.g2o", "pose_gtsam.txt", "pose_ros.yaml", "pose_tum.txt"]
FILES += ["pose_tum_covariance.txt"]
# Rounding: inverses of matrices of condition 1e6 and sums over hundreds of draws.
ROUNDING = 1e-8


class ExportTest(ToolTest):
    def assert_same_covariance(self, found, expected, tolerance=ROUNDING):
        for i in range(6):
            for k in range(6):
                scale = math.sqrt(expected[i][i] * expected[k][k])
                self.assertAlmostEqual(found[i][k], expected[i][k], delta=tolerance * scale)

    def assert_same_rotation(self, quaternion, pose):
        difference = formats.multiplied(
            formats.conjugate(quaternion), formats.quaternion_of(*pose[3:])
        )
        self.assertLess(math.dist(formats.rotation_vector(difference), (0, 0, 0)), 1e-12)
        self.assertGreaterEqual(quaternion[3], 0)


class ExportFormats(ExportTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        holder = ToolTest("assert_ran")
        holder.setUp()
        cls.addClassCleanup(holder.doCleanups)
        cls.output = holder.folder / "output"
        cls.result = run(*GOOD, "--export=ros,g2o,gtsam,tum,csv", *OPTIONS, "-o", cls.output)
        document = strict_json((cls.output / "posterior.json").read_text())
        cls.mean = list(document["posterior"]["mean"].values())[:6]
        with open(cls.output / "samples.csv", encoding="ascii") as file:
            cls.draws = [list(map(float, row[2:])) for row in list(csv.reader(file))[1:]]

    def text(self, name):
        return (self.output / name).read_text()

    def moment(self, error):
        return formats.second_moment(error, self.mean, self.draws)

    def test_all_files_are_there(self):
        self.assertEqual((self.result.returncode, self.result.stderr), (0, ""))
        self.assertIn("Posterior mean", self.result.stdout)
        names = sorted(path.name for path in self.output.iterdir())
        self.assertEqual(names, sorted([*WRITTEN, *FILES]))

    def test_ros(self):
        message = formats.read_yaml(self.text("pose_ros.yaml"))
        stamp = {"sec": 1700000000, "nanosec": 123456789}
        self.assertEqual(message["header"], {"stamp": stamp, "frame_id": "map/0"})
        pose = message["pose"]["pose"]
        self.assertEqual((list(pose["position"]), list(pose["orientation"])), (list("xyz"), list("xyzw")))
        self.assert_close(list(pose["position"].values()), self.mean[:3], delta=1e-12)
        self.assert_same_rotation(list(pose["orientation"].values()), self.mean)
        numbers = message["pose"]["covariance"]
        self.assertTrue(all(isinstance(number, float) for number in numbers), numbers)
        self.assertEqual(len(numbers), 36)
        rows = [numbers[6 * i : 6 * i + 6] for i in range(6)]
        self.assert_same_covariance(rows, self.moment(formats.ros_error))

    def test_g2o(self):
        lines = self.text("pose.g2o").splitlines()
        self.assertEqual(len(lines), 1)
        i, j, position, quaternion, information = formats.read_g2o_edge(lines[0])
        self.assertEqual((i, j), (3, 8))
        self.assert_close(position, self.mean[:3], delta=1e-12)
        self.assert_same_rotation(quaternion, self.mean)
        product = formats.product(information, self.moment(formats.g2o_error))
        scale = [math.sqrt(information[k][k]) for k in range(6)]
        for a in range(6):
            for b in range(6):
                self.assertAlmostEqual(
                    product[a][b] * scale[b] / scale[a], float(a == b), delta=1e-6
                )

    def test_gtsam(self):
        lines = self.text("pose_gtsam.txt").splitlines()
        rows = [list(map(float, line.split())) for line in lines if not line.startswith("#")]
        self.assertEqual([len(row) for row in rows], [4] * 4 + [6] * 12)
        self.assert_close([row[3] for row in rows[:3]], self.mean[:3], delta=1e-12)
        for k in range(3):
            axis = formats.turned(formats.quaternion_of(*self.mean[3:]), [float(k == i) for i in range(3)])
            self.assert_close([row[k] for row in rows[:3]], axis, delta=1e-12)
        self.assertEqual(rows[3], [0, 0, 0, 1])
        self.assert_same_covariance(rows[4:10], self.moment(formats.gtsam_error))
        product = formats.product(rows[4:10], rows[10:])
        for a in range(6):
            for b in range(6):
                scale = math.sqrt(rows[10 + b][b] / rows[10 + a][a])
                self.assertAlmostEqual(product[a][b] / scale, float(a == b), delta=1e-6)

    def test_tum(self):
        words = self.text("pose_tum.txt").split()
        self.assertEqual((len(words), words[0]), (8, TIME))
        numbers = list(map(float, words))
        self.assert_close(numbers[1:4], self.mean[:3], delta=1e-12)
        self.assert_same_rotation(numbers[4:], self.mean)
        words = self.text("pose_tum_covariance.txt").split()
        self.assertEqual((len(words), words[0]), (37, TIME))
        rows = [list(map(float, words[1 + 6 * i : 7 + 6 * i])) for i in range(6)]
        self.assert_same_covariance(rows, self.moment(formats.ros_error))

    def test_csv(self):
        (row,) = csv.DictReader(self.text("pose.csv").splitlines())
        given = {"timestamp_s": TIME, "target_frame": "map/0", "source_frame": "scan_1"}
        self.assertEqual({key: row[key] for key in given}, given)
        self.assertEqual(row["status"], "ok")
        names = ["x", "y", "z", "roll", "pitch", "yaw"]
        units = ["m"] * 3 + ["rad"] * 3
        found = [float(row[f"{name}_{unit}"]) for name, unit in zip(names, units)]
        self.assertEqual(found, self.mean)
        expected = self.moment(formats.parameter_error)
        for i in range(6):
            for k in range(i, 6):
                unit = units[i] + "2" if units[i] == units[k] else "m_rad"
                number = float(row[f"cov_{names[i]}_{names[k]}_{unit}"])
                scale = math.sqrt(expected[i][i] * expected[k][k])
                self.assertAlmostEqual(number, expected[i][k], delta=ROUNDING * scale)
        self.assertEqual(len(row), 4 + 6 + 21)

    def test_one_format_is_printed_in_place_of_the_table(self):
        for name, file in (("g2o", "pose.g2o"), ("tum", "pose_tum.txt")):
            result = run(*GOOD, f"--export={name}", *OPTIONS)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertEqual(result.stdout, self.text(file))


class ExportRefusals(ExportTest):
    def test_posterior_that_has_not_mixed(self):
        pair = self.small_pair()
        result = run(*pair, *FAST, "--export=g2o")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("--export g2o: the status is not_mixed, neither ok nor doubtful", result.stderr)
        output = self.folder / "output"
        result = run(*pair, *FAST, "--export=g2o,ros", "-o", output, "--quiet")
        self.assertEqual(result.returncode, 1)
        self.assertIn("--export g2o: not written: ", result.stderr)
        self.assertIn("--export ros: not written: ", result.stderr)
        names = sorted(path.name for path in output.iterdir())
        self.assertEqual(names, WRITTEN)
        result = run(*pair, *FAST, "--export=g2o", "--export-unreliable")
        self.assertEqual(result.returncode, 1)
        self.assertTrue(result.stdout.startswith("EDGE_SE3:QUAT 0 1 "), result.stdout)

    def test_covariance_of_too_few_draws(self):
        few = ["--samples=4", "--preset=paper", "--chains=1", "--step-size=1e-6"]
        few += ["--export-unreliable"]
        output = self.folder / "output"
        result = run(*self.small_pair(), *few, "--export=g2o,gtsam,ros", "-o", output, "--quiet")
        self.assertEqual(result.returncode, 1)
        self.assertIn("--export g2o: not written: the covariance is singular", result.stderr)
        self.assertIn("--export gtsam: not written: the covariance is singular", result.stderr)
        self.assertFalse((output / "pose.g2o").exists())
        self.assertTrue((output / "pose_ros.yaml").exists())
        result = run(*self.small_pair(), *few[1:], "--samples=1", "--export=ros")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("--export ros: the covariance is not finite", result.stderr)

    def test_usage(self):
        pair = self.small_pair()
        bad = [
            (["--export=g2"], "--export: 'g2' is not ros, g2o, gtsam, tum or csv"),
            (["--export=g2o,"], "--export: ''"),
            (["--export="], "--export"),
            (["--export=g2o,tum"], "several formats need --output"),
            (["--export=g2o", "--json"], "excludes --json"),
            (["--export=g2o", "--quiet"], "excludes --json and --quiet"),
            (["--timestamp=5"], "--timestamp: has no effect without --export"),
            (["--export=g2o", "--vertices=1"], "--vertices: '1'"),
            (["--export=g2o", "--vertices=1,1"], "--vertices: '1,1'"),
            (["--export=g2o", "--vertices=-1,1"], "--vertices: '-1,1'"),
            (["--export=ros", "--target-frame=a b"], "--target-frame: 'a b'"),
            (["--export=csv", "--source-frame=a,b"], "--source-frame: 'a,b'"),
        ]
        bad += [
            (["--export=tum", f"--timestamp={time}"], f"--timestamp: '{time}'")
            for time in ("-1", "1.2.3", "1e3", "nan", "2147483648", ".5", "1.1234567891")
        ]
        for options, reason in bad:
            with self.subTest(options=options):
                self.assert_refused(2, run(*pair, *FAST, *options), reason)

    def test_files_appear_together_or_not_at_all(self):
        output = self.folder / "output"
        (output / "pose.g2o").mkdir(parents=True)
        arguments = [*self.small_pair(), *FAST, "--export=ros,g2o", "--export-unreliable"]
        result = run(*arguments, "-o", output)
        self.assert_refused(3, result, output / "pose.g2o", "is a directory")
        self.assertEqual([path.name for path in output.iterdir()], ["pose.g2o"])
        shutil.rmtree(output)


if __name__ == "__main__":
    unittest.main()
