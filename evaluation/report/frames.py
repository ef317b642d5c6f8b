"""CSV files as tables, and numbers as words."""

import numpy as np
import pandas as pd

COORDINATES = ("x", "y", "z", "roll", "pitch", "yaw")
UNITS = ("m", "m", "m", "rad", "rad", "rad")
# Columns that are text, whatever they look like.
WORDS = ("key", "gold_key", "pair", "method", "variant", "scene", "condition", "sampler", "notes", "inputs",
         "recording", "quality", "means", "covariances", "vertices")  # fmt: skip


def read(path):
    try:
        # A pair may be called NA.
        unknown = {"keep_default_na": False, "na_values": ["nan", "-nan", ""]}
        table = pd.read_csv(path, dtype=dict.fromkeys(WORDS, str), **unknown)
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}") from error
    if "notes" in table:
        table["notes"] = table.notes.fillna("")
    return table


def read_folder(folder):
    """The CSV files of a folder by their names, without .csv."""
    return {path.stem: read(path) for path in sorted(folder.glob("*.csv")) if path.is_file()}


def spread_of(values):
    """Mean and standard deviation (NaN of one) of the finite ones, how many those are, and of how
    many. Where none is finite, unknown ones do not count."""
    values = np.asarray(values, float)
    finite = values[np.isfinite(values)]
    if not finite.size:
        return (np.nan, 0.0, 0, np.isinf(values).sum())
    sd = finite.std(ddof=1) if finite.size > 1 else np.nan
    return (finite.mean(), sd, finite.size, values.size)


def short(value):
    """Three decimals, or three digits of a large number."""
    if np.isnan(value):
        return "-"
    return f"{value:.3f}" if abs(value) < 1000 else f"{value:.3g}"


def spread_text(spread):
    """As "0.387 ± 0.199", or "0.387" of one value; says how many values were finite if not all."""
    mean, sd, num_finite, num_values = spread
    if num_finite == 0:
        return "infinite" if num_values else "-"
    text = short(mean) if np.isnan(sd) else f"{short(mean)} ± {short(sd)}"
    return text if num_finite == num_values else f"{text} ({num_finite} of {num_values} finite)"


def spread_cells(rows, columns):
    return [spread_text(spread_of(rows[column])) for column in columns]


def number(value, decimals):
    """So many decimals, fewer of a number so large that nobody reads them."""
    if np.isnan(value):
        return "-"
    limit = 1e4 if decimals else 1e7
    return f"{value:.{decimals}f}" if abs(value) < limit else f"{value:.1e}"
