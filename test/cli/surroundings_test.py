"""Locales with decimal commas, names with spaces and umlauts, and no folder for temporary
files."""

import os
import pathlib
import re
import shutil

from cli_tool import FAST, TOOL, scans, strict_json
from faults import FaultTest, call, rows_of

ODD_NAME = "Größe 1,5 m & 'Tee' \"$HOME\" 日本"


class DecimalCommas(FaultTest):
    """As in Germany: 1.5 is written 1,5, and 1.000 is a thousand."""

    def setUp(self):
        super().setUp()
        locales = self.folder / "locales"
        locales.mkdir()
        words = ["localedef", "-i", "de_DE", "-f", "UTF-8", locales / "de_DE.UTF-8"]
        if not shutil.which(words[0]) or call(*words).returncode != 0:
            self.skipTest("no sources of locales here (package locales)")
        self.has_display()  # its name is a part of the environment
        german = dict.fromkeys(["LC_ALL", "LANG"], "de_DE.UTF-8")
        self.german = {**os.environ, **german, "LOCPATH": str(locales)}
        shown = call("locale", "-k", "decimal_point", env=self.german)
        self.assertIn('","', shown.stdout)

    def files_of(self, tool, environment):
        output = self.new_folder()
        self.run_whole(tool, output, env=environment)
        return {path.name: self.without_the_run(path, output) for path in output.iterdir()}

    @staticmethod
    def without_the_run(path, output):
        """Content without what is of this run only: times, also of files, and the output's
        name."""
        if path.name == "coverage.csv":
            return rows_of(path)
        content = path.read_bytes().replace(bytes(output), b"OUTPUT")
        content = re.sub(rb'"(\w*_s|seconds)": ?[0-9.e+-]+', rb'"\1": 0', content)
        content = re.sub(rb'"files_state": ?"\w+"', b"", content)
        return re.sub(rb"[0-9.]+ s\b", b"0 s", content)

    def test_every_tool_writes_the_same(self):
        for tool in self.invocations(self.folder):
            with self.subTest(tool=tool):
                plain = self.files_of(tool, {**os.environ, "LC_ALL": "C"})
                self.assertEqual(self.files_of(tool, self.german), plain)

    def test_numbers_in_options_have_points(self):
        source, target = self.small_pair()
        words = [TOOL, source, target, *FAST, "--json", "--sigma"]
        document = strict_json(call(*words, "0.5", env=self.german).stdout)
        self.assertEqual(document["options"]["posterior"]["measurement_sigma_m"], 0.5)
        refused = call(*words, "0,5", env=self.german)
        self.assertEqual(refused.returncode, 2, refused.stderr)


class LocaleThatIsNotThere(FaultTest):
    def test_every_tool(self):
        for tool in self.invocations(self.folder):
            with self.subTest(tool=tool):
                environment = {**os.environ, "LC_ALL": "xx_XX.UTF-8"}
                self.run_whole(tool, self.new_folder(), env=environment)


class OddNames(FaultTest):
    def test_every_tool(self):
        self.folder = self.folder / ODD_NAME
        self.folder.mkdir()
        for tool in self.invocations(self.folder):
            with self.subTest(tool=tool):
                output = self.new_folder() / ODD_NAME
                output.mkdir()
                command = self.run_whole(tool, output)
                if tool == "register":
                    document = strict_json((output / "posterior.json").read_text())
                    self.assertEqual(document["source"]["file"], str(command[1]))


class NoTemporaryFolder(FaultTest):
    """Nothing needs /tmp, or what TMPDIR names: also gnuplot's figures do not."""

    def check(self, output, launcher=(), **options):
        words = [*launcher, TOOL, *scans("can"), *FAST, "--quiet", "-o", output]
        result = call(*words, **options)
        self.assertIn(result.returncode, (0, 1), result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1)  # the status
        self.assertIn("<svg", (output / "report.html").read_text())

    def test_variables_name_what_is_not_there(self):
        names = ("TMPDIR", "TMP", "TEMP", "TEMPDIR")
        nowhere = {**os.environ, **{name: "/proc/no_such" for name in names}}
        self.check(self.new_folder(), env=nowhere)

    def test_no_tmp_at_all(self):
        output = pathlib.Path("/var/tmp") / f"bayesian_icp_{os.getpid()}"
        hide = ["unshare", "-m", "sh", "-c", 'mount -t tmpfs -o ro none /tmp && exec "$@"', "sh"]
        if TOOL.startswith("/tmp/") or not shutil.which("unshare") or call(*hide, "true").returncode:
            self.skipTest("only root can take /tmp away")
        output.mkdir()
        self.addCleanup(shutil.rmtree, output)
        self.check(output, hide)
