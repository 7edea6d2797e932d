#!/usr/bin/python3
# Errors of images, by hand.
# SPDX-License-Identifier: BSD-3-Clause
import unittest
import unittest.mock

import numpy as np
import rosunit

from ddm_model.model_data import image_errors

NUM_IMAGES, SIZE = 40, 4
NUM_PIXELS = SIZE * SIZE


class ImageErrorsTest(unittest.TestCase):
    def setUp(self):
        random = np.random.RandomState(1)
        self.images = random.randint(0, 256, (NUM_IMAGES, NUM_PIXELS)).astype(np.uint8)
        self.reconstructions = random.randint(0, 256, self.images.shape).astype(np.uint8)
        y = self.images / 255.0
        basis = np.linalg.svd(y - y.mean(axis=0))[2][:3].T
        self.model = {"image_size": SIZE, "blur": np.eye(SIZE), "pca_mean": y.mean(axis=0).astype(np.float32),
                      "pca_basis": basis.astype(np.float32)}

    def errors(self):
        return image_errors(self.model, self.images, self.reconstructions)

    def test_those_of_reconstructions_and_of_the_mean_are_those_of_each_image(self):
        errors = self.errors()
        for i in range(NUM_IMAGES):
            difference = (self.images[i].astype(float) - self.reconstructions[i]) / 255.0
            self.assertAlmostEqual(errors.reconstruction_rms[i], np.sqrt(np.mean(difference ** 2)), places=12)
            difference = self.images[i] / 255.0 - self.model["pca_mean"]
            self.assertAlmostEqual(errors.mean_rms[i], np.sqrt(np.mean(difference ** 2)), places=12)

    def test_shares_of_components_and_what_they_lose_make_up_the_whole(self):
        errors = self.errors()
        lost = np.sum(errors.pca_rms ** 2) / np.sum(errors.mean_rms ** 2)
        self.assertAlmostEqual(np.sum(errors.share) + lost, 1.0, places=5)
        self.assertGreater(lost, 1e-4)  # or the sum above says little
        self.assertTrue(np.all(np.diff(errors.share) <= 1e-9))

    def test_images_are_compared_as_the_model_sees_them(self):
        self.model["blur"] = np.full((SIZE, SIZE), 1.0 / SIZE)  # each pixel is the mean of all
        self.images[:], self.reconstructions[:] = np.tile([0, 102], NUM_PIXELS // 2), 51
        np.testing.assert_allclose(self.errors().reconstruction_rms, 0.0, atol=1e-12)

    def test_variation_is_that_of_the_images_around_their_own_mean(self):
        self.images[:] = self.images[0]
        self.assertAlmostEqual(self.errors().variation, 0.0, places=12)
        self.images[::2], self.images[1::2] = 51, 102  # 0.1 to either side of 0.3
        self.assertAlmostEqual(self.errors().variation, 0.1, places=12)

    def test_a_block_of_images_at_a_time_gives_the_same(self):
        whole, block = self.errors(), "ddm_model.model_data.BLOCK_BYTES"
        with unittest.mock.patch(block, 7 * 8 * NUM_PIXELS):
            for name, values in self.errors()._asdict().items():
                np.testing.assert_allclose(values, getattr(whole, name), rtol=1e-12, err_msg=name)


if __name__ == "__main__":
    rosunit.unitrun("ddm_model", "model_data_test", ImageErrorsTest)
