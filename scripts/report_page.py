"""Pieces of a page that needs nothing but itself: text, tables, bars, inline pictures, style for screen and paper."""

import base64
import html
import io
import re

from figure_style import plt

STYLE = """
:root { --ink: #22272e; --soft: #5b6570; --line: #d5dae0; --blue: #1f5fa8; --red: #b03a48; --green: #2f7d5b; }
body { font: 15px/1.5 system-ui, 'DejaVu Sans', sans-serif; color: var(--ink); max-width: 60rem; margin: 2rem auto;
       padding: 0 1rem; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: 0 0 .3rem; }
h2 { font-size: 1.12rem; margin: 2.2rem 0 .5rem; border-bottom: 1px solid var(--line); padding-bottom: .2rem; }
.outcome { font-weight: 600; } .good { color: var(--green); } .bad { color: var(--red); } .soft { color: var(--soft); }
.note { border-left: 3px solid var(--red); padding: .3rem .8rem; background: #faf3f4; margin: .6rem 0; }
table { border-collapse: collapse; font-size: .88rem; margin: .6rem 0; display: block; overflow-x: auto; }
th, td { text-align: left; padding: .22rem .8rem .22rem 0; border-bottom: 1px solid var(--line); vertical-align: top; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.bar { display: inline-block; height: .7em; background: var(--blue); min-width: 1px; -webkit-print-color-adjust: exact;
       print-color-adjust: exact; }
figure { margin: 1rem 0; } figure img { max-width: 100%; height: auto; }
figcaption { color: var(--soft); font-size: .88rem; }
pre { font-size: .8rem; line-height: 1.35; background: #f5f7f9; padding: .7rem; overflow-x: auto;
      white-space: pre-wrap; }
code { font-size: .92em; background: #f5f7f9; }
@page { size: A4; margin: 16mm 14mm; }
@media print {
  body { font-size: 10.5pt; max-width: none; margin: 0; padding: 0; }
  h2, figcaption { break-after: avoid; } figure, tr { break-inside: avoid; }
  figure img { max-height: 210mm; } table { display: table; overflow: visible; } pre { white-space: pre-wrap; }
}
"""


def text(value):
    """Anything as escaped text; floats in six digits."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        value = f"{value:.6g}"
    return html.escape(str(value))


def table(head, rows):
    """Rows of cells; numbers to the right. A cell that is a tuple holds ready HTML: (html,)."""
    def cell(value, kind):
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        content = value[0] if isinstance(value, tuple) else text(value)
        return f"<{kind}{' class=number' if number else ''}>{content}</{kind}>"

    lines = ["<tr>" + "".join(cell(value, "th") for value in head) + "</tr>"] if head else []
    lines += ["<tr>" + "".join(cell(value, "td") for value in row) + "</tr>" for row in rows]
    return "<table>" + "\n".join(lines) + "</table>"


def bar(share):
    """A bar of so many hundredths of ten lines' height."""
    return (f"<span class=bar style='width:{12 * min(max(share, 0.0), 1.0):.2f}em'></span>",)


def note(words):
    return f"<p class=note>{text(words)}</p>"


def picture_of(png, caption):
    data = base64.b64encode(png).decode("ascii")
    return (f"<figure><img alt='{text(caption)}' src='data:image/png;base64,{data}'>"
            f"<figcaption>{text(caption)}</figcaption></figure>")


def picture(figure, caption):
    """A figure of matplotlib as part of the page."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=120, bbox_inches="tight")
    plt.close(figure)
    return picture_of(stream.getvalue(), caption)


def markdown(source):
    """Paragraphs, tables, **bold** and `code` of our own texts as HTML."""
    def inline(words):
        words = re.sub(r"`([^`]+)`", r"<code>\1</code>", text(words))
        return re.sub(r"\*\*([^*]+)\*\*", r"<b>\1</b>", words)

    blocks = []
    for block in re.split(r"\n\s*\n", source.strip()):
        lines = block.splitlines()
        if lines[0].startswith("|"):
            rows = [[(inline(cell.strip()),) for cell in line.strip().strip("|").split("|")] for line in lines]
            blocks.append(table(rows[0], rows[2:]))
        else:
            blocks.append(f"<p>{inline(' '.join(lines))}</p>")
    return "\n".join(blocks)


def page(title, sections):
    """The whole page. `sections`: (heading, HTML); the first one, without a heading, stands below the title."""
    body = "\n".join((f"<section><h2>{text(heading)}</h2>" if heading else "<section>") + f"{content}</section>"
                     for heading, content in sections if content)
    return (f"<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8>"
            f"<meta name=viewport content='width=device-width, initial-scale=1'><title>{text(title)}</title>"
            f"<style>{STYLE}</style></head>\n<body><h1>{text(title)}</h1>\n{body}\n</body></html>\n")
