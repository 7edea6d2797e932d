#!/usr/bin/python3
# inspect as a user calls it: model and bags in, a report and its numbers out.
# SPDX-License-Identifier: BSD-3-Clause
import base64
import errno
import html.parser
import io
import os
import resource
import sys

import matplotlib.image
import numpy as np
import rosbag
import rosunit
import yaml

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import toy_robot  # noqa: E402
from ddm_model.model import load  # noqa: E402
from ddm_model.model_data import ModelData  # noqa: E402

WITH_BAGS = ["Principal components", "Pairs of image and torque", "Reconstructions", "A prediction: typical",
             "A prediction: worst", "Error by step", "Feature plane", "Coverage"]


class Page(html.parser.HTMLParser):
    """What a browser makes of a report."""

    def __init__(self, path):
        super().__init__()
        self.tags, self.images, self.links, self.text = [], {}, [], ""
        with open(path, encoding="utf-8") as stream:
            self.feed(stream.read())

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.tags.append(tag)
        if tag == "img":
            self.images[attrs["alt"]] = attrs["src"]
        self.links += [attrs[name] for name in ("href", "src") if name in attrs]

    def handle_data(self, data):
        self.text += data

    def picture(self, title):
        data = self.images[title].split("base64,")[1]
        return matplotlib.image.imread(io.BytesIO(base64.b64decode(data)), format="png")


