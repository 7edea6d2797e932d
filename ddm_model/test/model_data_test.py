# Errors of images and of predictions, by hand.
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from ddm_model import model_data
from ddm_model.model_data import image_errors, predicted_features, prediction_errors, prediction_starts

NUM_IMAGES, SIZE = 40, 4
NUM_PIXELS = SIZE * SIZE


class SumModel:
    """A feature is the one before it and the torque; an image has one pixel, y = z / 10."""

    options = {"order": 3}
    arrays = {"image_size": 1, "brightness": 0.0, "blur": np.eye(1)}

    @staticmethod
    def roll_out(features, torques):
        return features[:, -1:] + np.cumsum(torques[:, 2:], axis=1)

    @staticmethod
    def decode(features):
        return features[:, :, None] / 10.0


@pytest.mark.parametrize("block_bytes", [1 << 23, 7 * 8 * NUM_PIXELS])  # all images at a time, and blocks of them
def test_errors_of_images_are_those_of_each_image_and_shares_of_components_make_up_the_whole(block_bytes, monkeypatch):
    monkeypatch.setattr(model_data, "BLOCK_BYTES", block_bytes)
    random = np.random.RandomState(1)
    images, reconstructions = random.randint(0, 256, (2, NUM_IMAGES, NUM_PIXELS)).astype(np.uint8)
    y = images / 255.0
    basis = np.linalg.svd(y - y.mean(axis=0))[2][:3].T.astype(np.float32)
    arrays = {"image_size": SIZE, "brightness": 0.0, "blur": np.eye(SIZE), "pca_mean": y.mean(axis=0).astype(np.float32), "pca_basis": basis}
    errors = image_errors(arrays, images, reconstructions)
    for rms, other in ((errors.reconstruction_rms, reconstructions / 255.0), (errors.mean_rms, arrays["pca_mean"])):
        np.testing.assert_allclose(rms, np.sqrt(np.mean((y - other) ** 2, axis=1)), rtol=1e-12)
    lost = np.sum(errors.pca_rms ** 2) / np.sum(errors.mean_rms ** 2)
    assert lost > 1e-4 and np.sum(errors.share) + lost == pytest.approx(1.0, abs=1e-5)
    images[::2], images[1::2] = 51, 102  # 0.1 to either side of 0.3
    arrays["blur"] = np.zeros((SIZE, SIZE))  # the variation is compared with the noise of a camera, which is not blurred
    assert image_errors(arrays, images, reconstructions).variation == pytest.approx(0.1)


def test_predictions_start_where_no_gap_is_near_and_are_evenly_thinned_out(monkeypatch):
    assert prediction_starts(np.array([6, 5]), 2, 3).tolist() == [1, 2, 7]
    assert prediction_starts(np.array([6, 5]), 2, 5).tolist() == []
    monkeypatch.setattr(model_data, "MAX_STARTS", 3)
    assert prediction_starts(np.array([9]), 2, 1).tolist() == [1, 3, 5]
    assert prediction_starts(np.array([4]), 2, 1).tolist() == [1, 2]


def test_predictions_are_told_of_the_torques_that_followed_or_of_one():
    torques, features = np.arange(10.0)[:, None], 0.5 * np.arange(10.0)[:, None]
    paths = predicted_features(SumModel, features, torques, np.array([3, 5]), 2)
    np.testing.assert_array_equal(paths[..., 0], [[1.5, 4.5, 8.5], [2.5, 7.5, 13.5]])
    blind = predicted_features(SumModel, features, torques, np.array([3]), 2, told=[1.0])
    np.testing.assert_array_equal(blind[..., 0], [[1.5, 2.5, 3.5]])
    assert torques[3] == 3.0  # ours are as they were


@pytest.mark.parametrize("block_bytes", [1 << 23, 8])
def test_errors_of_predictions_are_the_root_mean_square_over_all_predictions_and_pixels(block_bytes, monkeypatch):
    monkeypatch.setattr(model_data, "BLOCK_BYTES", block_bytes)
    images, starts = np.array([0, 51, 102, 255], dtype=np.uint8)[:, None, None], np.array([0, 1])
    predicted, blind = np.full((2, 3, 1), 2.0), np.full((2, 3, 1), 20.0)  # y = 0.2, y = 2 that is seen as 1
    errors = prediction_errors(SumModel, images, starts, predicted, blind)
    np.testing.assert_allclose(errors ** 2 * 2.0, [
        [0.0 + 0.2 ** 2, 0.2 ** 2 + 0.8 ** 2], [0.2 ** 2 + 0.2 ** 2, 0.4 ** 2 + 0.8 ** 2],
        [0.8 ** 2 + 0.6 ** 2, 0.6 ** 2 + 0.0]], atol=1e-12)
