# Python side of the model: a model in NumPy, and what it makes of bags, in pictures and words.
# SPDX-License-Identifier: BSD-3-Clause
import importlib


def __getattr__(name):
    """load(), Model, ModelFileError: NumPy is read by those who use them, not by every program that writes a file."""
    if name in ("Model", "ModelFileError", "load"):
        return getattr(importlib.import_module("ddm_model.model"), name)
    raise AttributeError("module ddm_model has no '%s': it has load, Model and ModelFileError" % name)
