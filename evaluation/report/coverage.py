"""Coverage: is the posterior as wide as it should be?"""

import numpy as np

from report import page

COLUMNS = ("scene", "condition", "seed", "method", "valid", "nees", "region", "pit_vx")
TWISTS = ("vx", "vy", "vz", "wx", "wy", "wz")
NUM_BINS = 10

TEXT = (
    "Truths within 50 %: share of the runs whose true pose is in the posterior's region of that "
    "probability, with its 95 % interval. Errors are of the source's centroid and of the rotation. "
    "Flagged: share of the poses that the method itself doubts, of all and of those with the truth "
    "outside the 95 % region. Of recordings, a good pair is not lost and has an NEES below 16.812; "
    "a bad one is lost, or above 27.856. Alarms are flags on good pairs, misses are bad ones without."
)


def lost_of(runs):
    """Runs whose pose is beyond the recording's limit, or missing."""
    has_limit = runs.lost_displacement_m.notna()
    return has_limit & ~(runs.displacement_m <= runs.lost_displacement_m)


def plot_regions(output, name, methods):
    figure, axes = page.panels(1, 1, 5.5, 5.5)
    axis = axes[0, 0]
    axis.plot([0, 1], [0, 1], color="gray", linewidth=1)
    for i, (method, runs) in enumerate(methods):
        regions = np.sort(runs.region.dropna())
        shares = np.arange(len(regions) + 1) / max(1, len(regions))
        axis.step(
            [0, *regions, 1], [*shares, 1], where="post", label=method,
            color=page.COLOURS[i % len(page.COLOURS)],
        )  # fmt: skip
    axis.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel="probability of the region",
             ylabel="share of truths within it")  # fmt: skip
    caption = "Share of truths within regions of each probability; the diagonal is right."
    return page.save(output, f"{name}_regions", caption, figure, key_of=axis)


def plot_pit(output, name, methods):
    figure, axes = page.panels(len(methods), 6, 1.9, 1.5)
    for (method, runs), row in zip(methods, axes):
        for twist, axis in zip(TWISTS, row):
            pit = runs[f"pit_{twist}"].dropna()
            axis.hist(pit, NUM_BINS, (0, 1), weights=np.full(len(pit), NUM_BINS / max(1, len(pit))),
                      color=page.COLOURS[0])  # fmt: skip
            axis.axhline(1, color="gray", linewidth=1)
            axis.set(title=f"{method} {twist}", xlim=(0, 1))
    caption = "Probability integral transforms of the six coordinates; flat is right."
    return page.save(output, f"{name}_pit", caption, figure)


def plot_anees(output, name, methods, cells):
    figure, axes = page.panels(1, 1, max(7.0, 0.25 * len(cells)), 4.5)
    axis = axes[0, 0]
    for i, (method, runs) in enumerate(methods):
        found = runs[~lost_of(runs)]
        means = (found.nees / 6).groupby([found.scene, found.condition]).mean()
        axis.plot([means.get(cell, np.nan) for cell in cells], page.MARKERS[i % len(page.MARKERS)], label=method,
                  color=page.COLOURS[i % len(page.COLOURS)])  # fmt: skip
    axis.axhline(1, color="gray", linewidth=1)
    axis.set(yscale="log", ylabel="mean NEES / 6")
    axis.set_xticks(range(len(cells)), [" ".join(cell) for cell in cells], rotation=60, ha="right")
    caption = "Mean NEES / 6 of every scene and condition; 1 is right, above it too narrow. Lost pairs are left out."
    return page.save(output, f"{name}_anees", caption, figure, key_of=axis)


def section_of(output, name, runs, tables):
    blocks = [page.Text(TEXT), *tables]
    runs = runs.drop_duplicates(list(COLUMNS[:4]), keep="last")
    valid = runs[runs.valid == 1]
    if valid.empty:
        return page.Section(f"Coverage ({name}.csv)", blocks)
    methods = list(valid.groupby("method", sort=False))
    cells = list(dict.fromkeys(zip(runs.scene, runs.condition)))
    figures = [
        plot_regions(output, name, [(method, runs[runs.method == method]) for method, _ in methods]),
        plot_pit(output, name, methods),
        plot_anees(output, name, methods, cells),
    ]
    return page.Section(f"Coverage ({name}.csv)", figures + blocks)
