# What pytest needs before it reads the tests of this folder.
# SPDX-License-Identifier: BSD-3-Clause
import rooms  # noqa: F401: the Python packages that are not installed
