"""Samplers against a gold standard: distance of their draws, and their rate."""

from report import page

COLUMNS = ("gold_key", "scene", "sigma", "effective_points", "sampler", "ks_x")


def section_of(_output, name, _runs, tables):
    return page.Section(f"Samplers ({name}.csv)", tables)
