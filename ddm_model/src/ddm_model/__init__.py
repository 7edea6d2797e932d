# Python side of the model: what it makes of bags, in pictures and words, and its arrays for NumPy.
# SPDX-License-Identifier: BSD-3-Clause
