"""The examples of a Kalman filter: kalman_fusion and kalman_sequence."""

import json
import math
import re
import shutil

import numpy as np
from numpy.linalg import inv

import cloud_files
from cli_tool import DATA, PROGRAMS, ToolTest, call, scans
from trajectories import CHI2_HIGH, CHI2_LOW, FOUR_EYES, TrajectoryTest, g2o_error, pose_of

KALMAN_FUSION = f"{PROGRAMS}/kalman_fusion"
KALMAN_SEQUENCE = f"{PROGRAMS}/kalman_sequence"
SCAN_LINE = re.compile(
    r"scan \d+: (.*); error of odometry (\S+) m (\S+) rad, "
    r"fused (\S+) m (\S+) rad, stated (\S+) m (\S+) rad"
)


class KalmanFusion(ToolTest):
    def test_each_direction_from_who_knows_it(self):
        """A can turns about its axis unseen: the odometry says how far."""
        true = np.loadtxt(DATA / "can" / "T_target_source.txt")
        # Errors of the odometry of about its standard deviation, 0.02. Of four or five odometries,
        # one makes noise of the clouds seem to say a little of the turn; this is one of the
        # others.
        error = np.array([0.015, 0.02, -0.01, 0.01, 0.008, -0.019])
        w = math.sqrt(1.0 - error[3:] @ error[3:])
        odometry = true @ inv(pose_of(error[:3], [*error[3:], w]))
        matrix = self.folder / "odometry.txt"
        np.savetxt(matrix, odometry)
        result = call(KALMAN_FUSION, *scans("can"), matrix)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("directions that they do not see: 1", result.stdout)
        fused = result.stdout[result.stdout.index("fused") :]
        numbers = [list(map(float, line.split(":")[1].split())) for line in fused.splitlines()[1:3]]
        deviations = numbers[1]
        # Half of the information about the axis would be 0.014: the odometry twice.
        self.assertAlmostEqual(deviations[5], 0.02, delta=0.001)
        self.assertLess(max(deviations[:5]), 0.005)
        error = g2o_error(cloud_files.matrix_of(*numbers[0]), true) * [1, 1, 1, 2, 2, 2]
        self.assertLess(max(abs(error) / deviations), 4)


