"""Table I of the paper, and what of it can be compared with ours: orders."""

import numpy as np

OBJECTS = ("bowl", "can", "mug_hidden_handle", "table_top", "mug", "table")

# Maken, Ramos, Ott (2020), Table I [nats]; objects in the order of OBJECTS.
BAYESIAN = {
    "x": (0.387, 0.118, 0.189, 0.619, 0.133, 0.086),
    "y": (0.373, 0.163, 0.218, 1.117, 0.092, 0.082),
    "z": (0.007, 0.020, 0.015, 0.015, 0.023, 0.008),
    "roll": (0.040, 0.063, 0.105, 5.947, 0.425, 0.012),
    "pitch": (0.084, 0.051, 0.335, 1.099, 0.098, 0.015),
    "yaw": (8.849, 6.620, 5.467, 0.842, 6.457, 1.148),
}
BAYESIAN_SD = {
    "x": (0.199, 0.078, 0.051, 0.044, 0.049, 0.011),
    "y": (0.311, 0.168, 0.112, 0.222, 0.019, 0.016),
    "z": (0.003, 0.006, 0.004, 0.000, 0.011, 0.001),
    "roll": (0.017, 0.055, 0.019, 0.828, 0.022, 0.003),
    "pitch": (0.038, 0.045, 0.016, 0.023, 0.027, 0.004),
    "yaw": (6.113, 3.251, 4.926, 0.254, 1.062, 0.283),
}
ONLINE = {
    "x": (0.731, 0.078, 0.104, 1.938, 0.100, 0.643),
    "y": (0.254, 0.312, 1.596, 1.845, 0.077, 0.062),
    "z": (0.000, 0.000, 0.055, 0.027, 0.018, 0.000),
    "roll": (0.078, 0.000, 0.166, 7.889, 0.571, 0.000),
    "pitch": (0.454, 0.000, 0.572, 1.568, 0.081, 0.002),
    "yaw": (39.689, 32.955, 370.697, 21.917, 13.438, 38.848),
}
ONLINE_SD = 0.004  # the paper: all are below
NUM_RUNS = 10

BAYESIAN_LOWER, ONLINE_LOWER, UNDECIDED = "Bayesian ICP", "Online-ICP", "undecided"


def cell(name, coordinate):
    """The paper's spreads of Bayesian ICP and of Online-ICP; None of another object."""
    if name not in OBJECTS:
        return None
    i = OBJECTS.index(name)
    bayesian = (BAYESIAN[coordinate][i], BAYESIAN_SD[coordinate][i], NUM_RUNS, NUM_RUNS)
    return bayesian, (ONLINE[coordinate][i], ONLINE_SD, NUM_RUNS, NUM_RUNS)


def order_of(bayesian, online):
    """Which of two spreads is nearer to the baseline. Undecided where the means differ by no
    more than the root of the summed variances; the mean is infinite if a value is."""
    means = [s[0] if s[2] == s[3] else np.inf for s in (bayesian, online)]
    difference = abs(means[0] - means[1])
    if not (difference == np.inf or difference > np.hypot(bayesian[1], online[1])):
        return UNDECIDED
    return BAYESIAN_LOWER if means[0] < means[1] else ONLINE_LOWER


def agreement(paper, ours):
    """Whether two orders are the same: "yes", "no", or "undecided" if one of them is."""
    if UNDECIDED in (paper, ours):
        return UNDECIDED
    return "yes" if paper == ours else "no"
