"""report.html: what is in it, that it needs nothing else, and that a browser shows it."""

import os
import pathlib
import re
import subprocess
import unittest

from cli_tool import CALIBRATED, FAST, TOOL, ToolTest, run, scans, strict_json
from html_page import Browser, Page, find_browser

NAMES = ["x", "y", "z", "roll", "pitch", "yaw"]
CLOUDS = [f"clouds-{when}-{view}" for when in ("before", "after") for view in ("above", "side")]
PAIRS = "pairs-of-coordinates"
FIGURES = (
    CLOUDS
    + [f"density-{name}" for name in NAMES]
    + [PAIRS]
    + [f"chains-{name}" for name in NAMES]
)
MAX_SIZE = 2_000_000


class ReportTest(ToolTest):
    writing = ["--quiet"]

    def report_of(self, *arguments):
        """The file and its text of a run with -o."""
        self.run_to_files(*arguments)
        file = self.folder / "output" / "report.html"
        return file, file.read_text(encoding="utf-8")

    def verdict_of(self, text):
        return re.search('<div class="box (.*?)</div>', text, re.S).group(1)


class ReportPage(ReportTest):
    def check_figures(self, page, expected):
        pictures = page.all("svg")
        self.assertEqual(sorted(svg["id"] for svg in pictures), sorted(expected))
        self.assertEqual(len(page.all("figure")), len(expected))
        self.assertEqual(len(page.all("figcaption")), len(expected))
        for svg in pictures:
            self.assertEqual(svg["role"], "img")
            self.assertRegex(svg["viewbox"], r"^0 0 \d+ \d+$")
            for name in svg["aria-labelledby"].split():
                self.assertTrue(page.texts["#" + name].strip(), name)

    def check_needs_nothing_else(self, page, text):
        names = {tag for tag, _ in page.tags}
        self.assertFalse(names & {"script", "iframe", "object", "embed", "img", "image"})
        for tag, attributes in page.tags:
            for name, value in attributes.items():
                self.assertFalse(name.startswith("on"), (tag, name))
                if name in ("href", "src", "xlink:href", "action"):
                    self.assertRegex(value, "^(#|data:,$)", (tag, name))
        self.assertNotIn("@import", text)
        self.assertFalse(re.search(r"url\((?!#)", text))

    def test_all_figures_and_nothing_from_elsewhere(self):
        for pair, options, more in (
            (scans("mug"), CALIBRATED, ["directions"]),
            (self.small_pair(), FAST, []),
            (self.small_pair(), ["--preset=paper", "--chains=1", "--samples=1"], []),
        ):
            with self.subTest(options=options):
                _, text = self.report_of(*pair, *options)
                page = Page(text)
                self.check_figures(page, FIGURES + more)
                self.check_needs_nothing_else(page, text)
                self.assertEqual(len(page.ids()), len(set(page.ids())))
                self.assertLess(len(text.encode()), MAX_SIZE)

    def axis_names(self, text, figure):
        """The texts with a unit of a figure."""
        drawing = re.search(rf'<svg[^>]*id="{figure}".*?</svg>', text, re.S).group(0)
        return re.findall(r"<text[^>]*>\s*(?:<tspan[^>]*>)?([^<]*\[[^<]*\])", drawing)

    def test_all_axes_have_names(self):
        _, text = self.report_of(*scans("table"), *CALIBRATED)
        names = [name.split()[0] for name in self.axis_names(text, PAIRS)]
        self.assertEqual(sorted(names), sorted(NAMES[1:] + NAMES[:5]))
        for name in NAMES:
            self.assertIn(f"{name} − mean", " ".join(self.axis_names(text, f"chains-{name}")))

    def test_clouds_far_from_the_origin_are_drawn_about_round_numbers(self):
        clouds = []
        for cloud in scans("corridor"):
            clouds.append(self.folder / f"far_{pathlib.Path(cloud).name}")
            move = [f"{TOOL}_transform", cloud, clouds[-1], "--pose=20000,200000,-3000,0,0,0"]
            subprocess.run(move, check=True, stderr=subprocess.DEVNULL)
        _, text = self.report_of(*clouds, *FAST)
        for figure, names in zip(CLOUDS, (["x - 20000 [m]", "y - 200000 [m]"], ["y - 200000 [m]", "z + 3000 [m]"])):
            self.assertEqual(sorted(self.axis_names(text, figure)), names)

    def test_head_is_fit_for_phones_and_screen_readers(self):
        page = Page(self.report_of(*self.small_pair(), *FAST)[1])
        self.assertEqual(page.all("html"), [{"lang": "en"}])
        self.assertIn({"charset": "utf-8"}, page.all("meta"))
        viewport = {"name": "viewport", "content": "width=device-width, initial-scale=1"}
        self.assertIn(viewport, page.all("meta"))
        self.assertIn("source.pcd registered to", page.texts["title"])
        self.assertEqual(len(page.all("h1")), 1)

    def test_table_has_the_numbers_of_posterior_json(self):
        self.run_to_files(*self.small_pair(), *FAST)
        output = self.folder / "output"
        document = strict_json((output / "posterior.json").read_text())
        text = (output / "report.html").read_text()
        for coordinate in document["posterior"]["coordinates"]:
            label = f"{coordinate['name']} [{coordinate['unit']}]"
            row = re.search(re.escape(f'<th scope="row">{label}</th>') + "(.*?)</tr>", text)
            cells = re.findall("<td>(.*?)</td>", row.group(1))
            mean = document["posterior"]["mean"][f"{coordinate['name']}_{coordinate['unit']}"]
            keys = ["standard_deviation", "quantile_2.5_percent", "quantile_97.5_percent"]
            for cell, value in zip(cells, [mean, *map(coordinate.get, keys)]):
                self.assertAlmostEqual(float(cell), value, delta=0.6e-6)
            self.assertAlmostEqual(float(cells[4]), coordinate["rhat"], delta=0.6e-3)

    def test_what_not_to_trust_comes_first(self):
        _, text = self.report_of(*self.small_pair(), *FAST)
        verdict = self.verdict_of(text)
        self.assertTrue(verdict.startswith('bad"'), verdict)
        self.assertIn("Do not trust the ±: the chains have not mixed", verdict)
        self.assertLess(text.index(verdict), text.index("<h2>"))

    def test_odd_file_names_are_shown_as_they_are(self):
        source, target = self.small_pair()
        odd = source.with_name("<b>&\"amp;'$(x)'.pcd")
        source.rename(odd)
        not_utf8 = os.fsencode(target.parent) + b"/\xff.pcd"
        os.rename(target, not_utf8)
        page = Page(self.report_of(odd, os.fsdecode(not_utf8), *FAST)[1])
        self.assertIn(f"{odd.name} registered to", page.texts["h1"])
        self.assertIn("/\ufffd.pcd", page.texts["h1"])
        self.assertFalse(page.all("b"))

    def test_the_command_repeats_the_run(self):
        source, target = self.small_pair()
        odd = source.with_name("it's & odd.pcd")
        source.rename(odd)
        page = Page(self.report_of(odd, target, *FAST, "--seed=5")[1])
        samples = (self.folder / "output" / "samples.csv").read_text()
        command = page.texts["pre"].splitlines()[0]
        (self.folder / "output" / "samples.csv").unlink()
        shell = command.split("{", maxsplit=1)[0]
        result = subprocess.run(["sh", "-c", shell], capture_output=True, check=False)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual((self.folder / "output" / "samples.csv").read_text(), samples)

    def test_motions_that_the_clouds_do_not_hold(self):
        """A can looks the same turned about its axis."""
        # With one seed of ten the noise of the clouds holds the turn a little.
        _, text = self.report_of(*scans("can"), *CALIBRATED)
        verdict = self.verdict_of(text)
        self.assertIn("1 of 6 motions cannot be observed well", verdict)
        self.assertIn("held by the prior alone: rotation about", verdict)

    def test_a_result_of_icp_that_the_posterior_excludes_is_a_warning(self):
        # Without pairs within 0.1 mm, ICP stays at the guess.
        pattern = '<div class="box caution">.*?Use the final transformation with care(.*?)</div>'
        _, text = self.report_of(*scans("mug"), "-d0.0001")
        self.assertTrue(self.verdict_of(text).startswith('good"'))
        self.assertIn("posterior excludes it", re.search(pattern, text, re.S).group(1))
        _, text = self.report_of(*scans("mug"), "-d0.0001", "--mean")
        self.assertNotIn("with care", text)


