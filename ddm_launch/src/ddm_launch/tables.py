# Reads and writes CSV files. Error messages name file and column.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import io
import os

import numpy as np
import pandas

from ddm_launch.command import Failure
from ddm_model.plain_file import write_file


def read_table(path, *numbers, remedy="is its folder a run folder?", once=()):
    """Reads a CSV file as a data frame.

    numbers: required columns, whose cells must be finite numbers or empty. once: columns whose combined values identify
    a row.
    Raises Failure with the remedy if the file cannot be read, lacks a column, has no row, has text in place of a
    number, or identifies two rows by the same values.
    """
    try:
        table = pandas.read_csv(path, float_precision="round_trip")
    except (OSError, ValueError) as error:  # pandas raises several kinds of ValueError for invalid contents
        raise Failure("%s cannot be read (%s): %s" % (path, getattr(error, "strerror", None) or error, remedy)) from None
    missing = [name for name in numbers if name not in table]
    if missing:
        raise Failure("%s has no column %s, only: %s" % (path, ", ".join(missing), ", ".join(table)))
    if table.empty:
        raise Failure("%s has no row yet: %s" % (path, remedy))
    for name in numbers:
        values = pandas.to_numeric(table[name], errors="coerce")
        wrong = table[name][table[name].notna() & ~np.isfinite(values)]
        if len(wrong) > 0:
            raise Failure("%s: column %s must hold numbers, got '%s'" % (path, name, wrong.iloc[0]))
    twice = table[table.duplicated(list(once))] if once else ()
    if len(twice) > 0:
        raise Failure("%s has two rows of %s: give each once" % (path, ", ".join("%s %s" % (name, twice[name].iloc[0]) for name in once)))
    return table


def write_csv(path, header, rows):
    """Writes a CSV file with six significant digits for floats. The file appears when it is complete. Raises OSError if
    the file cannot be written."""
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([["%.6g" % cell if isinstance(cell, float) else cell for cell in row] for row in rows])
    write_file(path, text.getvalue())
