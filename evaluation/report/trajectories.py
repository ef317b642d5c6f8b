"""Trajectories of the edges of several methods: their errors, and whether covariances say so."""

import numpy as np

from report import frames, page

COLUMNS = ("recording", "means", "covariances", "ate_m", "rpe_m", "nees_per_degree", "cycle_nees_per_degree")
LIKE_TIES = 1.02


def name_of(means, covariances):
    return means if means == covariances else f"{means} + {covariances}"


def mean_of(rows):
    """Root mean squares of errors over the seeds, means of the rest; unknown if one is."""
    errors = ("ate_m", "rpe_m", "rpe_rad", "drift_m")
    root = {name: np.sqrt((rows[name] ** 2).mean(skipna=False)) for name in errors}
    others = ("num_edges", "nees_per_degree", "cycle_nees_per_degree")
    means = {name: rows[name].mean(skipna=False) for name in others}
    return {**root, **means}


def rows_of(table):
    """A row for each recording and method, the smallest error of each recording marked."""
    rows = []
    for recording, runs in table.groupby("recording", sort=False):
        methods = runs.groupby(["means", "covariances"], sort=False)
        means = {name_of(*key): mean_of(members) for key, members in methods}
        best = min(one["ate_m"] for one in means.values())
        for name, one in means.items():
            ate = f"{1e3 * one['ate_m']:.2f}"
            rows.append([
                f"{recording} ({runs.quality.iloc[0]})",
                name,
                f"{one['num_edges']:.0f}",
                f"{ate} *" if one["ate_m"] <= LIKE_TIES * best else ate,
                f"{1e3 * one['rpe_m']:.2f}",
                f"{np.degrees(one['rpe_rad']):.3f}",
                f"{1e3 * one['drift_m']:.1f}",
                frames.number(one["nees_per_degree"], 2),
                frames.number(one["cycle_nees_per_degree"], 2),
            ])  # fmt: skip
    return rows


def plot_errors(output, name, table):
    """Errors relative to the trajectory with the calibrated covariances."""
    recordings = list(table.recording.unique())
    own = table[(table.means == "calibrated") & (table.covariances == "calibrated")]
    reference = own.groupby("recording").ate_m.apply(lambda ate: np.sqrt((ate**2).mean()))
    figure, axes = page.panels(1, 1, 7.5, max(1.6, 0.6 + 0.25 * len(recordings)))
    axis = axes[0][0]
    methods = table.groupby(["means", "covariances"], sort=False)
    for number, (key, runs) in enumerate(methods):
        ate = runs.groupby("recording").ate_m.apply(lambda ate: np.sqrt((ate**2).mean()))
        axis.plot(
            (ate / reference).reindex(recordings), range(len(recordings)),
            "o" if key[0] == "calibrated" else "x", label=name_of(*key), markersize=5,
            color=page.COLOURS[number % len(page.COLOURS)],
        )  # fmt: skip
    axis.set_xscale("log")
    axis.set_yticks(range(len(recordings)), recordings)
    axis.set_ylim(len(recordings) - 0.5, -0.5)
    axis.set_xlabel("ATE / ATE of calibrated")
    caption = (
        "Error of the positions after alignment, divided by that with the means and covariances of "
        "preset calibrated. Dots have its means; behind a plus are other covariances."
    )
    return page.save(output, f"{name}_errors", caption, figure, axis)


def section_of(output, name, table):
    errors = page.Table(
        "Number of registrations that are of use. Root mean square errors over the seeds: positions "
        "after alignment (ATE; *: the smallest of the recording, or within 2 % of it), relative "
        "poses of neighbours (RPE), the last pose (drift). Normalised squared error per degree of freedom of the poses (NEES/6) "
        "and of the closures of cycles: 1 if covariances are right. The letter is the quality of "
        "the true poses, whose accuracy is in NEES/6; those of C are of the same scans and have none.",
        ["recording", "edges of", "edges", "ATE [mm]", "RPE [mm]", "RPE [deg]", "drift [mm]", "NEES/6",
         "cycles"],
        rows_of(table),
    )
    title = f"Trajectories ({name}.csv)"
    return page.Section(title, [errors, plot_errors(output, name, table)])
