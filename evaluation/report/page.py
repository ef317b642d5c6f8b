"""A report of sections, and its two forms, Markdown and one HTML file; figures."""

import base64
import dataclasses
import html
import io
import os
import tempfile

import matplotlib

matplotlib.use("Agg")

from matplotlib import pyplot  # noqa: E402

# Users' own settings are not for these pictures; the same numbers give the same bytes.
matplotlib.rcdefaults()
matplotlib.rcParams.update(
    {"svg.fonttype": "none", "svg.hashsalt": "report", "font.size": 9, "axes.grid": True,
     "axes.axisbelow": True, "grid.color": "#dddddd", "axes.titlesize": 9, "lines.linewidth": 1.4}
)  # fmt: skip

# Told apart by colour-blind readers as well (Okabe and Ito).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999933", "#882255")  # fmt: skip
MARKERS = "osD^v<>Px"
KEY_WIDTH = 2.4  # inch

STYLE = """:root { color-scheme: light dark }
body { font: 1rem/1.5 system-ui, sans-serif; max-width: 68rem; margin: 0 auto; padding: 1rem }
h1 { font-size: 1.4rem } h2 { font-size: 1.15rem; border-top: 1px solid #8888; padding-top: .6rem }
p { max-width: 46rem } .scroll { overflow-x: auto }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums }
caption { text-align: left; opacity: .75; padding: .6rem 0 .3rem }
th, td { padding: .2rem .7rem .2rem 0; border-bottom: 1px solid #8886; text-align: right;
  white-space: nowrap } th:first-child, td:first-child { text-align: left }
pre { background: #8882; padding: .7rem; white-space: pre-wrap; overflow-wrap: anywhere }
figure { margin: .8rem 0 } img { width: 100%; min-width: 40rem; background: #fff }
figcaption { opacity: .75; max-width: 46rem }
@media print { img { min-width: 0 } td, th { white-space: normal } }"""

POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


@dataclasses.dataclass
class Text:
    text: str

    def markdown(self):
        return self.text + "\n"

    def html(self, _output):
        return f"<p>{html.escape(self.text)}</p>"


@dataclasses.dataclass
class Code(Text):
    """Commands, as they are."""

    def markdown(self):
        return f"```\n{self.text}\n```\n"

    def html(self, _output):
        return f"<pre>{html.escape(self.text)}</pre>"


@dataclasses.dataclass
class Table:
    """The first column is of names, the others of numbers."""

    caption: str
    header: list
    rows: list

    def markdown(self):
        def line(cells):
            return "".join("| " + cell.replace("|", "\\|") + " " for cell in cells) + "|\n"

        rule = "|---|" + "--:|" * (len(self.header) - 1) + "\n"
        return f"{self.caption}\n\n{line(self.header)}{rule}{''.join(map(line, self.rows))}"

    def html(self, _output):
        def line(cells, tag):
            return "<tr>" + "".join(f"<{tag}>{html.escape(c)}</{tag}>" for c in cells) + "</tr>\n"

        body = line(self.header, "th") + "".join(line(row, "td") for row in self.rows)
        caption = html.escape(self.caption)
        return f'<div class="scroll"><table><caption>{caption}</caption>\n{body}</table></div>'


@dataclasses.dataclass
class Figure:
    """A picture that is in the report's folder as NAME.svg and NAME.png."""

    name: str
    caption: str

    def markdown(self):
        return f"![{self.caption}]({self.name}.svg)\n"

    def html(self, output):
        data = base64.b64encode(output.files[f"{self.name}.svg"]).decode()
        caption = html.escape(self.caption)
        return (
            f'<figure><div class="scroll"><img alt="{html.escape(self.name)}" '
            f'src="data:image/svg+xml;base64,{data}"></div><figcaption>{caption}</figcaption></figure>'
        )


@dataclasses.dataclass
class Section:
    title: str
    blocks: list


def markdown_of(title, sections):
    text = f"# {title}\n"
    for section in sections:
        text += f"\n## {section.title}\n" + "".join("\n" + b.markdown() for b in section.blocks)
    return text


def html_of(title, sections, output):
    body = "".join(
        f"<h2>{html.escape(section.title)}</h2>\n"
        + "".join(block.html(output) + "\n" for block in section.blocks)
        for section in sections
    )
    title = html.escape(title)
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        f"<title>{title}</title><style>{STYLE}</style></head>\n"
        f"<body><h1>{title}</h1>\n{body}</body></html>\n"
    )


class Output:
    """Files on their way into a folder: all of them get there complete, or none does."""

    def __init__(self, folder):
        self.folder = folder
        self.files = {}

    def commit(self):
        """Raises ValueError with the name of the file that cannot be written."""
        temporary = {}
        mask = os.umask(0)
        os.umask(mask)
        try:
            for name, data in self.files.items():
                handle, temporary[name] = tempfile.mkstemp(dir=self.folder, prefix=".report")
                with open(handle, "wb") as file:
                    file.write(data)
                os.chmod(temporary[name], 0o666 & ~mask)
            for name in self.files:
                os.replace(temporary[name], self.folder / name)
                del temporary[name]
        except OSError as error:
            raise ValueError(f"{name} cannot be written: {error.strerror}") from error
        finally:
            for path in temporary.values():
                os.unlink(path)


def write(output, sections, title="Bayesian ICP: evaluation"):
    """Puts the report beside its figures, and all of them into the folder."""
    output.files["report.md"] = markdown_of(title, sections).encode()
    output.files["report.html"] = html_of(title, sections, output).encode()
    output.commit()


def panels(num_rows, num_columns, width, height, **options):
    """A figure with rows and columns of panels of this size [inch], as a 2-D array of axes."""
    return pyplot.subplots(
        num_rows, num_columns, figsize=(width * num_columns, height * num_rows), squeeze=False,
        constrained_layout=True, **options,
    )  # fmt: skip


def add_key(figure, axes):
    """The key of some axes, to the right of all panels."""
    width, height = figure.get_size_inches()
    share = width / (width + KEY_WIDTH)
    figure.set_size_inches(width + KEY_WIDTH, height)
    figure.get_layout_engine().set(rect=(0, 0, share, 1))
    figure.legend(*axes.get_legend_handles_labels(), loc="center left", bbox_to_anchor=(share, 0.5))


def save(output, name, caption, figure, key_of=None):
    """Saves a figure, with the key of the axes key_of."""
    if key_of is not None:
        add_key(figure, key_of)
    for kind, options in {"svg": {"metadata": {"Date": None}}, "png": {"dpi": 100}}.items():
        data = io.BytesIO()
        figure.savefig(data, format=kind, **options)
        output.files[f"{name}.{kind}"] = data.getvalue()
        figure.set_layout_engine("none")  # it is laid out, and that takes long
    pyplot.close(figure)
    return Figure(name, caption)
