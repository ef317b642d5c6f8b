"""The registration: what it finds, what it is given, how it is watched and ended."""

import concurrent.futures
import multiprocessing
import signal
import subprocess
import threading
import time

import numpy as np
import pytest

import bayesian_icp

from conftest import DATA, draw, turns_during


def test_finds_the_true_pose(mug, result):
    source, target, truth = mug
    assert result.status == "ok"
    assert result.flags == ()
    error = bayesian_icp.pose_error(bayesian_icp.pose_from_matrix(truth), result.mean)
    assert error @ np.linalg.solve(result.covariance(), error) < 25
    assert np.linalg.norm(error[:3]) < 0.001
    assert result.samples.shape == (4, 500, 6)
    assert [direction.observability for direction in result.directions] == ["observed"] * 6


def draws_of_program(program, folder, *arguments):
    """Those of the C++ program, (chains, draws, 6)."""
    subprocess.run([program, *map(str, arguments), "-o", str(folder), "--no-report", "--quiet"],
                   stderr=subprocess.DEVNULL)
    table = np.loadtxt(folder / "samples.csv", delimiter=",", skiprows=1)
    return table[:, 2:].reshape(int(table[-1, 0]) + 1, -1, 6)


# The program's guess has 32 bits.
GUESS = bayesian_icp.matrix_from_pose([0.02, -0.01, 0.01, 0.05, -0.05, 0.1]).astype(np.float32).astype(float)


@pytest.mark.parametrize("preset, rivals", [("calibrated", False), ("exact", False), ("exact", True),
                                            ("paper", False)])
def test_draws_are_those_of_the_program_to_the_last_bit(preset, rivals, mug, program, tmp_path):
    options = draw(400)
    lines = ["--preset", preset, "--seed", 7, "--prior-variance", 0.04]
    if preset == "exact":
        options.exact.scale.measurement_sigma = 0.05
        lines += ["--sigma", 0.05]
    if rivals:
        options.exact.residual.residual = "distribution-to-distribution"
        options.exact.residual.regularization = "frobenius"
        options.exact.steps = "stein-newton"
        options.exact.num_particles = 8
        options.exact.max_source_points = 100
        lines += ["--residual", "distribution-to-distribution", "--regularization", "frobenius",
                  "--steps", "stein-newton", "--particles", 8, "--max-source-points", 100]
    else:
        lines += ["--samples", 400]
    np.savetxt(tmp_path / "guess.txt", GUESS, fmt="%.17g")
    clouds = [DATA / "mug" / name for name in ("source.pcd", "target.pcd")]
    expected = draws_of_program(program, tmp_path / "out", *clouds,
                                "--guess", tmp_path / "guess.txt", *lines)
    found = bayesian_icp.align(source=mug[0], target=mug[1], init_T_target_source=GUESS, preset=preset, seed=7,
                               prior_variance=(0.04, 0.04), options=options)
    assert np.array_equal(found.samples, expected)


@pytest.mark.parametrize("num_threads", [1, 3])
def test_draws_do_not_depend_on_threads_or_layout(num_threads, mug, result):
    strided = np.asfortranarray(np.repeat(mug[1], 2, axis=0)[::2])
    again = bayesian_icp.align(source=mug[0].astype(float), target=strided, num_threads=num_threads)
    assert np.array_equal(again.samples, result.samples)


def test_another_seed_gives_other_draws(mug, result):
    assert not np.array_equal(bayesian_icp.align(source=mug[0], target=mug[1], seed=2).samples, result.samples)


def test_a_target_serves_many_sources(mug, result):
    target = bayesian_icp.Target(mug[1])
    assert len(target) == len(mug[1])
    for _ in range(2):
        assert np.array_equal(bayesian_icp.align(source=mug[0], target=target).samples, result.samples)
    assert np.array_equal(bayesian_icp.align(source=bayesian_icp.Target(mug[0]), target=target).samples,
                          result.samples)
    exact = dict(source=mug[0], preset="exact")
    assert np.array_equal(bayesian_icp.align(target=target, **exact).samples,
                          bayesian_icp.align(target=mug[1], **exact).samples)


def test_swapped_clouds_give_the_inverse(mug, result):
    swapped = bayesian_icp.align(source=mug[1], target=mug[0])
    assert np.allclose(swapped.T_target_source @ result.T_target_source, np.eye(4), atol=0.02)


def test_guess_and_prior(mug):
    far = bayesian_icp.matrix_from_pose([0.5, 0, 0, 0, 0, 0])
    source = mug[0] - np.array([0.5, 0, 0])
    by_guess = bayesian_icp.align(source=source, target=mug[1], init_T_target_source=far)
    by_prior = bayesian_icp.align(source=source, target=mug[1], prior_mean=far, prior_std=(0.35355, 0.35355))
    assert by_guess.T_target_source[0, 3] == pytest.approx(0.53, abs=0.02)
    assert np.allclose(by_guess.mean, by_prior.mean, atol=2e-3)
    six = bayesian_icp.align(source=mug[0], target=mug[1], prior_std=[0.1] * 3 + [0.2] * 3)
    two = bayesian_icp.align(source=mug[0], target=mug[1], prior_variance=(0.1**2, 0.2**2))
    assert np.array_equal(six.samples, two.samples)
    assert np.allclose(six.options.prior.variance, [0.01] * 3 + [0.04] * 3)


