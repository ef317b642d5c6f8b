"""What a result gives to others: covariances, exports, diagnostics, measurement."""

import pickle

import numpy as np
import pytest

import bayesian_icp

from conftest import DATA, draw, turns_during

CONVENTIONS = ("parameters", "r3xso3", "left_se3", "right_se3")


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_covariance_is_that_of_the_draws(result, convention):
    draws = result.samples.reshape(-1, 6)
    errors = np.array([bayesian_icp.pose_error(draw, result.mean, convention) for draw in draws])
    expected = errors.T @ errors / (len(draws) - 1)
    assert np.allclose(result.covariance(convention), expected, rtol=1e-9, atol=1e-16)
    for some in (draws, result.samples):
        assert np.allclose(bayesian_icp.covariance_about(result.mean, some, convention), expected, rtol=1e-9, atol=1e-16)
    assert np.array_equal(bayesian_icp.mean_pose(result.samples), bayesian_icp.mean_pose(draws))


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_covariances_convert(result, convention):
    converted = bayesian_icp.convert_covariance(result.covariance(), result.mean, "parameters", convention)
    assert np.allclose(converted, result.covariance(convention), rtol=0.05, atol=1e-8)
    with pytest.raises(ValueError, match=r"\(6, 6\)"):
        bayesian_icp.convert_covariance(np.ones(6), result.mean, "parameters", convention)
    back = bayesian_icp.convert_covariance(converted, result.mean, convention, "parameters")
    assert np.allclose(back, result.covariance(), rtol=1e-5, atol=1e-12)


def test_errors_and_poses_are_inverse():
    mean, error = np.array([1, 2, 3, 0.1, -0.2, 3.0]), np.array([0.1, 0, -0.1, 0.01, 0.2, -0.1])
    for convention in CONVENTIONS:
        pose = bayesian_icp.pose_from_error(error, mean, convention)
        assert np.allclose(bayesian_icp.pose_error(pose, mean, convention), error)
    assert np.allclose(bayesian_icp.log_se3(bayesian_icp.exp_se3(error)), error)
    T = bayesian_icp.matrix_from_pose(mean)
    assert np.allclose(bayesian_icp.pose_from_matrix(T), mean)
    left = bayesian_icp.pose_from_error(error, mean, "left_se3")
    assert np.allclose(bayesian_icp.matrix_from_pose(left), bayesian_icp.exp_se3(error) @ T)


def test_no_such_convention(result):
    with pytest.raises(ValueError, match="convention: 'ros' is none of .'parameters', 'r3xso3', 'left_se3', 'right_se3'"):
        result.covariance("ros")


def test_to_ros_has_the_fields_of_the_message(result):
    message = result.to_ros(frame_id="map", timestamp_ns=1_500_000_000)
    assert message["header"] == {"stamp": {"sec": 1, "nanosec": 500_000_000}, "frame_id": "map"}
    assert np.allclose(np.reshape(message["pose"]["covariance"], (6, 6)), result.covariance("r3xso3"))
    position, q = message["pose"]["pose"]["position"], message["pose"]["pose"]["orientation"]
    assert np.allclose([position[k] for k in "xyz"], result.mean[:3])
    assert q["w"] ** 2 + q["x"] ** 2 + q["y"] ** 2 + q["z"] ** 2 == pytest.approx(1)
    assert 2 * (q["x"] * q["y"] + q["z"] * q["w"]) == pytest.approx(result.T_target_source[1, 0])


def test_texts(result):
    words = result.to_g2o(target_vertex=3, source_vertex=5).split()
    assert words[:3] == ["EDGE_SE3:QUAT", "3", "5"] and len(words) == 3 + 7 + 21
    tum = [float(word) for word in result.to_tum(timestamp_ns=2_000_000_000).split()]
    assert tum[0] == 2 and np.allclose(tum[1:4], result.mean[:3])
    rows = [line for line in result.to_gtsam().splitlines() if not line.startswith("#")]
    covariance = np.array([[float(x) for x in row.split()] for row in rows[4:10]])
    assert np.allclose(covariance, bayesian_icp.gtsam_covariance(result.covariance("right_se3")))


def test_exports_refuse_what_is_bad(result, mug):
    with pytest.raises(ValueError, match="frame"):
        result.to_ros(frame_id="no spaces here")
    with pytest.raises(TypeError, match=r"timestamp_ns is 1.5, .*: Time since the epoch, an integer \[ns\]"):
        result.to_tum(timestamp_ns=1.5)
    with pytest.raises(TypeError, match="index is 1.5"):
        result.chain(1.5)
    with pytest.raises(ValueError, match="-5"):
        result.to_tum(timestamp_ns=-5)
    with pytest.raises(ValueError, match="vert"):
        result.to_g2o(target_vertex=1, source_vertex=1)
    unmixed = bayesian_icp.align(source=mug[0], target=mug[1], options=draw(40))
    with pytest.raises(ValueError, match="mixed"):
        unmixed.to_tum()
    assert unmixed.to_tum(accept_unreliable=True)


