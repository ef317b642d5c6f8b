"""pcl_bayesian_icp_pose_graph against trajectories that are known."""

import math
import os
import unittest

import cloud_files
from cli_tool import DATA
from robot_formats import read_g2o_edge
from trajectories import (
    CHI2_HIGH,
    CHI2_LOW,
    IDENTITY,
    TrajectoryTest,
    call,
    chained,
    composed,
    g2o_error,
    inverse,
    inverted,
    quadratic,
    read_graph,
    small_pose,
)

POSE_GRAPH = os.environ["PCL_BAYESIAN_ICP_POSE_GRAPH"]

def chain_covariance(edges):
    """Of the last pose of the chain, from those of its edges, to first order."""
    poses = [pose for pose, _ in edges]
    end = chained(poses)
    total = [[0.0] * 6 for _ in range(6)]
    for k, (_, information) in enumerate(edges):
        jacobian = []
        for axis in range(6):
            ends = []
            for step in (1e-6, -1e-6):
                error = [step * (i == axis) for i in range(6)]
                moved = [*poses[: k + 1], small_pose(error), *poses[k + 1 :]]
                ends.append(g2o_error(end, chained(moved)))
            jacobian.append([(a - b) / 2e-6 for a, b in zip(*ends)])
        covariance = inverse(information)
        for i in range(6):
            for j in range(6):
                total[i][j] += sum(
                    jacobian[a][i] * covariance[a][b] * jacobian[b][j]
                    for a in range(6)
                    for b in range(6)
                )
    return total


class PoseGraphTest(TrajectoryTest):
    program = "pcl_bayesian_icp_pose_graph"

    def setUp(self):
        super().setUp()
        self.graph = self.folder / "graph.g2o"


class PoseGraphOfSimulatedScans(PoseGraphTest):
    def test_truth_is_within_the_covariance(self):
        eyes = ["0,-1.2,0.7", "0.06,-1.19,0.72", "0.12,-1.17,0.71", "0.18,-1.14,0.7"]
        scans, from_world = self.trajectory(eyes)
        result = call(POSE_GRAPH, scans, "-o", self.graph, "--loop", "0,3", "--loop", "3,1")
        self.assertIn(result.returncode, (0, 1), result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 5)
        vertices, edges = read_graph(self.graph)
        self.assertEqual(sorted(vertices), [0, 1, 2, 3])
        self.assertEqual(sorted(edges), [(0, 1), (0, 3), (1, 2), (2, 3), (3, 1)])

        truth = {(i, j): composed(from_world[i], inverted(from_world[j])) for i, j in edges}
        nees = {
            key: quadratic(g2o_error(pose, truth[key]), information)
            for key, (pose, information) in edges.items()
        }
        for key, value in nees.items():
            self.assertLess(value, CHI2_HIGH[6], key)
        chain_nees = sum(nees[k, k + 1] for k in range(3))
        self.assertLess(chain_nees, CHI2_HIGH[18])
        self.assertGreater(chain_nees, CHI2_LOW[18])

        chain = [edges[k, k + 1] for k in range(3)]
        for k in range(4):
            expected = chained(pose for pose, _ in chain[:k])
            self.assertLess(max(map(abs, g2o_error(vertices[k], expected))), 1e-12)
        error = g2o_error(vertices[3], truth[0, 3])
        end_nees = quadratic(error, inverse(chain_covariance(chain)))
        self.assertLess(end_nees, CHI2_HIGH[6])
        # The scans moved: a graph of identities would not have passed.
        identity_nees = quadratic(g2o_error(IDENTITY, truth[0, 1]), chain[0][1])
        self.assertGreater(identity_nees, 100 * CHI2_HIGH[6])

    def test_files_in_their_order(self):
        scans, _ = self.trajectory(["0,-1.2,0.7", "0.06,-1.19,0.72"])
        files = [scans / "scan_1.pcd", scans / "scan_0.pcd"]
        self.assertIn(call(POSE_GRAPH, scans, "-o", self.graph).returncode, (0, 1))
        forward, _ = read_graph(self.graph)[1][0, 1]
        self.assertIn(call(POSE_GRAPH, *files, "-o", self.graph).returncode, (0, 1))
        backward, information = read_graph(self.graph)[1][0, 1]
        error = g2o_error(backward, inverted(forward))
        # Twice the variance, for two estimates of one motion.
        self.assertLess(quadratic(error, information) / 2, CHI2_HIGH[6])


