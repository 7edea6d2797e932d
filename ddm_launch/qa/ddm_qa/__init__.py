# Fault injection, soak tests and benchmarks. This package is not installed.
# SPDX-License-Identifier: BSD-3-Clause
