"""Simulation-based calibration: ranks of true poses among draws, uniform if all is right."""

import numpy as np

from report import frames, page

COLUMNS = ("sampler", "seed", "valid", "rank_x", "rank_yaw")
NUM_BINS = 10
NUM_RANKS = 100


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


def section_of(output, name, runs, tables):
    samplers = list(runs.groupby("sampler", sort=False))
    title = f"Simulation-based calibration ({name}.csv)"
    return page.Section(title, [*tables, plot_ranks(output, name, samplers)])
