# Lets the tests of this folder import the Python packages of study and qa, which are not installed.
# SPDX-License-Identifier: BSD-3-Clause
import rooms  # noqa: F401: the Python packages that are not installed
