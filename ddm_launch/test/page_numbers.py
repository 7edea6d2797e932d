# Numbers on pages, compared with the committed tables as page_numbers.yaml describes it.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os
import re

import numpy
import pandas
import yaml

import pages

RESULTS = "ddm_launch/results/"
NUMBER = r"[−+-]?(?:\d{1,3}(?:,\d{3})+|\d+)(?:\.\d+)?"
CELL = re.compile(r"(?:`[^`]*`|[^|`\n])+")
NOT_SHOWN = re.compile(r"`[^`\n]*`|\]\([^)\n]*\)")  # code, and targets of links
FUNCTIONS = {"count": len, "sum": numpy.sum, "mean": numpy.mean, "median": numpy.median, "min": numpy.min, "max": numpy.max,
             "share": numpy.mean, "std_error": lambda values: numpy.std(values, ddof=1) / len(values) ** 0.5}
Row = collections.namedtuple("Row", "heading head line start")


def leaves(tree, prefix=""):
    for name, value in tree.items():
        yield from leaves(value, prefix + name + "_") if isinstance(value, dict) else [(prefix + name, value)]


def read_rows(name):
    """The rows of a CSV in results/; a YAML file is a single row, with names such as latency_ms_median."""
    path = os.path.join(pages.CHECKOUT, RESULTS, name)
    if not name.endswith(".yaml"):
        return pandas.read_csv(path)
    with open(path) as stream:
        return pandas.DataFrame([dict(leaves(yaml.safe_load(stream)))])


def compute(expression, rows):
    """The number that an expression makes of the columns; `rows` is the table itself, for names that Python reserves."""
    names = dict(FUNCTIONS, table=read_rows, rows=rows, **{str(column): rows[column] for column in rows})
    result = eval(expression, names)
    if isinstance(result, pandas.Series):
        if len(result) != 1:
            raise ValueError("%d rows instead of one" % len(result))
        result = result.iloc[0]
    return float(result)


def agree(printed, computed):
    """Whether these are the printed digits of the number computed."""
    digits = len(printed.partition(".")[2])
    return abs(float(printed.replace("−", "-").replace(",", "")) - computed) <= 0.5000001 * 10.0 ** -digits


def parse(template):
    """(pattern, expressions) of a text with expressions in braces. Line breaks on the page count as spaces."""
    parts = re.split(r"\{([^{}]*)\}", template)
    texts = [r"\s+".join(re.escape(word) for word in re.split(r"\s+", part)) for part in parts[::2]]
    return ("(%s)" % NUMBER).join(texts), parts[1::2]


def table_rows(text):
    """Each row of each table, without heads, under the heading that the table is below."""
    heading, head, start = "", None, 0
    for line in text.splitlines(True):
        if not line.startswith("|"):
            heading, head = line.strip("# \n") if line.startswith("#") else heading, None
        elif head is None:
            head = line
        elif not re.match(r"\|[\s:|-]+\|\s*$", line):
            yield Row(heading, head, line, start)
        start += len(line)


