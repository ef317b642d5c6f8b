"""The paper's evaluation: Table I, curves, run time, accuracy."""

import json

import numpy as np

from report import distribution, frames, page
from report.frames import COORDINATES
from report.page import Section, Table, Text

CURVE_COLUMNS = [f"kl_{c}" for c in COORDINATES] + ["kl"]
KL = "KL(baseline ‖ method) [nats]"

INTRODUCTION = (
    "The evaluation of F. Afzal Maken, F. Ramos, L. Ott: Estimating Motion Uncertainty with "
    "Bayesian ICP, ICRA 2020 (arXiv 2004.07973), repeated. Metres, radians, nats. A pose maps "
    "source points into the target frame. Bayesian ICP is the paper's algorithm with its "
    "constants; Online-ICP its competitor, Censi's closed form in the point-to-plane form of "
    "Prakhya et al.; exact and calibrated are this project's."
)
QUICK = (
    "Made with --quick: too few runs for any conclusion, only to see that all of it works."
)
SAMPLES = (
    "Runs of 6000 draws by four chains, cut after the first draws of each. The paper: 2000 to "
    "3000 are nearly optimal. The step size of Bayesian ICP decays in the last 5 % of a run, "
    "here from draw 5700 on."
)
BURN_IN = (
    "Runs of 6000 draws by four chains: the first draws are left out, the next 2000 taken. The "
    "paper: no visible effect when the start is near. Beyond the paper: the same from chains "
    "that start as far out as the prior allows."
)
RUNTIME = (
    "Time for 1000 draws by four chains, the tree of the target given. {}More threads than "
    "cores cannot be faster, and other work makes wall time longer, but hardly processor time. "
    "The paper's program is another one on another machine; its figures are for scale."
)
ACCURACY = (
    "From each start, uniform within ±1 m and ±0.3 rad of the pair's guess on each axis, the "
    "error of the final pose: Euclidean distance of the translations, and the sum of the "
    "absolute differences of roll, pitch and yaw. Bayesian ICP gives the mean of 2000 draws. "
    "Preset paper has the paper's prior, which is about the guess and thus knows something "
    "that the others do not; for the presets exact and calibrated the start is the guess, and "
    "the prior about it has the variance of the starts. A direction that the clouds do not "
    "hold, such as the yaw of a can, keeps the error of its start or its prior's."
)
REPEAT = (
    "Results other than times depend on nothing but this command, the data and the versions "
    "below; not on the number of threads."
)

CURVE_TITLES = {
    "bayesian-icp": "Bayesian ICP",
    "exact": "exact",
    "calibrated": "calibrated",
    "near": "Bayesian ICP from the guess",
    "far": "Bayesian ICP from ±0.35 m, ±0.35 rad",
}
ACCURACY_TITLES = {
    "paper": "Bayesian ICP, paper",
    "exact": "Bayesian ICP, exact",
    "calibrated": "Bayesian ICP, calibrated",
    "sgd-icp": "SGD-ICP, Adam",
    "sgd-icp-filter": "SGD-ICP, Adam, repeated matches left out",
    "icp": "ICP to completion",
}
# Title, text and axis of the sections.
CURVES = {
    "samples": ("Number of draws", SAMPLES, "draws"),
    "burn_in": ("Burn-in", BURN_IN, "draws left out"),
}
# What the paper states of its program on an i7-7700 with four cores: seconds per 1000 draws.
PAPER_SECONDS = {1: (8.88, 3.59), 2: (6.392, 0.731), 4: (3.298, 0.573)}


def chosen(rows, record):
    """The rows that the study's last run asked for; all of them where nothing says so."""
    if record is None:
        return rows
    key_of = {pair["name"]: pair["key"] for pair in record["pairs"]}
    seeds = range(record["seed"], record["seed"] + record["seeds"])
    rows = rows[(rows.key == rows.pair.map(key_of)) & rows.seed.isin(seeds)]
    if "starts" in record:
        rows = rows[rows.start < record["starts"]]
    # In the order of the command line, not of the file.
    return rows.sort_values("pair", key=lambda p: p.map(list(key_of).index), kind="stable")


