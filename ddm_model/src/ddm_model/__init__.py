# Python interface of the model: model files in NumPy, run folders in pandas, and reports of a model on bags.
# SPDX-License-Identifier: BSD-3-Clause
import importlib

MODULES = {"Model": "model", "ModelFileError": "model", "load": "model",
           "Run": "run", "RunFolderError": "run", "read_run": "run"}


def __getattr__(name):
    """Imports NumPy and pandas on first use, because most programs that write a file need neither."""
    if name in MODULES:
        return getattr(importlib.import_module("ddm_model." + MODULES[name]), name)
    raise AttributeError("module ddm_model has no '%s': it has %s" % (name, ", ".join(MODULES)))
