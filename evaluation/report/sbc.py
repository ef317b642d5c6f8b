"""Simulation-based calibration: ranks of true poses among draws, uniform if all is right."""

import numpy as np

from report import frames, page

COLUMNS = ("sampler", "seed", "valid", "rank_x", "rank_yaw")
NUM_BINS = 10
NUM_RANKS = 100
# Chi-square of 9 degrees of freedom: beyond it is 0.1 %.
MAX_CHI_SQUARE = 27.9
# Scans come from no model that the posterior knows.
NOT_WELL_SPECIFIED = ("calibrated-scans",)


def histogram(ranks):
    return np.bincount(ranks.astype(int) * NUM_BINS // NUM_RANKS, minlength=NUM_BINS)


def chi_square(counts):
    """Sum over the bins of (count - expected)^2 / expected."""
    expected = counts.mean()
    return ((counts - expected) ** 2 / expected).sum() if expected > 0 else np.nan


def row_of(sampler, runs):
    valid = runs[runs.valid == 1]
    statistics = [chi_square(histogram(valid[f"rank_{k}"])) for k in frames.COORDINATES]
    is_uniform = len(valid) == len(runs) and max(statistics) < MAX_CHI_SQUARE
    verdict = "uniform" if is_uniform else "NOT UNIFORM"
    if sampler in NOT_WELL_SPECIFIED:
        verdict = "no model of the scans: for information"
    return [sampler, f"{len(valid)} / {len(runs)}", *(f"{s:.1f}" for s in statistics), verdict]


def plot_ranks(output, name, samplers):
    figure, axes = page.panels(len(samplers), 6, 1.9, 1.5)
    for (sampler, runs), row in zip(samplers, axes):
        valid = runs[runs.valid == 1]
        for coordinate, axis in zip(frames.COORDINATES, row):
            axis.bar(range(NUM_BINS), histogram(valid[f"rank_{coordinate}"]), color=page.COLOURS[0])
            axis.axhline(len(valid) / NUM_BINS, color="gray", linewidth=1)
            axis.set_title(f"{sampler} {coordinate}", fontsize=7)
    caption = "Runs in each of ten bins of ranks; the line is what is expected."
    return page.save(output, f"{name}_ranks", caption, figure)


def section_of(output, name, table):
    samplers = [(s, table[table.sampler == s]) for s in frames.names_of(table.sampler)]
    ranks = page.Table(
        f"Chi-square of 10 bins, uniform if below {MAX_CHI_SQUARE} (0.1 %).",
        ["sampler", "valid / runs", *frames.COORDINATES, "verdict"],
        [row_of(*item) for item in samplers],
    )
    title = f"Simulation-based calibration ({name}.csv)"
    return page.Section(title, [ranks, plot_ranks(output, name, samplers)])
