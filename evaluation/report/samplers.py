"""Samplers against a gold standard: distance of their draws, and their rate."""

import numpy as np

from report import frames, page

COLUMNS = ("gold_key", "scene", "sigma", "effective_points", "sampler", "ks_x")
GOOD_KS = 0.06  # a marginal of a smaller Kolmogorov-Smirnov distance counts as right

HEADER = ["sampler", "runs", "6-D KL, median", "worst", "1-D KL, median", "W1, median"]
HEADER += ["KS < .06 [%]", "R-hat, worst", "bulk ESS, smallest", "tail ESS, smallest"]
HEADER += ["ESS / s, median", "CPU time, median [s]", "mixed runs"]


def columns(prefix):
    return [f"{prefix}_{coordinate}" for coordinate in frames.COORDINATES]


def row_of(sampler, runs):
    return [
        sampler,
        str(len(runs)),
        f"{runs.kl.median():.4f}",
        f"{runs.kl.max():.4f}",
        f"{np.median(runs[columns('kl')]):.4f}",
        f"{runs[columns('w1')].max(axis=1).median():.3f}",
        f"{100 * (runs[columns('ks')] < GOOD_KS).to_numpy().mean():.0f}",
        f"{runs.rhat.max():.3f}",
        f"{runs.bulk_ess.min():.0f}",
        f"{runs.tail_ess.min():.0f}",
        f"{(runs.bulk_ess / runs.seconds).median():.1f}",
        f"{runs.seconds.median():.3f}",
        str((runs.status == "ok").sum()),
    ]


def table_of(cell, runs, is_only_one):
    """Step sizes that were only tried with the first seed are left out."""
    sizes = runs.groupby("sampler").size()
    most = sizes.groupby(sizes.index.str.split(" ").str[0]).max()
    chosen = [name for name in sizes.index if sizes[name] == most[name.split(" ")[0]]]
    title = f"{cell[0]}, sigma {cell[1]:g} m, N = {cell[2]:g}"
    if not is_only_one:
        title += f", gold standard {cell[3]}"
    return page.Table(title, HEADER, [row_of(n, runs[runs.sampler == n]) for n in chosen])


def section_of(_output, name, table):
    """A table for each cell and gold standard: with other points it is another posterior."""
    cell = ["scene", "sigma", "effective_points"]
    num_standards = table.groupby(cell).gold_key.nunique()
    tables = [
        table_of(key, runs, num_standards[key[:3]] == 1)
        for key, runs in table.groupby([*cell, "gold_key"])
    ]
    return page.Section(f"Samplers ({name}.csv)", tables)