def test_keywords_leave_the_options_alone(mug):
    options = draw(40)
    found = bayesian_icp.align(source=mug[0], target=mug[1], seed=5, options=options)
    assert options.chains.seed == 1 and found.options.chains.seed == 5
    assert found.samples.shape == (4, 10, 6) and found.status == "not_mixed"


def test_uneven_chains_are_cut(mug):
    found = bayesian_icp.align(source=mug[0], target=mug[1], options=draw(10, num_chains=3))
    assert found.samples.shape == (3, 3, 6)
    assert [len(found.chain(i)) for i in range(3)] == [4, 3, 3]
    for index in (3, -1):
        with pytest.raises(IndexError, match=f"index is {index}, but there are 3 chains"):
            found.chain(index)


def test_clouds_without_overlap_give_nan_not_the_identity(failed):
    assert failed.status == "too_few_correspondences"
    assert np.isnan(failed.T_target_source[:3]).all() and np.isnan(failed.covariance()).all()
    assert failed.samples.size == 0
    with pytest.raises(ValueError):
        failed.to_tum()


def test_progress_is_told_in_the_calling_thread_and_can_cancel(mug):
    told = []

    def observe(steps, total_steps, pose):
        told.append((steps, total_steps, threading.get_ident()))
        return steps < 100

    found = bayesian_icp.align(source=mug[0], target=mug[1], progress=observe, options=draw(2_000_000))
    assert found.status == "interrupted"
    assert told[-1][0] >= 100
    assert {thread for *_, thread in told} == {threading.get_ident()}


def test_an_exception_of_the_observer_reaches_the_caller(mug):
    def observe(*_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        bayesian_icp.align(source=mug[0], target=mug[1], progress=observe)


def test_an_observer_must_not_return_a_text(mug):
    with pytest.raises(TypeError, match="progress returned 'half', but must return True, False or None"):
        bayesian_icp.align(source=mug[0], target=mug[1], progress=lambda *_: "half")
    assert bayesian_icp.align(source=mug[0], target=mug[1], progress=lambda *_: np.bool_(False)).status == "interrupted"


def test_the_bar_ends_with_a_line(mug, capsys):
    bayesian_icp.align(source=mug[0], target=mug[1], progress=True)
    shown = capsys.readouterr().err
    assert "100 %" in shown and shown.endswith("\n")


def test_other_threads_run_meanwhile(mug):
    work = lambda: bayesian_icp.align(source=mug[0], target=mug[1], options=draw(20_000))
    assert turns_during(work) > 20


def test_several_at_once_are_as_one_after_the_other(mug, result):
    target = bayesian_icp.Target(mug[1])
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        runs = [pool.submit(bayesian_icp.align, source=mug[0], target=target) for _ in range(4)]
        assert all(np.array_equal(run.result().samples, result.samples) for run in runs)


def mean_of(clouds):
    return bayesian_icp.align(source=clouds[0], target=clouds[1]).mean


def test_a_forked_process_registers_too(mug, result):
    with multiprocessing.get_context("fork").Pool(1) as pool:
        mean = pool.apply_async(mean_of, [mug[:2]]).get(timeout=60)
    assert np.array_equal(mean, result.mean)


ENDLESS = """
import threading, time, numpy, bayesian_icp
scans = bayesian_icp.simulate("mug")
options = bayesian_icp.Options()
options.chains.num_draws = 10_000_000
def run(repeat=1):
    clouds = dict(source=numpy.repeat(scans.source, repeat, 0), target=numpy.repeat(scans.target, repeat, 0))
    bayesian_icp.align(**clouds, options=options)
"""
DAEMON = ENDLESS + """
threading.Thread(target=run, daemon=True).start()
time.sleep(0.5)
"""


def test_a_program_may_end_during_a_registration(python):
    assert subprocess.run([*python, "-c", DAEMON], timeout=60).returncode == 0


def test_digits_are_doubted_of_the_cloud_that_lost_them(mug):
    source, target, _ = mug
    far = np.array([0, 2e4, 0])
    guess = np.eye(4)
    guess[:3, 3] = far

    def status(target):
        result = bayesian_icp.align(source=source, target=target, init_T_target_source=guess)
        return result.status, "in 32 bits" in result.message

    assert status(target + far) == ("ok", False)
    assert status((target + far).astype(np.float32))[1]


INTERRUPTED = ENDLESS + """
print("begins", flush=True)
try:
    run({repeat})
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.parametrize("repeat, delay", [(1, 2), (200, 1)])  # among the draws, before them
def test_ctrl_c_ends_it_within_a_second(repeat, delay, python):
    process = subprocess.Popen([*python, "-c", INTERRUPTED.format(repeat=repeat)],
                               stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begins\n"
    time.sleep(delay)
    start = time.monotonic()
    process.send_signal(signal.SIGINT)
    assert process.stdout.readline() == "interrupted\n"
    assert process.wait(10) == 0
    assert time.monotonic() - start < 1
