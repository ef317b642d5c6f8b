"""Table I and its companions: how far is what a method reports from where ICP ends?"""

import numpy as np
import pandas as pd

from report import frames, page, table_one
from report.frames import COORDINATES, UNITS
from report.page import Section, Table, Text

TITLES = {
    "bayesian-icp": "Bayesian ICP",
    "bayesian-icp-1e-5": "Bayesian ICP, step 1e-5",
    "exact": "exact",
    "calibrated": "calibrated",
    "online-icp": "Online-ICP",
    "online-icp-point": "Online-ICP, point-to-point",
    "online-icp-noise": "Online-ICP, estimated noise",
    "hessian": "Hessian",
    "gicp": "Hessian of GICP",
}
# What stands for the paper's two methods.
CONTESTS = (
    ("bayesian-icp", "online-icp"),
    ("bayesian-icp", "online-icp-noise"),
    ("exact", "online-icp"),
)
COMPARED = ("bayesian-icp", "exact", "online-icp", "online-icp-noise")
CHAINS = ("bayesian-icp", "bayesian-icp-1e-5", "exact", "calibrated")

SD_COLUMNS = [f"sd_{c}_{u}" for c, u in zip(COORDINATES, UNITS)]
# By their titles.
DIVERGENCE_COLUMNS = {
    **{coordinate: f"kl_{coordinate}" for coordinate in COORDINATES},
    "6-D": "kl",
    "yaw, main basin": "main_kl_yaw",
    "6-D, main basin": "main_kl",
}
SCORE_COLUMNS = {
    **{f"W1 {coordinate}": f"w1_{coordinate}" for coordinate in COORDINATES},
    "energy score, baseline": "energy_score",
    "energy score, truth": "truth_energy_score",
    "NEES / 6": "nees_6",
    "truth in 95 % region [share]": "is_covered",
    "translation error [m]": "translation_error_m",
    "rotation error [rad]": "rotation_error_rad",
}

TEXT = (
    "How far is the distribution that a method reports from the baseline, where standard ICP "
    "ends from random starts? KL is that of Gaussian moments, KL(baseline ‖ method), angles "
    "unwrapped about the baseline's circular mean. The paper says neither its direction nor "
    "its density estimate, and its scans are others: its absolute values cannot come out, its "
    "orders can."
)
MIXING_TEXT = (
    "Did the chains sample their posterior? At the paper's step size they do not: their spread "
    "is that of the step size, not of the likelihood (exact draws from the same posterior), and "
    "the status says so."
)
TRUTH_TEXT = (
    "Beyond the paper: the truth is known here, and a distribution near the baseline is not yet "
    "a right one. Where ICP from a good start ends is far less uncertain than where it ends "
    "from starts within a metre and a radian."
)
BASELINE_CAPTION = (
    "The baseline: results of Monte Carlo ICP, all kept as in the paper. Main basin: mean "
    "squared distance at most twice the least."
)
ORDERS_CAPTION = (
    "Is the same of two methods nearer to the baseline as in the paper? Number of objects: "
    "same / opposite / undecided, that is, in the paper or here the two differ by no more than "
    "their standard deviations."
)
COORDINATE_CAPTION = (
    "KL(baseline ‖ method) of {} [nats], mean ± standard deviation over the runs: the paper's, "
    "ours, and whether the same of two methods is the lower one."
)
MIXING_CAPTION = (
    "Whether the chains sampled their posterior: statuses of the runs, median of the largest "
    "R-hat and of the smallest bulk effective sample size of a coordinate, and spread of the "
    "draws (root mean square over the three axes)."
)
DIVERGENCE_CAPTION = (
    "{}: KL(baseline ‖ method) [nats]; main basin: of the baseline's runs in it only."
)
SCORE_CAPTION = (
    "{}: Wasserstein-1 distances to the baseline in standard deviations of it; energy scores in "
    "units of the prior's standard deviations; NEES, coverage and errors are against the true "
    "pose."
)
DIVERGENCES_CAPTION = (
    "KL(baseline ‖ method) [nats] per coordinate: mean over the runs of each method. Infinite "
    "ones are not drawn."
)
DENSITIES_CAPTION = (
    "{}: marginal densities (kernel estimates, each scaled to a largest value of 1) of baseline "
    "and methods."
)

NUM_PLACES = 200  # of a density
REACH = 3  # bandwidths beyond the outer quantiles


def contest_name(contest):
    return " / ".join(TITLES[method] for method in contest)


def region_of(nees):
    """Probability of a smaller chi-square of 6 degrees of freedom."""
    half = nees / 2
    return 1 - np.exp(-half) * (1 + half + half**2 / 2)


