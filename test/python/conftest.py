"""Clouds that the tests share, and what else they do."""

import os
import pathlib
import sys
import threading

import hypothesis
import numpy as np
import pytest

import bayesian_icp

# The same inputs in each run, and no files of them.
hypothesis.settings.register_profile("repeatable", database=None, derandomize=True)
hypothesis.settings.load_profile("repeatable")

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"


def draw(num_draws, **chains):
    """Options for so many draws."""
    return bayesian_icp.Options(chains=bayesian_icp.ChainOptions(num_draws=num_draws, **chains))


def turns_during(work):
    """How often another thread has a turn, one each millisecond at the most, while this one works."""
    turns, done = [], threading.Event()

    def take_turns():
        while not done.wait(0.001):
            turns.append(1)

    thread = threading.Thread(target=take_turns)
    thread.start()
    before = len(turns)
    work()
    during = len(turns) - before
    done.set()
    thread.join()
    return during


@pytest.fixture(scope="session")
def mug():
    """Source, target and the true pose."""
    folder = DATA / "mug"
    return (
        bayesian_icp.read_pcd(folder / "source.pcd"),
        bayesian_icp.read_pcd(folder / "target.pcd"),
        np.loadtxt(folder / "T_target_source.txt"),
    )


@pytest.fixture(scope="session")
def result(mug):
    return bayesian_icp.align(source=mug[0], target=mug[1])


@pytest.fixture(scope="session")
def failed(mug):
    """The result of clouds that have nothing in common."""
    return bayesian_icp.align(source=mug[0] + np.float32(100), target=mug[1], prior_std=(0.01, 0.01))


@pytest.fixture(scope="session")
def program():
    """The command line tool of the build."""
    path = os.environ.get("PCL_BAYESIAN_ICP", "")
    if not path:
        pytest.skip("PCL_BAYESIAN_ICP names no program")
    return path


@pytest.fixture
def python():
    """A Python of its own that finds the package."""
    return [sys.executable, "-B"]
