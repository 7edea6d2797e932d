# Makes the committed results from run folders. This package is not installed.
# SPDX-License-Identifier: BSD-3-Clause
