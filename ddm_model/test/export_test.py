#!/usr/bin/python3
# export: the README's lines of NumPy compute what the C++ model does.
# SPDX-License-Identifier: BSD-3-Clause
import errno
import os
import re
import resource
import sys

import matplotlib.image
import numpy as np
import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import toy_robot  # noqa: E402

README = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "README.md")


def readme_functions(npz):
    """The names that the README's Python block defines, for this file."""
    with open(README) as stream:
        block = re.search(r"```python\n(.*?)```", stream.read(), re.DOTALL).group(1)
    names = {}
    exec(block.replace('"model.npz"', repr(npz)), names)  # pylint: disable=exec-used
    return names


def features_in(table):
    """[2 x rows]"""
    return np.array([table["z_1"], table["z_2"]])


class ExportTest(toy_robot.ToyRobotCase):
    def setUp(self):
        super().setUp()
        self.bag, self.npz = self.file("trial.bag"), self.file("model.npz")
        self.images, self.torques = toy_robot.write_bag(self.bag, num_frames=40)

    def export(self, model):
        code, output = toy_robot.call("export", "--model", model, "--out", self.npz)
        self.assertEqual(code, 0, output)
        return readme_functions(self.npz)

    def assertComputesTheSame(self, model_options, training_options=""):
        model = toy_robot.train(self.scratch, [self.bag], model_options, training_options)
        ours = self.export(model)
        code, output = toy_robot.call("inspect", "--model", model, "--out", self.scratch, "--steps", 4, self.bag)
        self.assertEqual(code, 0, output)
        truth = features_in(toy_robot.read_table(self.file("features.csv")))
        features = ours["encode"](self.images.reshape(len(self.images), -1).T)
        np.testing.assert_allclose(features, truth, rtol=0.0, atol=1e-5)
        self.assertGreater(np.ptp(truth), 0.05)  # or anything would do
        self.assertPredicts(ours, truth)
        self.assertDecodes(ours, truth, model)

    def assertPredicts(self, ours, truth):
        rows = toy_robot.read_table(self.file("predicted_features.csv"))
        self.assertEqual(len(rows["frame"]), 2 * 5)
        n, delay = int(ours["model"]["order"]), int(ours["model"]["delay"])
        for kind in ("typical", "worst"):
            predicted = rows[rows["kind"] == kind]
            frame = predicted["frame"][0]
            Z = [truth[:, [frame - lag]] for lag in range(n)]
            for k in range(4):
                U = [self.torques[frame + k - lag].reshape(1, 1) for lag in range(n + delay)]
                Z = [ours["predict"](Z, U)] + Z[:-1]
                np.testing.assert_allclose(Z[0][:, 0], features_in(predicted)[:, k + 1], rtol=0.0, atol=1e-5)

    def assertDecodes(self, ours, truth, model):
        with open(self.file("features.txt"), "w") as stream:
            stream.write("z_1,z_2\n" + "".join("%.17g,%.17g\n" % tuple(z) for z in truth[:, :5].T))
        command = "%s %s --frames %s < %s" % (
            toy_robot.find_program("decode_features"), model, self.scratch, self.file("features.txt"))
        self.assertEqual(os.system(command), 0)
        decoded = 255.0 * np.clip(ours["decode"](truth[:, :5]), 0.0, 1.0)
        for i in range(5):
            picture = 255.0 * matplotlib.image.imread(self.file("frame_%04d.png" % i)).reshape(-1)
            # The program rounds to a grey value: half of one, and what single precision does to 255.
            np.testing.assert_allclose(decoded[:, i], picture, rtol=0.0, atol=0.5 + 255e-5)
            self.assertGreater(np.ptp(picture), 20)

    def test_the_readme_encodes_decodes_and_predicts_as_the_model_does(self):
        self.assertComputesTheSame("")

    def test_so_it_does_with_blur_changes_increments_and_a_longer_past(self):
        self.assertComputesTheSame(", blur: 1.5, residual: true, increments: true, order: 3, predictor_widths: [5, 3]")

    def test_so_it_does_where_images_are_late(self):
        self.assertComputesTheSame(", increments: true, delay: 1")

    def test_the_goal_and_its_feature_are_exported(self):
        arrays = self.export(toy_robot.train(self.scratch, [self.bag]))["model"]
        np.testing.assert_array_equal(arrays["goal"], toy_robot.picture(3.0).reshape(-1))
        ours = readme_functions(self.npz)
        np.testing.assert_allclose(ours["encode"](arrays["goal"][:, None])[:, 0], arrays["goal_feature"], atol=1e-5)

    def test_a_file_that_is_no_model_is_named_and_nothing_is_written(self):
        code, output = toy_robot.call("export", "--model", self.bag, "--out", self.npz)
        self.assertEqual(code, 1)
        self.assertIn("model %s: " % self.bag, output)
        self.assertIn("DDMMODEL", output)
        self.assertFalse(os.path.exists(self.npz))

    def test_a_file_that_cannot_be_completed_is_named_and_nothing_of_it_is_left(self):
        model = toy_robot.train(self.scratch, [self.bag])
        self.export(model)
        size = os.path.getsize(self.npz)
        os.remove(self.npz)
        before = os.listdir(self.scratch)
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        self.addCleanup(resource.setrlimit, resource.RLIMIT_FSIZE, limits)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size - 1, limits[1]))  # larger than each of the arrays in it
        code, output = toy_robot.call("export", "--model", model, "--out", self.npz)
        self.assertEqual(code, 1)
        self.assertRegex(output, "^export: .*%s: %s\n$" % (re.escape(self.npz), os.strerror(errno.EFBIG)))
        self.assertEqual(os.listdir(self.scratch), before)

    def test_a_pipe_is_not_replaced(self):
        model = toy_robot.train(self.scratch, [self.bag])
        os.mkfifo(self.npz)
        code, output = toy_robot.call("export", "--model", model, "--out", self.npz)
        self.assertEqual(code, 1)
        self.assertRegex(output, "^export: .*%s: .*regular file\n$" % re.escape(self.npz))


if __name__ == "__main__":
    rosunit.unitrun("ddm_model", "export_test", ExportTest)
