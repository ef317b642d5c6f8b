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
        self.assertEqual(frames.spread_text(frames.spread_of([5.0])), "5.000")

    def test_large_numbers_have_three_digits(self):
        self.assertEqual(frames.short(999.0004), "999.000")
        self.assertEqual(frames.short(-9204.6), "-9.2e+03")
        self.assertEqual(frames.number(14000.0, 2), "1.4e+04")
        self.assertEqual(frames.number(14000.0, 0), "14000")
        self.assertEqual(frames.number(np.nan, 2), "-")

    def test_names_are_words_whatever_they_look_like(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "t.csv"
            file.write_text("recording,scene,seed\n00,NA,01\n05,1e3,02\n")
            table = frames.read(file)
        self.assertEqual([list(table[c]) for c in table], [["00", "05"], ["NA", "1e3"], [1, 2]])


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
            "drift_m": 0.02, "nees_per_degree": [1.0, 2.0, 3.0, np.nan],
            "cycle_nees_per_degree": 0.5,
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

    def test_a_recording_may_have_no_row_of_a_method(self):
        rows = pd.DataFrame({
            "recording": ["street", "street", "room"], "quality": "B", "means": "calibrated",
            "covariances": ["calibrated", "constant", "calibrated"], "num_edges": 40, "ate_m": 0.003,
            "rpe_m": 0.001, "rpe_rad": 0.01, "drift_m": 0.02, "nees_per_degree": 1.0,
            "cycle_nees_per_degree": 0.5,
        })  # fmt: skip
        trajectories.section_of(self.output, "some", rows)
        self.assertIn(b"</svg>", self.output.files["some_errors.svg"])


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
    def test_figure_of_regions_has_the_pairs_without_a_pose(self):
        runs = coverage_rows(lost_displacement_m=0.1)
        runs.loc[5:, ["nees", "displacement_m"]] = np.nan
        runs.loc[5:, ["region", "valid"]] = [1.0, 0]
        coverage.section_of(self.output, "c", runs)
        whole = self.output.files["c_regions.svg"]
        coverage.plot_regions(self.output, "c", [("a", runs)])
        self.assertEqual(self.output.files["c_regions.svg"], whole)

    def test_figures_are_drawn(self):
        section = coverage.section_of(self.output, "c", coverage_rows())
        for block in section.blocks[:3]:
            self.assertIn(b"</svg>", self.output.files[f"{block.name}.svg"])
            self.assertEqual(self.output.files[f"{block.name}.png"][1:4], b"PNG")
        # Of the rows of one name the last one counts.
        whole = self.output.files["c_anees.svg"]
        replaced = coverage_rows(num_rows=1, nees=1e6)
        again = coverage.section_of(self.output, "c", pd.concat([replaced, coverage_rows()]))
        self.assertEqual(self.output.files["c_anees.svg"], whole)
        self.assertEqual(again.blocks, section.blocks)

    def test_table_tells_of_ten_runs(self):
        (table,) = coverage.tables_of(coverage_rows())
        self.assertEqual((table.caption, len(table.header)), ("can, same", 15))
        # 5, 7, 9 and 10 of 10 regions are within the levels.
        self.assertEqual(
            table.rows,
            [["a", "10/10", "1.50", "0.50 [0.24,0.76]", "0.70 [0.40,0.89]", "0.90 [0.60,0.98]",
              "1.00 [0.72,1.00]", "2.00", "0.5000", "5.50", "5.7296", "20", "-", "0.250", "1000"]],
        )  # fmt: skip
        (uncounted,) = coverage.tables_of(coverage_rows(queries=-1))
        self.assertEqual(uncounted.rows[0][-1], "-")

    def test_tables_are_of_every_cell_and_of_the_pools(self):
        runs = [coverage_rows(scene=s, condition=c) for s in ("box", "can") for c in ("same", "moved")]
        titles = [table.caption for table in coverage.tables_of(pd.concat(runs))]
        for title in ("box, same", "can, moved", "box, all conditions", "all scenes, moved", "all"):
            self.assertEqual(titles.count(title), 1, title)
        recorded = coverage_rows(scene="hall", lost_displacement_m=0.1)
        section = coverage.section_of(self.output, "c", pd.concat([*runs, recorded]))
        self.assertEqual(section.blocks[-1].caption, "hall, same")
        self.assertIn("alarms/good", section.blocks[-1].header)
        self.assertNotIn("alarms/good", section.blocks[-2].header)

    def test_intervals_are_wilsons(self):
        # Newcombe (1998), table I, method 3.
        for hits, trials, low, high in (
            (81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)
        ):  # fmt: skip
            np.testing.assert_allclose(coverage.interval_of(hits / trials, trials), (low, high), atol=5e-5)
        self.assertEqual(coverage.share_text(pd.Series([], dtype=bool), coverage_rows(0)), "-")

    def test_intervals_count_a_pair_of_real_scans_once(self):
        # All ten seeds of one of two pairs are outside.
        runs = coverage_rows(20, scene=["one"] * 10 + ["two"] * 10, condition="real")
        is_hit = runs.scene == "one"
        one_of_two = coverage.share_text(pd.Series([True, False]), coverage_rows(2))
        self.assertEqual(coverage.share_text(is_hit, runs), one_of_two)
        self.assertNotEqual(coverage.share_text(is_hit, runs.assign(condition="clean")), one_of_two)

    def test_alarms_and_misses_are_counted(self):
        # Good, an alarm, neither, bad but told, lost and missed, without a result, a pose alone.
        runs = coverage_rows(
            7, nees=[1.0, 16.8, 20.0, 28.0, 1.0, np.nan, np.nan], lost_displacement_m=0.2,
            displacement_m=[0.1, 0.1, 0.1, 0.1, 0.3, np.nan, 0.3], valid=[1, 1, 1, 1, 1, 0, 0],
            notes=["", "flag:misfit", "", "flag:misfit", "", "", ""],
        )  # fmt: skip
        cells = coverage.cells_of(runs)
        self.assertEqual([cells[c] for c in ("lost", "alarms/good", "misses/bad")], ["3", "1/2", "1/3"])
        self.assertEqual(cells["mean NEES/6"], f"{(1.0 + 16.8 + 20.0 + 28.0) / 24.0:.2f}")

    def test_flags_are_counted_among_runs_outside(self):
        runs = coverage_rows(
            5, nees=[13.0, 12.6, 1.0, 1.0, np.nan], region=[0.97, 0.9501, 0.1, 0.1, np.nan],
            displacement_m=[0, 0, 0, 0, np.nan], valid=[1, 1, 1, 1, 0],
            notes=["prior_only=1;flag:misfit", "", "flag:few_patches", "no flag:here", ""],
        )  # fmt: skip
        cells = coverage.cells_of(runs)
        self.assertEqual(cells["valid/runs"], "4/5")
        self.assertEqual(cells["mean NEES/6"], "1.15")
        self.assertEqual(cells["truths within 95 %"][:4], "0.50")
        self.assertEqual((cells["flagged [%]"], cells["flagged if outside [%]"]), ("50", "50"))


class Samplers(FolderTest):
    def test_medians_and_worst_of_the_best_step_size(self):
        columns = {f"{kind}_{c}": 0.01 for kind in ("kl", "w1", "ks") for c in frames.COORDINATES}
        rows = pd.DataFrame({
            "gold_key": "g", "scene": "can", "sigma": 0.0015, "effective_points": 1000.0,
            "sampler": ["paper 1e-05"] * 3 + ["paper 0.001"], "seed": [1, 2, 3, 1], "status": "ok",
            "kl": [0.3, 0.1, 0.2, 0.3], **columns, "rhat": [1.0, 1.2, 1.1, 1.0],
            "bulk_ess": 400.0, "tail_ess": 300.0, "seconds": 2.0, "min_ess_per_second": 200.0,
        })  # fmt: skip
        rows.loc[:2, "ks_x"] = [0.07, 0.05, 0.05]
        (table,) = samplers.section_of(self.output, "s", rows).blocks
        self.assertEqual(table.caption, "can, sigma 0.0015 m, N 1000")
        self.assertEqual(
            table.rows,
            [["paper 1e-05", "3", "0.2000", "0.3000", "0.0100", "0.010", "94", "1.200", "400", "300", "200.0",
              "2.000", "3"]],
        )  # fmt: skip
        # Of other points or a longer gold standard.
        both = samplers.section_of(self.output, "s", pd.concat([rows, rows[:1].assign(gold_key="other")])).blocks
        self.assertEqual(both[1].caption, "can, sigma 0.0015 m, N 1000, gold standard other")
        self.assertEqual(both[1].rows[0][:3], ["paper 1e-05", "1", "0.3000"])


class Ranks(FolderTest):
    def test_histograms(self):
        counts = sbc.histogram(pd.Series([0, 9, 10, 99]))
        self.assertEqual(list(counts), [2, 1, 0, 0, 0, 0, 0, 0, 0, 1])
        columns = {f"rank_{c}": range(5, 100, 10) for c in frames.COORDINATES}
        rows = pd.DataFrame({"sampler": "s", "seed": range(10), "valid": 1, **columns})
        # All in one bin of ten: 9 n.
        rows = pd.concat([rows, rows.assign(sampler="narrow", rank_yaw=99)])
        rows.iloc[0, rows.columns.get_loc("valid")] = 0
        section = sbc.section_of(self.output, "sbc", rows)
        self.assertIn("sbc_ranks.png", self.output.files)
        self.assertEqual(
            section.blocks[0].rows,
            [["s", "9/10", *["1.0"] * 6], ["narrow", "10/10", *["0.0"] * 5, "90.0"]],
        )
        self.assertEqual(sbc.table_of([("none", rows[:1])]).rows, [["none", "0/1", *["-"] * 6]])


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
        self.assertEqual(table.rows[1], ["exact", "1.000", "-", "2.000", "-"])

    def test_curves_have_a_table_a_variant(self):
        rows = pd.DataFrame(
            [{"pair": "bowl", "variant": v, "value": n, **dict.fromkeys(paper.CURVE_COLUMNS, kl)}
             for v in ("far", "near") for n, kl in ((0, 1.0), (0, 3.0), (100, 5.0))]
        )  # fmt: skip
        section = paper.curve_section(self.output, "burn_in", rows, "Burn-in", "", "left out")
        near = section.blocks[2]
        self.assertIn("bowl, Bayesian ICP from the guess", near.caption)
        self.assertEqual(near.rows, [["0"] + ["2.000 ± 1.414"] * 7, ["100"] + ["5.000"] * 7])


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
                      "```\nmake it\n```", "| PCL | 1.13.0 |", "## Coverage (mine.csv)", "| a | 10/10 | 1.50 |",
                      "| Bayesian ICP | 1.000 |"):  # fmt: skip
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