class ReportOrNot(ReportTest):
    OTHERS = ["aligned.pcd", "posterior.json", "samples.csv"]

    def written(self):
        return sorted(path.name for path in (self.folder / "output").iterdir())

    def test_without_gnuplot_all_else_is_written(self):
        pair = self.small_pair()
        self.run_to_files(*pair, *FAST)
        self.assertIn("report.html", self.written())
        environment = {**os.environ, "PATH": str(self.folder)}
        output = self.folder / "output"
        result = run(*pair, *FAST, "--json", "-o", output, env=environment)
        self.assert_ran(result)
        first, *_ = result.stderr.splitlines()
        self.assertRegex(first, "^pcl_bayesian_icp: report.html is not written: gnuplot")
        self.assertIn("package gnuplot-nox", first)
        # The one of the run before does not belong to these files.
        self.assertEqual(self.written(), self.OTHERS)

    def test_gnuplot_that_fails_is_no_obstacle_either(self):
        program = self.file("gnuplot", '#!/bin/sh\n[ "$1" = --version ]\n')
        program.chmod(0o755)
        environment = {**os.environ, "PATH": f"{self.folder}:{os.environ['PATH']}"}
        result = run(*self.small_pair(), *FAST, "-o", self.folder / "output", env=environment)
        self.assert_ran(result)
        self.assertIn("report.html is not written: gnuplot: could not draw", result.stderr)
        self.assertEqual(self.written(), self.OTHERS)

    def test_no_report(self):
        pair = self.small_pair()
        self.run_to_files(*pair, *FAST)
        self.run_to_files(*pair, *FAST, "--no-report")
        self.assertEqual(self.written(), self.OTHERS)
        self.assert_refused(2, run(*pair, *FAST, "--no-report"), "--no-report", "--output")

    def test_users_settings_of_gnuplot_do_no_harm(self):
        self.file(".gnuplot", "set terminal dumb\nset datafile separator ','\nexit\n")
        environment = {**os.environ, "HOME": str(self.folder)}
        output = self.folder / "output"
        result = run(*self.small_pair(), *FAST, "-o", output, "--quiet", env=environment)
        self.assert_ran(result)
        self.assertEqual(self.written(), sorted(self.OTHERS + ["report.html"]))


