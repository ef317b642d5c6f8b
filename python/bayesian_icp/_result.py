"""What a registration found."""

from __future__ import annotations

import functools
import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._checks import convention as _convention

Array = NDArray[np.float64]

COORDINATES = ("x", "y", "z", "roll", "pitch", "yaw")


class Pose:
    """Mean and covariance of a pose that maps source points into the target frame."""

    def __init__(self, pose: _core.PoseEstimate) -> None:
        self._pose = pose

    @property
    def T_target_source(self) -> Array:
        """(4, 4) mean."""
        return _core.matrix_from_pose(self.mean)

    @property
    def mean(self) -> Array:
        """(6,) the same as (x, y, z, roll, pitch, yaw) [m, rad]."""
        return self._pose.mean

    def covariance(self, convention: str = "parameters") -> Array:
        """Covariance about the mean, translation first [m, rad].

        Parameters
        ----------
        convention : {"parameters", "r3xso3", "left_se3", "right_se3"}
            "parameters": x, y, z, roll, pitch, yaw. "r3xso3": translation and small
            rotation along the target's axes, as in ROS. "left_se3": T = exp(xi) T_mean,
            target frame. "right_se3": T = T_mean exp(xi), source frame; GTSAM has it
            with rotation first (`gtsam_covariance`).

        Returns
        -------
        ndarray, (6, 6)

        Raises
        ------
        ValueError
            If there is no such convention.
        """
        return self._pose.covariance(_convention("convention", convention))

    @property
    def status(self) -> str:
        """Whether to trust it: "ok", or what is wrong, as "doubtful", "not_mixed",
        "several_modes", "diverged", "interrupted" or "too_few_correspondences"."""
        return self._pose.status

    def to_ros(
        self, *, frame_id: str = "target", timestamp_ns: int = 0, accept_unreliable: bool = False
    ) -> dict[str, Any]:
        """The fields of a geometry_msgs/PoseWithCovarianceStamped, covariance "r3xso3".

        Parameters
        ----------
        frame_id : str
            Name of the target's frame: letters, digits, ``_ - . /``.
        timestamp_ns : int
            Since the epoch [ns].
        accept_unreliable : bool
            Also export a posterior whose status is worse than "doubtful".

        Raises
        ------
        ValueError
            If the posterior cannot be exported, or a name or time is bad.
        """
        return _core.ros(self._pose, _core.ExportOptions(
            target_frame=frame_id, timestamp_ns=timestamp_ns, accept_unreliable=accept_unreliable))

    def to_g2o(self, *, target_vertex: int = 0, source_vertex: int = 1, accept_unreliable: bool = False) -> str:
        """A line EDGE_SE3:QUAT with information, from the target's to the source's vertex.

        Raises
        ------
        ValueError
            If the posterior cannot be exported, or its covariance not be inverted.
        """
        return _core.g2o(self._pose, _core.ExportOptions(
            target_vertex=target_vertex, source_vertex=source_vertex, accept_unreliable=accept_unreliable))

    def to_gtsam(self, *, accept_unreliable: bool = False) -> str:
        """Pose (4x4), covariance and information (6x6, rotation first, body frame) as
        rows of numbers; lines that begin with # separate them.

        Raises
        ------
        ValueError
            If the posterior cannot be exported.
        """
        return _core.gtsam(self._pose, _core.ExportOptions(accept_unreliable=accept_unreliable))

    def to_tum(self, *, timestamp_ns: int = 0, accept_unreliable: bool = False) -> str:
        """One line of a TUM trajectory: timestamp x y z qx qy qz qw.

        Raises
        ------
        ValueError
            If the posterior cannot be exported.
        """
        return _core.tum(self._pose, _core.ExportOptions(
            timestamp_ns=timestamp_ns, accept_unreliable=accept_unreliable))

    def __repr__(self) -> str:
        std = np.sqrt(np.diag(self.covariance()))
        numbers = ", ".join(
            f"{name}={mean:.4g}±{deviation:.2g}" for name, mean, deviation in zip(COORDINATES, self.mean + 0.0, std)  # not -0
        )
        return f"<bayesian_icp.{type(self).__name__} {self.status}: {numbers}{self._remark()}>"

    def _remark(self) -> str:
        return ""


class Measurement(Pose):
    """What the clouds alone say about the pose: a posterior without its prior.

    Made by `Result.without_prior` and `Mode.without_prior`.

    Attributes
    ----------
    num_unmeasured : int
        Directions that the clouds do not see, 0 to 6; their deviation is 10 times the
        prior's. 6 without a posterior.
    """

    def __init__(self, pose: _core.PoseEstimate, num_unmeasured: int) -> None:
        super().__init__(pose)
        self.num_unmeasured = num_unmeasured

    def _remark(self) -> str:
        return f", {self.num_unmeasured} of 6 directions unmeasured"


class Prior(Pose):
    """The prior that was sampled with, as a Gaussian about its mean T_target_source.

    Made by `Result.prior`. Without a posterior all numbers are NaN.

    Attributes
    ----------
    variance : ndarray, (6,)
        Variances of x, y, z [m^2] of the reference point, and of roll, pitch, yaw [rad^2].
    reference_point : ndarray, (3,)
        The point that x, y, z of the variance are about, in the source frame [m]: its
        origin or the centroid of its points. `covariance` is about the origin.
    """

    def __init__(self, prior: _core.Prior) -> None:
        super().__init__(prior.estimate)
        self.variance = prior.variance
        self.reference_point = prior.reference_point


