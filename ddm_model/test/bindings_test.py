# The C++ model and the NumPy reader agree, and a saved model is the same file.
# SPDX-License-Identifier: BSD-3-Clause
import re

import numpy as np
import pytest

import ddm_model
import toy_robot

try:
    Model = ddm_model.Model
except ImportError:
    pytest.skip("the Python bindings are not built", allow_module_level=True)


@pytest.mark.parametrize("options", [
    "", ", normalise_brightness: true, blur: 1.5, order: 3, predictor_widths: [5, 3]", ", predictor: gp, order: 3"])
def test_the_model_of_c_plus_plus_and_that_of_numpy_agree(tmp_path, options):
    bag = str(tmp_path / "a.bag")
    images, torques = toy_robot.write_bag(bag)
    path, torques = toy_robot.train(tmp_path, [bag], model_options=options), torques.reshape(-1, 1)
    model, plain = Model.load(path), ddm_model.load(path)
    model.save(tmp_path / "again.ddm")
    with open(path, "rb") as stream:
        assert (tmp_path / "again.ddm").read_bytes() == stream.read()
    assert model.info == plain.info
    assert (model.image_size, model.torque_dim) == (plain.image_size, plain.torque_dim)
    features = plain.encode(images)
    assert np.ptp(features) > 0.05  # or anything would do
    np.testing.assert_allclose(model.encode(images), features, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(model.encode(np.repeat(images[..., None], 3, axis=3)), features, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(model.goal_feature, plain.goal_feature, rtol=0.0, atol=1e-9)
    grey = np.clip(255.0 * plain.decode(features[:5]), 0.0, 255.0)
    assert np.max(np.abs(model.decode(features[:5]) - grey)) < 0.51
    n = plain.options["order"]
    np.testing.assert_allclose(model.predict(features[:n], torques[:n]), plain.predict(features[:n], torques[:n]), rtol=0.0, atol=1e-9)
    future = model.roll_out(features[:n], torques[:n + 9])
    assert future.shape == (10, plain.options["feature_dim"])
    np.testing.assert_allclose(future, plain.roll_out(features[:n], torques[:n + 9]), rtol=0.0, atol=1e-9)


def test_a_damaged_model_is_refused_as_by_the_numpy_reader(tmp_path):
    (tmp_path / "text.ddm").write_text("no model")
    for load in (Model.load, ddm_model.load):
        with pytest.raises(ddm_model.ModelFileError, match="^model %s: " % re.escape(str(tmp_path / "text.ddm"))):
            load(str(tmp_path / "text.ddm"))


def test_the_file_of_a_plant_that_is_missing_is_named():
    with pytest.raises(OSError, match="/missing.yaml"):
        ddm_model.train([], None, plant="/missing.yaml")