def baseline_table(rows):
    header = ["pair", "points source / target", "runs", "in main basin [%]"]
    header += [f"sd {c} [{u}]" for c, u in zip(COORDINATES, UNITS)]
    lines = []
    for row in rows.itertuples():
        sds = [getattr(row, column) for column in SD_COLUMNS]
        points = f"{row.source_points} / {row.target_points}"
        share = f"{100 * row.main_basin_share:.1f}"
        lines.append([row.pair, points, str(row.runs), share, *(f"{sd:.3g}" for sd in sds)])
    return Table(BASELINE_CAPTION, header, lines)


def coordinate_comparison(rows, coordinate):
    """The paper's numbers beside ours; and the verdicts of each contest on the objects."""
    header = ["object", "paper: Bayesian ICP", "paper: Online-ICP", "paper: lower"]
    header += [f"ours: {TITLES[method]}" for method in COMPARED]
    header += [f"same: {contest_name(contest)}" for contest in CONTESTS]
    lines, verdicts = [], []
    for pair, of_pair in rows.groupby("pair", sort=False):
        stated = table_one.cell(pair, coordinate)
        if stated is None:
            continue
        ours = {m: frames.spread_of(of_pair[of_pair.method == m][f"kl_{coordinate}"]) for m in TITLES}
        order = table_one.order_of(*stated)
        same = [
            table_one.agreement(order, table_one.order_of(ours[a], ours[b])) for a, b in CONTESTS
        ]
        stated_cells = [frames.spread_text(stated[0]), frames.short(stated[1][0]), order]
        lines.append([pair, *stated_cells, *(frames.spread_text(ours[m]) for m in COMPARED), *same])
        verdicts.append(same)
    return Table(COORDINATE_CAPTION.format(coordinate), header, lines), verdicts


def comparison_tables(rows):
    """In how many cells the orders agree, then our Table I beside the paper's, a table a
    coordinate; nothing if the paper has none of the pairs."""
    tables, counts = [], []
    for coordinate in COORDINATES:
        table, verdicts = coordinate_comparison(rows, coordinate)
        if not table.rows:
            return []
        tables.append(table)
        of_contest = [
            " / ".join(str(column.count(word)) for word in ("yes", "no", table_one.UNDECIDED))
            for column in zip(*verdicts)
        ]
        counts.append([coordinate, *of_contest])
    header = ["coordinate", *map(contest_name, CONTESTS)]
    return [Table(ORDERS_CAPTION, header, counts), *tables]


def mixing_table(pairs):
    header = ["pair, method", "status", "R-hat", "bulk ESS", "translation sd [m]"]
    header += ["rotation sd [rad]", "CPU time of a run [s]"]
    lines = []
    for pair, rows in pairs:
        for method, runs in rows[rows.method.isin(CHAINS)].groupby("method", sort=False):
            statuses = runs.status.value_counts().sort_index()
            sd = runs[SD_COLUMNS].to_numpy()
            spreads = pd.DataFrame(np.sqrt(np.mean(sd.reshape(-1, 2, 3) ** 2, axis=2))).median()
            lines.append([
                f"{pair}, {TITLES[method]}",
                ", ".join(f"{status} {count}" for status, count in statuses.items()),
                frames.short(runs.rhat.median()),
                f"{runs.bulk_ess.median():.0f}",
                *(f"{spread:.3g}" for spread in spreads),
                f"{runs.seconds.median():.2g}",
            ])  # fmt: skip
    return Table(MIXING_CAPTION, header, lines)


def method_table(caption, rows, columns):
    """A row a method, of columns by their titles."""
    lines = [
        [title, *frames.spread_cells(rows[rows.method == method], columns.values())]
        for method, title in TITLES.items()
    ]
    return Table(caption, ["method", *columns], lines)


def plot_divergences(output, pairs):
    figure, axes = page.panels(2, 3, 4, 3.2)
    methods = list(TITLES)
    for coordinate, axis in zip(COORDINATES, axes.flat):
        for m, method in enumerate(methods):
            means = [
                frames.spread_of(rows[rows.method == method][f"kl_{coordinate}"])[0]
                for _, rows in pairs
            ]
            places = np.arange(len(pairs)) + 0.08 * (m - (len(methods) - 1) / 2)
            axis.plot(places, means, page.MARKERS[m], color=page.COLOURS[m], label=TITLES[method],
                      markersize=4)  # fmt: skip
        axis.set(title=coordinate, yscale="log", ylabel="KL(baseline ‖ method) [nats]")
        axis.set_xticks(range(len(pairs)), [pair for pair, _ in pairs], rotation=30, ha="right")
    return page.save(output, "divergences", DIVERGENCES_CAPTION, figure, key_of=axes[0, 0])


