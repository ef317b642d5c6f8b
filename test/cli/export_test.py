"""--export: each format is read back and compared with posterior.json of the same run, in the
coordinates of the software it is for."""

import csv

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

import cloud_files
from cli_tool import FAST, TOOL, WITHOUT_REPORT, WRITTEN, ToolTest, run, scans, strict_json
from trajectories import read_g2o_edge

GOOD = [*scans("mug"), "--preset=exact", "--sigma=0.005", "--effective-points=300"]
GOOD += ["--prior-frame=source-centroid"]
TIME = "1700000000.123456789"
OPTIONS = ["--timestamp", TIME, "--target-frame=map/0", "--source-frame=scan_1", "--vertices=3,8"]
FILES = ["pose.csv", "pose.g2o", "pose_gtsam.txt", "pose_ros.yaml", "pose_tum.txt"]
FILES += ["pose_tum_covariance.txt"]
# Rounding: inverses of matrices of condition 1e6 and sums over hundreds of draws.
ROUNDING = 1e-8
NAMES = ["x", "y", "z", "roll", "pitch", "yaw"]
UNITS = ["m"] * 3 + ["rad"] * 3


class ExportFormats(ToolTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.exported = cls.holder().output
        cls.result = run(*GOOD, "--export=ros,g2o,gtsam,tum,csv", *OPTIONS, "-o", cls.exported)
        posterior = strict_json((cls.exported / "posterior.json").read_text())["posterior"]
        cls.mean = np.array(list(posterior["mean"].values())[:6])
        covariances = (np.array(each["matrix"]) for each in posterior["covariances"])
        cls.of_parameters, cls.of_ros, _, cls.of_twist = covariances

    def setUp(self):
        super().setUp()
        self.output = self.exported

    def assert_same_covariance(self, found, expected):
        deviations = np.sqrt(np.diag(expected))
        difference = (np.array(found) - expected) / np.outer(deviations, deviations)
        self.assertLess(np.abs(difference).max(), ROUNDING)

    def assert_inverse(self, information, covariance):
        """Each in units of the information of its coordinate."""
        scale = np.sqrt(np.diag(information))
        product = information @ covariance * scale / scale[:, None]
        self.assertLess(np.abs(product - np.eye(6)).max(), 1e-6)

    def assert_same_rotation(self, quaternion, pose):
        rotation = Rotation.from_euler("xyz", pose[3:])  # Rz(yaw) Ry(pitch) Rx(roll)
        difference = Rotation.from_quat(quaternion).inv() * rotation
        self.assertLess(difference.magnitude(), 1e-12)
        self.assertGreaterEqual(quaternion[3], 0)

    def text(self, name):
        return (self.exported / name).read_text()

    def test_all_files_are_there(self):
        self.assertEqual((self.result.returncode, self.result.stderr), (0, ""))
        self.assertIn("Posterior mean", self.result.stdout)
        self.assertEqual(self.names_of_output(), sorted([*WRITTEN, *FILES]))

    def test_ros(self):
        message = yaml.safe_load(self.text("pose_ros.yaml"))
        stamp = {"sec": 1700000000, "nanosec": 123456789}
        self.assertEqual(message["header"], {"stamp": stamp, "frame_id": "map/0"})
        pose = message["pose"]["pose"]
        self.assertEqual((list(pose["position"]), list(pose["orientation"])), (list("xyz"), list("xyzw")))
        self.assert_close(list(pose["position"].values()), self.mean[:3], delta=1e-12)
        self.assert_same_rotation(list(pose["orientation"].values()), self.mean)
        numbers = message["pose"]["covariance"]
        self.assertTrue(all(isinstance(number, float) for number in numbers), numbers)
        self.assert_same_covariance(np.reshape(numbers, (6, 6)), self.of_ros)

    def test_g2o(self):
        lines = self.text("pose.g2o").splitlines()
        self.assertEqual(len(lines), 1)
        i, j, position, quaternion, information = read_g2o_edge(lines[0])
        self.assertEqual((i, j), (3, 8))
        self.assert_close(position, self.mean[:3], delta=1e-12)
        self.assert_same_rotation(quaternion, self.mean)
        half_angles = np.diag([1.0] * 3 + [0.5] * 3)
        self.assert_inverse(information, half_angles @ self.of_twist @ half_angles)

    def test_gtsam(self):
        lines = self.text("pose_gtsam.txt").splitlines()
        rows = [list(map(float, line.split())) for line in lines if not line.startswith("#")]
        self.assertEqual([len(row) for row in rows], [4] * 4 + [6] * 12)
        self.assert_close(rows[:4], cloud_files.matrix_of(*self.mean), delta=1e-12)
        self.assertEqual(rows[3], [0, 0, 0, 1])
        rotation_first = [3, 4, 5, 0, 1, 2]
        self.assert_same_covariance(rows[4:10], self.of_twist[np.ix_(rotation_first, rotation_first)])
        self.assert_inverse(np.array(rows[10:]), np.array(rows[4:10]))

    def test_tum(self):
        words = self.text("pose_tum.txt").split()
        self.assertEqual((len(words), words[0]), (8, TIME))
        numbers = list(map(float, words))
        self.assert_close(numbers[1:4], self.mean[:3], delta=1e-12)
        self.assert_same_rotation(numbers[4:], self.mean)
        words = self.text("pose_tum_covariance.txt").split()
        self.assertEqual((len(words), words[0]), (37, TIME))
        self.assert_same_covariance(np.array(words[1:], float).reshape(6, 6), self.of_ros)

    def read_csv(self, text):
        """The row, and its covariance."""
        (row,) = csv.DictReader(text.splitlines())
        covariance = np.zeros((6, 6))
        for i in range(6):
            for k in range(i, 6):
                unit = UNITS[i] + "2" if UNITS[i] == UNITS[k] else "m_rad"
                number = float(row[f"cov_{NAMES[i]}_{NAMES[k]}_{unit}"])
                covariance[i, k] = covariance[k, i] = number
        return row, covariance

    def test_csv(self):
        row, covariance = self.read_csv(self.text("pose.csv"))
        given = {"timestamp_s": TIME, "target_frame": "map/0", "source_frame": "scan_1"}
        self.assertEqual({key: row[key] for key in given}, given)
        self.assertEqual(row["status"], "ok")
        found = [float(row[f"{name}_{unit}"]) for name, unit in zip(NAMES, UNITS)]
        self.assertEqual(found, list(self.mean))
        self.assert_same_covariance(covariance, self.of_parameters)
        self.assertEqual(len(row), 4 + 6 + 21)

    def test_the_prior_and_the_measurement_without_it_are_the_posterior(self):
        variance = np.array([1e-5, 1e-5, 1e-5, 1e-3, 1e-3, 1e-3])
        pair = [*GOOD[:-1], "--prior-frame=origin", "--export=csv"]
        pair += ["--prior-variance=" + ",".join(map(str, variance))]
        informations = []
        for options in ([], ["--export-without-prior"]):
            result = run(*pair, *options)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            informations.append(np.linalg.inv(self.read_csv(result.stdout)[1]))
        posterior, measurement = informations
        shares = [
            np.linalg.eigvals(np.linalg.solve(posterior, information)).real
            for information in (measurement, measurement + np.diag(1 / variance))
        ]
        # In some direction the clouds have less than 0.7 of the information. The sum is
        # right as far as the posterior is Gaussian in these coordinates: 0.89 to 1.11.
        self.assertLess(shares[0].min(), 0.7)
        self.assertLess(np.abs(np.log(shares[1])).max(), np.log(1.2))

    def test_what_the_clouds_do_not_determine_is_told(self):
        options = ["--export=ros", "--export-without-prior"]
        result = run(*scans("bowl"), *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("the clouds do not determine 1 of 6 directions", result.stderr)

    def test_one_format_is_printed_in_place_of_the_table(self):
        for name, file in (("g2o", "pose.g2o"), ("tum", "pose_tum.txt")):
            result = run(*GOOD, f"--export={name}", *OPTIONS)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertEqual(result.stdout, self.text(file))


class ExportRefusals(ToolTest):
    def test_posterior_that_has_not_mixed(self):
        pair = self.small_pair()
        result = run(*pair, *FAST, "--export=g2o")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("--export g2o: the status is not_mixed, neither ok nor doubtful", result.stderr)
        result = run(*pair, *FAST, "--export=g2o,ros", "-o", self.output, "--quiet")
        self.assertEqual(result.returncode, 1)
        self.assertIn("--export g2o: not written: ", result.stderr)
        self.assertIn("--export ros: not written: ", result.stderr)
        self.assertEqual(self.names_of_output(), WRITTEN)
        result = run(*pair, *FAST, "--export=g2o", "--export-unreliable")
        self.assertEqual(result.returncode, 1)
        self.assertTrue(result.stdout.startswith("EDGE_SE3:QUAT 0 1 "), result.stdout)

    def test_covariance_of_too_few_draws(self):
        few = ["--samples=4", "--preset=paper", "--chains=1", "--step-size=1e-6"]
        few += ["--export-unreliable"]
        words = ["--export=g2o,gtsam,ros", "-o", self.output, "--quiet"]
        result = run(*self.small_pair(), *few, *words)
        self.assertEqual(result.returncode, 1)
        self.assertIn("--export g2o: not written: the covariance is singular", result.stderr)
        self.assertIn("--export gtsam: not written: the covariance is singular", result.stderr)
        self.assertEqual(self.names_of_output(), sorted([*WRITTEN, "pose_ros.yaml"]))
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
            (["--export-without-prior"], "--export-without-prior: has no effect without --export"),
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
        self.assert_each_refused(2, [TOOL, *pair, *FAST], bad)

    def test_no_export_of_an_older_result_stays(self):
        for formats, files in (("ros,g2o", ["pose_ros.yaml", "pose.g2o"]), ("csv", ["pose.csv"])):
            options = [f"--export={formats}", "--export-unreliable"]
            self.run_to_files(*self.small_pair(), *FAST, *options)
            self.assertEqual(self.names_of_output(), sorted([*WITHOUT_REPORT, *files]))
        self.run_to_files(*self.small_pair(), *FAST)
        self.assertEqual(self.names_of_output(), WITHOUT_REPORT)

    def test_files_appear_together_or_not_at_all(self):
        obstacle = self.output / "pose.g2o"
        obstacle.mkdir(parents=True)
        words = [*FAST, "--export=ros,g2o", "--export-unreliable", "-o", self.output]
        result = run(*self.small_pair(), *words)
        self.assert_refused(3, result, obstacle, "is not a regular file")
        self.assertEqual(self.names_of_output(), ["pose.g2o"])
