"""Samplers against a gold standard: distance of their draws, and their rate."""

from report import frames, page

COLUMNS = ("gold_key", "scene", "sigma", "effective_points", "sampler", "ks_x")
GOOD_KS = 0.06
HEADER = ["sampler", "runs", "6-D KL median", "6-D KL worst", "1-D KL median", "W1 median", "KS<.06 %",
          "R-hat worst", "bulk ESS smallest", "tail ESS smallest", "ESS/s median", "CPU [s] median",
          "mixed runs"]  # fmt: skip


def row_of(sampler, runs):
    kl, w1, ks = (runs[[f"{kind}_{c}" for c in frames.COORDINATES]] for kind in ("kl", "w1", "ks"))
    numbers = (
        (runs.kl.median(), 4), (runs.kl.max(), 4), (kl.stack().median(), 4),
        (w1.max(axis=1).median(), 3), (100 * (ks < GOOD_KS).to_numpy().mean(), 0), (runs.rhat.max(), 3),
        (runs.bulk_ess.min(), 0), (runs.tail_ess.min(), 0), (runs.min_ess_per_second.median(), 1),
        (runs.seconds.median(), 3),
    )  # fmt: skip
    cells = [frames.number(*number) for number in numbers]
    return [sampler, str(len(runs)), *cells, str((runs.status == "ok").sum())]


def rows_of(runs):
    """Step sizes that were tried less often than others of their sampler are left out."""
    num_runs = runs.sampler.map(runs.sampler.value_counts())
    family = runs.sampler.str.replace(r"^(paper|mala) .*", r"\1", regex=True)
    chosen = runs[num_runs == num_runs.groupby(family).transform("max")]
    return [row_of(sampler, of_sampler) for sampler, of_sampler in chosen.groupby("sampler")]


def section_of(_output, name, runs):
    """With other points or another gold standard it is another posterior."""
    runs = runs.drop_duplicates([*COLUMNS[:5], "seed"], keep="last")
    tables = []
    for (scene, sigma, number), of_cell in runs.groupby(["scene", "sigma", "effective_points"]):
        for gold_key, of_gold in of_cell.groupby("gold_key"):
            title = f"{scene}, sigma {sigma:g} m, N {number:g}"
            if of_cell.gold_key.nunique() > 1:
                title += f", gold standard {gold_key}"
            tables.append(page.Table(title, HEADER, rows_of(of_gold)))
    return page.Section(f"Samplers ({name}.csv)", tables)