def test_diagnostics_are_those_of_the_result(result):
    errors = np.array([[bayesian_icp.pose_error(d, result.mean) for d in chain] for chain in result.samples])
    assert np.allclose(bayesian_icp.rhat(errors), [c.rhat for c in result.coordinates.values()], atol=1e-3)
    assert np.allclose(bayesian_icp.ess(errors), [c.bulk_ess for c in result.coordinates.values()], rtol=0.02)
    assert np.allclose(bayesian_icp.ess(errors, "tail"), [c.tail_ess for c in result.coordinates.values()], rtol=0.05)
    assert bayesian_icp.rhat(errors[:, :, 0]).shape == ()
    assert bayesian_icp.mcse(errors).shape == (6,)
    assert np.isnan(bayesian_icp.rhat(np.zeros((2, 3))))
    assert np.isnan(bayesian_icp.rhat(np.zeros((0, 0, 6)))).sum() == 6
    with pytest.raises(ValueError, match="kind is 'all'"):
        bayesian_icp.ess(errors, "all")
    with pytest.raises(ValueError, match=r"draws has the shape \(6,\)"):
        bayesian_icp.rhat(result.mean)


@pytest.mark.parametrize("function, shape", [
    (bayesian_icp.mean_pose, (400_000, 6)), (bayesian_icp.rhat, (4, 250_000)), (bayesian_icp.ess, (4, 250_000))])
def test_long_work_lets_other_threads_run(function, shape):
    draws = np.random.default_rng(1).normal(scale=0.1, size=shape)
    assert turns_during(lambda: function(draws)) > 20


def test_to_arviz(result):
    groups = result.to_arviz()
    assert list(groups) == ["posterior"]
    assert list(groups["posterior"]) == list(bayesian_icp.COORDINATES)
    assert all(values.shape == (4, 500) for values in groups["posterior"].values())
    arviz = pytest.importorskip("arviz", reason="ArviZ is not here: only the groups are tested")
    is_first_generation = hasattr(arviz, "InferenceData")
    data = arviz.from_dict(**groups) if is_first_generation else arviz.from_dict(groups)
    assert float(arviz.rhat(data)["x"]) == pytest.approx(float(bayesian_icp.rhat(result.samples[:, :, 0])), abs=1e-3)


def test_without_prior(mug):
    narrow = bayesian_icp.align(source=mug[0], target=mug[1], prior_mean=mug[2], prior_std=(0.005, 0.01))
    wide = bayesian_icp.align(source=mug[0], target=mug[1])
    measured = narrow.without_prior()
    assert measured.num_unmeasured == 0
    assert np.allclose(measured.T_target_source, wide.T_target_source, atol=1e-3)
    yaw = measured.covariance()[5, 5]
    assert yaw > narrow.covariance()[5, 5]
    assert yaw == pytest.approx(wide.covariance()[5, 5], rel=0.3)
    assert measured.status == "ok"
    assert measured.to_g2o().startswith("EDGE_SE3:QUAT 0 1 ")
    assert measured.to_gtsam() != narrow.to_gtsam()
    assert repr(measured).startswith("<bayesian_icp.Measurement ok: x=0.0")
    assert repr(measured).endswith(", 0 of 6 directions unmeasured>")


@pytest.fixture(scope="module")
def several():
    """Scans of a rectangular tube, which looks the same after half a turn."""
    rng = np.random.default_rng(1)
    is_wide = rng.random(6000) < 0.5
    xyz = rng.uniform(-1, 1, (6000, 3)) * [0.3, 0.2, 0.1]
    xyz[is_wide, 1] = np.copysign(0.2, xyz[is_wide, 1])
    xyz[~is_wide, 0] = np.copysign(0.3, xyz[~is_wide, 0])
    xyz += rng.normal(scale=0.001, size=xyz.shape)
    guess = bayesian_icp.matrix_from_pose([0, 0, 0, 0, 0, 1.5])
    return bayesian_icp.align(source=xyz[::2], target=xyz[1::2], init_T_target_source=guess)


