# Makes the Python packages that are not installed (study and qa) importable.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys

PACKAGE = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
CHECKOUT = os.path.dirname(PACKAGE)
PRESETS = os.path.join(PACKAGE, "config", "presets")

sys.path += [os.path.join(PACKAGE, "study"), os.path.join(PACKAGE, "qa")]
