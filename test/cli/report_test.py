"""report.html: what is in it, that it needs nothing else, and that a browser shows it."""

import os
import re
import unittest

import numpy as np

from cli_tool import CALIBRATED, FAST, WITHOUT_REPORT, WRITTEN, ToolTest, call, run, scans
from faults import TRANSFORM
from html_page import Browser, Page, find_browser

NAMES = ["x", "y", "z", "roll", "pitch", "yaw"]
CLOUDS = [f"clouds-{when}-{view}" for when in ("before", "after") for view in ("above", "side")]
PAIRS = "pairs-of-coordinates"
FIGURES = [*CLOUDS, PAIRS]
FIGURES += [f"{kind}-{name}" for kind in ("density", "chains") for name in NAMES]
MAX_SIZE = 2_000_000


class ReportTest(ToolTest):
    writing = ["--quiet"]

    def report_of(self, *arguments):
        """The text of a run with -o."""
        self.run_to_files(*arguments)
        return (self.output / "report.html").read_text(encoding="utf-8")

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
                text = self.report_of(*pair, *options)
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
        text = self.report_of(*scans("table"), *CALIBRATED)
        names = [name.split()[0] for name in self.axis_names(text, PAIRS)]
        self.assertEqual(sorted(names), sorted(NAMES[1:] + NAMES[:5]))
        for name in NAMES:
            self.assertIn(f"{name} − mean", " ".join(self.axis_names(text, f"chains-{name}")))

    def test_clouds_far_from_the_origin_are_drawn_about_round_numbers(self):
        clouds = []
        for cloud in scans("corridor"):
            clouds.append(self.folder / f"far_{cloud.name}")
            moved = call(TRANSFORM, cloud, clouds[-1], "--pose=20000,200000,-3000,0,0,0")
            self.assertEqual(moved.returncode, 0, moved.stderr)
        text = self.report_of(*clouds, *FAST)
        for figure, names in zip(CLOUDS, (["x - 20000 [m]", "y - 200000 [m]"], ["y - 200000 [m]", "z + 3000 [m]"])):
            self.assertEqual(sorted(self.axis_names(text, figure)), names)

    def test_head_is_fit_for_phones_and_screen_readers(self):
        page = Page(self.report_of(*self.small_pair(), *FAST))
        self.assertEqual(page.all("html"), [{"lang": "en"}])
        self.assertIn({"charset": "utf-8"}, page.all("meta"))
        viewport = {"name": "viewport", "content": "width=device-width, initial-scale=1"}
        self.assertIn(viewport, page.all("meta"))
        self.assertIn("source.pcd registered to", page.texts["title"])
        self.assertEqual(len(page.all("h1")), 1)

    def test_table_has_the_numbers_of_posterior_json(self):
        _, document = self.run_to_files(*self.small_pair(), *FAST)
        text = (self.output / "report.html").read_text()
        rows = re.findall('<th scope="row">(.*?)</th>(.*?)</tr>', text)
        rows = {label: re.findall("<td>(.*?)</td>", cells) for label, cells in rows}
        self.assert_rows(document, rows)

    def test_what_not_to_trust_comes_first(self):
        text = self.report_of(*self.small_pair(), *FAST)
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
        page = Page(self.report_of(odd, os.fsdecode(not_utf8), *FAST))
        self.assertIn(f"{odd.name} registered to", page.texts["h1"])
        self.assertIn("/\ufffd.pcd", page.texts["h1"])
        self.assertFalse(page.all("b"))

    def test_the_command_repeats_the_run(self):
        source, target = self.small_pair()
        odd = source.with_name("it's & odd.pcd")
        source.rename(odd)
        page = Page(self.report_of(odd, target, *FAST, "--seed=5"))
        samples = self.output / "samples.csv"
        expected = samples.read_text()
        samples.unlink()
        command = page.texts["pre"].splitlines()[0]
        result = call("sh", "-c", command.split("{", maxsplit=1)[0])
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(samples.read_text(), expected)

    def test_a_result_of_icp_that_the_posterior_excludes_is_a_warning(self):
        # Without pairs within 0.1 mm, ICP stays at the guess.
        pattern = '<div class="box caution">.*?Use the final transformation with care(.*?)</div>'
        text = self.report_of(*scans("mug"), "-d0.0001")
        self.assertTrue(self.verdict_of(text).startswith('good"'))
        self.assertIn("posterior excludes it", re.search(pattern, text, re.S).group(1))
        text = self.report_of(*scans("mug"), "-d0.0001", "--mean")
        self.assertNotIn("with care", text)


class ReportOrNot(ReportTest):
    def run_with(self, **variables):
        """Standard error of a run in a changed environment."""
        words = [*self.small_pair(), *FAST, "-o", self.output]
        result = run(*words, env={**os.environ, **variables})
        self.assert_ran(result)
        return result.stderr

    def test_without_gnuplot_all_else_is_written(self):
        self.run_to_files(*self.small_pair(), *FAST)
        self.assertEqual(self.names_of_output(), WRITTEN)
        first, *_ = self.run_with(PATH=str(self.folder)).splitlines()
        self.assertRegex(first, "^pcl_bayesian_icp: report.html is not written: gnuplot")
        self.assertIn("package gnuplot-nox", first)
        # The one of the run before does not belong to these files.
        self.assertEqual(self.names_of_output(), WITHOUT_REPORT)

    def test_gnuplot_that_fails_is_no_obstacle_either(self):
        self.file("gnuplot", '#!/bin/sh\n[ "$1" = --version ]\n').chmod(0o755)
        errors = self.run_with(PATH=f"{self.folder}:{os.environ['PATH']}")
        self.assertIn("report.html is not written: gnuplot: could not draw", errors)
        self.assertEqual(self.names_of_output(), WITHOUT_REPORT)

    def test_no_report(self):
        pair = self.small_pair()
        self.run_to_files(*pair, *FAST)
        self.run_to_files(*pair, *FAST, "--no-report")
        self.assertEqual(self.names_of_output(), WITHOUT_REPORT)
        self.assert_refused(2, run(*pair, *FAST, "--no-report"), "--no-report", "--output")

    def test_users_settings_of_gnuplot_do_no_harm(self):
        self.file(".gnuplot", "set terminal dumb\nset datafile separator ','\nexit\n")
        self.run_with(HOME=str(self.folder))
        self.assertEqual(self.names_of_output(), WRITTEN)


@unittest.skipUnless(find_browser(), "chromium is not installed")
class ReportInBrowser(ReportTest):
    DESKTOP, PHONE = 1200, 400

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        holder = cls.holder()
        holder.report_of(*scans("mug"), *CALIBRATED)
        cls.file_of_report = holder.output / "report.html"
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
            blueness = np.subtract(figure.getchannel("B"), figure.getchannel("R"), dtype=int)
            self.assertGreater((blueness > 60).sum(), 20, f"blue of {name}")
            if name in CLOUDS or name.startswith("chains") or name == PAIRS:
                self.assertGreater((blueness < -60).sum(), 20, f"orange of {name}")