class KalmanSequence(TrajectoryTest):
    program = "kalman_sequence"

    def sequence(self):
        """Four scans along 0.18 m, with their exact poses."""
        scans, from_world = self.trajectory(FOUR_EYES)
        for k in range(len(from_world)):
            (scans / f"scan_{k}.pcd").rename(scans / f"scan_{k:04d}.pcd")
        np.savetxt(scans / "poses.txt", [inv(pose)[:3].ravel() for pose in from_world])
        self.state_accuracy(scans, 0.0)
        return scans

    def state_accuracy(self, folder, deviation):
        names = ("accuracy_translation_m", "accuracy_rotation_rad")
        (folder / "set.json").write_text(json.dumps(dict.fromkeys(names, deviation)))

    def run_sequence(self, *arguments):
        """[(verdict, odometry's errors, fused errors, stated deviations)], the rest."""
        result = call(KALMAN_SEQUENCE, *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        scans = []
        for words in SCAN_LINE.findall(result.stdout):
            numbers = list(map(float, words[1:]))
            scans.append((words[0], numbers[:2], numbers[2:4], numbers[4:]))
        return scans, result.stdout[result.stdout.index("NIS of the") :]

    def test_better_than_odometry_and_as_sure_as_stated(self):
        folder = self.sequence()
        # The coarse odometry tests the odometry, the fine one the registrations, too.
        for deviation in (0.02, 0.001):
            with self.subTest(deviation=deviation):
                scans, end = self.run_sequence(folder, deviation, deviation)
                self.assertEqual(len(scans), 3)
                matches = [re.match(r"NIS (\S+) of 6, accepted$", scan[0]) for scan in scans]
                total = sum(float(match[1]) for match in matches)
                self.assertLess(total, CHI2_HIGH[18])
                self.assertGreater(total, CHI2_LOW[18])
                self.assertIn("gated: 0,", end)
                self.assert_words(end, total)
                _, odometry, fused, stated = scans[-1]
                for k in range(2):
                    self.assertLess(fused[k], odometry[k])
                    # At worst all variance is in one direction.
                    self.assertLess(fused[k] ** 2, CHI2_HIGH[1] * stated[k] ** 2)

        # An odometry that states far more than its noise.
        self.state_accuracy(folder, 0.02)
        scans, end = self.run_sequence(folder, 0.001, 0.001)
        self.assertLess(float(scans[0][0].split()[1]), float(matches[0][1]) / 10)
        self.assertIn("below its 95 % bounds", end)

    def assert_words(self, end, total):
        """95 % bounds of chi-square with 18 degrees of freedom (R 4.2, qchisq)."""
        low, high = 8.231 / 18, 31.526 / 18
        pattern = r"per degree of freedom: (\S+), (\w+) its 95 % bounds (\S+) to (\S+)"
        for mean, word, *bounds in re.findall(pattern, end):
            self.assertAlmostEqual(float(mean), total / 18, delta=0.01)
            self.assertAlmostEqual(float(bounds[0]), low, delta=0.001)
            self.assertAlmostEqual(float(bounds[1]), high, delta=0.001)
            side = "below" if float(mean) < low else "above" if float(mean) > high else "within"
            self.assertEqual(word, side)

    def test_wrong_scans_are_not_used(self):
        folder = self.sequence()
        # The driver delivers an old scan: 0.18 m from where it should be, nine deviations.
        shutil.copy(folder / "scan_0000.pcd", folder / "scan_0003.pcd")
        # Points that have nothing to do with the others.
        self.pcd(folder / "scan_0001.pcd", cloud_files.far_box())
        scans, end = self.run_sequence(folder)
        self.assertTrue(scans[0][0].startswith("refused ("), scans[0])
        self.assertTrue(scans[1][0].startswith("refused ("), scans[1])
        self.assertTrue(scans[2][0].endswith(", gated"), scans[2])
        for _, odometry, fused, _ in scans:
            self.assertEqual(fused, odometry)
        self.assertIn("above its 95 % bounds", end)
        self.assertIn("0 accepted registrations: nothing to test", end)
        self.assertIn("gated: 1,", end)

    def test_refused(self):
        cases = [
            ([], "usage: kalman_sequence FOLDER"),
            ([self.folder, "0.02"], "usage"),
            ([self.folder, "0.02", "-1"], "'-1' is not a positive number"),
            ([self.folder, "0.02", "2cm"], "'2cm' is not a positive number"),
            ([self.folder, "0.02", "0.02", "x"], "'x' is not a positive number"),
            ([self.folder, "0.02", "0.02", "-5"], "'-5' is not a positive number"),
            ([self.folder / "none"], "none/poses.txt: fewer than two poses"),
        ]
        self.assert_each_refused(2, [KALMAN_SEQUENCE], cases)
        pose = "1 0 0 0 0 1 0 0 0 0 1 0\n"
        for poses, part in (
            (pose, "fewer than two poses"),
            (pose + "1 0 0 0\n", "not a 3x4 pose: '1 0 0 0'"),
            (pose + "2" + pose[1:], "not a 3x4 pose"),
            (pose + pose[:-1] + " 1\n", "not a 3x4 pose"),
            (2 * pose, "set.json: cannot be read"),
        ):
            with self.subTest(poses=poses):
                self.file("poses.txt", poses)
                self.assert_refused(2, call(KALMAN_SEQUENCE, self.folder), part)
        for text in ("{", "{}", '{"accuracy_translation_m": "1"}'):
            with self.subTest(text=text):
                self.file("set.json", text)
                self.assert_refused(2, call(KALMAN_SEQUENCE, self.folder), "set.json: ")
        self.state_accuracy(self.folder, 0.0)
        result = call(KALMAN_SEQUENCE, self.folder)
        self.assertEqual(result.returncode, 2)
        last = result.stderr.splitlines()[-1]  # PCL speaks first
        self.assertRegex(last, "^kalman_sequence: .*scan_0000.pcd: cannot be read$")
