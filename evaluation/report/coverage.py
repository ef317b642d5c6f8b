"""Coverage: is the posterior as wide as it should be?"""

import numpy as np

from report import frames, page

COLUMNS = ("scene", "condition", "seed", "method", "valid", "nees", "region", "pit_vx")
LEVELS = (0.50, 0.68, 0.90, 0.95)
TWISTS = ("vx", "vy", "vz", "wx", "wy", "wz")
# Beyond these a chi-square of 6 degrees of freedom has 1 % and 0.01 %.
MAX_GOOD_NEES = 16.812
MIN_BAD_NEES = 27.856
NUM_BINS = 10

HEADER = ["method", "valid / runs", "mean NEES/6"]
HEADER += [f"truths within {100 * level:.0f} % [95 % interval]" for level in LEVELS]
HEADER += ["log p", "energy score", "median error [mm]", "[deg]", "flagged [%]", "of those outside 95 % [%]"]  # fmt: skip
HEADER += ["median time [s]", "queries"]
SEQUENCE_HEADER = ["method", "pairs", "lost", "mean NEES/6 of those not lost", "truths within 50 %", "95 %", "log p"]
SEQUENCE_HEADER += ["median error [mm]", "[mrad]", "alarms / good", "misses / bad", "median time [s]"]


def flags_of(runs):
    """Whether the method itself doubts each run."""
    return runs.notes.str.contains(r"(?:^|;)flag:", regex=True)


def lost_of(runs):
    """Runs whose pose is beyond the recording's limit, or missing."""
    has_limit = runs.lost_displacement_m.notna()
    return has_limit & ~(runs.displacement_m <= runs.lost_displacement_m)


def within(runs, level):
    return frames.share_of(runs.region.dropna() <= level)


def doubts(runs):
    """Alarms among good runs, and misses among bad ones."""
    is_pose_alone = runs.displacement_m.notna() & (runs.valid == 0)
    runs = runs[~is_pose_alone]
    is_lost = lost_of(runs)
    is_doubted = flags_of(runs) | (runs.valid == 0)
    is_good = ~is_lost & (runs.nees < MAX_GOOD_NEES)
    is_bad = is_lost | (runs.nees > MIN_BAD_NEES)
    alarms = f"{(is_good & is_doubted).sum()} / {is_good.sum()}"
    return alarms, f"{(is_bad & ~is_doubted).sum()} / {is_bad.sum()}"


def percent(is_hit):
    return frames.number(100 * is_hit.mean() if len(is_hit) else np.nan, 0)


def row_of(method, runs):
    posed = runs[runs.displacement_m.notna()]
    queries = frames.median(posed.queries)
    return [
        method,
        f"{(runs.valid == 1).sum()} / {len(runs)}",
        frames.number((runs.nees[~lost_of(runs)] / 6).mean(), 2),
        *(frames.share_text(within(runs, level)) for level in LEVELS),
        frames.number(runs.log_score.mean(), 2),
        frames.number(runs.energy_score.mean(), 4),
        frames.number(1e3 * frames.median(runs.translation_error_m), 2),
        frames.number(np.degrees(frames.median(runs.rotation_error_rad)), 2),
        percent(flags_of(posed)),
        percent(flags_of(posed[posed.region > 0.95])),
        frames.number(frames.median(posed.seconds), 3),
        frames.number(queries if queries >= 0 else np.nan, 0),
    ]


def sequence_row_of(method, runs):
    """Of recordings, whose poses can be lost."""
    return [
        method,
        str(len(runs)),
        str(lost_of(runs).sum()),
        frames.number((runs.nees[~lost_of(runs)] / 6).mean(), 2),
        frames.share_text(within(runs, LEVELS[0])),
        frames.share_text(within(runs, LEVELS[-1])),
        frames.number(runs.log_score.mean(), 2),
        frames.number(1e3 * frames.median(runs.translation_error_m), 2),
        frames.number(1e3 * frames.median(runs.rotation_error_rad), 3),
        *doubts(runs),
        frames.number(frames.median(runs.seconds[runs.displacement_m.notna()]), 3),
    ]


def table_of(title, runs):
    of_method = [(name, runs[runs.method == name]) for name in frames.names_of(runs.method)]
    if runs.lost_displacement_m.notna().any():
        return page.Table(title, SEQUENCE_HEADER, [sequence_row_of(*item) for item in of_method])
    return page.Table(title, HEADER, [row_of(*item) for item in of_method])


def tables_of(runs):
    """Of each scene and condition, of the pools of those that have several, and of all."""
    cells = [(f"{s}, {c}", r) for (s, c), r in runs.groupby(["scene", "condition"], sort=False)]
    by_scene = [(f"{s}, all conditions", r) for s, r in runs.groupby("scene", sort=False)]
    by_condition = [(f"all scenes, {c}", r) for c, r in runs.groupby("condition", sort=False)]
    pools = [item for item in by_scene if item[1].condition.nunique() > 1]
    if len(by_condition) > 1:
        pools += [item for item in by_condition if item[1].scene.nunique() > 1]
    everything = [("all", runs)] if len(cells) > 1 else []
    return [table_of(*item) for item in cells + pools + everything]


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
    valid = runs[runs.valid == 1]
    if valid.empty:
        return page.Section(f"Coverage ({name}.csv)", tables_of(runs))
    names = frames.names_of(valid.method)
    methods = [(method, valid[valid.method == method]) for method in names]
    cells = list(dict.fromkeys(zip(runs.scene, runs.condition)))
    figures = [
        plot_regions(output, name, [(method, runs[runs.method == method]) for method in names]),
        plot_pit(output, name, methods),
        plot_anees(output, name, methods, cells),
    ]
    return page.Section(f"Coverage ({name}.csv)", figures + tables_of(runs))
