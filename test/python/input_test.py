"""Input that is refused, with its name and value in the text, and input of any layout."""

import pickle

import hypothesis.extra.numpy as arrays
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import bayesian_icp

from conftest import draw

RNG = np.random.default_rng(1)
CLOUD = RNG.normal(size=(100, 3))


def refused(error, pattern, **keywords):
    with pytest.raises(error, match=pattern):
        bayesian_icp.align(**{"source": CLOUD, "target": CLOUD, **keywords})


def test_clouds_are_keywords():
    with pytest.raises(TypeError, match="positional"):
        bayesian_icp.align(CLOUD, CLOUD)


@pytest.mark.parametrize("cloud, error, pattern", [
    (CLOUD.T, ValueError, r"source has the shape \(3, 100\), but must have \(N, 3\)"),
    (CLOUD[0], ValueError, r"source has the shape \(3,\)"),
    (CLOUD[:, :2], ValueError, r"\(100, 2\)"),
    (CLOUD[None], ValueError, r"\(1, 100, 3\)"),
    (CLOUD[:10], ValueError, "the source has 10 finite points, but preset calibrated needs 30"),
    (CLOUD[:0], ValueError, "source"),
    (CLOUD + 1j, TypeError, "source has the dtype complex128, but must be an array of real numbers"),
    (CLOUD > 0, TypeError, "source has the dtype bool"),
    (CLOUD.astype(str), TypeError, "source has the dtype <U32"),
    (CLOUD.astype(object), TypeError, "source has the dtype object"),
    (np.ma.masked_greater(CLOUD, 0.1), ValueError, "source has masked points"),
    ([[1, 2, 3], [4, 5]], TypeError, "source is of type list, but must be an array of real numbers"),
    ("source.pcd", TypeError, "source is of type str"),
    (None, TypeError, "source is of type NoneType"),
])
def test_bad_clouds(cloud, error, pattern):
    refused(error, pattern, source=cloud)
    with pytest.raises(error, match=pattern.replace("source", "target")):
        bayesian_icp.align(source=CLOUD, target=cloud)


def test_what_an_array_says_of_itself_is_passed_on():
    class OnAnotherDevice:
        def __array__(self, *_):
            raise TypeError("cannot convert from cuda:0; use .cpu()")

    refused(TypeError, r"cuda:0; use .cpu\(\)", source=OnAnotherDevice())


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_points_that_are_not_finite(value):
    cloud = CLOUD.copy()
    cloud[17, 1] = value
    refused(ValueError, r"source\[17\] is array.*must be finite", source=cloud)
    with pytest.raises(ValueError, match=r"target\[17\]"):
        bayesian_icp.Target(cloud)
    with pytest.raises(ValueError, match=r"scan 4\[17\]"):
        bayesian_icp.Target(cloud, "scan 4")


@pytest.mark.parametrize("keywords, error, pattern", [
    ({"init_T_target_source": np.eye(3)}, ValueError, r"init_T_target_source has the shape \(3, 3\)"),
    ({"init_T_target_source": 2 * np.eye(4)}, ValueError, "init_T_target_source: the matrix is not a rotation"),
    ({"prior_mean": np.diag([1, 1, -1, 1])}, ValueError, "prior_mean: the matrix is not a rotation.* det R is -1, "),
    ({"init_T_target_source": np.full((4, 4), np.nan)}, ValueError, "init_T_target_source is not finite"),
    ({"init_T_target_source": "here"}, TypeError, "init_T_target_source is 'here'"),
    ({"prior_mean": np.zeros(5)}, ValueError, r"prior_mean has the shape \(5,\)"),
    ({"prior_std": np.ones(3)}, ValueError, r"prior_std has the shape \(3,\)"),
    ({"prior_std": (0.1, -0.2)}, ValueError, r"prior_std is \(0.1, -0.2\), but must be positive"),
    ({"prior_mean": np.eye(3)}, ValueError, r"prior_mean has the shape \(3, 3\), but must have \(4, 4\) or \(6,\)"),
    ({"prior_std": (np.inf, 1)}, ValueError, r"prior_std is \(inf, 1\), but must be finite for preset calibrated"),
    ({"options": {"preset": "exact"}}, TypeError, "options is {'preset': 'exact'}"),
    ({"prior_std": np.ma.masked_array(np.ones(6), [0, 1, 0, 0, 0, 0])}, ValueError, "masked"),
    ({"prior_std": (1, 1), "prior_variance": (1, 1)}, ValueError, "both given"),
    ({"prior_frame": "middle"}, ValueError, "frame: 'middle' is none of .'origin', 'source-centroid', 'automatic'"),
    ({"preset": "best"}, ValueError, "preset: 'best' is none of .'paper', 'exact', 'calibrated'"),
    ({"preset": 3}, ValueError, "preset: 3 is none of"),
    ({"seed": -1}, ValueError, r"seed is -1, .*: Seed of all random numbers, an integer from 0 to 2\^64-1"),
    ({"seed": 1.5}, TypeError, "seed is 1.5"),
    ({"num_threads": -2}, ValueError, "num_threads is -2"),
    ({"progress": "bar"}, TypeError, "progress is 'bar'"),
    ({"num_threads": "two"}, TypeError, "num_threads is 'two'"),
])
def test_bad_keywords(keywords, error, pattern):
    refused(error, pattern, **keywords)


