#!/usr/bin/python3
# Errors of images and of predictions, by hand.
# SPDX-License-Identifier: BSD-3-Clause
import unittest
import unittest.mock

import numpy as np
import rosunit

from ddm_model.model_data import image_errors, predicted_features, prediction_errors, prediction_starts

NUM_IMAGES, SIZE = 40, 4
NUM_PIXELS = SIZE * SIZE


class SumModel:
    """A feature is the one before it and the torque; an image has one pixel, y = z / 10."""

    options = {"order": 2, "delay": 1}
    arrays = {"image_size": 1, "blur": np.eye(1)}

    @staticmethod
    def roll_out(features, torques):
        return features[:, -1:] + np.cumsum(torques[:, 2:], axis=1)

    @staticmethod
    def decode(features):
        return features[:, :, None] / 10.0


class ModelDataTest(unittest.TestCase):
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

    def test_variation_is_that_of_the_images_around_their_own_mean(self):
        self.images[:] = self.images[0]
        self.assertAlmostEqual(self.errors().variation, 0.0, places=12)
        self.images[::2], self.images[1::2] = 51, 102  # 0.1 to either side of 0.3
        self.assertAlmostEqual(self.errors().variation, 0.1, places=12)
        self.model["blur"] = np.zeros((SIZE, SIZE))  # it is compared with the noise of a camera, which is not blurred
        self.assertAlmostEqual(self.errors().variation, 0.1, places=12)

    def test_a_block_of_images_at_a_time_gives_the_same(self):
        whole, block = self.errors(), "ddm_model.model_data.BLOCK_BYTES"
        with unittest.mock.patch(block, 7 * 8 * NUM_PIXELS):
            for name, values in self.errors()._asdict().items():
                np.testing.assert_allclose(values, getattr(whole, name), rtol=1e-12, err_msg=name)

    def test_they_start_where_no_gap_is_near_and_are_evenly_thinned_out(self):
        self.assertEqual(prediction_starts(np.array([6, 5]), 2, 3).tolist(), [1, 2, 7])
        self.assertEqual(prediction_starts(np.array([6, 5]), 2, 5).tolist(), [])
        with unittest.mock.patch("ddm_model.model_data.MAX_STARTS", 3):
            self.assertEqual(prediction_starts(np.array([9]), 2, 1).tolist(), [1, 3, 5])
            self.assertEqual(prediction_starts(np.array([4]), 2, 1).tolist(), [1, 2])

    def test_they_are_told_of_the_torques_that_followed_or_of_one(self):
        torques, features = np.arange(10.0)[:, None], 0.5 * np.arange(10.0)[:, None]
        paths = predicted_features(SumModel, features, torques, np.array([3, 5]), 2)
        np.testing.assert_array_equal(paths[..., 0], [[1.5, 4.5, 8.5], [2.5, 7.5, 13.5]])
        blind = predicted_features(SumModel, features, torques, np.array([3]), 2, told=[1.0])
        np.testing.assert_array_equal(blind[..., 0], [[1.5, 2.5, 3.5]])
        self.assertEqual(torques[3], 3.0)  # ours are as they were

    def test_errors_are_the_root_mean_square_over_all_predictions_and_pixels(self):
        images, starts = np.array([0, 51, 102, 255], dtype=np.uint8)[:, None, None], np.array([0, 1])
        predicted, blind = np.full((2, 3, 1), 2.0), np.full((2, 3, 1), 20.0)  # y = 0.2, y = 2 that is seen as 1
        for block in (1 << 23, 8):
            with unittest.mock.patch("ddm_model.model_data.BLOCK_BYTES", block):
                errors = prediction_errors(SumModel, images, starts, predicted, blind)
            np.testing.assert_allclose(errors ** 2 * 2.0, [
                [0.0 + 0.2 ** 2, 0.2 ** 2 + 0.8 ** 2], [0.2 ** 2 + 0.2 ** 2, 0.4 ** 2 + 0.8 ** 2],
                [0.8 ** 2 + 0.6 ** 2, 0.6 ** 2 + 0.0]], atol=1e-12)

if __name__ == "__main__":
    rosunit.unitrun("ddm_model", "model_data_test", ModelDataTest)
