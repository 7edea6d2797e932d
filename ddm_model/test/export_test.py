# A model in Python, as the lines of the README use it; and export, its arrays in a file.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import shutil

import numpy as np
import pytest

import ddm_model
import toy_robot

README = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "README.md")


class Made:
    """A bag, its images and torques, and the path of a model of it."""

    def __init__(self, folder, model_options=""):
        self.bag = str(folder / "trial.bag")
        self.images, self.torques = toy_robot.write_bag(self.bag, num_frames=40)
        self.model = toy_robot.train(folder, [self.bag], model_options)


@pytest.fixture(name="made", scope="module")
def make(tmp_path_factory):
    return Made(tmp_path_factory.mktemp("made"))


def test_the_readme_reads_a_model_and_uses_it(made):
    with open(README) as stream:
        block = re.search(r"```python\n(.*?)```", stream.read(), re.DOTALL).group(1)
    names = dict(images=made.images, torques=made.torques[:, None])
    exec(block.replace('"robot.model"', repr(made.model)), names)
    np.testing.assert_array_equal(names["z"], ddm_model.load(made.model).encode(made.images))
    assert np.sqrt(np.mean((names["y"] - made.images / 255.0) ** 2)) < 0.15
    assert names["future"].shape == (16, 2) and np.ptp(names["future"]) > 0.0
    np.testing.assert_array_equal(names["future"][0], names["z_next"])


def test_images_features_and_torques_of_another_shape_are_refused(made):
    model = ddm_model.load(made.model)
    with pytest.raises(ValueError, match="12 x 12 pixels, got an array .*40, 11, 12"):
        model.encode(made.images[:, 1:])
    with pytest.raises(ValueError, match="last 2 features and 2 torques .* got 3 and 2"):
        model.predict(np.zeros((3, 2)), np.zeros((2, 1)))


def test_a_damaged_model_is_named(made, tmp_path):
    with open(made.model, "rb") as stream:
        data = stream.read()
    path = tmp_path / "model.ddm"
    for damage, word in ((data[:-1], "damaged"), (data[:5], "is not a DDM model"), (data[:12], "cut short"),
                         (data[:-9] + b"x" + data[-8:], "damaged"), (data[:8] + b"\x63" + data[9:], "format version 99")):
        path.write_bytes(damage)
        with pytest.raises(ddm_model.ModelFileError, match="model %s: .*%s" % (re.escape(str(path)), word)):
            ddm_model.load(str(path))


def test_paths_in_the_home_folder_are_expanded_after_an_equals_sign(made, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    shutil.copy(made.model, str(tmp_path / "m.ddm"))
    for name, out, written in (("export", "m.npz", "m.npz"), ("inspect", "report", "report/report.html")):
        code, output = toy_robot.call(name, "--model=~/m.ddm", "--out=~/" + out)
        assert code == 0 and (tmp_path / written).exists(), output


def test_all_arrays_are_exported_with_the_goal_and_its_feature(made, tmp_path):
    out = str(tmp_path / "model.npz")
    code, output = toy_robot.call("export", "--model", made.bag, "--out", out)
    assert code == 1 and "model %s: " % made.bag in output and "DDMMODEL" in output
    assert not os.path.exists(out)
    code, output = toy_robot.call("export", "--model", made.model, "--out", out)
    assert code == 0, output
    arrays, model = dict(np.load(out)), ddm_model.load(made.model)
    np.testing.assert_array_equal(arrays["goal"], toy_robot.image(3.0).reshape(-1))
    np.testing.assert_array_equal(arrays["goal_feature"], model.goal_feature)
    assert set(arrays) == set(model.arrays)
