"""The viewer: pictures of every mode without a window, the window, and what is refused.

Pictures need an X server; where Xvfb is missing their tests are skipped and say so."""

import colorsys
import math
import os
import shutil
import signal
import unittest

import numpy as np
import PIL.Image

from cli_tool import CALIBRATED, DATA, FAST, ToolTest, run, scans
from cloud_files import box_surface
from faults import VIEWER, call, start_x_server

WIDTH, HEIGHT = 480, 360
SMALL = (300, 200)
BLACK, WHITE = (0, 0, 0), (255, 255, 255)


def environment(display):
    others = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    return others if display is None else {**others, "DISPLAY": display}


def view(*arguments, display=None):
    return call(VIEWER, *arguments, env=environment(display))


class Picture:
    def __init__(self, path):
        self.image = PIL.Image.open(path).convert("RGB")
        pixels = np.asarray(self.image).reshape(-1, 3)
        codes, numbers = np.unique(pixels @ [1 << 16, 1 << 8, 1], return_counts=True)
        parts = [(codes >> shift & 255).tolist() for shift in (16, 8, 0)]
        self.colors = dict(zip(zip(*parts), numbers.tolist()))

    def count(self, color):
        return self.colors.get(color, 0)

    def count_hues(self, lowest, highest, saturation=0.3):
        """Pixels of these hues [degrees] that are as saturated at least."""
        total = 0
        for color, n in self.colors.items():
            hue, found, _ = colorsys.rgb_to_hsv(*(part / 255 for part in color))
            total += n if lowest <= 360 * hue <= highest and found >= saturation else 0
        return total

    def rows_with(self, color):
        lines = (self.part(0, y, self.image.width, 1) for y in range(self.image.height))
        return [y for y, line in enumerate(lines) if color in line.getdata()]

    def count_grey(self, top, bottom):
        """Pixels of a bright grey or white between these rows."""
        part = self.part(0, top, self.image.width, bottom - top)
        return sum(min(color) > 120 and max(color) - min(color) < 20 for color in part.getdata())

    def brightness(self):
        return sum(n * sum(color) for color, n in self.colors.items())

    def part(self, left, top, width, height):
        return self.image.crop((left, top, left + width, top + height))


class ViewerTest(ToolTest):
    program = "pcl_bayesian_icp_viewer"

    def refuse(self, exit_code, *arguments, parts=()):
        self.assert_refused(exit_code, view(*arguments), *parts)


class ScreenTest(ViewerTest):
    """Has an X server, and the posteriors of two scans."""

    @classmethod
    def setUpClass(cls):
        cls.display = start_x_server(cls)
        if cls.display is None:
            raise unittest.SkipTest("Xvfb is not here (see scripts/bootstrap)")
        cls.results = cls.holder().folder
        for name in ("can", "mug"):
            result = run(*scans(name), *CALIBRATED, "-o", cls.results / name, "--quiet")
            assert result.returncode == 0, result.stderr

    def setUp(self):
        super().setUp()
        self.path = self.folder / "picture.png"

    def draw(self, *arguments, size=(WIDTH, HEIGHT)):
        """The completed process of --screenshot."""
        words = ["--screenshot", self.path, "--size", f"{size[0]}x{size[1]}"]
        return view(*arguments, *words, display=self.display)

    def picture(self, *arguments, size=(WIDTH, HEIGHT)):
        result = self.draw(*arguments, size=size)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(sorted(self.folder.iterdir()), [self.path])
        picture = Picture(self.path)
        self.assertEqual(picture.image.size, size)
        return picture

    def assert_same_pixels(self, first, second):
        self.assertTrue(first.image == second.image, "the pictures differ")

    def saved(self, name, *arguments, **options):
        return self.picture(self.results / name / "posterior.json", *arguments, **options)


