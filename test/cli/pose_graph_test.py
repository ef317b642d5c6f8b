"""pcl_bayesian_icp_pose_graph against trajectories that are known."""

import math
import re
import os

import numpy as np
from numpy.linalg import inv
from scipy.spatial.transform import Rotation

import cloud_files
from cli_tool import call, scans
from faults import POSE_GRAPH
from trajectories import CHI2_HIGH, CHI2_LOW, FOUR_EYES, TrajectoryTest
from trajectories import chained, g2o_error, pose_of, quadratic, read_graph, rows_of_file


class PoseGraphTest(TrajectoryTest):
    program = "pcl_bayesian_icp_pose_graph"

    def setUp(self):
        super().setUp()
        self.graph = self.folder / "graph.g2o"

    def run_graph(self, *words):
        return call(POSE_GRAPH, *words, "-o", self.graph)


class PoseGraphOfSimulatedScans(PoseGraphTest):
    def test_truth_is_within_the_covariance(self):
        scans, from_world = self.trajectory(FOUR_EYES)
        result = self.run_graph(scans, "--span", 2, "--loop", "0,3", "--loop", "3,1")
        self.assert_ran(result)
        self.assertEqual(len(result.stderr.splitlines()), 6)
        vertices, edges = read_graph(self.graph)
        self.assertEqual(sorted(vertices), [0, 1, 2, 3])
        # The edge between scans 1 and 3 is there once, as it is named.
        self.assertEqual(sorted(edges), [(0, 1), (0, 2), (0, 3), (1, 2), (2, 3), (3, 1)])

        truth = {(i, j): from_world[i] @ inv(from_world[j]) for i, j in edges}
        nees = {
            key: quadratic(g2o_error(pose, truth[key]), information)
            for key, (pose, information) in edges.items()
        }
        for key, value in nees.items():
            self.assertLess(value, CHI2_HIGH[6], key)
        chain_nees = sum(nees[k, k + 1] for k in range(3))
        self.assertLess(chain_nees, CHI2_HIGH[18])
        self.assertGreater(chain_nees, CHI2_LOW[18])

        for k in range(4):
            self.assert_same_pose(vertices[k], chained(edges[i, i + 1][0] for i in range(k)))
        # The scans moved: a graph of identities would not have passed.
        identity_nees = quadratic(g2o_error(np.eye(4), truth[0, 1]), edges[0, 1][1])
        self.assertGreater(identity_nees, 100 * CHI2_HIGH[6])

    def test_files_in_their_order(self):
        scans, _ = self.trajectory(FOUR_EYES[:2])
        files = [scans / "scan_1.pcd", scans / "scan_0.pcd"]
        self.assertEqual(self.run_graph(scans).returncode, 0)
        forward, _ = read_graph(self.graph)[1][0, 1]
        self.assertEqual(self.run_graph(*files).returncode, 0)
        backward, information = read_graph(self.graph)[1][0, 1]
        error = g2o_error(backward, inv(forward))
        # Twice the variance, for two estimates of one motion.
        self.assertLess(quadratic(error, information) / 2, CHI2_HIGH[6])


class PoseGraphOfAScannerInAPlane(PoseGraphTest):
    def test_stays_in_the_plane_and_its_edges_are_as_sure_as_the_chain(self):
        num_scans = 6
        scans, from_world = self.trajectory_in_a_plane(num_scans)
        result = self.run_graph(scans, "--span", 3, "--loop", "0,5", "--optimize", self.output)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("scan 0 lies in a plane", result.stderr)
        # z, roll and pitch go without saying.
        self.assertNotIn("unmeasured", result.stderr)
        in_plane = np.ix_([0, 1, 5], [0, 1, 5])
        _, edges = read_graph(self.graph)
        self.assertEqual(len(edges), 5 + 4 + 3 + 1)
        deviations = {}
        for (i, j), (pose, information) in edges.items():
            error = g2o_error(pose, from_world[i] @ inv(from_world[j]))[[0, 1, 5]]
            covariance = inv(information)[in_plane]
            self.assertLess(quadratic(error, inv(covariance)), CHI2_HIGH[3], (i, j))
            deviations[i, j] = np.sqrt(np.diag(covariance))
        chain = np.median([deviations[k, k + 1] for k in range(num_scans - 1)], axis=0)
        for key, deviation in deviations.items():
            self.assertTrue((deviation < 3 * chain).all(), (key, deviation, chain))
        for row in rows_of_file(self.output / "trajectory_covariance.txt"):
            covariance = np.reshape(row[1:], (6, 6))
            self.assertLess(np.sqrt(np.diag(covariance)[2:5]).max(), 0.01)