POSE = np.array([500, -2, 3, 0.1, -0.2, 3.0])
T = bayesian_icp.matrix_from_pose(POSE)


@pytest.mark.parametrize("matrix, pattern", [
    (np.zeros((4, 4)), r"det R is 0, .R.T R - I. is 1.7, and the last row is \[0. 0. 0. 0.\]"),
    (np.diag([1, -1, 1, 1]) @ T, "det R is -1, "),
    (np.diag([2, 2, 2, 1]) @ T, "det R is 8, "),
    (T.T, r"last row is \[500.  -2.   3.   1.\]"),
    (T @ (np.eye(4) + 0.1 * np.eye(4, k=1)), "must be 1, 0 and"),
    (np.eye(3), r"(T_target_source|transform) has the shape \(3, 3\), but must have \(4, 4\)"),
    (np.full((4, 4), np.nan), "not finite"),
    (np.where(T == 500, np.inf, T), "not finite"),
])
@pytest.mark.parametrize("function", [bayesian_icp.pose_from_matrix, bayesian_icp.log_se3])
def test_matrices_that_are_not_rigid(function, matrix, pattern):
    with pytest.raises(ValueError, match=pattern):
        function(matrix)


@pytest.mark.parametrize("function, arguments, name", [
    ("matrix_from_pose", [np.zeros(5)], "pose"), ("pose_error", [POSE, np.eye(4)], "mean"),
    ("pose_from_error", [np.zeros(3), POSE], "error"), ("mean_pose", [np.zeros((3, 5))], "draws"),
    ("covariance_about", [POSE, np.zeros((4, 5, 7))], "draws"), ("exp_se3", [np.zeros(7)], "twist"),
    ("gtsam_covariance", [np.eye(5)], "right_se3"), ("g2o_covariance", [np.ones(6)], "right_se3"),
    ("convert_covariance", [np.eye(6), np.eye(4), "r3xso3", "r3xso3"], "mean"),
])
def test_wrong_shapes_and_kinds_are_named(function, arguments, name):
    with pytest.raises(ValueError, match=rf"^{name} has the shape \(.*\), but must have \("):
        getattr(bayesian_icp, function)(*arguments)
    for value in ("here", np.array(1j), None):
        with pytest.raises(TypeError, match=" is .*, but must be real numbers"):
            getattr(bayesian_icp, function)(value, *arguments[1:])


@pytest.mark.parametrize("function", [bayesian_icp.rhat, bayesian_icp.ess, bayesian_icp.mcse])
@pytest.mark.parametrize("draws", ["abc", np.ones((4, 100)) * 1j, [[1, 2], [3]]])
def test_draws_that_are_no_real_numbers(function, draws):
    with pytest.raises(TypeError, match="draws is"):
        function(draws)


INDEFINITE = np.eye(6) + 3 * (np.eye(6, k=1) + np.eye(6, k=-1))


@pytest.mark.parametrize("bad", [np.diag([np.nan, 1, 1, 1, 1, 1]), np.eye(6) + 0.1 * np.eye(6, k=1), -np.eye(6),
                                 INDEFINITE])
def test_covariances_that_are_none(bad):
    with pytest.raises(ValueError, match="covariance is .* finite and symmetric"):
        bayesian_icp.convert_covariance(bad, POSE, "r3xso3", "left_se3")
    with pytest.raises(ValueError, match="mean is .* finite"):
        bayesian_icp.convert_covariance(np.eye(6), np.full(6, np.nan), "r3xso3", "left_se3")
    with pytest.raises(ValueError, match="target: 'ros' is none of"):
        bayesian_icp.convert_covariance(np.eye(6), POSE, "r3xso3", "ros")


def test_matrices_of_32_bits_are_rigid():
    single = T.astype(np.float32)
    product = np.linalg.multi_dot([single, np.linalg.inv(single)] * 20 + [single])
    assert np.allclose(bayesian_icp.pose_from_matrix(product), POSE, atol=1e-2)
    assert np.allclose(bayesian_icp.exp_se3(bayesian_icp.log_se3(product)), T, atol=1e-2)


@pytest.mark.parametrize("group, field, value", [
    ("chains", "num_chains", 0), ("chains", "num_draws", 0), ("calibrated", "max_source_points", 3),
    ("calibrated", "thinning", 0), ("prior", "variance", -np.ones(6)),
])
def test_options_out_of_range(group, field, value):
    options = bayesian_icp.Options()
    setattr(getattr(options, group), field, value)
    refused(ValueError, field, options=options)


@pytest.mark.parametrize("variance, error, pattern", [
    (np.ones(2), ValueError, r"variance has the shape \(2,\), but must have \(6,\)"),
    (np.ma.masked_array(np.ones(6), [0, 1, 0, 0, 0, 0]), ValueError, "variance is .*masked"),
    (np.ones(6) + 1j, TypeError, "variance is .*real numbers"), (["1"] * 6, TypeError, "variance is .*real numbers"),
    (None, TypeError, "variance is None"),
])
def test_six_numbers_of_an_option(variance, error, pattern):
    with pytest.raises(error, match=pattern):
        bayesian_icp.PriorOptions(variance=variance)


