"""Closures of cycles of a pose graph: their probabilities are uniform if covariances are right."""

import numpy as np

from report import page

COLUMNS = ("vertices", "length", "squared_error", "num_degrees", "probability")
NUM_BINS = 10


def row_of(name, closures):
    inside = [f"{(closures.probability > p).mean():.2f}" for p in (0.5, 0.05)]
    ratio = closures.squared_error.sum() / closures.num_degrees.sum()
    return [name, str(len(closures)), f"{ratio:.2f}", *inside]


def plot_probabilities(output, name, table):
    figure, axes = page.panels(1, 1, 4.0, 2.2)
    axis = axes[0][0]
    axis.hist(table.probability, np.linspace(0, 1, NUM_BINS + 1), color=page.COLOURS[0])
    axis.axhline(len(table) / NUM_BINS, color="gray", linewidth=1)
    axis.set_xlabel("probability of a larger error")
    axis.set_ylabel("cycles")
    caption = (
        "Cycles in each of ten bins; the line is what is expected. Many on the left: covariances "
        "are too small, or edges are wrong. Many on the right: covariances are too large, or "
        "edges contain a prior."
    )
    return page.save(output, f"{name}_probabilities", caption, figure)


def section_of(output, name, table):
    lengths = sorted(table.length.unique())
    rows = [row_of(f"{length} edges", table[table.length == length]) for length in lengths]
    closures = page.Table(
        "Normalised squared error of closures per degree of freedom (1 if covariances are right), "
        "and shares of the closures in their 50 % and 95 % regions.",
        ["cycles of", "number", "NEES/degree", "50 %", "95 %"],
        [*rows, row_of("all", table)],
    )
    title = f"Cycles of a pose graph ({name}.csv)"
    return page.Section(title, [closures, plot_probabilities(output, name, table)])
