"""Tutorial: run it as a whole, or cell by cell in an editor that knows ``# %%``.

python3 tutorial.py [FOLDER]     pictures go to FOLDER, the current one unless it is given
"""

# %% [markdown]
# # Bayesian ICP in Python
# Poses are (x, y, z, roll, pitch, yaw) [m, rad] and map source points into the target frame.

# %%
import pathlib
import sys

import matplotlib.pyplot as plt
import numpy as np

import bayesian_icp

FOLDER = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
if not FOLDER.is_dir():
    sys.exit(f"{FOLDER} is no folder\n\n{__doc__}")

# %% [markdown]
# ## A mug in five lines
# Two simulated scans with a known pose. The handle is in view, so the clouds hold all six
# motions. Look at the status before you use the numbers.

# %%
scans = bayesian_icp.simulate("mug")
result = bayesian_icp.align(source=scans.source, target=scans.target)
print(result.status, result.flags)
print(result.T_target_source)
print(1000 * np.sqrt(np.diag(result.covariance())))  # mm, mrad

# %%
figure, axes = plt.subplots(1, 2, figsize=(9, 4))
moved = scans.source @ result.T_target_source[:3, :3].T + result.T_target_source[:3, 3]
for cloud, name in ((scans.target, "target"), (scans.source, "source, before"), (moved, "source, after")):
    axes[0].plot(*(1000 * cloud[::10, [0, 2]].T), ".", markersize=2, label=name)
axes[0].set(xlabel="x [mm]", ylabel="z [mm]", aspect="equal", title="mug, from the front")
axes[0].legend(loc="lower right", markerscale=4, framealpha=1)
truth = bayesian_icp.pose_from_matrix(scans.T_target_source)
draws = result.samples.reshape(-1, 6)
axes[1].plot(*(1000 * (draws - truth)[:, [0, 5]].T), ".", markersize=2, label="draws")
axes[1].plot(0, 0, "k+", markersize=14, label="truth")
axes[1].set(xlabel="error of x [mm]", ylabel="error of yaw [mrad]", title="posterior")
axes[1].legend()
figure.tight_layout()
figure.savefig(FOLDER / "python_mug.png", dpi=90)

# %% [markdown]
# ## A corridor: what `directions` says
# A camera goes along a corridor with smooth walls. Nothing in the clouds tells how far.
# ICP would answer "not at all" and be sure of it. Here the prior stays along that motion,
# and `directions` names it. The status is ok: the posterior is right, and wide.

# %%
scans = bayesian_icp.simulate("plain_corridor", width=160, height=120)
prior = dict(prior_std=(0.2, 0.1))  # what odometry leaves open [m, rad]
result = bayesian_icp.align(source=scans.source, target=scans.target, **prior)
print(result.status, "-", result.message)
for direction in result.directions:
    print(f"{direction.observability:10} {1000 * direction.standard_deviation:7.2f} mm  {direction.description}")

# %%
names = [direction.description.split(" through")[0].split(" with")[0] for direction in result.directions]
figure, axes = plt.subplots(figsize=(9, 3.2))
rows = np.arange(6)
axes.barh(rows, [1000 * d.prior_standard_deviation for d in result.directions], color="0.85", label="prior")
axes.barh(rows, [1000 * d.standard_deviation for d in result.directions], height=0.5, label="posterior")
axes.set_yticks(rows, names)
axes.set(xscale="log", xlabel="standard deviation, as rms displacement of the points [mm]")
axes.invert_yaxis()
axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=2, frameon=False)
figure.tight_layout()
figure.savefig(FOLDER / "python_corridor.png", dpi=90)

# %% [markdown]
# ## A pose graph of three scans
# A LiDAR in a room at A, B and C. Three registrations close a loop. `without_prior` makes
# each of them a measurement that knows nothing of the guess, with the information of the
# clouds alone. A few Gauss-Newton steps find the poses of B and C seen from A. As edges
# share scans, they share errors, and the graph is a little too sure of itself.

# %%
eyes = {"A": (0.0, 0.0, 1.2), "B": (0.15, 0.1, 1.2), "C": (0.3, 0.0, 1.2)}
looks_at = {"A": (1.0, 0.0, 1.2), "B": (1.15, 0.2, 1.2), "C": (1.3, -0.15, 1.2)}
clouds = {
    name: bayesian_icp.simulate("room", seed=seed, source_eye=eyes[name], source_look_at=looks_at[name]).source
    for seed, name in enumerate(eyes, start=1)
}
edges = []
for target, source in (("A", "B"), ("B", "C"), ("A", "C")):
    result = bayesian_icp.align(source=clouds[source], target=clouds[target])
    measured = result.without_prior()
    information = np.linalg.inv(measured.covariance("right_se3"))
    edges.append((target, source, measured.T_target_source, information))
    print(target, source, result.status, measured.to_g2o()[:60], "...")


