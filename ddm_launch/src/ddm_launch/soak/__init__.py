# Long experiments of the real nodes: whether memory and open files stay flat, and no frame is lost.
# SPDX-License-Identifier: BSD-3-Clause
