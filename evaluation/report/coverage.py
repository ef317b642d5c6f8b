"""Coverage: is the posterior as wide as it should be?"""

import numpy as np

from report import frames, page

COLUMNS = ("scene", "condition", "seed", "method", "valid", "nees", "region", "pit_vx", "lost_displacement_m",
           "queries")  # fmt: skip
TWISTS = ("vx", "vy", "vz", "wx", "wy", "wz")
NUM_BINS = 10
LEVELS = (0.5, 0.68, 0.9, 0.95)
# Beyond which a Gaussian has 1 % and 0.01 %.
MAX_GOOD_NEES, MIN_BAD_NEES = 16.812, 27.856

TEXT = (
    "Truths within 50 %: share of the runs whose true pose is in the posterior's region of that "
    "probability, with its 95 % interval, which counts a real pair once, for all its seeds. NEES/6 "
    "leaves lost pairs out. Errors are of the source's centroid and of the rotation. "
    "Flagged: share of the poses that the method itself doubts, of all and of those with the truth "
    "outside the 95 % region. Of recordings, a good pair is not lost and has an NEES below 16.812; "
    "a bad one is lost, or above 27.856. Alarms are flags on good pairs, misses are bad ones without."
)


def lost_of(runs):
    """Runs whose pose is beyond the recording's limit, or missing."""
    has_limit = runs.lost_displacement_m.notna()
    return has_limit & ~(runs.displacement_m <= runs.lost_displacement_m)


def interval_of(share, number):
    """The 95 % interval (Wilson's) of a share of this number of runs."""
    part = 1.959964**2 / number
    centre = (share + part / 2) / (1 + part)
    half_width = np.sqrt(share * (1 - share) * part + part**2 / 4) / (1 + part)
    return max(0, centre - half_width), min(1, centre + half_width)


def share_text(is_hit, runs):
    """Share of the runs for which it is true, with its interval. Seeds move a real pair and leave
    its points and their errors as they are, so it counts once."""
    if not len(is_hit):
        return "-"
    is_real = (runs.condition == "real").all()
    number = min(len(is_hit), runs.scene.nunique()) if is_real else len(is_hit)
    low, high = interval_of(is_hit.mean(), number)
    return f"{is_hit.mean():.2f} [{low:.2f},{high:.2f}]"


def cells_of(runs):
    """What is told of the runs of a method, by its title."""
    number = frames.number
    is_lost, is_flagged = lost_of(runs), runs.notes.str.contains("(?:^|;)flag:")
    posed, placed = runs.displacement_m.notna(), runs[runs.region.notna()]
    flagged = is_flagged[posed].mean()
    flagged_outside = is_flagged[posed & (runs.region > 0.95)].mean()
    cells = {
        "valid/runs": f"{runs.valid.sum()}/{len(runs)}",
        "lost": str(is_lost.sum()),
        "mean NEES/6": number((runs.nees[~is_lost] / 6).mean(), 2),
    }
    for level in LEVELS:
        cells[f"truths within {100 * level:.0f} %"] = share_text(placed.region <= level, runs)
    # A pose alone is neither good nor bad.
    judged = (runs.valid == 1) | ~posed
    is_good = judged & ~is_lost & (runs.nees < MAX_GOOD_NEES)
    is_bad = judged & (is_lost | (runs.nees > MIN_BAD_NEES))
    is_doubted = is_flagged | (runs.valid == 0)
    queries = runs.queries[posed].median()
    return {
        **cells,
        "mean log p": number(runs.log_score.mean(), 2),
        "energy score": number(runs.energy_score.mean(), 4),
        "median error [mm]": number(1e3 * runs.translation_error_m.median(), 2),
        "median error [deg]": number(np.degrees(runs.rotation_error_rad.median()), 4),
        "flagged [%]": number(100 * flagged, 0),
        "flagged if outside [%]": number(100 * flagged_outside, 0),
        "alarms/good": f"{(is_good & is_doubted).sum()}/{is_good.sum()}",
        "misses/bad": f"{(is_bad & ~is_doubted).sum()}/{is_bad.sum()}",
        "median time [s]": number(runs.seconds[posed].median(), 3),
        "median queries": number(queries if queries >= 0 else np.nan, 0),
    }


def table_of(title, runs):
    rows = {method: cells_of(of_method) for method, of_method in runs.groupby("method", sort=False)}
    # Nothing is lost or good without a limit.
    hidden = () if runs.lost_displacement_m.notna().any() else ("lost", "alarms/good", "misses/bad")
    header = [column for column in next(iter(rows.values())) if column not in hidden]
    lines = [[method, *(cells[column] for column in header)] for method, cells in rows.items()]
    return page.Table(title, ["method", *header], lines)


def tables_of(runs):
    """Of each scene and condition, of each that has several of the other, and of all."""
    tables = [table_of(", ".join(cell), of_cell) for cell, of_cell in runs.groupby(["scene", "condition"], sort=False)]
    for scene, of_scene in runs.groupby("scene", sort=False):
        if of_scene.condition.nunique() > 1:
            tables.append(table_of(f"{scene}, all conditions", of_scene))
    for condition, of_condition in runs.groupby("condition", sort=False):
        if of_condition.scene.nunique() > 1 and runs.condition.nunique() > 1:
            tables.append(table_of(f"all scenes, {condition}", of_condition))
    return [*tables, table_of("all", runs)] if len(tables) > 1 else tables


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


def section_of(output, name, runs):
    runs = runs.drop_duplicates(list(COLUMNS[:4]), keep="last")
    blocks = [page.Text(TEXT)]
    for _, of_kind in runs.groupby(runs.lost_displacement_m.notna()):
        blocks += tables_of(of_kind)
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
