"""pcl_bayesian_icp_transform: what it moves, what it keeps, what it refuses."""

import json
import math
import random
import struct

import cloud_files
from cli_tool import FAST, ToolTest, call, run, strict_json
from cloud_files import numbers
from faults import TRANSFORM

# It begins with a minus, as options do.
POSE = (-0.1, 0.2, 0.3, 0.4, -0.5, 0.6)
WORDS = ",".join(map(str, POSE))
FIELDS = [("intensity", "f"), ("x", "f"), ("y", "f"), ("z", "f"), ("ring", "H")]
FIELDS += [("normal_x", "f"), ("normal_y", "f"), ("normal_z", "f"), ("time", "d")]
# Further ones, of which PLY has no like.
MORE_FIELDS = [("rgb", "I"), ("label", "i"), ("flag", "B"), ("curvature", "f")]
# x, y, z below 1 m are rounded to 32 bits before and after.
FLOAT_ROUNDING = 1e-6


def transform(*arguments):
    return call(TRANSFORM, *arguments)


class TransformTest(ToolTest):
    program = "pcl_bayesian_icp_transform"

    def cloud(self, more_fields=(), **writing):
        """Points with a value of each kind in every field, one without coordinates and one
        without a normal."""
        generator = random.Random(3)
        nan = math.nan
        points = []
        for i in range(50):
            values = [cloud_files.as_float32(generator.uniform(-0.5, 0.5)) for _ in FIELDS]
            values[4] = i * 1000
            points.append((*values, 0xFF0000 + i, -i, 5 * i, i / 3))
        points[7] = (7.0, nan, nan, nan, 9, *points[7][5:8], 1e300, *points[7][9:])
        points[8] = (*points[8][:5], nan, nan, nan, *points[8][8:])
        fields = [*FIELDS, *more_fields]
        points = [point[: len(fields)] for point in points]
        return self.file("in.pcd", cloud_files.pcd_bytes(points, fields, **writing))

    def assert_others_kept(self, before, after, more_fields=()):
        for a, b in zip(before, after):
            for name in ("intensity", "ring", "time", *(name for name, _ in more_fields)):
                self.assertEqual(a[name], b[name])

    def assert_done(self, result):
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def assert_moved(self, before, after, matrix, normals=True):
        self.assertEqual(len(after), len(before))
        for a, b in zip(before, after):
            point = cloud_files.moved(matrix, numbers(a, "x", "y", "z"))
            if not math.isnan(point[0]):
                self.assertLess(math.dist(numbers(b, "x", "y", "z"), point), FLOAT_ROUNDING)
            else:
                self.assertTrue(all(map(math.isnan, numbers(b, "x", "y", "z"))))
            if not normals:
                continue
            names = ["normal_x", "normal_y", "normal_z"]
            normal = cloud_files.rotated(matrix, numbers(a, *names))
            if not math.isnan(normal[0]):
                self.assertLess(math.dist(numbers(b, *names), normal), FLOAT_ROUNDING)


