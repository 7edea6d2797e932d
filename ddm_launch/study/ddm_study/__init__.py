# What produces the committed results, from command lines and run folders. Not installed.
# SPDX-License-Identifier: BSD-3-Clause
