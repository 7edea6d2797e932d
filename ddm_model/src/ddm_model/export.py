# Writes a model as one file of NumPy arrays.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import io
import os
import sys
import tempfile

import numpy as np

from ddm_model.plain_file import write_file
from ddm_model.model_data import ModelDataError, read_arrays, write_model_data


def export(model, out):
    """Writes the arrays of a model file to a .npz file, which appears under its name when it is complete."""
    with tempfile.TemporaryDirectory() as folder:
        write_model_data(model, [], folder)
        arrays = read_arrays(os.path.join(folder, "model"))
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    write_file(out, stream.getvalue())
    return arrays


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="export",
        description="Writes a model's PCA, all weights and biases, options and goal as NumPy arrays. ddm_model's "
        "README has the ten lines that encode, decode and predict with them.")
    parser.add_argument("--model", metavar="FILE", required=True, help="model file")
    parser.add_argument("--out", metavar="FILE.npz", required=True, help="file to write")
    options = parser.parse_args(arguments)
    try:
        arrays = export(options.model, options.out)
    except (ModelDataError, OSError) as error:
        print("export: %s" % error, file=sys.stderr)
        return 1
    print("wrote %s with %d arrays" % (options.out, len(arrays)))
    return 0
