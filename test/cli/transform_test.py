"""pcl_bayesian_icp_transform: what it moves, what it keeps, what it refuses."""

import json
import math
import random
import struct

import numpy as np

import cloud_files
from cli_tool import FAST, ToolTest, call
from cloud_files import XYZ, columns, read_pcd
from faults import TRANSFORM

# It begins with a minus, as options do.
POSE = (-0.1, 0.2, 0.3, 0.4, -0.5, 0.6)
WORDS = ",".join(map(str, POSE))
MATRIX = cloud_files.matrix_of(*POSE)
# A camera at 1 2 3 that has made a quarter turn about z.
VIEWPOINT = f"1 2 3 {math.sqrt(0.5)} 0 0 {math.sqrt(0.5)}"
NORMAL = ["normal_x", "normal_y", "normal_z"]
FIELDS = [("intensity", "f"), *XYZ, ("ring", "H"), *((name, "f") for name in NORMAL), ("time", "d")]
# Further ones, of which PLY has no like.
MORE_FIELDS = [("rgb", "I"), ("label", "i"), ("flag", "B"), ("curvature", "f")]
# x, y, z below 1 m are rounded to 32 bits before and after.
FLOAT_ROUNDING = 1e-6


def transform(*arguments):
    return call(TRANSFORM, *arguments)


class TransformTest(ToolTest):
    program = "pcl_bayesian_icp_transform"

    def setUp(self):
        super().setUp()
        self.moved = self.folder / "moved.pcd"

    def cloud(self, more_fields=(), **writing):
        """Points with a value of each kind in every field, one without coordinates and one
        without a normal."""
        generator = random.Random(3)
        nan = math.nan
        points = []
        for i in range(50):
            values = np.float32([generator.uniform(-0.5, 0.5) for _ in FIELDS]).tolist()
            values[4] = i * 1000
            points.append((*values, 0xFF0000 + i, -i, 5 * i, i / 3))
        points[7] = (7.0, nan, nan, nan, 9, *points[7][5:8], 1e300, *points[7][9:])
        points[8] = (*points[8][:5], nan, nan, nan, *points[8][8:])
        fields = [*FIELDS, *more_fields]
        return self.pcd("in.pcd", [point[: len(fields)] for point in points], fields, **writing)

    def done(self, *arguments):
        """What read_pcd() finds in the output, if that is a PCD file."""
        result = transform(*arguments)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))
        output = arguments[1]
        return read_pcd(output) if output.suffix == ".pcd" else None

    def assert_moved(self, before, after, matrix=MATRIX):
        """Points and, where there are any, normals."""
        expected = cloud_files.moved(matrix, columns(before, *"xyz"))
        np.testing.assert_allclose(columns(after, *"xyz"), expected, atol=FLOAT_ROUNDING)
        if NORMAL[0] in before.dtype.names:
            expected = columns(before, *NORMAL) @ np.transpose(matrix)[:3, :3]
            np.testing.assert_allclose(columns(after, *NORMAL), expected, atol=FLOAT_ROUNDING)

    def assert_others_kept(self, before, after, more_fields=()):
        for name in ("intensity", "ring", "time", *(name for name, _ in more_fields)):
            np.testing.assert_array_equal(before[name], after[name])