class InspectionTest(toy_robot.ToyRobotCase):
    @classmethod
    def setUpClass(cls):
        """A model of two bags, and the report of what it makes of a third."""
        cls.class_scratch = toy_robot.new_folder(cls.addClassCleanup)
        bags = [os.path.join(cls.class_scratch, name) for name in ("first.bag", "second.bag", "unseen.bag")]
        for seed, bag in enumerate(bags):
            toy_robot.write_bag(bag, num_frames=200, seed=seed + 1)
        cls.unseen, cls.report = bags[2], os.path.join(cls.class_scratch, "report")
        cls.model = toy_robot.train(cls.class_scratch, bags[:2], ", residual: true, increments: true",
                                    ", num_starts: 4, selection_steps: 4, prediction_steps: 4")
        cls.code, cls.words = toy_robot.call("inspect", "--model", cls.model, "--out", cls.report, "--steps", 6,
                                             cls.unseen)

    def setUp(self):
        super().setUp()
        self.out = self.file("report")

    def inspect(self, *arguments):
        code, self.output = toy_robot.call("inspect", "--model", self.model, "--out", self.out, *arguments)
        self.assertEqual(code, 0, self.output)
        return Page(os.path.join(self.out, "report.html"))

    @staticmethod
    def verdict(report):
        with open(os.path.join(report, "verdict.yaml")) as stream:
            return {check["name"]: check["ok"] for check in yaml.safe_load(stream)}

    def assertRefused(self, words, *arguments, code=1):
        done, output = toy_robot.call("inspect", "--out", self.out, *arguments)
        self.assertEqual(done, code, output)
        for word in words:
            self.assertIn(word, output)
        self.assertFalse(os.path.exists(os.path.join(self.out, "report.html")))

    def test_a_good_model_passes_on_a_bag_that_it_has_not_seen(self):
        self.assertEqual(self.code, 0, self.words)
        self.assertEqual([name for name, ok in self.verdict(self.report).items() if not ok], [], self.words)
        page = Page(os.path.join(self.report, "report.html"))
        self.assertRegex(page.text, r"\b14\b[^.]* passed")
        self.assertNotIn("what to do", page.text)
        self.assertEqual(list(page.images), WITH_BAGS)
        for title in WITH_BAGS:
            self.assertGreater(np.ptp(page.picture(title)[..., :3]), 0.5, title)

    def test_the_numbers_behind_it_are_there(self):
        errors = toy_robot.read_table(os.path.join(self.report, "prediction_errors.csv"))
        self.assertEqual(list(errors["steps"]), [1, 2, 3, 4, 5, 6])
        self.assertEqual(errors["num_predictions"][0], 200 - 1 - 6)
        self.assertTrue(np.all(errors["rmse"] < errors["rmse_repeat"]))
        self.assertTrue(np.all(errors["rmse"] < errors["rmse_mean_torque"]))
        frames = toy_robot.read_table(os.path.join(self.report, "features.csv"))
        self.assertEqual(len(frames["z_1"]), 200)
        self.assertTrue(np.all(frames["pca_rms"] <= frames["mean_rms"]))
        share = toy_robot.read_table(os.path.join(self.report, "spectrum.csv"))["share"]
        kept = 1.0 - np.sum(frames["pca_rms"] ** 2) / np.sum(frames["mean_rms"] ** 2)
        self.assertAlmostEqual(np.sum(share), kept, places=4)

    def test_names_cannot_break_the_page_and_another_camera_is_brought_to_the_size_of_the_model(self):
        bag = self.file("<script>alert('\"&'),.bag")
        toy_robot.write_bag(bag, num_frames=80, seed=3, size=48, channels=3)
        page = self.inspect(bag)
        self.assertIn(bag, page.text)
        self.assertNotIn("script", page.tags)
        self.assertIn("48x48 rgb8", page.text)
        self.assertTrue(self.verdict(self.out)["Enough components, for such images"], self.output)

    def test_a_motor_that_hardly_moves_is_found_under_whatever_name_of_its_topics(self):
        toy_robot.write_bag(self.file("lazy.bag"), num_frames=80, image_topic="eye", torque=lambda u: 0.05 * u)
        self.assertRefused(["no topic camera/image_raw", "eye"], "--model", self.model, self.file("lazy.bag"))
        with open(self.file("names.yaml"), "w") as stream:
            stream.write("data_set: {image_topic: eye}\n")
        page = self.inspect("--config", self.file("names.yaml"), self.file("lazy.bag"))
        self.assertEqual(self.inspect("--image-topic", "eye", self.file("lazy.bag")).text, page.text)
        self.assertIn("what to do", page.text)
        self.assertIn("Record trials", page.text)
        self.assertFalse(self.verdict(self.out)["Torques are excited"])
        self.assertRegex(self.output, r"FAILED +Torques are excited")

    def test_a_model_alone_tells_what_it_is(self):
        page = self.inspect()
        self.assertEqual(list(page.images), ["Principal components", "Feature plane"])
        self.assertRegex(page.text, r"frames\s*400")
        self.assertIn("No bag", page.text)
        self.assertFalse(os.path.exists(os.path.join(self.out, "bags.csv")))

    def test_a_single_feature_and_a_bag_too_short_to_predict_are_drawn_as_far_as_they_go(self):
        toy_robot.write_bag(self.file("short.bag"), num_frames=2)
        model = toy_robot.train(self.scratch, [self.unseen], ", feature_dim: 1")
        code, output = toy_robot.call("inspect", "--model", model, "--out", self.out, self.file("short.bag"))
        self.assertEqual(code, 0, output)
        self.assertEqual(list(Page(os.path.join(self.out, "report.html")).images),
                         ["Principal components", "Pairs of image and torque", "Reconstructions", "Feature plane",
                          "Coverage"])
        self.assertIsNone(self.verdict(self.out)["Predictions beat repeating the last frame"])

    def test_what_could_not_be_paired_is_known_with_its_bag_and_time(self):
        images, torques = toy_robot.write_bag(self.file("whole.bag"), num_frames=20)
        with rosbag.Bag(self.file("whole.bag")) as whole, rosbag.Bag(self.file("gaps.bag"), "w") as gaps:
            for topic, message, time in whole.read_messages():
                frame = round((time.to_sec() - 10.0) / 0.2)
                if (topic, frame) not in (("torque", 5), ("camera/image_raw", 9)):
                    gaps.write(topic, message, time)
        data = ModelData(load(self.model), [self.unseen, self.file("gaps.bag")])
        np.testing.assert_allclose(data.unpaired["images without torque"], [[1.0], [1.0]], atol=1e-6)  # bag 1, after 1 s
        np.testing.assert_allclose(data.unpaired["torques without image"], [[1.0], [1.8]], atol=1e-6)
        paired = [k for k in range(20) if k not in (5, 9)]
        np.testing.assert_array_equal(data.images[200:], images[paired])
        np.testing.assert_array_equal(data.torques[200:, 0], torques[paired])
        np.testing.assert_array_equal(data.frames["segment"][200:], np.repeat([1, 2, 3], [5, 3, 10]))

    def test_a_bag_of_another_robot_is_named(self):
        with rosbag.Bag(self.unseen) as bag, rosbag.Bag(self.file("two.bag"), "w") as two:
            for topic, message, time in bag.read_messages():
                if topic == "torque":
                    message.torque = [0.0, 1.0]
                two.write(topic, message, time)
        self.assertRefused(["inspect: bag %s: has 2 torque(s) a frame, the model has 1" % self.file("two.bag")],
                           "--model", self.model, self.unseen, self.file("two.bag"))

    def test_what_cannot_be_read_is_named(self):
        self.assertRefused(["missing.bag"], "--model", self.model, self.unseen, self.file("missing.bag"))
        self.assertRefused([self.unseen, "DDMMODEL"], "--model", self.unseen)
        self.assertRefused(["missing.ddm"], "--model", self.file("missing.ddm"))
        os.mkfifo(self.file("pipe.ddm"))
        self.assertRefused(["pipe.ddm", "regular file"], "--model", self.file("pipe.ddm"))
        self.assertRefused(["--steps", "[1, 1000]", "got 0"], "--model", self.model, "--steps", 0, code=2)

    def test_what_cannot_be_written_is_named_and_there_is_no_report(self):
        os.makedirs(os.path.join(self.out, "verdict.yaml"))
        self.assertRefused(["inspect: ", os.path.join(self.out, "verdict.yaml"), "regular file"],
                           "--model", self.model)
        self.out = self.file("small")
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        self.addCleanup(resource.setrlimit, resource.RLIMIT_FSIZE, limits)
        resource.setrlimit(resource.RLIMIT_FSIZE, (50000, limits[1]))
        self.assertRefused(["inspect: ", os.path.join(self.out, "report.html"), os.strerror(errno.EFBIG)],
                           "--model", self.model)
        self.assertEqual(sorted(os.listdir(self.out)), ["model.yaml", "verdict.yaml"])


if __name__ == "__main__":
    rosunit.unitrun("ddm_model", "inspection_test", InspectionTest)