def residual(poses, target, source, T):
    """Twist from the measurement to the poses, in the source frame."""
    return bayesian_icp.log_se3(np.linalg.inv(T) @ np.linalg.inv(poses[target]) @ poses[source])


poses = {"A": np.eye(4), "B": edges[0][2], "C": edges[0][2] @ edges[1][2]}
free = {"B": 0, "C": 6}
for _ in range(5):
    H, g = np.zeros((12, 12)), np.zeros(12)
    for target, source, T, information in edges:
        r = residual(poses, target, source, T)
        J = np.zeros((6, 12))
        for name in {target, source} & set(free):
            for k in range(6):
                nudged = dict(poses, **{name: poses[name] @ bayesian_icp.exp_se3(1e-6 * np.eye(6)[k])})
                J[:, free[name] + k] = (residual(nudged, target, source, T) - r) / 1e-6
        H += J.T @ information @ J
        g += J.T @ information @ r
    step = -np.linalg.solve(H, g)
    for name, first in free.items():
        poses[name] = poses[name] @ bayesian_icp.exp_se3(step[first : first + 6])
covariance = np.linalg.inv(H)
for name, first in free.items():
    error = 1000 * (poses[name][:3, 3] - eyes[name] + np.array(eyes["A"]))
    print(name, "is off by", error.round(2), "mm; standard deviations",
          (1000 * np.sqrt(np.diag(covariance)[first : first + 3])).round(2))

# %%
figure, axes = plt.subplots(1, 2, figsize=(9, 3.6))
circle = np.array([np.cos(np.linspace(0, 2 * np.pi, 60)), np.sin(np.linspace(0, 2 * np.pi, 60))])
for panel, (name, first) in zip(axes, free.items()):
    R = poses[name][:3, :3]  # the covariance is in the frame of the scan
    xy = (R @ covariance[first : first + 3, first : first + 3] @ R.T)[:2, :2]
    centre = poses[name][:2, 3] - np.array(eyes[name])[:2]
    ellipse = centre[:, None] + np.linalg.cholesky(xy) @ circle * np.sqrt(5.99)
    panel.plot(*(1000 * ellipse), label="95 % region")
    panel.plot(*(1000 * centre), "o", label="pose graph")
    panel.plot(0, 0, "k+", markersize=14, label="truth")
    panel.set(xlabel="error of x [mm]", ylabel="error of y [mm]", title=f"scan {name}", aspect="equal")
    panel.margins(0.15)
axes[0].legend(loc="upper left", fontsize="small")
figure.tight_layout()
figure.savefig(FOLDER / "python_pose_graph.png", dpi=90)

# %% [markdown]
# ## Is it calibrated on your data?
# Put pairs of your own with known poses in place of `pairs`. For each of them, the share of
# draws that are nearer to the mean than the truth is should be a uniform number: a 90 %
# region then holds 90 % of the truths. Points above the line are regions that are too wide,
# points below are too narrow.

# %%
pairs = [bayesian_icp.simulate("mug", seed=seed, width=240, height=180) for seed in range(1, 101)]
levels = []
for scans in pairs:
    result = bayesian_icp.align(source=scans.source, target=scans.target)
    truth = bayesian_icp.pose_from_matrix(scans.T_target_source)
    information = np.linalg.inv(result.covariance())

    def distance(pose):
        error = bayesian_icp.pose_error(pose, result.mean)
        return error @ information @ error

    draws = result.samples.reshape(-1, 6)[::4]
    levels.append(np.mean([distance(draw) < distance(truth) for draw in draws]))
levels = np.sort(levels)
for level in (0.5, 0.68, 0.9, 0.95):
    print(f"the {100 * level:.0f} % region holds the truth of {np.mean(levels <= level):.0%}")

# %%
figure, axes = plt.subplots(figsize=(4.5, 4))
axes.plot([0, 1], [0, 1], "k--", linewidth=1, label="calibrated")
axes.step(np.append(levels, 1), np.append(np.arange(1, len(levels) + 1) / len(levels), 1), where="post",
          label=f"{len(levels)} pairs")
axes.set(xlabel="credible region", ylabel="share of truths inside", xlim=(0, 1), ylim=(0, 1), aspect="equal")
axes.legend()
figure.tight_layout()
figure.savefig(FOLDER / "python_calibration.png", dpi=90)