def density_of(values):
    """Gaussian kernels of Silverman's bandwidth, 0.9 min(sd, interquartile range / 1.34)
    n^(-1/5), at evenly spread places; scaled so that the largest value is 1."""
    low, lower, upper, high = np.quantile(values, (0.005, 0.25, 0.75, 0.995))
    scale = np.std(values, ddof=1)
    if upper > lower:
        scale = min(scale, (upper - lower) / 1.34)
    width = 0.9 * scale * len(values) ** -0.2
    places = np.linspace(low - REACH * width, high + REACH * width, NUM_PLACES)
    if not places[-1] > places[0]:
        return np.full(3, values[0]), np.array([0.0, 1.0, 0.0])
    heights = np.exp(-0.5 * ((places[:, None] - values) / width) ** 2).sum(axis=1)
    return places, heights / heights.max()


def plot_densities(output, pair, draws):
    figure, axes = page.panels(2, 3, 4, 2.8)
    for coordinate, unit, axis in zip(COORDINATES, UNITS, axes.flat):
        for i, (method, of_method) in enumerate(draws.groupby("method", sort=False)):
            values = of_method[f"{coordinate}_{unit}"].to_numpy()
            curve = density_of(values)
            if method == "baseline":
                axis.fill_between(*curve, color="#bbbbbb", label="Monte Carlo ICP")
            else:
                axis.plot(*curve, color=page.COLOURS[i - 1], label=TITLES[method])
        axis.set(xlabel=f"{coordinate} [{unit}]", ylim=(0, 1.05), yticks=[])
    for axis in axes[:, 0]:
        axis.set_ylabel("density, largest = 1")
    caption = DENSITIES_CAPTION.format(pair)
    return page.save(output, f"densities_{pair}", caption, figure, key_of=axes[0, 0])


def plot_clouds(output, pair, points):
    """Same scale on all axes, and the same in all panels: those of the target."""
    of_cloud = {
        name: of_cloud[["x_m", "y_m", "z_m"]].to_numpy()
        for name, of_cloud in points.groupby("cloud", sort=False)
    }
    target = of_cloud.pop("target")
    least, most = target.min(axis=0), target.max(axis=0)
    half = 0.6 * (most - least).max()
    figure, axes = page.panels(1, len(of_cloud), 2.6, 2.8, subplot_kw={"projection": "3d"})
    for (name, source), axis in zip(of_cloud.items(), axes[0]):
        axis.scatter(*target.T, s=0.8, color=page.COLOURS[0], depthshade=False, label="target")
        axis.scatter(*source.T, s=0.8, color=page.COLOURS[1], depthshade=False, label="source")
        limits = np.stack([(least + most) / 2 - half, (least + most) / 2 + half], axis=1)
        axis.set(title=TITLES.get(name, name), xlim=limits[0], ylim=limits[1], zlim=limits[2])
        axis.set_box_aspect((1, 1, 1))
        axis.view_init(elev=25, azim=-70)
        axis.set_axis_off()
    caption = f"{pair}: target and source before and after [m]."
    return page.save(output, f"clouds_{pair}", caption, figure, key_of=axes[0, 0])


def section_of(output, rows, tables):
    rows = rows.assign(nees_6=rows.nees / 6)
    rows["is_covered"] = (region_of(rows.nees) <= 0.95).astype(float).where(rows.nees.notna())
    pairs = list(rows.groupby("pair", sort=False))
    names = [pair for pair, _ in pairs]
    blocks = [Text(TEXT)]
    if "baseline" in tables:
        baseline = tables["baseline"]
        blocks.append(baseline_table(baseline[baseline.pair.isin(names)]))
    blocks += comparison_tables(rows)
    blocks += [plot_divergences(output, pairs), Text(MIXING_TEXT), mixing_table(pairs)]
    blocks += [method_table(DIVERGENCE_CAPTION.format(p), r, DIVERGENCE_COLUMNS) for p, r in pairs]
    blocks.append(Text(TRUTH_TEXT))
    blocks += [method_table(SCORE_CAPTION.format(p), r, SCORE_COLUMNS) for p, r in pairs]
    for pair in names:
        if f"draws_{pair}" in tables:
            blocks.append(plot_densities(output, pair, tables[f"draws_{pair}"]))
        if f"points_{pair}" in tables:
            blocks.append(plot_clouds(output, pair, tables[f"points_{pair}"]))
    return Section("Distribution (Table I)", blocks)