def curve_section(output, name, rows, title, text, axis_title):
    pairs = list(rows.groupby("pair", sort=False))
    figure, axes = page.panels(len(pairs), 6, 2.6, 2.4)
    tables = []
    for (pair, of_pair), line in zip(pairs, axes):
        for i, variant in enumerate(v for v in CURVE_TITLES if (of_pair.variant == v).any()):
            values = list(of_pair[of_pair.variant == variant].groupby("value"))
            spreads = [[frames.spread_of(r[c]) for c in CURVE_COLUMNS] for _, r in values]
            where = [value for value, _ in values]
            for k, axis in enumerate(line):
                axis.errorbar(
                    where, [s[k][0] for s in spreads], [s[k][1] for s in spreads],
                    label=CURVE_TITLES[variant], color=page.COLOURS[i], marker="o", markersize=3,
                )  # fmt: skip
            cells = [[str(v), *map(frames.spread_text, s)] for v, s in zip(where, spreads)]
            caption = f"{pair}, {CURVE_TITLES[variant]}: {KL}."
            tables.append(Table(caption, [axis_title, *COORDINATES, "6-D"], cells))
        for coordinate, axis in zip(COORDINATES, line):
            axis.set(title=f"{pair}, {coordinate}", yscale="log", xlabel=axis_title)
        line[0].set_ylabel("KL [nats]")
    caption = f"{KL}, mean and standard deviation over the runs."
    picture = page.save(output, name, caption, figure, key_of=axes[0, 0])
    return Section(title, [Text(text), picture, *tables])


def runtime_section(output, rows, cores):
    """Over the pairs, of the median of each pair's runs, which other work disturbs least."""
    measures = ["wall_s_per_1000_draws", "cpu_s_per_1000_draws"]
    medians = rows.groupby(["method", "pair", "threads"])[measures].median()
    threads = sorted(set(rows.threads))
    methods = [m for m in distribution.TITLES if (rows.method == m).any()]
    figure, axes = page.panels(1, 1, 6, 4)
    axis = axes[0, 0]
    table = []
    for i, method in enumerate(methods):
        of_method = medians.loc[method].unstack("threads")
        spreads = [[frames.spread_of(of_method[m].get(n, [])) for n in threads] for m in measures]
        wall = np.array([s[:2] for s in spreads[0]])
        axis.errorbar(threads, wall[:, 0], wall[:, 1], label=distribution.TITLES[method],
                      color=page.COLOURS[i], marker="o")  # fmt: skip
        texts = [frames.spread_text(s) for measure in spreads for s in measure]
        table.append([distribution.TITLES[method], *texts])
    paper = np.array(list(PAPER_SECONDS.values()))
    axis.errorbar(list(PAPER_SECONDS), paper[:, 0], paper[:, 1], label="the paper", color="gray",
                  linestyle="--", marker="o")  # fmt: skip
    axis.set(yscale="log", xlabel="threads", ylabel="wall time per 1000 draws [s]", xticks=threads)
    stated = [PAPER_SECONDS.get(n) for n in threads]
    texts = ["–" if s is None else f"{s[0]:.3f} ± {s[1]:.3f}" for s in stated]
    table.append(["the paper, Intel i7-7700 with 4 cores", *texts, *["–"] * len(threads)])
    header = ["method"] + [f"{n} thread{'s' if n > 1 else ''} [s]" for n in threads]
    caption = (
        "Seconds of wall time per 1000 draws, warm-up and estimate included: mean ± standard "
        "deviation over the pairs, of the median of each pair's runs; and seconds of processor "
        "time of all threads."
    )
    caption_of_figure = "Wall time per 1000 draws: mean and standard deviation over pairs."
    blocks = [
        Text(RUNTIME.format(f"This machine has {cores} cores. " if cores else "")),
        Table(caption, header + [f"processor, {n} [s]" for n in threads], table),
        page.save(output, "runtime", caption_of_figure, figure, key_of=axis),
    ]
    return Section("Run time", blocks)


