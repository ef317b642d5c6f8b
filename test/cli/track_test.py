"""pcl_bayesian_icp_track: a camera that moves about a table."""

import os
import random
import re

import numpy as np
from numpy.linalg import inv

import cloud_files
from cli_tool import call, strict_json
from faults import EVALUATE, POSE_GRAPH, TRACK, TRACKED
from trajectories import CHI2_HIGH, STUDENT_HIGH, TrajectoryTest
from trajectories import g2o_error, pose_of, quadratic, read_graph, rows_of_file

UNITS_OF_ERRORS = [f"error_{c}" for c in ("vx_m", "vy_m", "vz_m", "wx_rad", "wy_rad", "wz_rad")]
EYES = ["0,-1.2,0.7", "0.05,-1.19,0.71", "0.1,-1.18,0.71", "0.15,-1.16,0.7", "0.2,-1.14,0.7"]


def gaussian_of(values):
    """Pose and covariance (right_se3)."""
    return np.array(values["mean"]["T_target_source"]), np.array(values["covariance"]["matrix"])


def carried(covariance, pose):
    """The covariance (right_se3) of errors that are on the other side of the pose."""
    rotation, shift = pose[:3, :3], np.cross(np.eye(3), pose[:3, 3])
    adjoint = np.block([[rotation, shift @ rotation], [np.zeros((3, 3)), rotation]])
    return adjoint @ covariance @ adjoint.T


class TrackTest(TrajectoryTest):
    program = "pcl_bayesian_icp_track"

    def setUp(self):
        super().setUp()
        self.track = self.folder / "track"

    def run_track(self, *words):
        return call(TRACK, *words, "-o", self.track)

    def tracked(self, *words):
        """run_track() of scans that can be registered, whatever is to be thought of it."""
        result = self.run_track(*words)
        self.assert_ran(result)
        return result

    def read_graph(self):
        return read_graph(self.track / "graph.g2o")

    def targets(self):
        return [line["edge"]["target"] for line in self.lines()]

    def lines(self):
        return [strict_json(line) for line in (self.track / "edges.jsonl").read_text().splitlines()]

    def times(self):
        return [row[0] for row in rows_of_file(self.track / "trajectory_tum.txt")]


