"""Reports of the studies: numbers worked out by hand from a few rows."""

import json
import pathlib
import resource
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import pandas as pd
import report
from report import (
    coverage,
    distribution,
    frames,
    page,
    paper,
    samplers,
    sbc,
    table_one,
    trajectories,
)

INFINITY = float("inf")


class FolderTest(unittest.TestCase):
    """Each test has a folder of its own."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.output = page.Output(self.folder)


class Numbers(unittest.TestCase):
    def test_spreads_leave_infinities_out_and_say_so(self):
        mean, sd, num_finite, num_values = frames.spread_of([1.0, 3.0, INFINITY])
        self.assertEqual((mean, num_finite, num_values), (2.0, 2, 3))
        self.assertAlmostEqual(sd, 2**0.5)
        text = frames.spread_text(frames.spread_of([1.0, 3.0, INFINITY]))
        self.assertEqual(text, "2.000 ± 1.414 (2 of 3 finite)")
        self.assertEqual(frames.spread_text(frames.spread_of([INFINITY])), "infinite")
        self.assertEqual(frames.spread_text(frames.spread_of([])), "-")
        self.assertEqual(frames.spread_text(frames.spread_of([np.nan])), "-")
        self.assertEqual(frames.spread_text(frames.spread_of([5.0])), "5.000 ± 0.000")

    def test_large_numbers_have_three_digits(self):
        self.assertEqual(frames.short(999.0004), "999.000")
        self.assertEqual(frames.short(-9204.6), "-9.2e+03")
        self.assertEqual(frames.number(14000.0, 2), "1.4e+04")
        self.assertEqual(frames.number(14000.0, 0), "14000")
        self.assertEqual(frames.number(np.nan, 2), "-")

    def test_interval_is_wilsons(self):
        # Of 8 in 10, z = 1.96: centre 0.9921 / 1.3842, half width 0.2266.
        low, high = frames.share_of([True] * 8 + [False] * 2)[1:]
        self.assertAlmostEqual(low, 0.4902, 4)
        self.assertAlmostEqual(high, 0.9433, 4)
        self.assertEqual(frames.share_of([True] * 3)[2], 1.0)
        self.assertEqual(frames.share_text(frames.share_of([])), "-")

    def test_names_are_words_whatever_they_look_like(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "t.csv"
            file.write_text("recording,scene,seed\n00,NA,01\n05,1e3,02\n")
            table = frames.read(file)
        self.assertEqual([list(table[c]) for c in table], [["00", "05"], ["NA", "1e3"], [1, 2]])

    def test_median_leaves_out_what_is_unknown(self):
        self.assertEqual(frames.median([4.0, np.nan, 1.0, 2.0, 8.0]), 3.0)
        self.assertTrue(np.isnan(frames.median([])))


class TableOne(unittest.TestCase):
    def test_orders_are_decided_beyond_the_deviations(self):
        def order(a, b):
            return table_one.order_of((*a, 10, 10), (*b, 10, 10))

        self.assertEqual(order((1.0, 0.3), (1.6, 0.4)), "Bayesian ICP")
        self.assertEqual(order((1.6, 0.4), (1.0, 0.3)), "Online-ICP")
        self.assertEqual(order((1.0, 0.3), (1.5, 0.4)), "undecided")
        finite, diverged = (100.0, 0.0, 10, 10), frames.spread_of([INFINITY] * 2)
        self.assertEqual(table_one.order_of(diverged, finite), "Online-ICP")
        self.assertEqual(table_one.order_of(finite, diverged), "Bayesian ICP")
        self.assertEqual(table_one.order_of(diverged, diverged), "undecided")
        partly = frames.spread_of([1.0, INFINITY])
        self.assertEqual(table_one.order_of(partly, finite), "Online-ICP")
        self.assertEqual(table_one.order_of(partly, diverged), "undecided")
        self.assertEqual(table_one.order_of(frames.spread_of([]), finite), "undecided")
        self.assertEqual(table_one.agreement("Bayesian ICP", "Bayesian ICP"), "yes")
        self.assertEqual(table_one.agreement("Bayesian ICP", "Online-ICP"), "no")
        self.assertEqual(table_one.agreement("undecided", "Online-ICP"), "undecided")


class Trajectories(FolderTest):
    def test_seeds_are_put_together_and_the_best_is_marked(self):
        rows = pd.DataFrame({
            "recording": "street", "quality": "exact",
            "means": ["calibrated"] * 4, "covariances": ["calibrated", "constant"] * 2,
            "num_edges": [40, 40, 38, 38],
            "ate_m": [0.003, 0.0042, 0.004, 0.0042], "rpe_m": 0.001, "rpe_rad": 0.01,
            "drift_m": 0.02, "nees": [1.0, 2.0, 3.0, np.nan], "cycle_nees": 0.5,
        })  # fmt: skip
        # The root of (9 + 16) / 2 is 3.54.
        self.assertEqual(
            trajectories.rows_of(rows),
            [["street (exact)", "calibrated", "39", "3.54 *", "1.00", "0.573", "20.0", "2.00", "0.50"],
             ["street (exact)", "calibrated + constant", "39", "4.20", "1.00", "0.573",
              "20.0", "-", "0.50"]],
        )  # fmt: skip
        section = trajectories.section_of(self.output, "drives", rows)
        self.assertEqual(section.title, "Trajectories (drives.csv)")
        self.assertIn(b"</svg>", self.output.files["drives_errors.svg"])


def coverage_rows(num_rows=10, **changes):
    """Right posteriors of a method: the truth is within every tenth region once."""
    k = np.arange(num_rows)
    rows = {
        "scene": "can", "condition": "same", "seed": k + 1, "method": "a", "valid": 1,
        "nees": np.where(k % 2, 12.0, 6.0), "region": (k + 0.5) / num_rows,
        "log_score": 2.0, "energy_score": 0.5, "translation_error_m": 1e-3 * (k + 1),
        "rotation_error_rad": 0.1, "displacement_m": 0.01, "lost_displacement_m": np.nan,
        "seconds": 0.25, "queries": 1000, "notes": np.where(k < 2, "flag:modes", ""),
    }  # fmt: skip
    rows.update({f"pit_{twist}": (k + 0.5) / num_rows for twist in coverage.TWISTS})
    return pd.DataFrame({**rows, **changes})


class Coverage(FolderTest):
    def test_ten_runs(self):
        # 5, 7, 9 and 10 of 10 regions are within the levels.
        self.assertEqual(
            coverage.row_of("a", coverage_rows()),
            ["a", "10 / 10", "1.50", "0.50 [0.24, 0.76]", "0.70 [0.40, 0.89]",
             "0.90 [0.60, 0.98]", "1.00 [0.72, 1.00]", "2.00", "0.5000", "5.50", "5.73", "20",
             "-", "0.250", "1000"],
        )  # fmt: skip

    def test_runs_without_a_posterior_count(self):
        runs = coverage_rows()
        runs.loc[5:, "valid"] = 0
        runs.loc[5:, ["nees", "region", "displacement_m"]] = np.nan
        runs["queries"] = -1
        row = coverage.row_of("a", runs)
        # NEES of 6, 12, 6, 12, 6; two of five poses are flagged; queries are not counted.
        self.assertEqual(row[1:4], ["5 / 10", "1.40", "1.00 [0.57, 1.00]"])
        self.assertEqual((row[11], row[14]), ("40", "-"))

    def test_flags_are_where_a_note_begins(self):
        notes = pd.Series(["", "flag:a", "no flag:a", "note;flag:b"])
        flags = coverage.flags_of(pd.DataFrame({"notes": notes}))
        self.assertEqual(list(flags), [False, True, False, True])

    def test_recordings_have_lost_pairs_alarms_and_misses(self):
        # Run 0 is flagged, the others are not; 7 is lost, 8 has no pose, 9 is far off.
        runs = coverage_rows(lost_displacement_m=0.1, nees=6.0)
        runs["notes"] = ["flag:x"] + [""] * 9
        runs.loc[7, "displacement_m"] = 0.2
        runs.loc[8, ["displacement_m", "nees"]] = np.nan
        runs.loc[8, "valid"] = 0
        runs.loc[9, "nees"] = 60.0
        table = coverage.table_of("all", runs)
        self.assertEqual(table.header, coverage.SEQUENCE_HEADER)
        row = table.rows[0]
        # NEES / 6 of what is not lost: seven times 1, once 10.
        self.assertEqual(row[:4], ["a", "10", "2", "2.12"])
        self.assertEqual(row[9:11], ["1 / 7", "2 / 3"])

    def test_figure_of_regions_has_the_pairs_without_a_pose(self):
        runs = coverage_rows(lost_displacement_m=0.1)
        runs.loc[5:, ["nees", "displacement_m"]] = np.nan
        runs.loc[5:, ["region", "valid"]] = [1.0, 0]
        coverage.section_of(self.output, "c", runs)
        whole = self.output.files["c_regions.svg"]
        coverage.plot_regions(self.output, "c", [("a", runs)])
        self.assertEqual(self.output.files["c_regions.svg"], whole)

    def test_pools_follow_the_cells(self):
        scenes = [coverage_rows(scene=s, condition=c) for s in "pq" for c in ("u", "v")]
        titles = [table.caption for table in coverage.tables_of(pd.concat(scenes))]
        pools = ["p, all conditions", "q, all conditions", "all scenes, u", "all scenes, v"]
        self.assertEqual(titles, ["p, u", "p, v", "q, u", "q, v", *pools, "all"])

    def test_figures_are_drawn(self):
        replaced = coverage_rows(num_rows=1, nees=1e6)
        rows = pd.concat([replaced, coverage_rows()])
        section = coverage.section_of(self.output, "c", rows)
        self.assertEqual(
            section.blocks[-1].rows, coverage.tables_of(coverage_rows())[-1].rows
        )
        for block in section.blocks[:3]:
            self.assertIn(b"</svg>", self.output.files[f"{block.name}.svg"])
            self.assertEqual(self.output.files[f"{block.name}.png"][1:4], b"PNG")
        self.assertEqual(len(section.blocks), 4)


class Ranks(FolderTest):
    def rows(self, ranks):
        columns = {f"rank_{c}": ranks for c in frames.COORDINATES}
        return pd.DataFrame({"sampler": "s", "seed": range(len(ranks)), "valid": 1, **columns})

    def test_chi_square_of_histograms(self):
        self.assertEqual(sbc.chi_square(np.full(10, 7)), 0.0)
        # Ten runs in one bin: (10 - 1)^2 + 9.
        self.assertEqual(sbc.chi_square(np.array([10] + [0] * 9)), 90.0)
        counts = sbc.histogram(pd.Series([0, 9, 10, 99]))
        self.assertEqual(list(counts), [2, 1, 0, 0, 0, 0, 0, 0, 0, 1])

    def test_verdicts(self):
        even = self.rows(range(5, 100, 10))
        self.assertEqual(sbc.row_of("s", even)[1:4], ["10 / 10", "0.0", "0.0"])
        self.assertEqual(sbc.row_of("s", even)[-1], "uniform")
        self.assertEqual(sbc.row_of("s", self.rows([0] * 10))[2::6], ["90.0", "NOT UNIFORM"])
        # A run without good draws is no good sign.
        self.assertEqual(sbc.row_of("s", even.assign(valid=[0] + [1] * 9))[-1], "NOT UNIFORM")
        self.assertIn("for information", sbc.row_of("calibrated-scans", even)[-1])
        section = sbc.section_of(self.output, "sbc", even)
        self.assertIn("sbc_ranks.png", self.output.files)
        self.assertEqual(len(section.blocks), 2)


class Samplers(unittest.TestCase):
    def test_medians_worst_cases_and_the_best_step_size(self):
        names = [*samplers.columns("kl"), *samplers.columns("w1"), *samplers.columns("ks")]
        rows = pd.DataFrame([dict.fromkeys(names, 0.05)] * 4)
        rows["sampler"] = ["paper 1e-05", "paper 1e-05", "paper 1e-04", "exact"]
        rows = rows.assign(scene="can", sigma=0.0015, effective_points=100.0, tail_ess=700.0)
        rows = rows.assign(gold_key="k")
        rows = rows.assign(kl=[0.1, 0.3, 9.0, 0.2], rhat=[1.0, 1.2, 1, 1], seconds=[1.0, 3, 1, 1])
        rows = rows.assign(bulk_ess=[400.0, 600, 1, 1], status=["ok", "not_mixed", "ok", "ok"])
        rows.loc[0, "ks_x"] = 0.06
        table = samplers.section_of(None, "samplers", rows).blocks[0]
        self.assertEqual(table.caption, "can, sigma 0.0015 m, N = 100")
        # The step size that was tried once is left out.
        self.assertEqual([row[0] for row in table.rows], ["exact", "paper 1e-05"])
        self.assertEqual(
            table.rows[1][1:],
            ["2", "0.2000", "0.3000", "0.0500", "0.050", "92", "1.200", "400", "700", "300.0",
             "2.000", "1"],
        )  # fmt: skip
        # Of other points or a longer gold standard.
        both = pd.concat([rows, rows.assign(gold_key="other", kl=9.0)])
        tables = samplers.section_of(None, "samplers", both).blocks
        self.assertEqual([t.caption.split(", ")[-1] for t in tables], ["gold standard k", "gold standard other"])
        self.assertEqual([t.rows[1][1:3] for t in tables], [["2", "0.2000"], ["2", "9.0000"]])


def distribution_rows(pair="can", methods=("bayesian-icp", "online-icp"), num_runs=2):
    numbers = dict.fromkeys(
        [*distribution.DIVERGENCE_COLUMNS.values(), *distribution.SCORE_COLUMNS.values()], 1.0
    )
    numbers.update(dict.fromkeys(distribution.SD_COLUMNS, 0.1))
    numbers.update(rhat=1.0, bulk_ess=400.0, seconds=0.5, nees=6.0, status="ok")
    rows = [
        {"key": "k", "pair": pair, "method": method, "seed": seed + 1, **numbers}
        for method in methods
        for seed in range(num_runs)
    ]
    return pd.DataFrame(rows)


class Distribution(unittest.TestCase):
    def test_region_is_that_of_chi_square(self):
        # Quantiles of chi-square with 6 degrees of freedom.
        self.assertAlmostEqual(distribution.region_of(12.5916), 0.95, 6)
        self.assertAlmostEqual(distribution.region_of(5.3481), 0.5, 5)
        self.assertEqual(distribution.region_of(0.0), 0.0)

    def test_density_of_gaussian_quantiles_is_a_wider_gaussian(self):
        size = 2000
        shares = (np.arange(size) + 0.5) / size
        grid = np.linspace(-6, 6, 200001)
        distribution_function = np.cumsum(np.exp(-0.5 * grid**2))
        values = 1 + 0.5 * np.interp(shares, distribution_function / distribution_function[-1], grid)
        places, heights = distribution.density_of(values)
        # A Gaussian kernel adds its variance.
        width = 0.9 * 0.5 * size**-0.2
        expected = np.exp(-0.5 * (places - 1) ** 2 / (0.25 + width**2))
        np.testing.assert_allclose(heights, expected, atol=2e-3)
        self.assertAlmostEqual(places[0], values[10] - 3 * width, 1)

    def test_density_of_equal_values_is_a_peak(self):
        places, heights = distribution.density_of(np.full(20, 3.0))
        self.assertEqual((places[0], heights.max()), (3.0, 1.0))

    def test_table_one_stands_beside_the_papers(self):
        rows = distribution_rows(methods=("bayesian-icp", "online-icp", "online-icp-noise", "exact"))
        rows.loc[rows.method == "bayesian-icp", "kl_yaw"] = [2.0, 4.0]
        rows.loc[rows.method == "online-icp-noise", "kl_yaw"] = 5e4
        summary, *tables = distribution.comparison_tables(rows)
        self.assertEqual(
            tables[5].rows,
            [["can", "6.620 ± 3.251", "32.955", "Bayesian ICP", "3.000 ± 1.414", "1.000 ± 0.000",
              "1.000 ± 0.000", "5e+04 ± 0.000", "no", "yes", "undecided"]],
        )  # fmt: skip
        self.assertEqual(summary.rows[5], ["yaw", "0 / 1 / 0", "1 / 0 / 0", "0 / 0 / 1"])
        # In x the paper's two differ by less than 0.078.
        self.assertEqual(summary.rows[0], ["x", "0 / 0 / 1", "0 / 0 / 1", "0 / 0 / 1"])
        self.assertEqual(distribution.comparison_tables(distribution_rows("corridor")), [])

    def test_baseline_and_mixing(self):
        columns = dict.fromkeys(distribution.SD_COLUMNS, [0.0146])
        row = pd.DataFrame({"pair": ["can"], "source_points": 500, "target_points": 6083,
                            "runs": 60, "main_basin_share": 0.7, **columns})  # fmt: skip
        table = distribution.baseline_table(row)
        self.assertEqual(table.rows, [["can", "500 / 6083", "60", "70.0", *["0.0146"] * 6]])
        rows = distribution_rows(methods=distribution.CHAINS)
        rows.loc[rows.method == "exact", "status"] = ["ok", "not_mixed"]
        rows.loc[rows.method == "exact", ["sd_x_m", "sd_y_m", "sd_z_m"]] = [0.3, 0.0, 0.0]
        lines = distribution.mixing_table([("can", rows)]).rows
        # Root mean square: 0.3 / sqrt(3).
        self.assertEqual(
            lines[2], ["can, exact", "not_mixed 1, ok 1", "1.000", "400", "0.173", "0.1", "0.5"]
        )


class Paper(FolderTest):
    def test_rows_of_other_inputs_are_left_alone(self):
        rows = pd.DataFrame(
            {"pair": ["b", "a", "a", "a", "c"], "key": ["2", "1", "0", "1", "3"], "seed": [5, 5, 5, 7, 5],
             "start": [0, 1, 0, 0, 0]}
        )  # fmt: skip
        pairs = [{"name": "a", "key": "1"}, {"name": "b", "key": "2"}]
        record = {"pairs": pairs, "seed": 5, "seeds": 2}
        self.assertEqual(list(paper.chosen(rows, record).index), [1, 0])
        self.assertEqual(list(paper.chosen(rows, {**record, "starts": 1}).index), [0])
        self.assertEqual(len(paper.chosen(rows, None)), 5)

    def test_accuracy_in_millimetres_and_milliradians(self):
        runs = pd.DataFrame({"translation_error_m": [0.001, 0.003, np.nan],
                             "rotation_error_rad": [0.01, 0.02, 0.06]})  # fmt: skip
        self.assertEqual(
            paper.accuracy_row("t", runs),
            ["t", "2.000 ± 1.414 (2 of 3 finite)", "2", "30.000 ± 26.458", "20"],
        )

    def test_run_time_is_of_the_median_of_each_pair(self):
        rows = pd.DataFrame(
            [("exact", pair, n, wall, 2 * wall) for n in (1, 2, 4)
             for pair, walls in (("a", (1, 2, 90)), ("b", (4, 4, 4))) for wall in walls],
            columns=["method", "pair", "threads", "wall_s_per_1000_draws", "cpu_s_per_1000_draws"],
        )  # fmt: skip
        table = paper.runtime_section(self.output, rows, 2).blocks[1]
        cells = ["3.000 ± 1.414"] * 3 + ["6.000 ± 2.828"] * 3
        self.assertEqual(table.rows[0], ["exact", *cells])
        self.assertEqual(table.rows[1][1:5], ["8.880 ± 3.590", "6.392 ± 0.731", "3.298 ± 0.573", "–"])

    def test_run_time_of_an_interrupted_study_has_gaps(self):
        rows = pd.DataFrame({"method": ["bayesian-icp", "bayesian-icp", "exact"], "pair": "a",
                             "threads": [1, 2, 1], "wall_s_per_1000_draws": 1.0,
                             "cpu_s_per_1000_draws": 2.0})  # fmt: skip
        table = paper.runtime_section(self.output, rows, 2).blocks[1]
        self.assertEqual(table.rows[1], ["exact", "1.000 ± 0.000", "-", "2.000 ± 0.000", "-"])

    def test_curves_have_a_table_a_variant(self):
        rows = pd.DataFrame(
            [{"pair": "bowl", "variant": v, "value": n, **dict.fromkeys(paper.CURVE_COLUMNS, kl)}
             for v in ("far", "near") for n, kl in ((0, 1.0), (0, 3.0), (100, 5.0))]
        )  # fmt: skip
        section = paper.curve_section(self.output, "burn_in", rows, "Burn-in", "", "left out")
        near = section.blocks[2]
        self.assertIn("bowl, Bayesian ICP from the guess", near.caption)
        self.assertEqual(near.rows, [["0"] + ["2.000 ± 1.414"] * 7, ["100"] + ["5.000 ± 0.000"] * 7])


class Page(FolderTest):
    def sections(self):
        table = page.Table("T", ["name", "a|b"], [["x", "1"]])
        figures = [page.Figure("one", "first"), page.Figure("two", "second")]
        return [page.Section("One & two", [page.Text("p < q"), page.Code("run --it"), table, *figures])]

    def test_markdown(self):
        self.assertEqual(
            page.markdown_of("A < B", self.sections()),
            "# A < B\n\n## One & two\n\np < q\n\n```\nrun --it\n```\n\nT\n\n"
            "| name | a\\|b |\n|---|--:|\n| x | 1 |\n\n"
            "![first](one.svg)\n\n![second](two.svg)\n",
        )

    def test_html_needs_no_other_file(self):
        for name in ("one", "two"):
            self.output.files[f"{name}.svg"] = b"<svg/>"
        text = page.html_of("A < B", self.sections(), self.output)
        for piece in ("<title>A &lt; B</title>", "<h2>One &amp; two</h2>", "<p>p &lt; q</p>",
                      "run --it</", ">a|b</th>", ">1</td>"):  # fmt: skip
            self.assertIn(piece, text)
        self.assertEqual(text.count("src="), 2)
        self.assertEqual(text.count('src="data:image/svg+xml;base64,PHN2Zy8+"'), 2)
        self.assertNotIn("<script", text)

    def test_all_files_are_there_or_none(self):
        (self.folder / "a").write_text("old")
        self.output.files = {"a": b"new", "b": bytes(1000)}
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, limits[1]))
        try:
            with self.assertRaisesRegex(ValueError, "b cannot be written: File too large"):
                self.output.commit()
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["a"])
        self.assertEqual((self.folder / "a").read_text(), "old")
        self.output.commit()
        self.assertEqual((self.folder / "a").read_text(), "new")
        self.assertEqual((self.folder / "b").stat().st_size, 1000)


class Program(FolderTest):
    def run_report(self):
        program = pathlib.Path(report.__file__).parent
        words = [sys.executable, "-B", program, self.folder]
        return subprocess.run(words, capture_output=True, text=True, check=False)

    def test_report_of_a_folder(self):
        coverage_rows().to_csv(self.folder / "mine.csv", index=False)
        distribution_rows().to_csv(self.folder / "distribution.csv", index=False)
        record = {"command": "make it", "quick": True, "seed": 1, "seeds": 1, "skipped_pairs": 2,
                  "pairs": [{"name": "can", "key": "k"}]}  # fmt: skip
        study = {"versions": {"PCL": "1.13.0"}, "experiments": {"distribution": record}}
        (self.folder / "study.json").write_text(json.dumps(study))
        result = self.run_report()
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(result.stdout, f"{self.folder}/report.html\n")
        text = (self.folder / "report.md").read_text()
        for piece in ("## Distribution (Table I)", "2 pairs could not be read", "with --quick",
                      "```\nmake it\n```", "| PCL | 1.13.0 |", "## Coverage (mine.csv)",
                      "| Bayesian ICP | 1.000 ± 0.000 |"):  # fmt: skip
            self.assertIn(piece, text)

    def test_what_is_wrong_is_named(self):
        result = self.run_report()
        self.assertEqual(result.returncode, 1)
        self.assertIn("no rows of a study", result.stderr)
        (self.folder / "odd.csv").write_text("a,b\n1,2,3\n4,5,6,7\n")
        self.assertIn("odd.csv", self.run_report().stderr)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["odd.csv"])


if __name__ == "__main__":
    unittest.main()