class PoseGraphLoops(PoseGraphTest):
    """A camera that goes once around a table."""

    NUM_STEPS = 12

    def setUp(self):
        super().setUp()
        angles = [2 * math.pi * k / self.NUM_STEPS for k in range(self.NUM_STEPS + 1)]
        eyes = [f"{1.2 * math.cos(a)},{1.2 * math.sin(a)},0.7" for a in angles]
        scans, from_world = self.trajectory(eyes)
        self.scans = [scans / f"scan_{k}.pcd" for k in range(self.NUM_STEPS + 1)]
        self.truth = [from_world[0] @ inv(pose) for pose in from_world]

    def odometry(self, turn, variance):
        """Options that state the motion, the same from each scan to the next, but for a
        factor of its rotation."""
        pose = self.truth[1]
        angles = Rotation.from_matrix(pose[:3, :3]).as_euler("xyz")
        numbers = [*pose[:3, 3], *(turn * angles)]
        return ["--guess", ",".join(f"{n:.4f}" for n in numbers), "--prior-variance", variance]

    def drift(self, vertices):
        """Root mean square of the errors of the positions."""
        errors = [g2o_error(vertices[k], self.truth[k])[:3] for k in vertices]
        return np.linalg.norm(errors) / math.sqrt(len(errors))

    def check_trajectory(self, vertices):
        poses = rows_of_file(self.output / "trajectory_tum.txt")
        covariances = rows_of_file(self.output / "trajectory_covariance.txt")
        self.assertEqual([row[0] for row in poses], list(range(self.NUM_STEPS + 1)))
        variances = [row[1] + row[8] + row[15] for row in covariances]
        for k, (row, variance) in enumerate(zip(poses, variances)):
            self.assert_same_pose(vertices[k], pose_of(row[1:4], row[4:]))
            error = math.dist(row[1:4], self.truth[k][:3, 3])
            self.assertLessEqual(error, 4 * math.sqrt(variance) + 1e-12, k)
        # The end is as near to the beginning as the scans after that.
        self.assertEqual(variances[0], 0.0)
        self.assertLess(variances[-1], variances[self.NUM_STEPS // 2])

    def test_they_take_drift_away_if_they_close(self):
        loops = ["--loops", 0.4]
        words = [*self.scans, *self.odometry(1.02, 0.0025), *loops]
        result = self.run_graph(*words, "--optimize", self.output)
        self.assert_ran(result)
        self.assertIn("1 candidates for loops, within 0.4 m of", result.stderr)
        self.assertRegex(result.stderr, r"loop 0-12: ok .*, closes with probability 0\.")
        vertices, edges = read_graph(self.graph)
        self.assertIn((0, 12), edges)
        self.assertEqual((self.output / "graph.g2o").read_text(), self.graph.read_text())
        chain = [chained(edges[i, i + 1][0] for i in range(k)) for k in vertices]
        self.assertLess(self.drift(vertices), 0.7 * self.drift(dict(enumerate(chain))))
        self.check_trajectory(vertices)
        report = (self.output / "report.html").read_text()
        for part in ("Where was the sensor?", "Do the edges agree?", ">0-12<", "optimized poses"):
            self.assertTrue(part in report, part)
        self.assertTrue(report.endswith("</html>\n"))

        # An odometry that is sure and wrong: the chain does not end where it began.
        words = [*self.scans, *self.odometry(1.04, 1e-6)]
        result = self.run_graph(*words, *loops)
        self.assertNotIn((0, 12), read_graph(self.graph)[1])
        self.assertRegex(
            result.stderr,
            r"loop 0-12: refused, contradicts the chain, [\d.]+ m and [\d.]+ degrees away: squared "
            r"error \d+\.\d for 6 degrees of freedom, probability ",
        )
        # At most a turn of 0.04 circles, and less as far as the registrations correct it.
        away = float(re.search(r"([\d.]+) degrees away", result.stderr)[1])
        self.assertTrue(5.0 < away < 14.5, away)
        words += ["--quiet", "--loop", "0,12", "--robust-loss", "cauchy", "--optimize", self.output]
        result = call(POSE_GRAPH, *words)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("edge 0-12: contradicts the chain", result.stderr)
        self.assertRegex(result.stderr, r"edge \d+-\d+ contradicts the others: squared error \d")
        self.assertIn((0, 12), read_graph(self.output / "graph.g2o")[1])
        report = (self.output / "report.html").read_text()
        self.assertTrue("Edges contradict each other" in report)

    def test_spans_begin_where_the_chain_leads(self):
        """Two steps are a turn of 60 degrees: no other guess leads there."""
        result = self.run_graph(*self.scans[:4], *self.odometry(1.0, 0.0025), "--span", 2)
        self.assert_ran(result)
        _, edges = read_graph(self.graph)
        self.assertEqual(sorted(edges), [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)])
        for (i, j), (pose, information) in edges.items():
            error = g2o_error(pose, inv(self.truth[i]) @ self.truth[j])
            self.assertLess(quadratic(error, information), CHI2_HIGH[6], (i, j))


class PoseGraphEdges(PoseGraphTest):
    def test_no_silent_edge(self):
        source, target = self.small_pair()
        far = self.pcd("far.pcd", cloud_files.far_box())
        scans = [target, source, far, self.folder / "gone.pcd"]
        options = ["--guess", "0.1,0,0,0,0,0.2", "--prior-variance", "0.04", "--quiet"]
        options += ["--prior-frame", "origin"]  # where it has no correlations
        result = self.run_graph(*scans, *options, "--weak-edges")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertRegex(result.stderr, r"edge 1-2: the prior only, [a-z_]+: ")
        self.assertRegex(result.stderr, r"edge 2-3: MISSING, error: .*gone.pcd: no such file")
        vertices, edges = read_graph(self.graph)
        self.assertEqual(sorted(vertices), [0, 1, 2, 3])
        self.assertIn((1, 2), edges)
        self.assertNotIn((2, 3), edges)
        pose, information = edges[1, 2]
        half = math.sin(0.1)
        self.assert_same_pose(pose, pose_of([0.1, 0.0, 0.0], [0.0, 0.0, half, math.cos(0.1)]))
        self.assert_same_pose(vertices[3], vertices[2] @ pose)  # by the guess
        # 1 / variance, and 4 / variance of half angles; float round-off of differences.
        self.assert_close(information, np.diag([25.0] * 3 + [100.0] * 3), delta=1e-4)

        result = self.run_graph(*scans, *options)
        self.assertRegex(result.stderr, r"edge 1-2: MISSING, [a-z_]+: ")
        few = ["--samples", "40", "--chains", "2", "--optimize", self.folder / "few"]
        result = call(POSE_GRAPH, target, source, *few)
        reason = "(the chains did not mix: largest R-hat|40 draws are too few to tell)"
        expected = rf"edge 0-1: MISSING, not_mixed: {reason}.*; not used: the status is not_mixed"
        self.assertRegex(result.stderr, expected)
        vertices, edges = read_graph(self.graph)
        self.assertEqual(sorted(vertices), [0, 1, 2, 3])
        self.assertNotIn((1, 2), edges)

        # The graph is in two parts. Files of an earlier run do not stay beside it.
        self.output.mkdir()
        (self.output / "trajectory_tum.txt").write_text("old")
        result = call(POSE_GRAPH, *scans, "--optimize", self.output, *options)
        self.assertEqual(result.returncode, 1)
        self.assertIn("cannot be optimized: no edges join scan 2 to scan 0", result.stderr)
        self.assertEqual(self.names_of_output(), ["graph.g2o"])
        self.assertEqual((self.output / "graph.g2o").read_text(), self.graph.read_text())

    def test_edges_that_contradict_each_other_end_with_one(self):
        """Each two of three scans have another part in common, the last of which has moved."""
        generator = np.random.default_rng(1)

        def part(sides, place):
            points = generator.uniform(size=(600, 3)) * sides
            points[np.arange(600), np.arange(600) % 3] = 0
            return points + place + 0.001 * generator.normal(size=(600, 3))

        a, b = ((0.3, 0.2, 0.1), (0, 0, 0)), ((0.2, 0.3, 0.25), (1, 0, 0))
        for shift, exit_code in ((0, 0), (0.05, 1)):
            c, moved_c = (((0.15, 0.1, 0.3), (x, 1, 0)) for x in (0, shift))
            scans = [
                self.pcd(f"{k}.pcd", np.vstack([part(*each) for each in parts]).tolist())
                for k, parts in enumerate([(a, c), (a, b), (b, moved_c)])
            ]
            words = ["--prior-variance", 0.0025, "--span", 2, "--optimize", self.output]
            result = self.run_graph(*scans, *words)
            self.assertEqual(result.returncode, exit_code, result.stderr)
            self.assertEqual(result.stderr.count(": ok ("), 3, result.stderr)
            self.assertEqual("edge 0-1 contradicts the others" in result.stderr, exit_code == 1)

    def test_loops_do_not_count_the_prior(self):
        """In its plane a bare table top is held by the prior alone."""
        source, target = scans("table_top")
        variance = 0.01
        options = ["--loop", "0,2", "--prior-variance", variance]
        result = self.run_graph(target, source, source, *options)
        self.assert_ran(result)
        self.assertRegex(result.stderr, r"edge 0-1: ok .*held by the prior alone: rotation about")
        self.assertIn("2 of 2 registrations leave a motion unmeasured: along it", result.stderr)
        chain, _, loop = (inv(information) for _, information in read_graph(self.graph)[1].values())
        for axis in (0, 1):
            # To 20 %: axes are tilted, and a variance of 2000 draws is known to 3 %.
            self.assertAlmostEqual(chain[axis][axis], variance, delta=0.2 * variance)
            self.assertGreater(loop[axis][axis], 1000 * variance)
        self.assertLess(loop[2][2], 1e6 * chain[2][2])

    def test_help_names_the_files(self):
        text = call(POSE_GRAPH, "--help").stdout
        for part in ("--span", "--loops", "--optimize", "--robust-loss", "trajectory_tum.txt"):
            self.assertIn(part, text)

    def test_refused(self):
        source, target = self.small_pair()
        pair, g = [source, target], ["-o", "g"]
        pipe, new = self.folder / "pipe.g2o", self.folder / "new.g2o"
        os.mkfifo(pipe)
        (self.folder / "scans").mkdir()
        bad_words = [
            ([], "at least two scans"),
            ([source, *g], "at least two scans"),
            (pair, "--output"),
            ([*pair, "-o", source], "is one of the scans"),
            ([*pair, *g, "--loop", "0,2"], "--loop: '0,2'"),
            ([*pair, *g, "--loop", "1,1"], "--loop: '1,1'"),
            ([*pair, *g, "--loop", "0,1"], "--loop: '0,1' are neighbours"),
            ([*pair, *g, "--loop", "1,0"], "--loop: '1,0' are neighbours"),
            ([*pair, *g, "--sigma", "1"], "--sigma"),
            ([*pair, *g, "--span", "0"], "--span is 0, but must be from 1"),
            ([*pair, *g, "--loops", "0"], "--loops is 0, but must be above"),
            ([*pair, *g, "--loops", "nan"], "--loops"),
            ([*pair, *g, "--robust-loss", "huber"], "needs --optimize"),
            ([*pair, "--optimize", "g", "--robust-loss", "tukey"], "'tukey' is not"),
        ]
        bad_files = [
            ([*pair, "--optimize", "/proc/none/g"], "/proc/none"),
            ([self.folder / "scans", *g], "fewer than two"),
            ([self.folder / "none", *g], "none: no such folder"),
            ([*pair, "-o", "/proc/none/g"], "/proc/none"),
            ([*pair, "-o", pipe], "pipe.g2o: is not a regular file"),
            ([*pair, "-o", new, "--optimize", new], "new.g2o: is not a regular file"),
        ]
        self.assert_each_refused(2, [POSE_GRAPH], bad_words)
        self.assert_each_refused(3, [POSE_GRAPH], bad_files)
        self.assertTrue(pipe.is_fifo())
        self.assertFalse(new.exists())
