#!/usr/bin/python3
# The figures of a report, in numbers.
# SPDX-License-Identifier: BSD-3-Clause
import types
import unittest

import numpy as np
import rosunit

from ddm_model import report_figures

SIZE = 4
NUM_PIXELS = SIZE * SIZE


class ReportFiguresTest(unittest.TestCase):
    def test_what_the_components_keep_is_shown_of_images_as_the_model_sees_them(self):
        blur = np.full((SIZE, SIZE), 1.0 / SIZE)  # each pixel is the mean of all
        arrays = {"image_size": SIZE, "blur": blur, "pca_mean": np.zeros(NUM_PIXELS), "pca_basis": np.eye(NUM_PIXELS)}
        images = np.tile([0, 102], NUM_PIXELS // 2).reshape(1, SIZE, SIZE).astype(np.uint8)
        data = types.SimpleNamespace(model=types.SimpleNamespace(arrays=arrays), images=images, reconstructions=images)
        figure = report_figures.draw_reconstructions(data)
        self.addCleanup(report_figures.plt.close, figure)
        shown = {axes.get_ylabel(): axes.images[0].get_array() for axes in figure.axes}
        np.testing.assert_allclose(shown["PCA"], 51.0)
        np.testing.assert_array_equal(shown["image"], images[0])


if __name__ == "__main__":
    rosunit.unitrun("ddm_model", "report_figures_test", ReportFiguresTest)
