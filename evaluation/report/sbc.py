"""Simulation-based calibration: ranks of true poses among draws, uniform if all is right."""

import numpy as np

from report import frames, page

COLUMNS = ("sampler", "seed", "valid", "rank_x", "rank_yaw")
NUM_BINS = 10
NUM_RANKS = 100
CAPTION = (
    "Chi-square of ten bins of ranks, of at least 50 runs: uniform ranks are below 27.9 with a "
    "probability of 99.9 %. calibrated-scans is for information: its likelihood is no model of the scans."
)


def histogram(ranks):
    return np.bincount(ranks.astype(int) * NUM_BINS // NUM_RANKS, minlength=NUM_BINS)


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


def chi_square(ranks):
    """0 of evenly filled bins."""
    expected = len(ranks) / NUM_BINS
    return ((histogram(ranks) - expected) ** 2 / expected).sum() if expected else np.nan


def table_of(samplers):
    lines = []
    for sampler, runs in samplers:
        valid = runs[runs.valid == 1]
        statistics = [frames.number(chi_square(valid[f"rank_{c}"]), 1) for c in frames.COORDINATES]
        lines.append([sampler, f"{len(valid)}/{len(runs)}", *statistics])
    return page.Table(CAPTION, ["sampler", "valid/runs", *frames.COORDINATES], lines)


def section_of(output, name, runs):
    runs = runs.drop_duplicates(["sampler", "seed"], keep="last")
    samplers = list(runs.groupby("sampler", sort=False))
    title = f"Simulation-based calibration ({name}.csv)"
    return page.Section(title, [table_of(samplers), plot_ranks(output, name, samplers)])
