# What attacks and times the code. Not installed.
# SPDX-License-Identifier: BSD-3-Clause
