"""Clouds that are read in every encoding, and clouds that cannot be."""

import math
import os
import pathlib
import resource
import unittest

import numpy as np

import cloud_files
from cli_tool import DATA, FAST, SANITIZER, ToolTest, run, strict_json, true_translation
from cloud_files import XYZ, pcd_bytes, pcd_header, ply_bytes, read_pcd
from faults import limited

POINTS = cloud_files.box_surface(num_points=50)
PLY_ENCODINGS = ("binary_little_endian", "binary_big_endian")


class BrokenClouds(ToolTest):
    def setUp(self):
        super().setUp()
        self.good = self.pcd("good.pcd", POINTS)

    def refuse(self, name, content, *reason):
        """As the target: exit 3, the file and the reason."""
        bad = self.file(name, content)
        self.assert_refused(3, run(self.good, bad, *FAST), f"{bad}: ", *reason)

    def refuse_in_both_places(self, name, *reason):
        """As refuse(), of what there is by that name; also as the source."""
        bad = self.folder / name
        for clouds in ((bad, self.good), (self.good, bad)):
            self.assert_refused(3, run(*clouds, *FAST), f"{bad}: ", *reason)

    def test_no_such_thing(self):
        self.refuse_in_both_places("missing.pcd", "no such file")
        self.refuse("empty.pcd", "", "is empty")
        self.refuse("empty.ply", "", "is empty")
        self.refuse("cloud.xyz", "1 2 3\n", "neither .pcd nor .ply")
        (self.folder / "folder.pcd").mkdir()
        self.refuse_in_both_places("folder.pcd", "is a directory")
        (self.folder / "null.pcd").symlink_to("/dev/null")
        self.refuse_in_both_places("null.pcd", "is not a regular file")
        # As a process substitution of the shell.
        (self.folder / "63").symlink_to("/dev/null")
        self.refuse_in_both_places("63", "is not a regular file")

    def test_no_cloud(self):
        self.file("text.pcd", "Dear reader,\nthis is no cloud.\n")
        self.refuse_in_both_places("text.pcd", "has no PCD header")
        self.refuse("text.ply", "Dear reader,\nthis is no cloud.\n", "has no PLY header")
        self.refuse("binary.pcd", bytes(range(256)) * 400, "has no PCD header")
        self.refuse("escape.ply", "ply\n\x1b[31m\n", "'?[31m'")

    def test_headers_cut_off_anywhere(self):
        for encoding in ("ascii", "binary"):
            header = pcd_header(XYZ, 50, encoding)
            for length in range(60, len(header) - len(encoding), 25):
                self.refuse("cut.pcd", header[:length])
        header = ply_bytes(POINTS).split(b"end_header")[0]
        for length in range(8, len(header), 25):
            self.refuse("cut.ply", header[:length])

    def test_bodies_cut_off(self):
        # In ASCII a number that lost digits is a number still; so many bytes are a whole one.
        for name, bytes_of, end_of_header, last, encodings in (
            ("cut.pcd", pcd_bytes, b"DATA ", 24, ("ascii", "binary", "binary_compressed")),
            ("cut.ply", ply_bytes, b"end_header", 14, ("ascii", *PLY_ENCODINGS)),
        ):
            for encoding in encodings:
                content = bytes_of(POINTS, encoding=encoding)
                start = content.index(b"\n", content.index(end_of_header)) + 1
                for length in (start, start + 5, (start + len(content)) // 2, len(content) - last):
                    with self.subTest(name=name, encoding=encoding, length=length):
                        self.refuse(name, content[:length])

    def test_headers_that_lie(self):
        def changed(encoding, old, new):
            return pcd_bytes(POINTS, encoding=encoding).replace(old, new)

        for encoding in ("ascii", "binary", "binary_compressed"):
            for count in (b"51", b"2000000000"):
                more = changed(encoding, b"WIDTH 50", b"WIDTH " + count)
                more = more.replace(b"POINTS 50", b"POINTS " + count)
                self.refuse("lie.pcd", more, f"it says {count.decode()} points")
            huge = changed(encoding, b"POINTS 50", b"POINTS 1000000000000")
            self.refuse("lie.pcd", huge, "POINTS 1000000000000")
        self.refuse("lie.pcd", changed("binary", b"WIDTH 50", b"WIDTH 49"), "inconsistent")
        self.refuse("lie.pcd", changed("binary", b"SIZE 4", b"SIZE 3"), "'x'", "SIZE")
        self.refuse("lie.pcd", changed("binary", b"COUNT 1 1 1", b"COUNT 1 1"), "COUNT")
        self.refuse("lie.pcd", changed("binary", b"DATA binary", b"DATA zip"), "zip")
        fewer = changed("ascii", b" 50", b" 49")
        self.refuse("lie.pcd", fewer, "more points than the 49")
        vertices = ply_bytes(POINTS, encoding="binary_little_endian")
        vertices = vertices.replace(b"vertex 50", b"vertex 2000000000")
        self.refuse("lie.ply", vertices, "2000000000")

    def test_headers_that_pcl_takes_for_others(self):
        """It would read other numbers than those of the points, or end the program."""
        content = pcd_bytes(POINTS, encoding="ascii")
        for old, new, reason in (
            (b"POINTS 50\n", b"POINTS 50\n \n", "blank"),
            (b"VIEWPOINT 0 0", b"VIEWPOINT nan 0", "VIEWPOINT nan"),
            (b"VIEWPOINT 0 0", b"VIEWPOINT 0", "VIEWPOINT 0 0 1"),
            (b"FIELDS x y z", b"FIELDS x y\vz", "2 FIELDS"),
            (b"COUNT 1 1 1", b"COUNT 4294967295 1 1", "3 values in place of 4294967297"),
        ):
            with self.subTest(new=new):
                self.assertIn(old, content)
                self.refuse("other.pcd", content.replace(old, new), reason)
        whole = content.replace(b"TYPE F F F", b"TYPE F F I")
        for value in (b"nan", b"2147483648", b"-1e10"):
            bad = whole.replace(b"DATA ascii\n", b"DATA ascii\n1 2 " + value + b"\n")
            self.refuse("whole.pcd", bad, "does not fit into the integer 'z'")
        body = content[content.index(b"DATA ascii\n") + len("DATA ascii\n") :]
        self.refuse("tab.pcd", content.replace(body, body.replace(b" ", b"\v")), "1 values")

    def test_points_that_pcl_takes_for_a_header(self):
        """It goes on reading the header behind the line DATA."""
        content = pcd_bytes(POINTS)
        start = len(pcd_header(XYZ, 50, "binary"))
        for line in (b"COLUMNS a\n", b"\n\nWIDTH 9\n", b"#\0\n COUNT 1 1\n", b"VERSION\n"):
            bad = content[:start] + line + content[start + len(line) :]
            self.refuse("points.pcd", bad, "the points begin like a line of the header")
        comment = content[:start] + b"#\n\n" + content[start + 3 :]
        good = self.file("good.pcd", content)
        self.assert_ran(run(self.file("comment.pcd", comment), good, *FAST))

    def test_ply_headers_that_pcl_takes_for_others(self):
        """As above: PCL believes obj_info, and stores colours and alpha as one number."""
        content = ply_bytes(POINTS)
        x = b"property float x\n"
        for old, new, reason in (
            (x, b"obj_info num_cols 1\n" + x, "num_cols times num_rows is 1"),
            (x, b"obj_info num_rows 400000000\n" + x, "num_cols times num_rows"),
            (x, b"obj_info num_cols \n" + x, "bad line in the header"),
            (x, b" obj_info num_cols 50\n" + x, "bad line in the header"),
            (x, x + x, "two properties are called 'x'"),
            (x, b"property uchar blue\n", "red, green, blue"),
            (x, b"property uchar alpha\n", "red, green, blue"),
            (x, b"property uchar red\n", "red, green, blue"),
            (x, b"".join(b"property uchar p%d\n" % i for i in range(1000)), "more than 1000"),
            (b"element face 1\n", b"element range_grid 1\n", "range grid with gaps"),
            (b"property list uchar int vertex_indices\n", b"", "'face' has no properties"),
        ):
            with self.subTest(new=new):
                self.assertIn(old, content)
                self.refuse("other.ply", content.replace(old, new), reason)

    @unittest.skipIf(SANITIZER, "a sanitizer needs more address space than is left")
    def test_lying_headers_allocate_nothing(self):
        """With an address space that could not hold a tenth of what the header claims."""
        lie = pcd_bytes(POINTS).replace(b" 50", b" 2000000000")
        limit = 2 * 1024**3
        pair = [self.file("lie.pcd", lie), self.pcd("good.pcd", POINTS)]
        result = run(*pair, preexec_fn=limited(resource.RLIMIT_AS, limit))
        self.assert_refused(3, result, "lie.pcd", "cut off")

    def test_values_that_are_no_numbers(self):
        content = pcd_bytes(POINTS, encoding="ascii")
        bad = content.replace(b"\nDATA ascii\n", b"\nDATA ascii\n1 2 three\n")
        self.refuse("word.pcd", bad, "point 1: 'three' is not a number")
        bad = content.replace(b"\nDATA ascii\n", b"\nDATA ascii\n1 2\n")
        self.refuse("short.pcd", bad, "point 1 has 2 values in place of 3")

    def test_no_usable_points(self):
        nan = math.nan
        self.pcd("nan.pcd", [(nan, nan, nan)] * 9)
        self.refuse_in_both_places("nan.pcd", "has no finite points")
        self.refuse("nan.pcd", pcd_bytes([(nan, 1, 1)] * 9, encoding="ascii"), "no finite points")
        two_finite = [(nan, 1, 1)] * 9 + [(0, 0, 0), (1, 1, 1)]
        self.pcd("two.pcd", two_finite)
        self.refuse_in_both_places("two.pcd", "has only 2 finite points")
        self.refuse("none.pcd", pcd_bytes([]), "has no points")
        self.refuse("none.pcd", pcd_bytes([], encoding="binary_compressed"), "has no points")
        self.refuse("none.ply", ply_bytes([]), "has no points")
        for count in (1, 2):
            reason = f"has only {count} finite points"
            self.refuse("few.pcd", pcd_bytes(POINTS[:count]), reason)

    def test_no_coordinates(self):
        flat = [("x", "f"), ("y", "f"), ("intensity", "f")]
        self.pcd("flat.pcd", POINTS, flat)
        self.refuse_in_both_places("flat.pcd", "no floating-point fields x, y and z")
        whole = [("x", "i"), ("y", "i"), ("z", "i")]
        rows = [(1, 2, 3)] * 9
        self.refuse("whole.pcd", pcd_bytes(rows, whole), "no floating-point fields")
        self.refuse("flat.ply", ply_bytes(POINTS, flat), "no floating-point fields")


class Encodings(ToolTest):
    """The same points give the same draws, however they are written."""

    def samples_of(self, name, content_of):
        pairs = []
        for role, seed in (("source", 2), ("target", 1)):
            points = cloud_files.box_surface(seed=seed)
            pairs.append(self.file(f"{role}_{name}", content_of(points)))
        return self.run_to_files(*pairs, *FAST)[0]

    def test_all_encodings_give_the_same_draws(self):
        expected = self.samples_of("a.pcd", pcd_bytes)
        self.assertEqual(len(expected.splitlines()), 61)
        double = [(name, "d") for name, _ in XYZ]
        colour = XYZ + [("red", "B"), ("green", "B"), ("blue", "B")]

        def ascii_without(points, *lines):
            content = pcd_bytes(points, encoding="ascii").split(b"\n")
            return b"\n".join(line for line in content if not line.startswith(lines))

        variants = {
            "ascii.pcd": lambda p: pcd_bytes(p, encoding="ascii"),
            "compressed.pcd": lambda p: pcd_bytes(p, encoding="binary_compressed"),
            "CAPITAL.PCD": pcd_bytes,
            "double.pcd": lambda p: pcd_bytes(p, double),
            "double_ascii.pcd": lambda p: pcd_bytes(p, double, "ascii"),
            "windows.pcd": lambda p: pcd_bytes(p, encoding="ascii").replace(b"\n", b"\r\n"),
            "padded.pcd": lambda p: pcd_bytes(p) + bytes(4096),
            "organised.pcd": lambda p: pcd_bytes(p, height=10),
            "moved_viewpoint.pcd": lambda p: pcd_bytes(p, viewpoint="1 2 3 0 1 0 0"),
            "no_count.pcd": lambda p: ascii_without(p, b"COUNT"),
            "no_size.pcd": lambda p: ascii_without(p, b"WIDTH", b"HEIGHT", b"VIEWPOINT"),
            "columns.pcd": lambda p: pcd_bytes(p).replace(b"FIELDS", b"COLUMNS"),
            "ascii.ply": ply_bytes,
            "little.ply": lambda p: ply_bytes(p, encoding="binary_little_endian"),
            "big.ply": lambda p: ply_bytes(p, encoding="binary_big_endian"),
            "double.ply": lambda p: ply_bytes(p, double, "binary_little_endian"),
            "colour.ply": lambda p: ply_bytes([q + (1, 2, 3) for q in p], colour),
        }
        for name, content_of in variants.items():
            with self.subTest(file=name):
                self.assertEqual(self.samples_of(name, content_of), expected)

    def test_points_that_are_not_finite_are_skipped(self):
        nan = math.nan
        with_nan = lambda p: pcd_bytes([(nan, nan, nan)] + p[:9] + [(1, math.inf, 1)] + p[9:])
        self.assertEqual(self.samples_of("n.pcd", with_nan), self.samples_of("a.pcd", pcd_bytes))


class DegenerateClouds(ToolTest):
    """Little or nothing to register: an answer, no crash, and JSON that is JSON."""

    def test_far_from_the_origin(self):
        path = self.pcd("cloud.pcd", np.add(POINTS, 1e6))
        result = run(path, path, "--json", *FAST)
        self.assert_ran(result)
        self.assertEqual(strict_json(result.stdout)["source"]["finite_points"], 50)
        self.assertIn("kept to 0.062 m", result.stderr)

    def test_returns_without_a_range(self):
        without = self.pcd("without.pcd", POINTS)
        path = self.pcd("zeros.pcd", [*POINTS, (0, 0, 0), (-0.0, 0, 0)])
        result = run(without, path, *FAST)
        self.assert_ran(result)
        self.assertIn("zeros.pcd: note: 2 points are at 0 0 0", result.stderr)
        self.assertNotIn("without.pcd: note", result.stderr)
        self.assertNotIn("0 0 0", run(path, path, *FAST, "--quiet").stderr)

    def test_hardly_in_metres(self):
        path = self.pcd("cloud.pcd", np.multiply(POINTS, 6000))
        result = run(path, path, *FAST)
        self.assert_ran(result)
        self.assertRegex(result.stderr, r"cloud.pcd: note: the points are [0-9]+ m from .* -scale")
        for words in (["--prior-variance", "100"], ["--quiet"]):
            self.assertNotIn("-scale", run(path, path, *FAST, *words).stderr)

    def test_coordinates_too_large_to_register(self):
        path = self.pcd("huge.pcd", np.multiply(POINTS, 1e30))
        result = run(path, path, *FAST)
        self.assertEqual(result.returncode, 1)
        self.assertIn("finite coordinates below 1e18 m", " ".join(result.stdout.split()))


class CommittedScans(ToolTest):
    def test_every_pair_is_registered(self):
        folders = sorted(path.parent for path in DATA.glob("*/source.pcd"))
        self.assertEqual(len(folders), 7)
        for folder in folders:
            with self.subTest(pair=folder.name):
                self.check(folder)

    def check(self, folder):
        """With a small step the posterior holds the truth within four deviations; where
        the translation is observable, ICP halves the error of the guess at least."""
        pair = (folder / "source.pcd", folder / "target.pcd")
        _, document = self.run_to_files(*pair, "--preset", "paper", "--step-size", "1e-5")
        self.assertEqual(document["source"]["points"], len(read_pcd(pair[0])[1]))
        self.assertGreater(document["posterior"]["draws"], 0)
        self.assert_holds_truth(document, folder)
        if folder.name not in ("table_top", "corridor"):
            found = [row[3] for row in document["icp"]["T_target_source"][:3]]
            truth = true_translation(folder)
            self.assertLess(math.dist(found, truth), math.hypot(*truth) / 2)


@unittest.skipUnless(
    os.environ.get("PCL_BAYESIAN_ICP_REAL_DATA"), "PCL_BAYESIAN_ICP_REAL_DATA is not set"
)
class RealScans(ToolTest):
    def test_every_pair_is_registered_from_its_guess(self):
        root = pathlib.Path(os.environ["PCL_BAYESIAN_ICP_REAL_DATA"])
        guesses = sorted(root.glob("*/T_init.txt"))
        self.assertTrue(guesses, f"no scans in {root}")
        for guess in guesses:
            with self.subTest(pair=guess.parent.name):
                pair = [guess.parent / f"{role}.pcd" for role in ("source", "target")]
                options = ["--guess", guess, "-i", "10"]
                samples, document = self.run_to_files(*pair, *options)
                self.assertEqual(len(samples.splitlines()), document["posterior"]["draws"] + 1)
                self.assertGreater(document["posterior"]["draws"], 0)
