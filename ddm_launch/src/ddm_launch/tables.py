# CSV files: reading with checks that name file and column, and writing.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import io
import math
import os

import numpy as np

from ddm_launch.command import Failure
from ddm_model.plain_file import write_file


def unreadable(path, error, remedy=None):
    """The exception to raise for a file that cannot be read at all."""
    reason = getattr(error, "strerror", None) or error
    return Failure("%s cannot be read (%s): %s" % (path, reason, remedy or "is its folder a run folder?"))


def convert(text, kind):
    if kind not in (float, int):
        return kind(text)
    if not math.isfinite(float(text)):
        raise ValueError
    return kind(float(text))


def optional(kind):
    """A kind of column whose cells may be empty: None."""
    return lambda text: convert(text, kind) if (text or "").strip() else None


def read_csv(path, columns, remedy=None, once=()):
    """The rows of a CSV file as dictionaries.

    columns: those that must be there; as {name: kind} their cells are converted by kind: str, int, float (finite) or a
    function of the text that raises ValueError. remedy: what to do if the file is missing, unless it is a run's.
    once: columns whose cells name a row. Raises Failure if the file is missing,
    lacks a column, has no row, names a row twice, or if a cell cannot be converted.
    """
    try:
        with open(path, newline="") as stream:
            reader = csv.DictReader(stream)
            header = reader.fieldnames or []
            rows = list(reader)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise unreadable(path, error, remedy)
    missing = [column for column in columns if column not in header]
    if missing:
        raise Failure("%s has no column %s, only: %s" % (path, ", ".join(missing), ", ".join(header)))
    if not rows:
        raise Failure("%s has no row yet: %s" % (path, remedy or "wait for the first trial"))
    seen = set()
    for row in rows:
        for name, kind in columns.items() if isinstance(columns, dict) else ():
            try:
                row[name] = convert(row[name], kind)
            except (TypeError, ValueError):
                raise Failure("%s: column %s must hold numbers, got '%s'" % (path, name, row[name])) from None
        named = tuple(row[column] for column in once)
        if once and named in seen:
            raise Failure("%s has two rows of %s: give each once" % (path, ", ".join(
                "%s %s" % item for item in zip(once, named))))
        seen.add(named)
    return rows


def read_columns(path, names):
    """Numbers of these columns  [rows x names]. Raises Failure as read_csv() does."""
    return np.array([[row[name] for name in names] for row in read_csv(path, dict.fromkeys(names, float))])


def motors_of(path):
    """Names of the motors' columns of a torques.csv: step, motors, exploratory."""
    with open(path) as stream:
        return stream.readline().strip().split(",")[1:-1]


def write_csv(path, header, rows):
    """Floats get six digits. The file appears only when it is complete."""
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([["%.6g" % cell if isinstance(cell, float) else cell for cell in row] for row in rows])
    write_file(path, text.getvalue())
