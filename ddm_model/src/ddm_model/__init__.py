# Python interface: training and models, run folders in pandas, and reports of a model on bags.
# SPDX-License-Identifier: BSD-3-Clause
import importlib

# train and Model are bindings of the C++ core. load() reads a model file with NumPy only.
MODULES = {"Model": "learner", "train": "learner", "ModelFileError": "model", "load": "model",
           "Run": "run", "RunFolderError": "run", "read_run": "run"}


def __getattr__(name):
    """Imports NumPy, pandas and the C++ core on first use, because most programs that write a file need none of them."""
    if name in MODULES:
        return getattr(importlib.import_module("ddm_model." + MODULES[name]), name)
    raise AttributeError("module ddm_model has no '%s': it has %s" % (name, ", ".join(MODULES)))


def __dir__():
    return [*globals(), *MODULES]