def is_blue(red, green, blue):
    return blue > red + 60


def is_orange(red, green, blue):
    return red > blue + 60


@unittest.skipUnless(find_browser(), "chromium is not installed")
class ReportInBrowser(ReportTest):
    DESKTOP, PHONE = 1200, 400

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        holder = ReportTest("report_of")
        holder.setUp()
        cls.addClassCleanup(holder.doCleanups)
        cls.file_of_report, _ = holder.report_of(*scans("mug"), *CALIBRATED)
        cls.browser = Browser()
        cls.figures = sorted(FIGURES + ["directions"])

    def test_nothing_on_the_console(self):
        page = self.file("bad.html", "<script>console.error('seen')</script>")
        self.assertIn("seen", "".join(self.browser.console(page)))
        self.assertEqual(self.browser.console(self.file_of_report), [])

    def test_fits_a_phone_and_a_desk(self):
        wide = self.file("wide.html", "<div style='width:450px'>wide</div>")
        self.assertGreater(self.browser.layout(wide, self.PHONE)["scroll_width"], self.PHONE)
        for width in (self.PHONE, self.DESKTOP):
            with self.subTest(width=width):
                layout = self.browser.layout(self.file_of_report, width)
                self.assertLessEqual(layout["scroll_width"], width)
                self.assertEqual(sorted(layout["figures"]), self.figures)
                for name, (left, _, figure_width, height) in layout["figures"].items():
                    self.assertGreater(figure_width, 250, name)
                    self.assertGreater(height, 100, name)
                    if name != PAIRS:  # scrolls by itself on a phone
                        self.assertLessEqual(left + figure_width, width, name)

    def test_every_figure_has_its_colours(self):
        layout = self.browser.layout(self.file_of_report, self.DESKTOP)
        scale = 0.5
        height = int(layout["height"]) + 50
        picture = self.browser.picture(self.file_of_report, self.DESKTOP, height, scale)
        self.assertEqual(picture.width, self.DESKTOP * scale)
        for name, rectangle in layout["figures"].items():
            left, top, figure_width, figure_height = (int(scale * n) for n in rectangle)
            figure = picture.crop((left, top, left + figure_width, top + figure_height))
            two_colours = name in CLOUDS or name.startswith("chains") or name == PAIRS
            for colour in (is_blue, is_orange) if two_colours else (is_blue,):
                count = sum(colour(*pixel) for pixel in figure.getdata())
                self.assertGreater(count, 20, (name, colour.__name__))