class _Posterior(Pose):
    """A pose with the prior that is in it."""

    def __init__(self, pose: _core.PoseEstimate, prior: _core.Prior) -> None:
        super().__init__(pose)
        self._prior = prior

    @property
    def prior(self) -> Prior:
        """The prior that is in mean and covariance, T_target_source as they are."""
        return Prior(self._prior)

    def without_prior(self) -> Measurement:
        """Remove the prior, for filters and pose graphs that know it already."""
        return Measurement(*_core.without_prior(self._pose, self._prior))


class Mode(_Posterior):
    """One mode of a posterior: mean and covariances are those of its draws.

    Made by `Result.modes`. If the result has the status "several_modes", the mode has
    "doubtful", so it can be exported: it is you who chose it.

    Attributes
    ----------
    weight : float
        Share of the posterior, 0 to 1, good to a factor of a few.
    chains : list of int
        Indices of its chains, for `Result.chain`.
    """

    def __init__(
        self, pose: _core.PoseEstimate, prior: _core.Prior, weight: float, chains: list[int]
    ) -> None:
        super().__init__(pose, prior)
        self.weight = weight
        self.chains = chains

    def _remark(self) -> str:
        return f", weight {self.weight:.2g}"


class Result(_Posterior):
    """Posterior of the pose that maps source points into the target frame.

    Made by `align`. The pose is the posterior mean, the bi-invariant mean of the draws on
    SE(3), and the covariance is their second moment about it. Without a posterior all
    numbers are NaN and `samples` is empty.

    Attributes
    ----------
    seconds : float
        Wall time of the run [s].
    """

    def __init__(
        self,
        estimate: _core.Estimate,
        options: _core.Options,
        guess: Array,
        num_points: tuple[int, int],
        seconds: float,
    ) -> None:
        super().__init__(estimate.posterior, estimate.prior)
        self._estimate = estimate
        self._options = options
        self._guess = guess
        self._num_points = num_points
        self.seconds = seconds

    @property
    def samples(self) -> Array:
        """(chains, draws, 6) of the chains that did not diverge, cut to the shortest."""
        return self._estimate.samples

    def chain(self, index: int) -> Array:
        """(draws, 6) of one chain, from 0 on, diverged or not; IndexError if there is none."""
        if not hasattr(index, "__index__"):
            raise TypeError(f"index is {index!r}, but must be an integer")
        return self._estimate.chain(index)

    @property
    def message(self) -> str:
        """The status in words, with the numbers behind it."""
        return self._estimate.message

    @property
    def flags(self) -> tuple[str, ...]:
        """Raised flags of preset calibrated: reasons to doubt the posterior, of
        wrong_basin, low_support, few_patches, misfit, no_information, prior_conflict."""
        return tuple(self._estimate.data.flags)

    @property
    def directions(self) -> list[_core.Direction]:
        """Six motions of preset calibrated, best known first, and how each is known."""
        return self._estimate.data.directions

    @property
    def data(self) -> _core.DataReport:
        """All that preset calibrated says about the clouds: noise, support, warnings."""
        return self._estimate.data

    @functools.cached_property
    def modes(self) -> list[Mode]:
        """The modes, heaviest first. Empty if preset calibrated found one alone, and for
        preset paper, which does not look for them."""
        return [Mode(pose, self._prior, weight, chains) for pose, weight, chains in self._estimate.modes]

    @property
    def coordinates(self) -> dict[str, _core.CoordinateSummary]:
        """Mean, deviation, quantiles, R-hat and ESS of x, y, z, roll, pitch and yaw."""
        return dict(zip(COORDINATES, self._estimate.coordinates))

    @property
    def num_diverged_chains(self) -> int:
        """Chains that `samples` leaves out."""
        return self._estimate.num_diverged_chains

    @property
    def init_T_target_source(self) -> Array:
        """(4, 4) initial guess of the run, which maps source points into the target
        frame [m]: the identity unless it was given."""
        return _core.matrix_from_pose(self._guess) + 0.0  # not -0

    @property
    def options(self) -> _core.Options:
        """A copy of the options of the run."""
        return _core.Options(self._options)

    def to_arviz(self) -> dict[str, dict[str, Array]]:
        """Groups and variables for ``arviz.from_dict``: ``from_dict(d)`` from ArviZ 1.0 on,
        ``from_dict(**d)`` before it. Variables have the shape (chains, draws)."""
        samples = self.samples
        return {"posterior": {name: samples[:, :, k] for k, name in enumerate(COORDINATES)}}

    def write_report(self, path: str | os.PathLike[str], *, source: Any, target: Any) -> None:
        """Write the HTML report: verdict, tables and charts on one page. Needs gnuplot.

        Parameters
        ----------
        path : path_like
            Folders that are missing are made.
        source, target : array_like, (N, 3), or Target
            The clouds of the run [m].

        Raises
        ------
        ValueError
            If there are no draws, or a cloud has not as many points as that of the run.
        OSError
            If the file cannot be written, or gnuplot cannot draw, as it cannot where
            coordinates are so large that 32 bits keep no shape of the cloud.
        """
        from . import _tools

        _tools.write_report(self._estimate, self._options, self._guess, self.seconds,
                            os.fsencode(path), source, target, self._num_points)

    def _remark(self) -> str:
        return f", flags: {', '.join(self.flags)}" if self.flags else ""
