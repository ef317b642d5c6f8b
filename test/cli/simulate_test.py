"""The simulator as a user runs it, and the committed scans that it has made."""

import json
import os
import re

import numpy as np

from cli_tool import DATA, ToolTest, call
from cloud_files import read_xyz
from faults import SIMULATE, SIMULATED

REPOSITORY = DATA.parent
SCENES = """bowl can mug mug_hidden_handle table_top table_plate table box bracket carton cube
    tool corridor plain_corridor corridor_loop stairs room office_floor ground car tree street
    forest bare_ground tunnel tunnel_cabinets""".split()
COMMITTED = ["bowl", "can", "mug", "mug_hidden_handle", "table_top", "table", "corridor"]


def record_of(folder):
    return json.loads((folder / "scene.json").read_text())


class Simulate(ToolTest):
    program = "pcl_bayesian_icp_simulate"

    def simulate(self, words, name="pair", **options):
        """The folder of a pair."""
        folder = self.folder / name
        result = call(SIMULATE, *words.split(), "-o", folder, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual({path.name for path in folder.iterdir()}, SIMULATED)
        return folder

    def assert_same_files(self, first, second):
        for name in SIMULATED:
            self.assertEqual((first / name).read_bytes(), (second / name).read_bytes(), name)

    def test_help_version_and_list_of_scenes(self):
        text = call(SIMULATE, "--help").stdout
        for words in ("--scene can --noise-correlation 0.5 --incidence-noise 1", "--scene room"):
            for option in record_of(self.simulate(words))["options"]:
                self.assertIn(f"--{option} ", text)
        listed = call(SIMULATE, "-list-scenes").stdout
        self.assertEqual(re.findall(r"^(\w+): ", listed, re.MULTILINE), SCENES)
        self.assertRegex(call(SIMULATE, "--version").stdout, r"^pcl_bayesian_icp_simulate 0\.")

    def test_one_or_two_dashes_and_negative_numbers(self):
        once = self.simulate("-scene can -offset -0.1,-.2,3e-1,0,0,0 -seed=7", "once")
        self.assertEqual(
            (once / "T_target_source.txt").read_text(),
            "1 0 0 -0.10000000000000001\n0 1 0 -0.20000000000000001\n"
            "0 0 1 0.29999999999999999\n0 0 0 1\n",
        )
        self.assert_same_files(
            once, self.simulate("--scene can --offset=-0.1,-0.2,0.3,0,0,0 --seed 7", "again")
        )

    def test_bad_arguments(self):
        folder = self.folder / "out"
        lines = """
            --scene can --output; --scene moon; --scene can extra; --scene can --sead 3
            --scene can --out x; --scene can --seed -1; --scene can --seed 1.5
            --scene can --width many; --scene can --width 0; --scene can --incidence-noise no
            --scene can --offset 1,2,3; --scene can --offset 1,2,3,4,5,6,7
            --scene can --offset 1,2,3,4,5,; --scene can --target-eye 0,0,0
            --scene can --target-look-at 0,-0.62,0.32; --scene can --target-look-at 0,-5,0
            --scene can --sensor sonar; --scene street --sensor lidar12
            --scene street --sweep-motion 2; --scene can --sweep-motion 0.5
            --scene can --rings 3; --scene mug --ring-offset 0.1; --scene mug --range-noise 5
            --scene room --width 100; --scene can --noise-correlation-pixels 4
            --scene can --frame world; --scene can --quantisation fine
            --scene room --quantisation kinect; --scene can --scene mug
            --scene room --sensor-seed 3; --scene street --same-view --sweep-motion 0.5
            --scene can --same-view --source-eye 0,-1,1; --scene can --outlier-spread 0.2
            --scene street --noise 0 --incidence-noise 1; --scene room --noise 0 --range-noise 1
            --scene room --range-noise 0 --noise 2; --scene room --range-noise 0 --incidence-noise 1
            --scene room --range-noise 0 --noise-correlation 0.5"""
        for words in ["", *re.split("[;\n]", lines.strip())]:
            with self.subTest(words=words):
                self.assert_refused(2, call(SIMULATE, *words.split(), "-o", folder))
        self.assert_refused(2, call(SIMULATE, "--scene", "can"), "--output")
        self.assert_refused(2, call(SIMULATE, "--scene", "can", "-o", ""), "name is empty")
        self.assertFalse(folder.exists())

    def test_same_bytes_for_any_number_of_threads(self):
        words = "--scene mug --outliers 0.05 --jitter 1 --noise-correlation 0.7"
        one, three = (
            self.simulate(words, number, env={**os.environ, "OMP_NUM_THREADS": number})
            for number in "13"
        )
        self.assert_same_files(one, three)

    def test_recorded_command_line_makes_the_pair_again(self):
        for words in (
            "--scene stairs --width 100 --height 80 --quantisation 0.002 --lateral-noise 0.5 "
            "--outliers 0.02 --outlier-spread 0.3 --jitter 0.3 --fov 50 --min-range 0.5 "
            "--source-eye -1.25,0.07,1.3 --source-look-at 0,0,0.4 --seed 18446744073709551615",
            "--scene room --range-noise 0.01 --noise 2 --rings 8 --min-elevation -20 "
            "--max-elevation 5 --azimuth-step 1.5 --max-range 4 --same-view --frame object "
            "--offset 0.1,0,-0.05,0,0.02,-0.3 --dropout-from 70",
            "--scene street --sensor lidar64 --azimuth-step 2 --sweep-motion 1 "
            "--ring-offset 0.02 --sensor-seed 7 --incidence-noise 0",
            "--scene carton --noise-correlation 0.5 --noise-correlation-pixels 4 "
            "--incidence-noise 1.5",
            "--scene street --range-noise 0 --noise 0 --azimuth-step 2 --incidence-noise 0",
            "--scene street --range-noise 0 --azimuth-step 2 --same-view --sweep-motion 0",
        ):
            with self.subTest(words=words):
                first = self.simulate(words, "first")
                program, again = record_of(first)["command_line"].split(" ", 1)
                self.assertEqual(program, self.program)
                self.assert_same_files(first, self.simulate(again, "again"))

    def test_committed_data_are_made_again(self):
        made = call(REPOSITORY / "scripts" / "make-data", SIMULATE, self.folder)
        self.assertEqual(made.returncode, 0, made.stderr)
        readme = (DATA / "README.md").read_text()
        for name in COMMITTED:
            again = self.folder / "data" / name
            for cloud in ("source.pcd", "target.pcd"):
                # Up to the rounding of another C library.
                found = read_xyz(again / cloud)
                self.assertGreater(len(found), 3000)
                np.testing.assert_allclose(found, read_xyz(DATA / name / cloud), rtol=0, atol=1e-6)
            matrices = [path / "T_target_source.txt" for path in (DATA / name, again)]
            self.assertEqual(matrices[0].read_text(), matrices[1].read_text())
            points = record_of(again)["points"]
            self.assertIn(f"{points['source']} / {points['target']}", readme, name)
