# Tells catkin where the Python package is; called by CMake, not by hand.
# SPDX-License-Identifier: BSD-3-Clause
from setuptools import setup

from catkin_pkg.python_setup import generate_distutils_setup

setup(**generate_distutils_setup(packages=["ddm_sim"], package_dir={"": "python"}))