class TransformMotion(TransformTest):
    def test_pose_in_words(self):
        output = self.folder / "out.pcd"
        _, before = cloud_files.read_pcd(self.cloud(MORE_FIELDS))
        for encoding, height in (("binary", 1), ("ascii", 10), ("binary_compressed", 10)):
            source = self.cloud(MORE_FIELDS, encoding=encoding, height=height)
            self.assert_done(transform(source, output, "--pose", WORDS))
            header, after = cloud_files.read_pcd(output)
            self.assertEqual(header["HEIGHT"], [str(height)])
            self.assertEqual(header["DATA"], ["binary_compressed"])
            self.assertEqual(header["FIELDS"], [name for name, _ in FIELDS + MORE_FIELDS])
            self.assert_moved(before, after, cloud_files.matrix_of(*POSE))
            self.assert_others_kept(before, after, MORE_FIELDS)

    def test_matrix_file_and_inverse(self):
        source, moved, back = self.cloud(), self.folder / "moved.pcd", self.folder / "back.pcd"
        rows = cloud_files.matrix_of(*POSE)
        matrix = self.file("T.txt", "\n".join(" ".join(map(repr, row)) for row in rows))
        self.assert_done(transform(source, moved, "-p", matrix))
        self.assert_done(transform(moved, back, "-p", matrix, "--inverse"))
        _, before = cloud_files.read_pcd(source)
        _, there = cloud_files.read_pcd(moved)
        _, again = cloud_files.read_pcd(back)
        self.assert_moved(before, there, rows)
        self.assert_moved(before, again, cloud_files.matrix_of(0, 0, 0, 0, 0, 0))

    def test_viewpoint_moves_with_the_cloud(self):
        half = math.sqrt(0.5)  # a quarter turn about z
        source = self.cloud(viewpoint=f"1 2 3 {half} 0 0 {half}")
        output = self.folder / "out.pcd"
        self.assert_done(transform(source, output, f"--pose={WORDS}"))
        header, _ = cloud_files.read_pcd(output)
        viewpoint = list(map(float, header["VIEWPOINT"]))
        matrix = cloud_files.matrix_of(*POSE)
        # Six digits are what PCL writes.
        self.assert_close(viewpoint[:3], cloud_files.moved(matrix, (1, 2, 3)), delta=1e-5)
        w, x, y, z = viewpoint[3:]
        looks_along = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]
        self.assert_close(looks_along, cloud_files.rotated(matrix, (0, 1, 0)), delta=1e-5)

    def test_posterior(self):
        source, target = self.cloud(MORE_FIELDS), self.small_pair()[1]
        output = self.folder / "output"
        result = run(source, target, *FAST, "-o", output, "--quiet")
        self.assert_ran(result)
        document = strict_json((output / "posterior.json").read_text())
        _, before = cloud_files.read_pcd(source)
        _, aligned = cloud_files.read_pcd(output / "aligned.pcd")
        moved = self.folder / "moved.pcd"
        self.assert_done(transform(source, moved, "--pose", output / "posterior.json"))
        self.assertEqual(cloud_files.read_pcd(moved)[1], aligned)
        self.assert_done(
            transform(source, moved, "--pose", output / "posterior.json", "--use", "mean")
        )
        matrix = document["posterior"]["mean"]["T_target_source"]
        self.assert_moved(before, cloud_files.read_pcd(moved)[1], matrix)

    def test_ply_keeps_all_fields_and_the_viewpoint(self):
        half = math.sqrt(0.5)
        source = self.cloud(viewpoint=f"1 2 3 {half} 0 0 {half}")
        ply, pcd = self.folder / "all.ply", self.folder / "all.pcd"
        self.assert_done(transform(source, ply, "--pose", WORDS))
        self.assert_done(transform(ply, pcd, "--pose", WORDS, "--inverse"))
        _, before = cloud_files.read_pcd(source)
        header, after = cloud_files.read_pcd(pcd)
        self.assertEqual(header["FIELDS"], [name for name, _ in FIELDS])
        self.assert_moved(before, after, cloud_files.matrix_of(0, 0, 0, 0, 0, 0))
        self.assert_others_kept(before, after)
        # The camera is the last element: 17 floats from its position on, two ints, two floats.
        position = struct.unpack("<3f", ply.read_bytes()[-84:-72])
        expected = cloud_files.moved(cloud_files.matrix_of(*POSE), (1, 2, 3))
        self.assertLess(math.dist(position, expected), FLOAT_ROUNDING * 10)

    def test_ply(self):
        points = cloud_files.box_surface()
        source = self.file("in.ply", cloud_files.ply_bytes(points))
        ply, pcd = self.folder / "out.PLY", self.folder / "out.pcd"
        self.assert_done(transform(source, ply, "--pose", WORDS))
        self.assertTrue(ply.read_bytes().startswith(b"ply\nformat binary_little_endian 1.0\n"))
        self.assert_done(transform(ply, pcd, "--pose", "0,0,0,0,0,0"))
        _, after = cloud_files.read_pcd(pcd)
        before = [dict(zip("xyz", (struct.pack("<f", c) for c in point))) for point in points]
        self.assert_moved(before, after, cloud_files.matrix_of(*POSE), normals=False)


    def test_a_matrix_with_few_digits_does_not_stretch_the_cloud(self):
        matrix = [[1.0004 if i == j else 0 for j in range(4)] for i in range(3)] + [[0, 0, 0, 1]]
        pose = self.file("stretched.txt", "\n".join(" ".join(map(str, row)) for row in matrix))
        far = self.file("far.pcd", cloud_files.pcd_bytes([(100, 0, 0), (0, 200, 0), (0, 0, 300)]))
        output = self.folder / "out.pcd"
        self.assert_done(transform(far, output, "--pose", pose))
        self.assertEqual(cloud_files.read_pcd(output)[1], cloud_files.read_pcd(far)[1])

    def test_a_mean_of_several_modes_is_warned_of(self):
        output = self.folder / "output"
        run(*self.small_pair(), *FAST, "-o", output, "--quiet")
        file = output / "posterior.json"
        document = strict_json(file.read_text())
        document["status"]["name"] = "several_modes"
        file.write_text(json.dumps(document))
        words = (self.cloud(), self.folder / "moved.pcd", "--pose", file)
        self.assert_done(transform(*words))
        result = transform(*words, "--use=mean")
        self.assertEqual(result.returncode, 0)
        self.assertIn(f"{file}: warning: the status is several_modes", result.stderr)

    def test_digits_that_32_bits_lose_are_told(self):
        output = self.folder / "out.pcd"
        result = transform(self.cloud(), output, "--pose", "500000,5000000,0,0,0,0")
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stderr, rf"{output}: note: .* kept to 0.5 m only")
        fields = [(name, "d") for name in "xyz"]
        doubles = self.file("double.pcd", cloud_files.pcd_bytes([(1, 2, 3)] * 3, fields))
        self.assert_done(transform(doubles, output, "--pose", "500000,5000000,0,0,0,0"))

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
        self.assert_done(transform(source, source, "--pose", WORDS, "--overwrite"))
        self.assertNotEqual(source.read_bytes(), content)

    def test_usage(self):
        source, output = self.cloud(), self.folder / "out.pcd"
        self.assert_refused(2, transform(source, "--pose", WORDS), "expected two files")
        self.assert_refused(2, transform(source, output), "--pose is missing")
        self.assert_refused(2, transform(source, output, "--pose", "1,2,3"), "--pose: '1,2,3'")
        for words in ("nan,0,0,0,0,0", "0,0,0,0,0,inf"):
            self.assert_refused(2, transform(source, output, "--pose", words), "--pose: must be finite")
        self.assert_refused(2, transform(source, output, "--pose", WORDS, "--use=x"), "--use: 'x'")
        self.assert_refused(
            2, transform(source, output, "--pose", WORDS, "--use=mean"), "--use: has no effect"
        )
        self.assert_refused(2, transform(source, output, "--poses", WORDS), "--poses")
        self.assertFalse(output.exists())
        for word in ("--help", "--version"):
            result = transform(word)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertIn("pcl_bayesian_icp_transform", result.stdout)

    def test_pose_that_is_too_long_for_a_name(self):
        result = transform(self.cloud(), self.folder / "out.pcd", "--pose", "1," * 5000)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("is neither the six numbers", result.stderr)

    def test_pose_in_degrees(self):
        result = transform(self.cloud(), self.folder / "out.pcd", "--pose", "0.1,0,0,0,0,90")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("angles are in radians", result.stderr)

    def test_files(self):
        source, output = self.cloud(), self.folder / "out.pcd"
        result = transform(source, self.folder / "out.xyz", "--pose", WORDS)
        self.assert_refused(3, result, "out.xyz: is neither .pcd nor .ply")
        result = transform(self.folder / "no.pcd", output, "--pose", WORDS)
        self.assert_refused(3, result, "no.pcd: no such file")
        result = transform(source, output, "--pose", self.folder / "no.json")
        self.assert_refused(3, result, "no.json: no such file")
        result = transform(source, output, "--pose", self.file("empty.json", "{}"))
        self.assert_refused(3, result, "empty.json: is not a posterior.json")
        scaled = self.file("scaled.txt", "2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1")
        self.assert_refused(3, transform(source, output, "-p", scaled), "is not a rotation")
        self.assertFalse(output.exists())

    def test_fields_that_ply_cannot_have(self):
        twice = [("x", "f"), ("y", "f"), ("z", "f"), ("x", "f")]
        source = self.file("twice.pcd", cloud_files.pcd_bytes([(1, 2, 3, 4)] * 3, twice))
        output = self.folder / "out.ply"
        result = transform(source, output, "--pose", WORDS)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn(f"{output}: cannot be written", result.stderr)
        self.assertIn("two properties are called 'x'", result.stderr)
        self.assertFalse(output.exists())
        self.assert_done(transform(source, self.folder / "out.pcd", "--pose", WORDS))

    def test_ply_has_colours_that_are_whole_numbers(self):
        fields = [("x", "f"), ("y", "f"), ("z", "f"), ("rgb", "I")]
        points = [(0.5 * i, 1.0, 2.0, 0x102030 + i) for i in range(9)]
        source = self.file("colours.pcd", cloud_files.pcd_bytes(points, fields))
        output = self.folder / "out.ply"
        self.assert_done(transform(source, output, "--pose", WORDS))
        header, body = output.read_bytes().split(b"end_header\n")
        self.assertIn(b"property uchar red\nproperty uchar green\nproperty uchar blue", header)
        for i in range(9):
            self.assertEqual(body[15 * i + 12 : 15 * i + 15], bytes([0x10, 0x20, 0x30 + i]))

    def test_fields_that_pcl_writes_wrongly(self):
        fields = [("x", "f"), ("y", "f"), ("z", "f")]
        fields += [("normal_x", "d"), ("normal_y", "d"), ("normal_z", "d")]
        points = [(0.5 * i, 1.0, 2.0, 0.0, 0.0, 1.0) for i in range(9)]
        source = self.file("double.pcd", cloud_files.pcd_bytes(points, fields))
        output = self.folder / "out.ply"
        result = transform(source, output, "--pose", WORDS)
        self.assert_refused(3, result, f"{output}: cannot be written", "a .pcd keeps all fields")
        self.assertFalse(output.exists())