class TransformMotion(TransformTest):
    def test_pose_in_words(self):
        _, before = read_pcd(self.cloud(MORE_FIELDS))
        for encoding, height in (("binary", 1), ("ascii", 10), ("binary_compressed", 10)):
            source = self.cloud(MORE_FIELDS, encoding=encoding, height=height)
            header, after = self.done(source, self.moved, "--pose", WORDS)
            self.assertEqual(header["HEIGHT"], [str(height)])
            self.assertEqual(header["DATA"], ["binary_compressed"])
            self.assertEqual(header["FIELDS"], [name for name, _ in FIELDS + MORE_FIELDS])
            self.assert_moved(before, after)
            self.assert_others_kept(before, after, MORE_FIELDS)

    def test_matrix_file_and_inverse(self):
        source = self.cloud()
        _, before = read_pcd(source)
        matrix = self.folder / "T.txt"
        np.savetxt(matrix, MATRIX)
        _, there = self.done(source, self.moved, "-p", matrix)
        _, again = self.done(self.moved, self.folder / "back.pcd", "-p", matrix, "--inverse")
        self.assert_moved(before, there)
        self.assert_moved(before, again, np.eye(4))

    def test_viewpoint_moves_with_the_cloud(self):
        header, _ = self.done(self.cloud(viewpoint=VIEWPOINT), self.moved, f"--pose={WORDS}")
        viewpoint = list(map(float, header["VIEWPOINT"]))
        # Six digits are what PCL writes.
        self.assert_close(viewpoint[:3], cloud_files.moved(MATRIX, (1, 2, 3)), delta=1e-5)
        w, x, y, z = viewpoint[3:]
        looks_along = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]
        self.assert_close(looks_along, MATRIX[:3, 1], delta=1e-5)

    def test_posterior(self):
        source = self.cloud(MORE_FIELDS)
        _, document = self.run_to_files(source, self.small_pair()[1], *FAST)
        words = [source, self.moved, "--pose", self.output / "posterior.json"]
        _, aligned = read_pcd(self.output / "aligned.pcd")
        self.assertEqual(self.done(*words)[1].tobytes(), aligned.tobytes())
        matrix = document["posterior"]["mean"]["T_target_source"]
        self.assert_moved(read_pcd(source)[1], self.done(*words, "--use", "mean")[1], matrix)

    def test_ply_keeps_all_fields_and_the_viewpoint(self):
        source = self.cloud(viewpoint=VIEWPOINT)
        ply = self.folder / "all.ply"
        self.done(source, ply, "--pose", WORDS)
        header, after = self.done(ply, self.moved, "--pose", WORDS, "--inverse")
        _, before = read_pcd(source)
        self.assertEqual(header["FIELDS"], [name for name, _ in FIELDS])
        self.assert_moved(before, after, np.eye(4))
        self.assert_others_kept(before, after)
        # The camera is the last element: 17 floats from its position on, two ints, two floats.
        position = struct.unpack("<3f", ply.read_bytes()[-84:-72])
        expected = cloud_files.moved(MATRIX, (1, 2, 3))
        self.assertLess(math.dist(position, expected), FLOAT_ROUNDING * 10)

    def test_ply(self):
        points = cloud_files.box_surface()
        source = self.file("in.ply", cloud_files.ply_bytes(points))
        ply = self.folder / "out.PLY"
        self.done(source, ply, "--pose", WORDS)
        self.assertTrue(ply.read_bytes().startswith(b"ply\nformat binary_little_endian 1.0\n"))
        _, after = self.done(ply, self.moved, "--pose", "0,0,0,0,0,0")
        self.assert_moved(np.array(points, XYZ), after)

    def test_a_matrix_with_few_digits_does_not_stretch_the_cloud(self):
        pose = self.folder / "stretched.txt"
        np.savetxt(pose, np.diag([1.0004, 1.0004, 1.0004, 1]))
        far = self.pcd("far.pcd", [(100, 0, 0), (0, 200, 0), (0, 0, 300)])
        _, after = self.done(far, self.moved, "--pose", pose)
        np.testing.assert_array_equal(after, read_pcd(far)[1])

    def test_a_mean_of_several_modes_is_warned_of(self):
        _, document = self.run_to_files(*self.small_pair(), *FAST)
        document["status"]["name"] = "several_modes"
        file = self.file("several.json", json.dumps(document))
        words = [self.cloud(), self.moved, "--pose", file]
        self.done(*words)
        result = transform(*words, "--use=mean")
        self.assertEqual(result.returncode, 0)
        self.assertIn(f"{file}: warning: the status is several_modes", result.stderr)

    def test_digits_that_32_bits_lose_are_told(self):
        words = [self.moved, "--pose", "500000,5000000,0,0,0,0"]
        result = transform(self.cloud(), *words)
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stderr, rf"{self.moved}: note: .* kept to 0.5 m only")
        self.done(self.pcd("double.pcd", [(1, 2, 3)] * 3, [(name, "d") for name in "xyz"]), *words)

    def test_places_beyond_a_float_are_refused(self):
        for name in ("out.pcd", "out.ply"):
            output = self.folder / name
            result = transform(self.cloud(), output, "--pose", "1e39,0,0,0,0,0")
            self.assert_refused(3, result, name, "further than a float can say")
            self.assertFalse(output.exists())


