"""The core of Bayesian ICP; use it by the package bayesian_icp."""

from typing import Any, Callable, Final, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Array = NDArray[np.float64]

class PriorOptions:
    mean: Any
    variance: Any
    frame: str
    def __init__(self, other: Optional[PriorOptions] = None, **fields: Any) -> None: ...

class ChainOptions:
    num_chains: int
    num_draws: int
    seed: int
    num_threads: int
    def __init__(self, other: Optional[ChainOptions] = None, **fields: Any) -> None: ...

class LikelihoodScale:
    effective_points: float
    measurement_sigma: float
    def __init__(self, other: Optional[LikelihoodScale] = None, **fields: Any) -> None: ...

class SgldOptions:
    step_size: float
    decay_rate: float
    lambda_rms: float
    noise_factor: float
    block_decay_factor: float
    block_decay_interval: int
    block_decay_start: float
    def __init__(self, other: Optional[SgldOptions] = None, **fields: Any) -> None: ...

class PaperOptions:
    scale: LikelihoodScale
    batch_size: int
    sampling: str
    sgld: SgldOptions
    max_distance: float
    num_burn_in: int
    thinning: int
    initial_spread: Any
    def __init__(self, other: Optional[PaperOptions] = None, **fields: Any) -> None: ...

class ResidualOptions:
    residual: str
    regularization: str
    kernel: str
    kernel_width: float
    max_distance: float
    def __init__(self, other: Optional[ResidualOptions] = None, **fields: Any) -> None: ...

class ExactOptions:
    scale: LikelihoodScale
    residual: ResidualOptions
    steps: str
    num_particles: int
    batch_size: Optional[int]
    max_step_size: float
    num_burn_in: Optional[int]
    thinning: Optional[int]
    initial_spread: Any
    max_source_points: int
    def __init__(self, other: Optional[ExactOptions] = None, **fields: Any) -> None: ...

class CalibratedOptions:
    max_source_points: int
    num_mode_points: int
    num_burn_in: Optional[int]
    thinning: Optional[int]
    def __init__(self, other: Optional[CalibratedOptions] = None, **fields: Any) -> None: ...

class Options:
    preset: str
    prior: PriorOptions
    chains: ChainOptions
    paper: PaperOptions
    exact: ExactOptions
    calibrated: CalibratedOptions
    def __init__(self, other: Optional[Options] = None, **fields: Any) -> None: ...
    def validate(self) -> str: ...

class ExportOptions:
    target_frame: str
    timestamp_ns: int
    target_vertex: int
    source_vertex: int
    accept_unreliable: bool
    def __init__(self, other: Optional[ExportOptions] = None, **fields: Any) -> None: ...

class CoordinateSummary:
    mean: Final[float]
    standard_deviation: Final[float]
    quantile_2_5: Final[float]
    median: Final[float]
    quantile_97_5: Final[float]
    rhat: Final[float]
    bulk_ess: Final[float]
    tail_ess: Final[float]
    mcse: Final[float]

class Direction:
    twist: Final[_Array]
    standard_deviation: Final[float]
    prior_standard_deviation: Final[float]
    relative_information: Final[float]
    observability: Final[str]
    description: Final[str]

class DataReport:
    is_available: Final[bool]
    noise_scale: Final[float]
    residual_scale: Final[float]
    effective_patches: Final[float]
    active_fraction: Final[float]
    active_fraction_of_target: Final[float]
    correlation_factor: Final[float]
    degrees_of_freedom: Final[int]
    basin_distance: Final[float]
    other_cost_ratio: Final[float]
    prior_probability: Final[float]
    centre: Final[_Array]
    directions: Final[list[Direction]]
    flags: Final[list[str]]
    warnings: Final[list[str]]

class Target:
    def __init__(self, points: Any, name: str = "target") -> None: ...
    def __len__(self) -> int: ...
    points: Final[_Array]

class PoseEstimate:
    status: Final[str]
    mean: Final[_Array]
    def covariance(self, convention: str) -> _Array: ...

class Prior:
    estimate: Final[PoseEstimate]
    variance: Final[_Array]
    reference_point: Final[_Array]

class Estimate:
    posterior: Final[PoseEstimate]
    prior: Final[Prior]
    message: Final[str]
    coordinates: Final[list[CoordinateSummary]]
    num_diverged_chains: Final[int]
    modes: Final[list[tuple[PoseEstimate, float, list[int]]]]
    data: Final[DataReport]
    samples: Final[_Array]
    def chain(self, index: int) -> _Array: ...

def without_prior(posterior: PoseEstimate, prior: Prior) -> tuple[PoseEstimate, int]: ...
def estimate(
    source: Target,
    target: Target,
    guess: ArrayLike,
    options: Options,
    observer: Optional[Callable[[int, int, _Array], Optional[bool]]],
) -> Estimate: ...
def matrix_from_pose(pose: ArrayLike) -> _Array: ...
def pose_from_matrix(T_target_source: ArrayLike) -> _Array: ...
def pose_error(pose: ArrayLike, mean: ArrayLike, convention: str = "parameters") -> _Array: ...
def pose_from_error(error: ArrayLike, mean: ArrayLike, convention: str = "parameters") -> _Array: ...
def convert_covariance(
    covariance: ArrayLike, mean: ArrayLike, source: str, target: str
) -> _Array: ...
def mean_pose(draws: ArrayLike) -> _Array: ...
def covariance_about(mean: ArrayLike, draws: ArrayLike, convention: str = "parameters") -> _Array: ...
def exp_se3(twist: ArrayLike) -> _Array: ...
def log_se3(transform: ArrayLike) -> _Array: ...
def gtsam_covariance(right_se3: ArrayLike) -> _Array: ...
def g2o_covariance(right_se3: ArrayLike) -> _Array: ...
def rhat(draws: ArrayLike) -> float: ...
def bulk_ess(draws: ArrayLike) -> float: ...
def tail_ess(draws: ArrayLike) -> float: ...
def mcse_mean(draws: ArrayLike) -> float: ...
def ros(estimate: PoseEstimate, options: ExportOptions) -> dict[str, Any]: ...
def g2o(estimate: PoseEstimate, options: ExportOptions) -> str: ...
def gtsam(estimate: PoseEstimate, options: ExportOptions) -> str: ...
def tum(estimate: PoseEstimate, options: ExportOptions) -> str: ...
