"""The types of the package: mypy agrees with its code, and its stubs with its extensions."""

import os
import pathlib
import re
import subprocess
import sys

import pytest

import bayesian_icp

pytest.importorskip("mypy", reason="mypy is not here: types are not tested")

PACKAGE = pathlib.Path(bayesian_icp.__file__).parent

USER = '''
import numpy as np
import bayesian_icp

scans = bayesian_icp.simulate("mug")
target = bayesian_icp.Target(scans.target)
result = bayesian_icp.align(source=scans.source, target=target, seed=3, progress=True)
reveal_type(result.covariance("r3xso3"))
reveal_type(result.directions[0].description)
bayesian_icp.align(source=scans.source, target=target, sead=3)
result.covariance(3)
result.data.noise_scale = 3
'''


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    """What mypy has learned of NumPy."""
    return tmp_path_factory.mktemp("mypy")


def mypy(tool, *arguments, **keywords):
    environment = {**os.environ, "MYPYPATH": str(PACKAGE.parent)}
    return subprocess.run([sys.executable, "-m", tool, *map(str, arguments)], env=environment,
                          capture_output=True, text=True, **keywords)


def test_the_package_is_well_typed(cache):
    run = mypy("mypy", "--strict", "--cache-dir", cache, PACKAGE)
    assert run.returncode == 0, run.stdout


def test_users_get_types(cache, tmp_path):
    (tmp_path / "user.py").write_text(USER)
    run = mypy("mypy", "--cache-dir", cache, "user.py", cwd=tmp_path)
    lines = run.stdout.splitlines()
    assert any('"numpy.ndarray' in line for line in lines), run.stdout
    assert any('"builtins.str"' in line for line in lines), run.stdout
    errors = [line for line in lines if " error: " in line]
    assert len(errors) == 3 and "sead" in errors[0] and "covariance" in errors[1], run.stdout
    assert "final attribute" in errors[2], run.stdout


def test_stubs_are_those_of_the_extensions(tmp_path):
    run = mypy("mypy.stubtest", "--concise", "bayesian_icp._core", "bayesian_icp._tools", cwd=tmp_path)
    # pybind11 has a metaclass, and classes without a constructor have object's.
    of_pybind11 = ("metaclass differs", "__init__ is inconsistent, stub does not have *args")
    # Properties are Final in the stub, which does not know that this is read-only.
    finals = re.findall(r"(\w+): Final\[", (PACKAGE / "_core.pyi").read_text())
    read_only = tuple(f".{name} is read-only at runtime but not in the stub" for name in finals)
    differences = [line for line in run.stdout.splitlines()
                   if not line.endswith(read_only) and not any(words in line for words in of_pybind11)]
    assert not differences and "_core.Options " in run.stdout, run.stdout + run.stderr