def test_options_refuse_unknown_names_and_kinds():
    options = bayesian_icp.Options()
    with pytest.raises(AttributeError, match="colour"):
        options.colour = 1
    with pytest.raises(TypeError, match="num_draws is 'many'"):
        options.chains.num_draws = "many"
    with pytest.raises(ValueError, match="kernel: 'round' is none of .'none', 'huber', 'tukey'"):
        options.exact.residual.kernel = "round"
    with pytest.raises(ValueError, match="sampling: None is none of .'with-replacement', 'shuffled-epochs'.$"):
        options.paper.sampling = None
    with pytest.raises(TypeError, match="chains is None"):
        bayesian_icp.Options(chains=None)
    assert options.exact.thinning is None
    options.exact.thinning = 3
    assert bayesian_icp.Options(options).exact.thinning == 3


@pytest.mark.parametrize("mean, error", [
    (np.full(6, np.nan), ValueError), ([0, 0, 0, 0, 0, np.nan], ValueError), ([np.inf] * 6, ValueError),
    ("here", TypeError), (np.zeros(5), ValueError),
])
def test_a_prior_mean_that_is_not_finite(mean, error):
    with pytest.raises(error, match="^mean (is|has the shape) "):
        bayesian_icp.PriorOptions(mean=mean)


def test_no_prior_mean_is_the_guess():
    prior = bayesian_icp.PriorOptions()
    assert prior.mean is None
    prior.mean = POSE
    assert np.array_equal(prior.mean, POSE)
    with pytest.raises(ValueError, match="read-only"):
        prior.mean[0] = 1
    prior.mean = None
    assert prior.mean is None


def test_options_are_made_of_their_fields():
    chains = bayesian_icp.ChainOptions(num_draws=8, seed=2**64 - 1)
    assert (chains.num_chains, chains.num_draws, chains.seed) == (4, 8, 2**64 - 1)
    options = bayesian_icp.Options(preset="exact", chains=chains)
    copy = bayesian_icp.Options(options, prior=bayesian_icp.PriorOptions(frame="origin"))
    assert (copy.preset, copy.chains.num_draws, copy.prior.frame) == ("exact", 8, "origin")
    assert options.prior.frame == "automatic"
    with pytest.raises(AttributeError, match="colour"):
        bayesian_icp.Options(colour=1)


def test_options_show_themselves_and_pickle():
    options = bayesian_icp.Options(preset="exact")
    options.prior.mean = POSE
    options.exact.scale.measurement_sigma = 0.25
    options.exact.thinning = 3
    copy = pickle.loads(pickle.dumps(options))
    assert repr(copy) == repr(options) != repr(bayesian_icp.Options())
    assert repr(copy).startswith("Options(preset='exact', prior=PriorOptions(mean=array([")
    assert "measurement_sigma=0.25)" in repr(copy)
    assert np.array_equal(copy.prior.mean, POSE) and copy.exact.thinning == 3


SHEET = RNG.uniform(-1, 1, (60, 3)) * [1, 1, 0.1]


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.sampled_from([">f8", "<f8", "<f4", ">f4", "<f2", "i1", "<i4", ">u2", "g"]),
       st.sampled_from(["C", "F"]), st.integers(1, 3), st.booleans(), st.booleans())
def test_any_layout_gives_the_same_draws(dtype, order, stride, is_backward, is_read_only):
    values = np.round(SHEET * 100).clip(-100, 100)
    values = np.abs(values) if "u" in dtype else values
    cloud = np.repeat(values, stride, axis=0).astype(dtype, order=order)[::stride]
    if is_backward:
        cloud = cloud[::-1, ::-1][::-1, ::-1]
    cloud.setflags(write=not is_read_only)
    before = cloud.copy()
    plain = np.ascontiguousarray(values, dtype=np.float64)
    found = bayesian_icp.align(source=cloud, target=cloud, preset="exact", options=draw(8))
    expected = bayesian_icp.align(source=plain, target=plain, preset="exact", options=draw(8))
    assert np.array_equal(found.samples, expected.samples)
    assert np.array_equal(cloud, before)


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.one_of(
    arrays.arrays(dtype=arrays.scalar_dtypes(), shape=arrays.array_shapes(min_dims=0, max_dims=3, max_side=5)),
    arrays.arrays(dtype=arrays.floating_dtypes(), shape=st.tuples(st.integers(0, 40), st.just(3))),
    st.lists(st.lists(st.floats())), st.text(), st.binary()))
def test_whatever_is_given_is_registered_or_refused(cloud):
    try:
        found = bayesian_icp.align(source=cloud, target=SHEET, preset="exact", options=draw(8))
    except (TypeError, ValueError) as error:
        assert "source" in str(error)
    else:
        values = np.asarray(cloud)
        assert values.shape[1:] == (3,) and np.isfinite(values).all()
        assert found.status != "not_run"