class TransformRefusals(TransformTest):
    def test_input_is_not_overwritten_unless_asked_for(self):
        source = self.cloud()
        content = source.read_bytes()
        link = self.folder / "link.pcd"
        link.symlink_to(source)
        for output in (source, self.folder / "." / "in.pcd", link):
            result = transform(source, output, "--pose", WORDS)
            self.assert_refused(2, result, "is the input", "--overwrite")
        self.assertEqual(source.read_bytes(), content)
        self.done(source, source, "--pose", WORDS, "--overwrite")
        self.assertNotEqual(source.read_bytes(), content)

    def test_usage(self):
        source = self.cloud()
        self.assert_refused(2, transform(source, "--pose", WORDS), "expected two files")
        cases = [
            ([], "--pose is missing"),
            (["--pose", "1,2,3"], "--pose: '1,2,3'"),
            (["--pose", "nan,0,0,0,0,0"], "--pose: must be finite"),
            (["--pose", "0,0,0,0,0,inf"], "--pose: must be finite"),
            (["--pose", WORDS, "--use=x"], "--use: 'x'"),
            (["--pose", WORDS, "--use=mean"], "--use: has no effect"),
            (["--poses", WORDS], "--poses"),
            # Too long for the name of a file.
            (["--pose", "1," * 5000], "is neither the six numbers"),
            (["--pose", "0.1,0,0,0,0,90"], "angles are in radians"),
        ]
        self.assert_each_refused(2, [TRANSFORM, source, self.moved], cases)
        self.assertFalse(self.moved.exists())
        for word in ("--help", "--version"):
            result = transform(word)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertIn("pcl_bayesian_icp_transform", result.stdout)

    def test_files(self):
        source = self.cloud()
        empty = self.file("empty.json", "{}")
        scaled = self.file("scaled.txt", "2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1")
        cases = [
            ([source, self.folder / "out.xyz", "-p", WORDS], "out.xyz: is neither .pcd nor .ply"),
            ([self.folder / "no.pcd", self.moved, "-p", WORDS], "no.pcd: no such file"),
            ([source, self.moved, "-p", self.folder / "no.json"], "no.json: no such file"),
            ([source, self.moved, "-p", empty], "empty.json: is not a posterior.json"),
            ([source, self.moved, "-p", scaled], "is not a rotation"),
        ]
        self.assert_each_refused(3, [TRANSFORM], cases)
        self.assertFalse(self.moved.exists())

    def test_fields_that_ply_cannot_have(self):
        source = self.pcd("twice.pcd", [(1, 2, 3, 4)] * 3, [*XYZ, ("x", "f")])
        output = self.folder / "out.ply"
        result = transform(source, output, "--pose", WORDS)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn(f"{output}: cannot be written", result.stderr)
        self.assertIn("two properties are called 'x'", result.stderr)
        self.assertFalse(output.exists())
        result = transform(source, self.moved, "--pose", WORDS)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_ply_has_colours_that_are_whole_numbers(self):
        points = [(0.5 * i, 1.0, 2.0, 0x102030 + i) for i in range(9)]
        output = self.folder / "out.ply"
        self.done(self.pcd("colours.pcd", points, [*XYZ, ("rgb", "I")]), output, "--pose", WORDS)
        header, body = output.read_bytes().split(b"end_header\n")
        self.assertIn(b"property uchar red\nproperty uchar green\nproperty uchar blue", header)
        for i in range(9):
            self.assertEqual(body[15 * i + 12 : 15 * i + 15], bytes([0x10, 0x20, 0x30 + i]))

    def test_fields_that_pcl_writes_wrongly(self):
        fields = [*XYZ, *((name, "d") for name in NORMAL)]
        source = self.pcd("double.pcd", [(0.5 * i, 1, 2, 0, 0, 1) for i in range(9)], fields)
        output = self.folder / "out.ply"
        result = transform(source, output, "--pose", WORDS)
        self.assert_refused(3, result, f"{output}: cannot be written", "a .pcd keeps all fields")
        self.assertFalse(output.exists())
