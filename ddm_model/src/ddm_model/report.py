# Formats a report as one self-contained HTML file: verdict, facts and figures.
# SPDX-License-Identifier: BSD-3-Clause
import html

STYLE = """body { font: 15px/1.45 sans-serif; color: #222; max-width: 62em; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.5em; } h2 { font-size: 1.15em; margin-top: 2em; }
table { border-collapse: collapse; } td, th { border: 1px solid #ccc; padding: .3em .6em; text-align: left;
vertical-align: top; overflow-wrap: anywhere; } th { background: #f3f3f3; }
img { max-width: 100%; height: auto; } pre { background: #f6f6f6; padding: .8em; overflow-x: auto; }
.summary { border-left: .4em solid #0072B2; background: #f3f7fb; padding: .8em 1em; }
.failed { border-left-color: #D55E00; background: #fcf3ee; } tr.failed td:first-child { font-weight: bold; }
td:first-child { white-space: nowrap; } td:nth-child(2) { min-width: 10em; }"""
MARKS = {True: "passed", False: "FAILED", None: "not known"}


def escaped(value):
    return html.escape(str(value), quote=True)


def table(head, rows, marked=()):
    """HTML table; all cells are escaped. marked: indices of highlighted rows."""
    lines = ["<table>", "<tr>%s</tr>" % "".join("<th>%s</th>" % escaped(cell) for cell in head)]
    for i, row in enumerate(rows):
        lines.append("<tr%s>%s</tr>" % (' class="failed"' if i in marked else "",
                                        "".join("<td>%s</td>" % escaped(cell) for cell in row)))
    return "\n".join(lines + ["</table>"])


def figure(title, uri, caption):
    return '<h2>%s</h2>\n<p>%s</p>\n<img alt="%s" src="%s">' % (escaped(title), escaped(caption), escaped(title), uri)


def verdict_table(checks):
    """HTML table of checks. Failed checks are highlighted."""
    rows = [(MARKS[check.ok], check.name, check.figure, check.rule, "" if check.ok else check.remedy)
            for check in checks]
    marked = [i for i, check in enumerate(checks) if check.ok is False]
    head = ["", "what", "found", "should be", "what to do"]
    if not any(row[-1] for row in rows):  # omit the last column if it is empty
        head, rows = head[:-1], [row[:-1] for row in rows]
    return table(head, rows, marked)


def page(title, summary, failed, sections):
    """Whole HTML page. sections: HTML that is already escaped."""
    return "\n".join(
        ["<!DOCTYPE html>", '<html lang="en"><head><meta charset="utf-8"><title>%s</title>' % escaped(title),
         "<style>%s</style></head><body>" % STYLE, "<h1>%s</h1>" % escaped(title),
         '<p class="summary%s">%s</p>' % (" failed" if failed else "", escaped(summary))]
        + sections + ["</body></html>", ""])