def test_a_mode_is_a_posterior(several):
    assert several.status == "several_modes"
    with pytest.raises(ValueError, match="several"):
        several.to_tum()
    assert sum(mode.weight for mode in several.modes) == pytest.approx(1)
    for mode in several.modes:
        assert mode.status == "doubtful"
        assert len(mode.to_g2o().split()) == 3 + 7 + 21
        draws = np.concatenate([several.chain(index) for index in mode.chains])
        assert np.allclose(mode.mean, bayesian_icp.mean_pose(draws))
        for convention in CONVENTIONS:
            expected = bayesian_icp.covariance_about(mode.mean, draws, convention)
            assert np.allclose(mode.covariance(convention), expected, rtol=1e-9, atol=1e-16)
        measured = mode.without_prior()
        assert measured.num_unmeasured == 1  # along the tube
        # 10 of the prior's deviations, which is the posterior's, but for the noise of the draws.
        ratio = measured.covariance()[2, 2] / mode.covariance()[2, 2]
        assert measured.status == "doubtful" and ratio == pytest.approx(100, rel=0.2)
        assert ", weight 0." in repr(mode)


def test_result_has_the_guess_and_the_prior(several, mug):
    assert np.allclose(several.init_T_target_source, bayesian_icp.matrix_from_pose([0, 0, 0, 0, 0, 1.5]))
    assert np.allclose(several.prior.T_target_source, several.init_T_target_source)
    far = np.array([3.0, 0, 0])
    mean = [0.01, 0, 0, 0, 0, 0.1]
    result = bayesian_icp.align(source=mug[0] + far, target=mug[1] + far, prior_mean=mean,
                                prior_std=(0.1, 0.2), prior_frame="source-centroid")
    assert np.array_equal(result.init_T_target_source, np.eye(4))
    prior = result.prior
    assert np.allclose(prior.mean, mean) and np.allclose(prior.variance, [0.01] * 3 + [0.04] * 3)
    assert np.allclose(prior.reference_point, (mug[0] + far).mean(axis=0), atol=0.1)
    # Of the origin, which a turn about the centroid moves.
    assert prior.covariance()[1, 1] == pytest.approx(0.01 + 0.04 * 9, rel=0.1)
    assert prior.to_gtsam() and result.modes == []


def test_a_failed_result_has_a_guess_and_no_prior(failed):
    assert failed.without_prior().num_unmeasured == 6
    assert np.array_equal(failed.init_T_target_source, np.eye(4))
    assert failed.prior.status == "not_run" and np.isnan(failed.prior.covariance()).all()
    assert np.isnan(failed.prior.variance).all() and np.isnan(failed.prior.reference_point).all()


def test_result_shows_itself_and_does_not_pickle(result):
    assert repr(result).startswith("<bayesian_icp.Result ok: x=0.0")
    assert "observed" in repr(result.directions[0])
    assert repr(result.data).startswith("<bayesian_icp.DataReport: noise 0.00")
    assert repr(result.coordinates["x"]).startswith(f"<{result.coordinates['x'].mean:.4g}±")
    assert not np.signbit(result.init_T_target_source).any() and "=-0±" not in repr(result.prior)
    assert result.seconds > 0
    for part in (result, result.data, result.directions[0]):
        with pytest.raises(TypeError, match="cannot pickle"):
            pickle.dumps(part)


@pytest.mark.parametrize("kind", [bayesian_icp.DataReport, bayesian_icp.CoordinateSummary, bayesian_icp.Direction])
def test_fields_say_what_they_are(kind):
    fields = [name for name in dir(kind) if not name.startswith("_")]
    assert fields and all(getattr(kind, name).__doc__ for name in fields)


def test_deviations_of_directions_are_displacements_of_the_source(result, mug):
    points = mug[0] @ result.T_target_source[:3, :3].T + result.T_target_source[:3, 3]
    for direction in result.directions:
        v, w = direction.twist[:3], direction.twist[3:]
        moved = v + np.cross(w, points - result.data.centre)
        assert np.sqrt((moved**2).sum(axis=1).mean()) == pytest.approx(1, rel=0.1)
        assert direction.standard_deviation == pytest.approx(
            direction.prior_standard_deviation / np.sqrt(1 + direction.relative_information), rel=1e-6)


def test_the_angle_of_a_direction():
    folder = DATA / "can"
    can = bayesian_icp.align(source=bayesian_icp.read_pcd(folder / "source.pcd"),
                             target=bayesian_icp.read_pcd(folder / "target.pcd"))
    turn = can.directions[-1]
    norm = np.linalg.norm(turn.twist[3:])
    assert turn.prior_standard_deviation * norm == pytest.approx(np.sqrt(0.125), rel=0.01)
    assert turn.standard_deviation * norm == pytest.approx(0.3533, rel=0.01)
