# export: writes the arrays of a model file into a NumPy file.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import io
import os
import sys

import numpy as np

from ddm_model.model import load
from ddm_model.plain_file import write_file


def export(model, out):
    """Writes the arrays of a model file to a .npz file and returns them. The .npz file gets its name when it is
    complete.

    Raises OSError if one of the files cannot be read or written.
    """
    arrays = load(model).arrays
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    write_file(out, stream.getvalue())
    return arrays


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="export",
        description="Writes a model's PCA, all weights and biases, options and goal as NumPy arrays, for those without "
        "this package. With it, ddm_model.load() of Python encodes, decodes and predicts.")
    path = os.path.expanduser  # a shell does not expand --out=~/x
    parser.add_argument("--model", metavar="FILE", type=path, required=True, help="model file")
    parser.add_argument("--out", metavar="FILE.npz", type=path, required=True, help="file to write")
    options = parser.parse_args(arguments)
    try:
        arrays = export(options.model, options.out)
    except OSError as error:
        print("export: %s" % error, file=sys.stderr)
        return 1
    print("wrote %s with %d arrays" % (options.out, len(arrays)))
    return 0
