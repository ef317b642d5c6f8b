"""Readers, report, simulator, the program, and what importing costs."""

import inspect
import json
import os
import pathlib
import shutil
import subprocess
import sys
import typing

import numpy as np
import pytest

import bayesian_icp

from conftest import DATA


def test_reads_finite_points(tmp_path):
    file = tmp_path / "cloud.pcd"
    header = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA ascii\n"
    file.write_text(header + "1 2 3\nnan nan nan\n4 5 6\n7 8 9\n")
    assert bayesian_icp.read_pcd(file).tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    assert bayesian_icp.read_pcd(str(file)).dtype == np.float32


def test_warns_of_digits_that_are_lost(tmp_path):
    file = tmp_path / "far.pcd"
    header = "VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA ascii\n"
    file.write_text(header + "500000.1 5000000.1 0\n500001.2 5000001 0\n500003 5000002 0\n")
    with pytest.warns(UserWarning, match="far.pcd: .* are kept to 0.5 m only") as warned:
        bayesian_icp.read_pcd(file)
    assert warned[0].filename == __file__


def test_names_of_files_need_not_be_utf_8(mug, tmp_path):
    name = os.path.join(os.fsencode(tmp_path), b"caf\xe9.pcd")
    with pytest.raises(OSError, match="caf\udce9.pcd"):
        bayesian_icp.read_pcd(name)
    with open(name, "wb") as file:
        file.write((DATA / "mug" / "source.pcd").read_bytes())
    assert np.array_equal(bayesian_icp.read_pcd(os.fsdecode(name)), mug[0])


def test_reads_ply(tmp_path):
    file = tmp_path / "cloud.ply"
    file.write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                    "end_header\n1 2 3\n4 5 6\n7 8 9\n")
    assert bayesian_icp.read_ply(file).shape == (3, 3)


@pytest.mark.parametrize("name, content, pattern", [
    ("missing.pcd", None, "missing.pcd"), ("broken.pcd", "DATA ascii\n", "broken.pcd"),
    ("cloud.txt", "1 2 3", "neither .pcd nor .ply"),
])
def test_bad_files(tmp_path, name, content, pattern):
    if content:
        (tmp_path / name).write_text(content)
    with pytest.raises(OSError, match=pattern):
        bayesian_icp.read_pcd(tmp_path / name)


def test_writes_the_report(mug, result, tmp_path):
    page = tmp_path / "report.html"
    result.write_report(page, source=mug[0], target=mug[1])
    again = tmp_path / "new" / "folder" / "report.html"
    result.write_report(again, source=bayesian_icp.Target(mug[0]), target=bayesian_icp.Target(mug[1]))
    assert again.stat().st_size == page.stat().st_size
    text = page.read_text()
    assert "<svg" in text and "was not run" in text and "bayesian_icp.align" in text
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match="file"):
        result.write_report(tmp_path / "file" / "report.html", source=mug[0], target=mug[1])
    with pytest.raises(ValueError, match="source has the shape"):
        result.write_report(page, source=mug[0].T, target=mug[1])
    with pytest.raises(ValueError, match="source has .* points, but the one that was registered had"):
        result.write_report(page, source=mug[1], target=mug[0])
    with pytest.raises(ValueError, match=f"target has {len(mug[1]) - 1} points"):
        result.write_report(page, source=mug[0], target=mug[1][1:])


def test_simulates_as_the_program(program, tmp_path):
    scans = bayesian_icp.simulate("mug", seed=5, width=160, height=120)
    words = ["--scene=mug", "--seed=5", "--width=160", "--height=120", f"--output={tmp_path}"]
    subprocess.run([program + "_simulate", *words], check=True, stdout=subprocess.DEVNULL)
    assert np.array_equal(scans.source, bayesian_icp.read_pcd(tmp_path / "source.pcd"))
    assert np.array_equal(scans.target, bayesian_icp.read_pcd(tmp_path / "target.pcd"))
    assert np.array_equal(scans.T_target_source, np.loadtxt(tmp_path / "T_target_source.txt"))
    again = bayesian_icp.simulate("mug", seed=5, width=160, height=120)
    other = bayesian_icp.simulate("mug", seed=6, width=160, height=120)
    assert np.array_equal(scans.source, again.source) and not np.array_equal(scans.source, other.source)
    assert scans.source.dtype == np.float32 and scans.T_target_source.shape == (4, 4)
    same_view = bayesian_icp.simulate("mug", width=160, height=120, same_view=True, offset=(0, 0, 0, 0, 0, 0))
    assert np.allclose(same_view.T_target_source, np.eye(4))
    assert "mug" in bayesian_icp.scenes()


