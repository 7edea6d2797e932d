# Python side of the model: a model in NumPy, a run folder in pandas, and what a model makes of bags, in pictures and words.
# SPDX-License-Identifier: BSD-3-Clause
import importlib

MODULES = {"Model": "model", "ModelFileError": "model", "load": "model",
           "Run": "run", "RunFolderError": "run", "read_run": "run"}


def __getattr__(name):
    """NumPy and pandas are read by those who use them, not by every program that writes a file."""
    if name in MODULES:
        return getattr(importlib.import_module("ddm_model." + MODULES[name]), name)
    raise AttributeError("module ddm_model has no '%s': it has %s" % (name, ", ".join(MODULES)))
