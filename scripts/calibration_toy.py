"""Draws the picture of docs/calibration.md from two toys in the plane. Argument: a PNG file.

Left: half of an ellipse, whose noise is correlated along it, is aligned to the whole one
2000 times. Right: half of a circle is turned about the centre, against lines that were
fitted to noisy points of the circle. All numbers in the legends are counted or computed
here. Lengths are in mm. Needs numpy and matplotlib."""

import sys

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

NUM_POINTS = 400
NUM_CLUSTERS = 24
CHI_SQUARE = -2 * np.log(0.05)  # 95 % quantile, two degrees of freedom
FIRSTS = np.arange(NUM_CLUSTERS) * NUM_POINTS // NUM_CLUSTERS  # of the clusters
random = np.random.default_rng(1)


def moved(points, x, y, angle):
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]]) + [x, y]


def score_covariance(scores):
    sums = np.add.reduceat(scores, FIRSTS)
    return sums.T @ sums * NUM_CLUSTERS / (NUM_CLUSTERS - 1)


def rates_of(normals, points):
    """Derivatives of distances along the normals with respect to x, y and the angle."""
    turns = points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]
    return np.column_stack([normals, turns])


def fit(points, half_axes):
    """x, y and angle; covariance of independent points, and of clusters."""
    pose = np.zeros(3)
    for _ in range(8):
        now = moved(points, *pose)
        slopes = 2 * now / half_axes**2
        sizes = np.linalg.norm(slopes, axis=1)
        distances = (np.sum((now / half_axes) ** 2, axis=1) - 1) / sizes  # first order
        rates = rates_of(slopes / sizes[:, None], now)
        pose -= np.linalg.solve(rates.T @ rates, rates.T @ distances)
    inverse = np.linalg.inv(rates.T @ rates)
    J = score_covariance(distances[:, None] * rates)
    return pose, inverse * np.sum(distances**2) / (NUM_POINTS - 3), inverse @ J @ inverse


def draw_estimates(axes):
    half_axes = np.array([60.0, 40.0])
    angles = np.linspace(np.pi, 2 * np.pi, NUM_POINTS)
    surface = half_axes * np.column_stack([np.cos(angles), np.sin(angles)])
    normals = surface / half_axes**2
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    way = np.cumsum(np.linalg.norm(np.diff(surface, axis=0, prepend=surface[:1]), axis=1))
    correlation = np.exp(-0.5 * ((way[:, None] - way) / 2.0) ** 2)  # over 2 mm
    factor = np.linalg.cholesky(correlation + 1e-6 * np.eye(NUM_POINTS))
    noise = [factor @ random.normal(size=NUM_POINTS) for _ in range(2000)]  # of 1 mm
    runs = [fit(surface + normals * u[:, None], half_axes) for u in noise]
    poses, hessians, sandwiches = (np.array(column) for column in zip(*runs))
    axes.plot(poses[:, 0], poses[:, 1], ".", color="0.7", markersize=2, label="2000 estimates")
    turn = np.linspace(0, 2 * np.pi, 200)
    for covariances, colour, name in (
        (hessians[:, :2, :2], "tab:red", "Hessian, points independent"),
        (sandwiches[:, :2, :2], "tab:blue", f"score covariance, {NUM_CLUSTERS} clusters"),
    ):
        inverses = np.linalg.inv(covariances)
        squares = np.einsum("ni,nij,nj->n", poses[:, :2], inverses, poses[:, :2])
        share = 100 * np.mean(squares < CHI_SQUARE)
        label = f"{name}: truth in\n95 % region in {share:.0f} % of the runs"
        edge = np.linalg.cholesky(CHI_SQUARE * covariances.mean(axis=0))
        axes.plot(*(edge @ [np.cos(turn), np.sin(turn)]), color=colour, label=label)
    axes.plot(0, 0, "k+", markersize=10, label="truth")
    axes.set(xlabel="x [mm]", ylabel="y [mm]", title="Position of an aligned arc")
    axes.set_aspect("equal", adjustable="datalim")


def circle(angles):
    radii = 40.0 + random.normal(size=len(angles))  # noise of 1 mm
    return radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])


def draw_secants(axes):
    target = circle(np.linspace(0, 2 * np.pi, NUM_POINTS, endpoint=False))
    source = circle(np.linspace(np.pi, 2 * np.pi, NUM_POINTS))

    def nearest(points, count):
        return np.argsort(np.sum((points[:, None] - target) ** 2, axis=2), axis=1)[:, :count]

    neighbors = target[nearest(target, 15)]  # a line is fitted to each 15
    centres = neighbors.mean(axis=1)
    normals = np.linalg.svd(neighbors - centres[:, None])[2][:, 1]
    matches = nearest(source, 1)[:, 0]

    def scores_at(turn, is_fixed):
        points = moved(source, 0, 0, turn)
        i = matches if is_fixed else nearest(points, 1)[:, 0]
        rates = rates_of(normals[i], points)[:, 2:]
        return np.sum(normals[i] * (points - centres[i]), axis=1)[:, None] * rates, rates

    scores, rates = scores_at(0.0, True)
    deviation = np.sqrt(score_covariance(scores)[0, 0])
    claim = np.degrees(deviation / np.sum(rates**2))
    turns = np.linspace(0, np.radians(5), 51)
    for is_fixed, colour, label in (
        (True, "tab:red", f"matches kept: turn known to {claim:.1f} degrees"),
        (False, "tab:blue", "matches made anew: turn unknown"),
    ):
        changes = [scores_at(t, is_fixed)[0] - scores_at(-t, is_fixed)[0] for t in turns]
        secants = 0.5 * np.sum(changes, axis=(1, 2)) / deviation
        axes.plot(np.degrees(turns), secants, color=colour, label=label)
    axes.axhline(0, color="k", linewidth=0.5)
    axes.set(
        xlabel="turn of a circle about its centre [degrees]",
        ylabel="score against the turn [standard deviations]",
        title="Turn of a circle",
    )


figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.6), dpi=100)
draw_estimates(left)
draw_secants(right)
for axes in (left, right):
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, loc="upper left")
figure.tight_layout()
figure.savefig(sys.argv[1])
