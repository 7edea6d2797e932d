#!/usr/bin/python3
# A model in Python: it computes what the C++ model does, as the README's lines ask it to; and export, its arrays in a file.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import struct
import subprocess
import sys
import zlib

import numpy as np
import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import ddm_model  # noqa: E402
import toy_robot  # noqa: E402

FRAME, STEPS = 20, 15  # of a prediction
TOLERANCE = 1e-9
README = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "README.md")


def readme_names(model, images, torques):
    """What the README's Python block computes of this model file, these images and torques."""
    with open(README) as stream:
        block = re.search(r"```python\n(.*?)```", stream.read(), re.DOTALL).group(1)
    names = dict(images=images, torques=torques)
    exec(block.replace('"robot.model"', repr(model)), names)  # pylint: disable=exec-used
    return names


class ExportTest(toy_robot.ToyRobotCase):
    def setUp(self):
        super().setUp()
        self.bag, self.npz = self.file("trial.bag"), self.file("model.npz")
        self.images, self.torques = toy_robot.write_bag(self.bag, num_frames=40)

    def export(self, model):
        code, output = toy_robot.call("export", "--model", model, "--out", self.npz)
        self.assertEqual(code, 0, output)
        return dict(np.load(self.npz))

    def assertComputesTheSame(self, model_options, training_options=""):
        path = toy_robot.train(self.scratch, [self.bag], model_options, training_options)
        model = ddm_model.load(path)
        lines = subprocess.check_output([toy_robot.find_program("model_test_numbers"), path, self.bag, str(FRAME), str(STEPS)])
        lines = lines.splitlines()
        truth, predicted, decoded = (np.loadtxt(part) for part in (
            lines[:len(self.images)], lines[len(self.images):-STEPS - 1], lines[-STEPS - 1:]))
        np.testing.assert_allclose(model.encode(self.images), truth, rtol=0.0, atol=TOLERANCE)
        self.assertGreater(np.ptp(truth), 0.05)  # or anything would do
        n, delay = model.options["order"], model.options["delay"]
        ahead = model.roll_out(model.encode(self.images)[FRAME - n + 1:FRAME + 1],
                               self.torques[FRAME - n + 1 - delay:FRAME + STEPS, None])
        np.testing.assert_allclose(ahead, predicted[1:], rtol=0.0, atol=TOLERANCE)
        # C++ rounds to a grey value: half of one, and what single precision does to 255.
        images = 255.0 * np.clip(model.decode(predicted), 0.0, 1.0).reshape(decoded.shape)
        np.testing.assert_allclose(images, decoded, rtol=0.0, atol=0.5 + 255e-5)
        self.assertGreater(np.ptp(decoded), 20)

    def test_it_encodes_decodes_and_predicts_as_the_model_does(self):
        self.assertComputesTheSame("")

    def test_so_it_does_with_every_option_of_the_model(self):
        self.assertComputesTheSame(", blur: 1.5, residual: true, increments: true, order: 3, delay: 1, predictor_widths: [5, 3]")

    def test_the_readme_reads_a_model_and_uses_it(self):
        path = toy_robot.train(self.scratch, [self.bag])
        names, model = readme_names(path, self.images, self.torques[:, None]), ddm_model.load(path)
        np.testing.assert_array_equal(names["z"], model.encode(self.images))
        self.assertLess(np.sqrt(np.mean((names["y"] - self.images / 255.0) ** 2)), 0.15)
        self.assertEqual(names["future"].shape, (16, 2))
        np.testing.assert_array_equal(names["future"][0], names["z_next"])
        self.assertGreater(np.ptp(names["future"]), 0.0)

    def test_images_of_another_size_are_refused(self):
        model = ddm_model.load(toy_robot.train(self.scratch, [self.bag]))
        with self.assertRaisesRegex(ValueError, "12 x 12 pixels, got an array .*40, 11, 12"):
            model.encode(self.images[:, 1:])

    def test_features_and_torques_that_do_not_fit_the_past_are_refused(self):
        model = ddm_model.load(toy_robot.train(self.scratch, [self.bag], ", order: 3, delay: 1"))
        with self.assertRaisesRegex(ValueError, "last 3 features and 4 torques .* got 3 and 3"):
            model.predict(np.zeros((3, 2)), np.zeros((3, 1)))

    def test_a_damaged_model_is_named(self):
        path = toy_robot.train(self.scratch, [self.bag])
        with open(path, "rb") as stream:
            data = stream.read()
        for damage, word in ((data[:-1], "damaged"), (data[:5], "is not a DDM model"), (data[:12], "cut short"),
                             (data[:-9] + b"x" + data[-8:], "damaged"),
                             (data[:8] + b"\x63" + data[9:], "format version 99")):
            with open(path, "wb") as stream:
                stream.write(damage)
            with self.assertRaisesRegex(ddm_model.ModelFileError, "model %s: .*%s" % (re.escape(path), word)):
                ddm_model.load(path)

    def test_a_model_with_a_number_that_is_not_finite_is_named(self):
        path = toy_robot.train(self.scratch, [self.bag])
        mean = ddm_model.load(path).arrays["pca_mean"].tobytes()
        with open(path, "rb") as stream:
            content = stream.read()[len("DDMMODEL") + struct.calcsize("<IQI"):]
        content = content.replace(mean, struct.pack("<f", np.nan) + mean[4:])
        with open(path, "wb") as stream:
            stream.write(b"DDMMODEL" + struct.pack("<IQI", 5, len(content), zlib.crc32(content)) + content)
        with self.assertRaisesRegex(ddm_model.ModelFileError, "pca_mean must be finite"):
            ddm_model.load(path)

    def test_the_goal_and_its_feature_are_exported(self):
        path = toy_robot.train(self.scratch, [self.bag])
        arrays, model = self.export(path), ddm_model.load(path)
        np.testing.assert_array_equal(arrays["goal"], toy_robot.picture(3.0).reshape(-1))
        np.testing.assert_array_equal(arrays["goal_feature"], model.goal_feature)
        self.assertEqual(set(arrays), set(model.arrays))

    def test_a_file_that_is_no_model_is_named_and_nothing_is_written(self):
        code, output = toy_robot.call("export", "--model", self.bag, "--out", self.npz)
        self.assertEqual(code, 1)
        self.assertIn("model %s: " % self.bag, output)
        self.assertIn("DDMMODEL", output)
        self.assertFalse(os.path.exists(self.npz))

if __name__ == "__main__":
    rosunit.unitrun("ddm_model", "export_test", ExportTest)