@pytest.mark.parametrize("kind, keywords, pattern", [
    (ValueError, {"scene": "castle"}, r"castle.*scenes\(\)"), (ValueError, {"noise": -1}, "noise"),
    (ValueError, {"noise": "loud"}, "loud"), (ValueError, {"noise": False}, "noise.*False"),
    (ValueError, {"source_eye": (1, 2)}, "source-eye"), (TypeError, {"nois": 2}, "no option nois$"),
    (TypeError, {"max_rang": False}, "no option max_rang$"), (TypeError, {"help": True}, "no option help$"),
    (TypeError, {"list_scenes": True}, "no option list_scenes$"), (TypeError, {"output": "x"}, "no option output$"),
])
def test_bad_simulations(kind, keywords, pattern, capfd):
    with pytest.raises(kind, match=pattern) as error:
        bayesian_icp.simulate(**{"scene": "mug", **keywords})
    assert "--list" not in str(error.value) and capfd.readouterr().out == ""


def test_module_is_the_program(python, program, tmp_path):
    def run(*arguments):
        environment = {**os.environ, "PATH": os.path.dirname(program) + ":" + os.environ["PATH"]}
        return subprocess.run([*python, "-m", "bayesian_icp", *arguments], env=environment, capture_output=True, text=True)

    clouds = [str(DATA / "mug" / name) for name in ("source.pcd", "target.pcd")]
    direct = subprocess.run([program, *clouds, "--json"], capture_output=True, text=True)
    forwarded = run(*clouds, "--json")
    assert forwarded.returncode == direct.returncode == 0
    found, expected = (json.loads(run.stdout) for run in (forwarded, direct))
    assert found.pop("time") and expected.pop("time")
    assert found == expected
    assert run("--no-such-option").returncode == 2
    assert run("missing.pcd", "missing.pcd").returncode == 3


def test_module_without_the_program(python, tmp_path):
    if (pathlib.Path(bayesian_icp.__file__).parent / "bin").exists():
        pytest.skip("the package is of a wheel, which has the program in it")
    run = subprocess.run([*python, "-m", "bayesian_icp"], env={**os.environ, "PATH": str(tmp_path)},
                         capture_output=True, text=True)
    assert run.returncode == 1 and "pcl_bayesian_icp is not in PATH" in run.stderr


def test_importing_loads_little(python):
    code = ("import sys, numpy.typing; before = set(sys.modules); import bayesian_icp; text = open('/proc/self/maps').read(); "
            "new = {name.partition('.')[0] for name in set(sys.modules) - before} - set(sys.stdlib_module_names); "
            "print('libpcl_common' in text, 'libboost' in text, '_tools' in text, *new)")
    assert subprocess.check_output([*python, "-c", code], text=True).split() == ["False"] * 3 + ["bayesian_icp"]


def test_import_of_all_without_the_tools(python, tmp_path):
    package = pathlib.Path(bayesian_icp.__file__).parent
    shutil.copytree(package, tmp_path / package.name, ignore=shutil.ignore_patterns("_tools*", "__pycache__"))
    code = "from bayesian_icp import *; print(align.__name__, 'read_pcd' in globals())"
    run = [*python, "-c", code]
    text = subprocess.check_output(run, env={**os.environ, "PYTHONPATH": str(tmp_path)}, text=True)
    assert text.split() == ["align", "False"]
    assert "read_pcd" in bayesian_icp.__all__ and "read_pcd" in dir(bayesian_icp)


def test_version_is_that_of_the_program(program):
    said = subprocess.check_output([program, "--version"], text=True)
    assert bayesian_icp.__version__ == said.split()[-1]


@pytest.mark.skipif(sys.version_info < (3, 10), reason="Python 3.9 does not evaluate X | None")
def test_types_can_be_looked_up():
    functions = [getattr(bayesian_icp, name) for name in bayesian_icp.__all__]
    functions += [function for _, function in inspect.getmembers(bayesian_icp.Result, inspect.isfunction)]
    for function in filter(inspect.isfunction, functions):
        assert "return" in typing.get_type_hints(function)
    assert typing.get_type_hints(bayesian_icp.align)["return"] is bayesian_icp.Result


def test_open3d(mug, result):
    open3d = pytest.importorskip("open3d", reason="Open3D is not here (python3-open3d): its clouds are not tested")
    clouds = {}
    for name, points in (("source", mug[0]), ("target", mug[1])):
        clouds[name] = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points.astype(float)))
    assert np.array_equal(bayesian_icp.align(**clouds).samples, result.samples)


def test_clouds_with_points_are_taken(mug, result):
    class Cloud:
        def __init__(self, points):
            self.points = points.astype(float)

    assert np.array_equal(bayesian_icp.align(source=Cloud(mug[0]), target=Cloud(mug[1])).samples, result.samples)
