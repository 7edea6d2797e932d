# The fault table: real experiments, one fault in each, and what is left of them.
# SPDX-License-Identifier: BSD-3-Clause