class Page:
    """The claims about a page, checked one by one: what is wrong, and which part of the page they cover."""

    def __init__(self, name, text, entry):
        self.name, self.text = name, pages.without_blocks(text)
        self.rows = list(table_rows(self.text))
        self.without_csv = entry.get("without_csv", {})
        self.problems, self.covered, self.compared = [], [], 0
        for csv, claims in entry.items():
            for claim in claims if csv != "without_csv" else []:
                self.check(csv, claim if isinstance(claim, dict) else {"text": claim})

    def check(self, csv, claim):
        try:
            rows = read_rows(csv)
            rows = rows.query(claim["where"], engine="python") if "where" in claim else rows
            rows = rows.set_index(claim["index"]) if "index" in claim else rows
            (self.check_table if "table" in claim else self.check_text)(claim, rows)
        except (ArithmeticError, AttributeError, LookupError, NameError, OSError, SyntaxError, TypeError, ValueError) as error:
            self.fail(claim, "%s: %s" % (csv, error))

    def fail(self, claim, problem):
        self.problems.append("%s: claim '%s': %s" % (self.name, claim.get("text") or claim.get("table"), problem))

    def check_text(self, claim, rows):
        pattern, expressions = parse(claim["text"])
        found = list(re.finditer(pattern, self.text))
        if len(found) != 1:
            self.fail(claim, "is on the page %d times instead of once" % len(found))
        for match in found:
            self.covered.append(match.span())
            self.compare(claim, match, expressions, rows)

    def compare(self, claim, match, expressions, rows, place="the page"):
        for printed, expression in zip(match.groups(), expressions):
            computed = compute(expression, rows)
            self.compared += 1
            if not agree(printed, computed):
                self.fail(claim, "%s prints %s, %s is %.6g" % (place, printed, expression, computed))

    def check_table(self, claim, rows):
        table = [row for row in self.rows if claim["table"] == row.heading or row.head.startswith(claim["table"])]
        if len({row.head for row in table}) != 1:
            self.fail(claim, "is not the heading or first row of one table")
        for row in table:
            if not self.excused(row):
                self.check_row(claim, row, rows)

    def check_row(self, claim, row, rows):
        def picked(column, label):  # the rows that a label on the page names
            label = str(claim.get("words", {}).get(label.strip(), label.strip()))
            label = label.replace(",", "") if re.fullmatch(NUMBER, label) else label
            few = rows[rows[column].astype(str) == label]
            if few.empty:
                raise ValueError("no row has '%s' in column %s" % (label, column))
            return few

        heads, cells, keys = CELL.findall(row.head), list(CELL.finditer(row.line)), claim["keys"]
        for column, cell in zip(keys, cells):
            if column:
                rows = picked(column, cell.group())
                self.covered.append((row.start + cell.start(), row.start + cell.end()))
        templates = claim["cells"] if isinstance(claim["cells"], list) else [claim["cells"]] * (len(cells) - len(keys))
        if len(keys) + len(templates) != len(cells):
            raise ValueError("%d cells in a row instead of %d" % (len(cells), len(keys) + len(templates)))
        for template, cell, head in zip(templates, cells[len(keys):], heads[len(keys):]):
            if template is not None and re.search(r"\d", cell.group()):
                pattern, expressions = parse(template)
                bare = parse(template.partition(" ±")[0])[0]  # an error may be left out
                match = re.fullmatch(pattern, cell.group().strip()) or re.fullmatch(bare, cell.group().strip())
                if not match:
                    raise ValueError("a cell is '%s' instead of '%s'" % (cell.group().strip(), template))
                self.compare(claim, match, expressions, picked(claim["across"], head) if "across" in claim else rows,
                             "'%s'" % row.line.strip())
                self.covered.append((row.start + cell.start(), row.start + cell.end()))

    def excused(self, row):
        return any(row.heading == name or row.head.startswith(name) or row.line.startswith(name) for name in self.without_csv)

    def uncovered(self):
        """Rows with a number outside all claims, and entries of without_csv that are not on the page."""
        excuses = {name: [match.span() for match in re.finditer(parse(name)[0], self.text)] for name in self.without_csv}
        shown = list(self.text)
        for start, end in self.covered + sum(excuses.values(), [match.span() for match in NOT_SHOWN.finditer(self.text)]):
            shown[start:end] = " " * (end - start)
        return ["%s: no claim has all numbers of '%s'" % (self.name, row.line.strip()) for row in self.rows
                if not self.excused(row) and re.search(r"(?<!\w)\d", "".join(shown[row.start:row.start + len(row.line)]))
                ] + ["%s: without_csv: '%s' is not on the page" % (self.name, name) for name in excuses if not excuses[name]]


def checked_pages():
    with open(os.path.join(pages.CHECKOUT, "ddm_launch/test/page_numbers.yaml"), encoding="utf-8") as stream:
        return [Page(name, pages.read(name), entry or {}) for name, entry in yaml.safe_load(stream).items()]