def accuracy_row(title, runs):
    cells = [title]
    for column in ("translation_error_m", "rotation_error_rad"):
        errors = 1000 * runs[column]
        finite = errors[np.isfinite(errors)]
        cells.append(frames.spread_text(frames.spread_of(errors)))
        cells.append(f"{finite.median():.3g}" if len(finite) else "–")
    return cells


def accuracy_section(output, rows):
    header = ["method", "translation, mean ± sd [mm]", "median [mm]"]
    header += ["rotation, mean ± sd [mrad]", "median [mrad]"]
    pairs = list(rows.groupby("pair", sort=False))
    methods = [m for m in ACCURACY_TITLES if (rows.method == m).any()]
    figure, axes = page.panels(2, len(pairs), 2.4, 3.2)
    tables = []
    for i, (pair, runs) in enumerate(pairs):
        of_method = [runs[runs.method == method] for method in methods]
        num_starts = max(map(len, of_method))
        lines = [accuracy_row(ACCURACY_TITLES[m], r) for m, r in zip(methods, of_method)]
        tables.append(Table(f"{pair}: errors from {num_starts} starts.", header, lines))
        for axis, column in zip(axes[:, i], ("translation_error_m", "rotation_error_rad")):
            axis.boxplot([r[column].dropna() for r in of_method], widths=0.5, sym=".")
            axis.set(title=pair, yscale="log")
            axis.set_xticks(range(1, len(methods) + 1), methods, rotation=45, ha="right")
    axes[0, 0].set_ylabel("translation error [m]")
    axes[1, 0].set_ylabel("rotation error [rad]")
    caption = "Errors of the final poses from all starts, a box a method."
    return Section("Accuracy", [Text(ACCURACY), *tables, page.save(output, "accuracy", caption, figure)])


def introduction(records):
    blocks = [Text(INTRODUCTION)]
    skipped = max((r["skipped_pairs"] for r in records), default=0)
    if skipped:
        blocks.append(Text(f"{skipped} pairs could not be read and are not here."))
    if any(r["quick"] for r in records):
        blocks.append(Text(QUICK))
    return Section("What this is", blocks)


def origin(study, records):
    commands = "\n".join(dict.fromkeys(r["command"] for r in records))
    versions = [[name, str(value)] for name, value in study["versions"].items()]
    versions.append(["matplotlib", page.matplotlib.__version__])
    table = Table("Versions and machine.", ["what", "version"], versions)
    return Section("How to repeat it", [Text(REPEAT), page.Code(commands), table])


def sections_of(output, tables):
    """Of the experiments that the output has files of."""
    study_file = output.folder / "study.json"
    study = json.loads(study_file.read_text("utf-8")) if study_file.exists() else None
    record_of = study["experiments"] if study else {}
    rows_of = {}
    for name in ("distribution", "samples", "burn_in", "runtime", "accuracy"):
        if name in tables and {"key", "pair", "seed"} <= set(tables[name].columns):
            rows = chosen(tables[name], record_of.get(name))
            if len(rows):
                rows_of[name] = rows
    cores = study and study["versions"].get("cores")
    records = [record_of[name] for name in rows_of if name in record_of]
    sections = [introduction(records)] if rows_of else []
    for name, rows in rows_of.items():
        if name == "distribution":
            sections.append(distribution.section_of(output, rows, tables))
        elif name == "runtime":
            sections.append(runtime_section(output, rows, cores))
        elif name == "accuracy":
            sections.append(accuracy_section(output, rows))
        else:
            sections.append(curve_section(output, name, rows, *CURVES[name]))
    if study and sections:
        sections.append(origin(study, records))
    return sections
