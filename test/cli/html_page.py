"""An HTML page taken apart by Python's parser, and looked at in a browser."""

import html
import html.parser
import json
import pathlib
import re
import shutil
import subprocess
import tempfile

from PIL import Image

VOID = {"meta", "link", "br", "hr", "img", "input"}
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


class Page(html.parser.HTMLParser):
    """Tags as (name, attributes); texts of elements by their id and by their name."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.tags = []
        self.open = []
        self.texts = {}
        self.feed(text)
        self.close()
        if self.open:
            raise ValueError(f"not closed: {self.open}")

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append((tag, dict(attributes).get("id")))

    def handle_startendtag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        name, _ = self.open.pop()
        if name != tag:
            raise ValueError(f"</{tag}> closes <{name}>")

    def handle_data(self, data):
        for tag, identity in self.open:
            for key in (tag, identity and "#" + identity):
                if key:
                    self.texts[key] = self.texts.get(key, "") + data

    def all(self, name):
        return [attributes for tag, attributes in self.tags if tag == name]

    def ids(self):
        return [attributes["id"] for _, attributes in self.tags if "id" in attributes]


def find_browser():
    """Path of a Chromium; None if there is none."""
    return next(filter(None, map(shutil.which, BROWSERS)), None)


class Browser:
    """A headless Chromium."""

    def __init__(self):
        self.program = find_browser()

    def run(self, *arguments):
        with tempfile.TemporaryDirectory() as profile:
            command = [self.program, "--headless=new", "--no-sandbox", "--disable-gpu"]
            command += ["--hide-scrollbars", "--enable-logging=stderr", "--no-first-run"]
            command += [f"--user-data-dir={profile}", *map(str, arguments)]
            return subprocess.run(
                command, capture_output=True, text=True, timeout=100, check=True
            )

    def console(self, page):
        """What the page says on the console: errors, and what was not allowed."""
        errors = self.run("--dump-dom", pathlib.Path(page).as_uri()).stderr
        return [line for line in errors.splitlines() if "CONSOLE" in line]

    def layout(self, page, width):
        """How the page is laid out on a screen of so many pixels: scroll_width, height, and
        the rectangles [left, top, width, height] of its figures' pictures by their ids."""
        inside = html.escape(pathlib.Path(page).read_text(encoding="utf-8"))
        script = """
          window.onload = () => {
            const page = document.querySelector("iframe").contentDocument;
            const figures = {};
            for (const svg of page.querySelectorAll("figure svg")) {
              const r = svg.getBoundingClientRect();
              if (svg.checkVisibility())
                figures[svg.id] = [r.left, r.top, r.width, r.height];
            }
            const root = page.documentElement;
            document.querySelector("pre").textContent = JSON.stringify(
              {scroll_width: root.scrollWidth, height: root.scrollHeight, figures: figures});
          };"""
        with tempfile.TemporaryDirectory() as folder:
            wrapper = pathlib.Path(folder) / "wrapper.html"
            wrapper.write_text(
                f"<!DOCTYPE html><meta charset='utf-8'><pre></pre><script>{script}</script>"
                f'<iframe style="border:0" width="{width}" height="900" srcdoc="{inside}">'
                "</iframe>",
                encoding="utf-8",
            )
            shown = self.run("--dump-dom", wrapper.as_uri()).stdout
        return json.loads(html.unescape(re.search("<pre>(.*?)</pre>", shown, re.S).group(1)))

    def picture(self, page, width, height, scale=1):
        """A screenshot."""
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "screenshot.png"
            self.run(
                f"--screenshot={file}",
                f"--window-size={width},{height}",
                f"--force-device-scale-factor={scale}",
                pathlib.Path(page).as_uri(),
            )
            return Image.open(file).convert("RGB")