class PoseGraphEdges(PoseGraphTest):
    def test_no_silent_edge(self):
        source, target = self.small_pair()
        far = [(x + 50, y, z) for x, y, z in cloud_files.box_surface(seed=3)]
        far = self.file("far.pcd", cloud_files.pcd_bytes(far))
        gone = self.folder / "gone.pcd"
        scans = [target, source, far, gone]
        guess = "0.1,0,0,0,0,0.2"
        options = ["--guess", guess, "--prior-variance", "0.04", "--quiet"]
        options += ["--prior-frame", "origin"]  # where it has no correlations
        result = call(POSE_GRAPH, *scans, "-o", self.graph, *options, "--weak-edges")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertRegex(result.stderr, r"edge 1-2: the prior only, [a-z_]+: ")
        self.assertRegex(result.stderr, r"edge 2-3: MISSING, error: .*gone.pcd: no such file")
        vertices, edges = read_graph(self.graph)
        self.assertEqual(sorted(vertices), [0, 1, 2, 3])
        self.assertIn((1, 2), edges)
        self.assertNotIn((2, 3), edges)
        pose, information = edges[1, 2]
        half = math.sin(0.1)
        expected = ([0.1, 0.0, 0.0], (0.0, 0.0, half, math.cos(0.1)))
        self.assertLess(max(map(abs, g2o_error(pose, expected))), 1e-12)
        # 1 / variance, and 4 / variance of half angles; float round-off of differences.
        for i in range(6):
            for k in range(6):
                diagonal = (25.0 if i < 3 else 100.0) * (i == k)
                self.assertAlmostEqual(information[i][k], diagonal, delta=1e-4)

        result = call(POSE_GRAPH, *scans, "-o", self.graph, *options)
        self.assertRegex(result.stderr, r"edge 1-2: MISSING, [a-z_]+: ")
        vertices, edges = read_graph(self.graph)
        self.assertEqual(sorted(vertices), [0, 1, 2, 3])
        self.assertNotIn((1, 2), edges)

    def test_loops_do_not_count_the_prior(self):
        """In its plane a bare table top is held by the prior alone."""
        scans = [DATA / "table_top" / "target.pcd", DATA / "table_top" / "source.pcd"]
        variance = 0.01
        options = ["--loop", "0,1", "--prior-variance", variance]
        result = call(POSE_GRAPH, *scans, "-o", self.graph, *options)
        self.assertIn(result.returncode, (0, 1), result.stderr)
        lines = [line for line in self.graph.read_text().splitlines() if "EDGE" in line]
        chain, loop = (inverse(read_g2o_edge(line)[4]) for line in lines)
        for axis in (0, 1):
            # To 20 %: axes are tilted, and a variance of 2000 draws is known to 3 %.
            self.assertAlmostEqual(chain[axis][axis], variance, delta=0.2 * variance)
            self.assertGreater(loop[axis][axis], 1000 * variance)
        self.assertLess(loop[2][2], 1e6 * chain[2][2])

    def test_refused(self):
        source, target = self.small_pair()
        for code, words, part in (
            (2, [], "at least two scans"),
            (2, [source, "-o", "g"], "at least two scans"),
            (2, [source, target], "--output"),
            (2, [source, target, "-o", "g", "--loop", "0,2"], "--loop: '0,2'"),
            (2, [source, target, "-o", "g", "--loop", "1,1"], "--loop: '1,1'"),
            (2, [source, target, "-o", "g", "--sigma", "1"], "--sigma"),
            (3, [self.folder / "scans", "-o", "g"], "fewer than two"),
            (3, [source, target, "-o", "/proc/none/g"], "/proc/none"),
        ):
            with self.subTest(words=words):
                (self.folder / "scans").mkdir(exist_ok=True)
                self.assert_refused(code, call(POSE_GRAPH, *words), part)


if __name__ == "__main__":
    unittest.main()