class TrackOfSimulatedScans(TrackTest):
    def check_truth(self, from_world):
        truth = [from_world[0] @ inv(pose) for pose in from_world]
        vertices, edges = self.read_graph()
        self.assertEqual(sorted(vertices), [0, 1, 2, 3, 4])
        for (i, j), (pose, information) in edges.items():
            true = from_world[i] @ inv(from_world[j])
            self.assertLess(quadratic(g2o_error(pose, true), information), STUDENT_HIGH, (i, j))
        for k, line in enumerate(self.lines(), 1):
            self.assertEqual(line["scan"], k)
            # Rotations of right_se3 are whole angles, those of g2o half ones.
            scale = np.diag([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
            half = scale @ line["pose_in_scan_0"]["covariance"]["matrix"] @ scale
            error = g2o_error(vertices[k], truth[k])
            self.assertLess(quadratic(error, inv(half)), CHI2_HIGH[6], k)
            self.assertLess(max(map(abs, error)), 0.01)
        return vertices

    def test_scan_to_scan(self):
        scans, from_world = self.trajectory(EYES)
        result = self.tracked(scans, "--period", 0.2)
        self.assertEqual({path.name for path in self.track.iterdir()}, TRACKED)
        vertices = self.check_truth(from_world)
        self.assertEqual(self.targets(), [0, 1, 2, 3])
        rows = rows_of_file(self.track / "trajectory_tum.txt")
        self.assertEqual(self.times(), [0.0, 0.2, 0.4, 0.6, 0.8])
        for k, row in enumerate(rows):
            self.assert_same_pose(vertices[k], pose_of(row[1:4], row[4:]))
        covariances = rows_of_file(self.track / "trajectory_covariance.txt")
        self.assertEqual({len(row) for row in covariances}, {37})
        traces = [sum(row[1 + 7 * i] for i in range(3)) for row in covariances]
        self.assertEqual(traces, sorted(traces))
        self.assertEqual(traces[0], 0.0)
        report = (self.track / "report.html").read_text()
        self.assertIn("Where was the sensor?", report)
        self.assertTrue(report.endswith("</html>\n"))
        self.assertIn(f"In the folder {os.getcwd()}:", report)
        self.assertNotIn("unmeasured", report + result.stderr)

    def test_map(self):
        scans, from_world = self.trajectory(EYES)
        self.tracked(scans, "--map", 0.005, "--map-scans", 2)
        self.check_truth(from_world)
        self.assertEqual(self.targets(), [0, 0, 2, 2])
        # The map is in the frame of scan 2, and on average as uncertain as scans 1 and 2.
        (scan1, of_scan1), (scan2, of_scan2) = (
            gaussian_of(line["pose_in_scan_0"]) for line in self.lines()[:2]
        )
        of_map = (of_scan2 + carried(of_scan1, inv(scan2) @ scan1)) / 2
        for line in self.lines()[2:]:
            pose, covariance = gaussian_of(line["edge"])
            own = covariance - carried(of_map, inv(pose))
            self.assertGreater(np.linalg.eigvalsh(own).min(), 0.0)

    def cycles(self, graph, *words):
        return call(EVALUATE, "cycles", graph, "--output", self.folder / "cycles.csv", *words)

    def test_span_and_its_cycles(self):
        scans, from_world = self.trajectory(EYES)
        self.tracked(scans, "--span", 3)
        self.check_truth(from_world)
        _, edges = self.read_graph()
        expected = [(i, k) for k in range(1, 5) for i in range(max(0, k - 3), k)]
        self.assertEqual(sorted(edges), sorted(expected))
        csv, graph = self.folder / "cycles.csv", self.track / "graph.g2o"
        result = self.cycles(graph)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        header, *rows = csv.read_text().splitlines()
        self.assertEqual(header.split(",")[:2], ["vertices", "length"])
        self.assertEqual(header.split(",")[-6:], UNITS_OF_ERRORS)
        # A cycle for each edge that the chain of scans does not need.
        self.assertEqual(len(rows), len(expected) - 4)
        self.assertRegex(result.stdout, r"(?m)^all +5 +6\.00 ")
        # Noise that all edges have in common nearly cancels around a triangle.
        self.assertNotEqual(self.cycles(graph, "--common-share", 0).stdout, result.stdout)
        for words, reason in (
            (["cycles", graph, "--output", csv, "--common-share", 0.5], "together below 1"),
            (["cycles", graph, "--output", graph], "graph.g2o' is the graph"),
            (["foo"], "there is no command 'foo'"),
        ):
            refused = call(EVALUATE, *words)
            self.assertEqual(refused.returncode, 2)
            self.assertIn(reason, refused.stderr)
        # An edge that is 3 cm off.
        text = graph.read_text()
        shifted = lambda found: f"{found[1]}{float(found[2]) + 0.03!r}"
        wrong, count = re.subn(r"(EDGE_SE3:QUAT 1 2 )(\S+)", shifted, text)
        self.assertEqual(count, 1)
        result = self.cycles(self.file("wrong.g2o", wrong))
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertRegex(result.stdout, r"Edges none of whose cycles closes:\n  1-2: all \d cycles\n$")
        # Without the edges of --span a chain is left.
        chain = re.sub(r"EDGE_SE3:QUAT (0 [2-9]|1 [3-9]|2 4).*\n", "", text)
        result = self.cycles(self.file("chain.g2o", chain))
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertRegex(result.stdout, "chain.g2o has no cycle of at most 4 edges .* --span 3")
        self.assertFalse(csv.exists())

    def test_goes_on(self):
        scans, _ = self.trajectory(EYES)
        self.tracked(scans)
        expected = {path.name: path.read_text() for path in self.track.iterdir()}
        lines, edges = self.lines(), expected.pop("edges.jsonl").splitlines(keepends=True)
        # Killed while it wrote the third line.
        (self.track / "edges.jsonl").write_text("".join(edges[:2]) + edges[2][:100])
        result = self.run_track(scans)
        self.assertIn("2 of 4 steps are in", result.stderr)
        for name, text in expected.items():
            self.assertEqual((self.track / name).read_text(), text, name)
        kept = self.lines()
        for old, new in zip(lines, kept):
            self.assertGreater(new["seconds"], 0)
            self.assertEqual({**old, "seconds": new["seconds"]}, new)
        result = self.run_track(scans, "--acceleration", 1)
        self.assert_refused(3, result, "edges.jsonl", "other settings")
        for k, num_kept in ((3, 2), (0, 0)):
            scan = scans / f"scan_{k}.pcd"
            scan.write_bytes(scan.read_bytes())
            result = self.run_track(scans)
            self.assertIn(f"so the track goes on from scan {num_kept + 1}\n", result.stderr)
            self.assertEqual(self.lines()[:num_kept], kept[:num_kept])
            self.assertEqual(result.stderr.count(" s)"), 4 - num_kept)
            self.assertEqual((self.track / "graph.g2o").read_text(), expected["graph.g2o"])
        renamed = scans.rename(self.folder / "renamed")
        result = self.run_track(renamed)
        self.assert_refused(3, result, "edges.jsonl", "scan 1 is another file here", renamed, scans)
        renamed.rename(scans)
        (scans / "scan_2.pcd").rename(scans / "scan_5.pcd")
        result = self.run_track(scans)
        self.assert_refused(3, result, "edges.jsonl", "scan 2 is another file here")
        (scans / "scan_3.pcd").rename(scans / "scan_10.pcd")
        self.assert_refused(3, self.run_track(scans), "scan_4.pcd", "by number")
        for scan in scans.iterdir():
            scan.rename(scans / f"{scan.stem.split('_')[1]}_scan.pcd")
        self.assert_refused(3, self.run_track(scans), "_scan.pcd", "by number")
        # An index and a time, and seconds with decimals.
        for rest in ("_1305031102.{}.pcd", ".{}.pcd"):
            for k, scan in enumerate(sorted(scans.iterdir())):
                scan.rename(scans / (re.split(r"[_.]", scan.name)[0] + rest.format(9 - k)))
            self.assert_refused(3, self.run_track(scans), ".pcd", "by number")


class TrackWithUnseenMotions(TrackTest):
    def test_along_a_wall_that_is_oblique_to_the_axes(self):
        random_numbers = random.Random(1)
        scans = []
        for k in range(4):
            points = []
            for _ in range(3000):
                u, v = (random_numbers.uniform(-2, 2) for _ in range(2))
                w = 3 + random_numbers.gauss(0, 0.002)
                # Orthonormal: along the wall (1, -1, 0), (1, 1, -2); across (1, 1, 1).
                a, b, c = u / 2**0.5, v / 6**0.5, w / 3**0.5
                points.append((a + b + c, b - a + c, c - 2 * b))
            scans.append(self.pcd(f"wall_{k}.pcd", points))
        result = self.run_track(*scans, "--acceleration", 1, "--angular-acceleration", 1)
        self.assertEqual(result.returncode, 0, result.stderr)
        warning = "3 of 3 registrations leave a motion unmeasured: along it the result is"
        self.assertIn(warning, result.stderr)
        report = (self.track / "report.html").read_text()
        self.assertIn(warning, report)
        self.assertIn("Every scan is registered, but not every motion measured", report)
        for k, line in enumerate(self.lines(), 1):
            self.assertEqual((line["kind"], line["edge"]["num_unmeasured"]), ("registered", 3))
            matrix = line["pose_in_scan_0"]["covariance"]["matrix"]
            across = np.sum(np.array(matrix)[:3, :3]) / 3
            along = (matrix[0][0] + matrix[1][1] - 2 * matrix[0][1]) / 2
            self.assertLess(across, 0.002**2)
            # The first motion is not seen, and the velocity does not change much.
            self.assertAlmostEqual(along**0.5, k * 0.125**0.5, delta=0.1 * k)
        self.assertEqual(len(self.read_graph()[1]), 3)


class TrackOfAScannerInAPlane(TrackTest):
    def test_stays_in_the_plane(self):
        scans, from_world = self.trajectory_in_a_plane(10)
        options = (["--span", 2], ["--map", 0.02, "--map-scans", 3])
        for number, words in enumerate(options):
            self.track = self.folder / f"track{number}"
            result = self.run_track(scans, *words)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("scan 0 lies in a plane", result.stderr)
            # z, roll and pitch go without saying.
            self.assertNotIn("unmeasured", result.stderr + (self.track / "report.html").read_text())
            for k, line in enumerate(self.lines(), 1):
                pose = line["pose_in_scan_0"]
                for out in ("z_m", "roll_rad", "pitch_rad"):
                    self.assertLess(abs(pose["mean"][out]), 1e-9, k)
                covariance = np.array(pose["covariance"]["matrix"])
                np.testing.assert_allclose(np.diag(covariance)[2:5], 1e-6, err_msg=str(k))
                found = np.array(pose["mean"]["T_target_source"])
                error = inv(found) @ from_world[0] @ inv(from_world[k])
                turn = np.arctan2(error[1, 0], error[0, 0])
                in_plane = np.array([error[0, 3], error[1, 3], turn])
                stated = covariance[np.ix_([0, 1, 5], [0, 1, 5])]
                self.assertLess(quadratic(in_plane, inv(stated)), CHI2_HIGH[3], k)
                self.assertLess(abs(in_plane).max(), 0.03)
            self.assertEqual(len(self.read_graph()[1]), 17 if number == 0 else 9)


class TrackWithBadScans(TrackTest):
    def test_are_predicted_and_said(self):
        scans, from_world = self.trajectory(EYES)
        self.pcd(scans / "scan_2.pcd", cloud_files.far_box())
        self.file(scans / "scan_3.pcd", "no cloud")
        result = self.run_track(scans, "--quiet")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertRegex(result.stderr, r"2/4 scan_2.pcd: predicted .*, [a-z_]+: .*")
        self.assertRegex(result.stderr, r"3/4 scan_3.pcd: predicted .*, error: .*scan_3.pcd: ")
        kinds = [line["kind"] for line in self.lines()]
        self.assertEqual(kinds[1:3], ["predicted", "predicted"])
        self.assertIn(kinds[3], ("registered", "widened"))
        self.assertEqual(self.targets(), [0, 1, 1, 1])
        vertices, edges = self.read_graph()
        self.assertEqual(sorted(edges), [(0, 1), (1, 2), (1, 3), (1, 4)])
        true = from_world[0] @ inv(from_world[4])
        self.assertLess(max(map(abs, g2o_error(vertices[4], true))), 0.01)
        self.assertIn("scan_3.pcd", (self.track / "report.html").read_text())

    def test_split(self):
        scans, _ = self.trajectory(EYES)
        for k in (1, 2, 3):
            self.pcd(scans / f"scan_{k}.pcd", cloud_files.far_box())
        self.assertEqual(self.run_track(scans).returncode, 1)
        kinds = [line["kind"] for line in self.lines()]
        self.assertEqual(kinds[:3], ["predicted", "predicted", "split"])
        self.assertEqual(self.targets(), [0, 0, 0, 3])

    def test_scan_before_the_target_is_gone(self):
        scans, _ = self.trajectory(EYES[:4])
        files = [scans / f"scan_{k}.pcd" for k in range(4)]
        self.tracked(*files, "--span", 2)
        edges = self.track / "edges.jsonl"
        lines = edges.read_text().splitlines(keepends=True)
        edges.write_text("".join(lines[:2]))
        files[1].unlink()
        result = self.run_track(*files, "--span", 2, "--quiet")
        self.assert_refused(3, result, "scan_1.pcd", "no such file")

    def test_first_scan(self):
        source, target = self.small_pair()
        gone = self.folder / "gone.pcd"
        self.assert_refused(3, self.run_track(gone, source, target), "gone.pcd", "no such file")


class TrackUsage(TrackTest):
    def test_guess_is_the_first_motion_whatever_the_period(self):
        _, target = self.small_pair()
        far = self.pcd("far.pcd", cloud_files.box_surface(seed=3) + np.array([50, 0, 0]))
        guess = [0.3, 0.1, 0.0, 0.0, 0.0, 0.2]
        for period in (0.1, 1.0):
            self.track = self.folder / f"track_{period}"
            self.run_track(target, far, "--period", period, "--guess", ",".join(map(str, guess)))
            self.assertEqual(self.lines()[0]["kind"], "predicted")
            mean = list(self.lines()[0]["edge"]["mean"].values())
            self.assert_close([mean[:6]], [guess], delta=1e-9)

    def test_largest_distance_is_that_of_the_preset(self):
        source, target = self.small_pair()
        exact = ["--preset", "exact", "--sigma", 0.005, "--effective-points", 300]
        for distance, kinds in ((0.3, ("registered", "widened")), (1e-4, ("predicted",))):
            self.track = self.folder / f"track_{distance}"
            self.run_track(target, source, *exact, "--max-distance", distance)
            self.assertIn(self.lines()[0]["kind"], kinds)

    def test_hardly_in_metres(self):
        """Said of scan 0, by all programs that register many scans."""
        scans = [self.pcd(f"{k}.pcd", np.multiply(cloud_files.box_surface(), 6000)) for k in (0, 1)]
        for result in (self.run_track(*scans), call(POSE_GRAPH, *scans, "-o", self.folder / "graph.g2o")):
            self.assertRegex(result.stderr, r"0.pcd: note: the points are .* in millimetres")
            self.assertNotIn("1.pcd: note", result.stderr)
        self.assertNotIn("note", self.run_track(*scans, "--quiet").stderr)

    def test_times_from_names(self):
        source, target = self.small_pair()
        first = target.rename(self.folder / "17.25.pcd")
        second = source.rename(self.folder / "17.5.pcd")
        self.tracked(first, second, "--times", "names")
        self.assertEqual(self.times(), [17.25, 17.5])
        # As they went in, though numbers of 64 bits are 240 ns apart there; nine decimals.
        first = first.rename(self.folder / "1700000000.25.pcd")
        second = second.rename(self.folder / "1700000000.2500000429.pcd")
        self.track = self.folder / "of_today"
        self.tracked(first, second, "--times", "names")
        for name in ("trajectory_tum.txt", "trajectory_covariance.txt"):
            stamps = [line.split()[0] for line in (self.track / name).read_text().splitlines()]
            self.assertEqual(stamps[-2:], ["1700000000.250000000", "1700000000.250000042"])
        for text in ("3.00000000000\n4.50000000000\n", "3e0 4.5e+00"):
            times = self.file("times.txt", text)
            self.track = self.folder / f"another_{len(text)}"
            self.tracked(first, second, "--times", times)
            self.assertEqual(self.times(), [3.0, 4.5])

    def test_folder_of_capitals(self):
        scans = self.folder / "scans"
        scans.mkdir()
        for k, scan in enumerate(self.small_pair()):
            scan.rename(scans / f"{k}.PCD")
        self.tracked(scans)
        self.assertEqual(len(self.times()), 2)

    def test_refused(self):
        source, target = self.small_pair()
        two = [target, source]
        (self.folder / "empty").mkdir()
        bad_words = [
            ([target], "at least two scans"),
            ([*two, "--acceleration", 0], "--acceleration is 0, but must be from 1e-09 to"),
            ([*two, "--period", "-1"], "--period is -1"),
            ([*two, "--period", "1", "--times", "names"], "--period and --times exclude"),
            ([*two, "--map", 0], "--map is 0"),
            ([*two, "--span", 0], "--span is 0"),
            ([*two, "--span", 2, "--map", 1], "--span excludes --map"),
            ([*two, "--map-scans", 3], "--map-scans needs --map"),
            ([*two, "--map", 0.1, "--map-scans", 0], "--map-scans is 0"),
            ([*two, "--prior-variance", "inf"], "must be finite"),
            ([*two, "--prior-frame", "source-centroid"], "--prior-frame"),
            ([*two, "--sigma", "1"], "--sigma"),
            ([*two, "--iterations", 50], "--iterations has no meaning: a track does not"),
            ([*two, "--reciprocal"], "--reciprocal has no meaning"),
            ([*two, "--max-distance", 1], "preset calibrated has no largest distance"),
            ([*two, "--map", 1e-9], "--map is 1e-09"),
        ]
        bad_files = [
            ([*two, "--period", 2147483648], "not from 0 to below 2^31 s"),
            ([*two, "--times", "names"], "'target' is not a number"),
            ([*two, "--times", self.file("short.txt", "1\n")], "has 1 times for 2 scans"),
            ([*two, "--times", self.file("back.txt", "2 1")], "is not at least 1 ns after"),
            ([*two, "--period", 100001], "scan 1, 100001 s, is more than 100000 s after"),
            ([self.folder / "empty"], "fewer than two"),
            ([self.folder / "none"], "none: no such folder"),
        ]
        self.assert_each_refused(2, [TRACK, "-o", self.track], bad_words)
        self.assert_each_refused(3, [TRACK, "-o", self.track], bad_files)
        self.assert_refused(2, call(TRACK, *two), "--output")
        self.assert_refused(3, call(TRACK, *two, "-o", "/proc/none/t"), "/proc/none")
