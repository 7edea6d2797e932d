# Python side of the experiments: reading run folders and drawing figures from them.
# SPDX-License-Identifier: BSD-3-Clause
