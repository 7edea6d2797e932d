# The C++ model and the NumPy reader agree, and a saved model is the same file.
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import ddm_model
import toy_robot

try:
    Model = ddm_model.Model
except ImportError:
    pytest.skip("the Python bindings are not built", allow_module_level=True)


@pytest.mark.parametrize("options", ["", ", predictor: gp, order: 3"])
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
    np.testing.assert_allclose(model.encode(images), features, atol=1e-6)
    np.testing.assert_allclose(model.encode(np.repeat(images[..., None], 3, axis=3)), features, atol=1e-6)
    np.testing.assert_allclose(model.goal_feature, plain.goal_feature, atol=1e-6)
    grey = np.clip(255.0 * plain.decode(features[:5]), 0.0, 255.0)
    assert np.max(np.abs(model.decode(features[:5]) - grey)) < 0.51
    n = plain.options["order"]
    np.testing.assert_allclose(model.predict(features[:n], torques[:n]), plain.predict(features[:n], torques[:n]), atol=1e-6)
    future = model.rollout(features[:n], torques[:n + 9])
    assert future.shape == (10, plain.options["feature_dim"])
    np.testing.assert_allclose(future, plain.roll_out(features[:n], torques[:n + 9]), atol=1e-6)


def test_a_damaged_model_is_refused_as_by_the_numpy_reader(tmp_path):
    (tmp_path / "text.ddm").write_text("no model")
    for load in (Model.load, ddm_model.load):
        with pytest.raises(ddm_model.ModelFileError, match="text.ddm"):
            load(str(tmp_path / "text.ddm"))