class Pictures(ScreenTest):
    def test_deviations_of_a_can_are_those_of_a_turn(self):
        """Its wall turns by 20 degrees at 33 mm from the axis: 12 of the bar's 15 mm, the
        bright green of viridis. The middle of its lid stays: dark violet."""
        with_bar = self.saved("can", "--show", "deviation")
        self.assertGreater(with_bar.count_hues(75, 140), 3000)
        self.assertGreater(with_bar.count_hues(250, 300), 50)
        # The mug's deviations are nearly the same everywhere.
        self.assertGreater(self.saved("mug", "--show", "deviation").count_hues(100, 180), 3000)

    def test_clouds_have_the_users_colours_and_fill_the_picture(self):
        colors = ["-fc", "255,0,0", "-fc", "0,1,0", "-fc", "0,0,255", "-ps", "4", "-ps", "4"]
        for layers, expected in (
            ("source", [(255, 0, 0)]),
            ("target", [(0, 255, 0)]),
            ("aligned", [(0, 0, 255)]),
            ("source,target,aligned", [(255, 0, 0), (0, 255, 0), (0, 0, 255)]),
        ):
            picture = self.saved("mug", "--show", layers, *colors)
            for color in [(255, 0, 0), (0, 255, 0), (0, 0, 255)]:
                found = picture.count(color)
                (self.assertGreater if color in expected else self.assertLess)(found, 500)
        rows = picture.rows_with((0, 255, 0))
        self.assertGreater(max(rows) - min(rows), 0.5 * HEIGHT)

    def test_point_size_opacity_and_background(self):
        def brightness(*arguments):
            return self.saved("mug", "--show", "target", *arguments).brightness()

        first = ["-fc", "1,1,1", "-fc", "1,1,1"]
        small = brightness(*first, "-ps", "1", "-ps", "1")
        large = brightness(*first, "-ps", "1", "-ps", "5")
        self.assertGreater(large, 2 * small)
        faint = brightness(*first, "-ps", "1", "-ps", "5", "-opaque", "1", "-opaque", "0.2")
        self.assertLess(faint, 0.6 * large)
        picture = self.saved("mug", "-bc", "0,128,255")
        self.assertEqual(picture.image.getpixel((0, HEIGHT // 2)), (0, 128, 255))
        self.assertEqual(self.saved("mug").image.getpixel((0, HEIGHT // 2)), (0, 0, 0))

    def test_draws_ellipsoid_and_cones(self):
        draws = self.saved("mug", "--show", "draws")
        self.assertGreater(draws.count_hues(45, 65), 2000)
        one = self.saved("mug", "--show", "draws", "--draws", "1", "--magnify", "1")
        self.assertFalse(one.image == draws.image)
        small = self.saved("mug", "--show", "position", "--magnify", "40")
        large = self.saved("mug", "--show", "position", "--magnify", "120")
        self.assertGreater(large.count_hues(300, 340), 2 * small.count_hues(300, 340))
        cones = self.saved("mug", "--show", "rotation")
        for lowest, highest in ((0, 10), (110, 130), (230, 250)):
            self.assertGreater(cones.count_hues(lowest, highest, 0.7), 300)

    def test_axes_have_names(self):
        for words in (["--show", "rotation"], ["--show", "position", "-ax", "0.05"]):
            self.assertGreater(self.saved("mug", *words).count_grey(56, 310), 90)

    def test_bar_and_text_keep_off_the_border(self):
        for words, size in ((["--show", "all"], (300, 1000)), (["-multiview", "1"], (600, 400))):
            picture = self.saved("can", *words, size=size)
            width, height = size
            border = picture.part(width - 2, 0, 2, height)
            self.assertEqual(set(border.getdata()), {BLACK})
            bar = picture.part(width - 80, 0, 78, height)
            self.assertGreater(sum(pixel != BLACK for pixel in bar.getdata()), 1000)

    def test_legend_is_left_out_where_it_has_no_room(self):
        words = ["--show", "draws,position,rotation"]
        for size, has_legend in (((300, 200), False), ((300, 500), True)):
            top = self.saved("mug", *words, size=size).part(0, 0, 60, 16)
            self.assertEqual(set(top.getdata()) != {BLACK}, has_legend)

    def test_multiview_has_four_pictures(self):
        picture = self.saved("mug", "-multiview", "1", size=(640, 480))
        quadrants = [picture.part(x, y, 320, 240) for y in (0, 240) for x in (0, 320)]
        for quadrant in quadrants:
            self.assertGreater(sum(pixel != (0, 0, 0) for pixel in quadrant.getdata()), 2000)
        self.assertEqual(len({quadrant.tobytes() for quadrant in quadrants}), 4)

    def test_axes_and_camera(self):
        plain = self.saved("mug", "--show", "target")
        axes = self.saved("mug", "--show", "target", "-ax", "0.05")
        self.assertGreater(axes.count_hues(0, 10, 0.7), plain.count_hues(0, 10, 0.7) + 50)
        # Clipping range / focal point / position / up / angle / size / place
        away = "0.01,10/0,0,2/0,0,1/0,1,0/0.5236/480,360/0,0"
        picture = self.saved("mug", "--show", "deviation", "-cam", away)
        self.assertLess(picture.count_hues(100, 180), WIDTH * HEIGHT // 40)

    def test_pictures_repeat(self):
        first, second = (self.saved("can", "--show", "all") for _ in range(2))
        self.assert_same_pixels(first, second)

    def test_registers_what_is_not_saved(self):
        words = [*CALIBRATED, "--show", "deviation", "--quiet"]
        registered = self.picture(*scans("mug"), *words)
        self.assert_same_pixels(registered, self.saved("mug", "--show", "deviation"))

    def test_live_shows_every_chain(self):
        live = [*scans("mug"), *CALIBRATED, "--live", "--chains"]
        one, two = (self.picture(*live, chains) for chains in ("1", "2"))
        for picture in (one, two):
            self.assertGreater(picture.count_hues(35, 48, 0.7), 500)
        # The second chain is green, and makes olive of the first one's orange. How much
        # of it is green alone is chance.
        self.assertLess(one.count_hues(60, 170), 100)
        self.assertGreater(two.count_hues(60, 170), 3000)

    def test_what_cannot_be_trusted_is_shown_and_said(self):
        few = ["--samples", "40", "--chains", "2"]
        result = self.draw(*scans("mug"), *CALIBRATED, *few, size=SMALL)
        self.assertEqual(result.returncode, 1)
        self.assertIn("not mixed: ", result.stderr)
        self.assertEqual(Picture(self.path).image.width, SMALL[0])

    def test_clouds_that_a_posterior_names_may_have_moved(self):
        shutil.copytree(self.results / "mug", self.results / "moved")
        moved = self.results / "moved" / "posterior.json"
        moved.write_text(moved.read_text().replace(str(DATA / "mug"), "/nowhere"))
        self.assert_refused(3, self.draw(moved), "/nowhere/source.pcd", "no such file")
        shown = self.picture(moved, *scans("mug"), "--show", "draws")
        self.assert_same_pixels(shown, self.saved("mug", "--show", "draws"))

    def test_relative_names_are_also_of_the_folder_of_the_posterior(self):
        self.small_pair()
        words = ["source.pcd", "target.pcd", *FAST, "-o", ".", "--quiet"]
        self.assert_ran(run(*words, cwd=self.folder))
        self.assert_ran(self.draw(self.folder / "posterior.json"))
        self.assertTrue(self.path.exists())

    def view_mixed(self, samples, *arguments):
        """The mug's posterior.json beside other draws; standard error."""
        self.file("samples.csv", samples)
        saved = shutil.copy(self.results / "mug" / "posterior.json", self.folder)
        result = self.draw(saved, *arguments)
        self.assertEqual(result.returncode, 1)
        return result.stderr

    def test_draws_of_another_run_are_told_and_drawn(self):
        green = ["--show", "target", "-fc", "1,1,1", "-fc", "0,1,0"]
        usual = self.saved("mug", *green).rows_with(WHITE)
        samples, _ = self.run_to_files(*scans("mug"), *CALIBRATED, "--seed", "2")
        errors = self.view_mixed(samples, *green)
        self.assertIn("samples.csv has another mean or other deviations", errors)
        picture = Picture(self.path)
        warned = picture.rows_with(WHITE)
        # The text is below the target, however many lines it has.
        self.assertGreater(min(warned), max(picture.rows_with((0, 255, 0))))
        self.assertGreater(len(warned), len(usual))

    def test_files_that_do_not_belong_together_are_told(self):
        samples = (self.results / "mug" / "samples.csv").read_text()
        errors = self.view_mixed("\n".join(samples.splitlines()[:100]), *scans("can"))
        for part in ("the source has ", "the target has ", "samples.csv has 99 in place of the"):
            self.assertIn(part, errors)

    def draw_result(self, points, *options):
        """As draw(), of a cloud registered to itself."""
        cloud = self.pcd("cloud.pcd", points)
        self.assert_ran(run(cloud, cloud, *options, "-o", self.output, "--no-report"))
        return self.draw(self.output / "posterior.json", size=SMALL)

    def test_points_that_are_not_finite_count(self):
        exact = ["--preset=exact", "--sigma=0.01"]
        result = self.draw_result([*box_surface(), (math.nan, 0, 0)], *exact)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("in place of", result.stderr)

    def test_draws_of_the_same_run_are_not_told(self):
        single = ["--preset=paper", "--step-size=1e-6", "--samples=1", "--chains=1"]
        stein = ["--preset=exact", "--sigma=0.01", "--steps=stein-newton"]
        for options in (FAST, [*FAST, "--normalize-cloud"], single, stein):
            self.assertNotIn("samples.csv", self.draw_result(box_surface(), *options).stderr)

    def test_run_without_draws_is_shown(self):
        self.assert_ran(self.draw_result(box_surface(), "--preset=paper", "--step-size=10"))
        self.assertTrue(self.path.exists())

    def test_bad_camera(self):
        result = self.draw(self.results / "mug" / "posterior.json", "-cam", "1/2")
        self.assert_refused(2, result, "-cam", "'1/2'")


class WindowOnScreen(ScreenTest):
    """The window itself, until Ctrl-C or `kill`."""

    def interrupt(self, *arguments, by=signal.SIGINT):
        process = self.start(VIEWER, *arguments, env=environment(self.display))
        self.assertIn("press h", process.stdout.readline())
        process.send_signal(by)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        return errors

    def test_saved_posterior(self):
        self.assertEqual(self.interrupt(self.results / "can" / "posterior.json"), "")

    def test_live(self):
        endless = ["--samples", "1000000", "--live"]
        self.interrupt(*scans("mug"), *CALIBRATED, *endless, by=signal.SIGTERM)


class ViewerUsage(ViewerTest):
    def test_help_and_version(self):
        text = view("--help").stdout
        for word in ("-bc", "-fc", "-ps", "-opaque", "-ax", "-cam", "-multiview", "--show"):
            self.assertIn("-" + word.lstrip("-") + " ", text)
        for word in ("deviation", "rotation", "--preset", "--live", "--screenshot", "600x400", "Exit codes"):
            self.assertIn(word, text)
        self.assertRegex(text, r"Excludes\s+--show")
        self.assertRegex(view("--version").stdout, r"^pcl_bayesian_icp_viewer \d+\.\d+\.\d+\n$")

    def test_bad_values(self):
        named = """-bc 1,2,256; -ps 65; -opaque 1.1; -ax -1; -multiview 2; --draws 0; --magnify 0;
            --reference middle; --size 800; --size 299x200; --size 300x199; --preset best;
            --nonsense"""
        cases = [(words.split(), words.split()[0]) for words in named.split(";")]
        cases += [
            (["-bc", "1,2"], "-bc", "'1,2'"),
            (["-fc", "red"], "-fc", "'red'"),
            (["-ps", "0"], "-ps", "'0'"),
            (["-ps", "1", "-ps", "1", "-ps", "1", "-ps", "1"], "-ps", "three"),
            (["--show", "target,nothing"], "--show", "'nothing'"),
            (["--show", "target,target"], "--show", "'target'"),
            (["--show", "target", "-multiview", "1"], "--show", "-multiview"),
            (["--size", "10x10"], "--size", "300x200"),
            (["--size", "599x400", "-multiview", "1"], "--size", "600x400"),
            (["--size", "600x399", "-multiview", "1"], "--size", "600x400"),
            (["--screenshot="], "--screenshot"),
            (["--screenshot", "picture.jpg"], "--screenshot", "'picture.jpg' does not end in .png"),
        ]
        self.assert_each_refused(2, [VIEWER, "a.pcd", "b.pcd"], cases)

    def test_files_are_counted(self):
        for files in ([], ["a.pcd"], ["a.pcd", "b.pcd", "c.pcd"], ["p.json", "a.pcd"]):
            self.refuse(2, *files, parts=["a source and a target cloud"])
        self.refuse(2, "p.json", "q.json", parts=["q.json"])

    def test_a_saved_posterior_is_not_registered_again(self):
        for word in ("--live", "--sigma=1", "--preset=exact", "--config=c.json"):
            self.refuse(2, "p.json", word, parts=[word.split("=")[0], "no effect"])

    def test_bad_files(self):
        self.refuse(3, "no.pcd", "no.pcd", parts=["no.pcd: no such file"])
        self.refuse(3, "no.json", parts=["no.json: no such file"])
        broken = self.file("broken.json", "{}")
        self.refuse(3, broken, parts=[broken])
        blocked = self.file("file", "") / "picture.png"
        self.refuse(3, *scans("mug"), "--screenshot", blocked, parts=[self.folder / "file"])

    def test_without_a_display(self):
        self.refuse(1, *scans("mug"), parts=["no X display", "xvfb-run"])
        words = ["--screenshot", self.folder / "picture.png"]
        self.assert_refused(1, view(*scans("mug"), *words, display=":98765"), "xvfb-run")
        self.assertEqual(list(self.folder.iterdir()), [])
