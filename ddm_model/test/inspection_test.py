# inspect as a user calls it: model and bags in, a report and its numbers out.
# SPDX-License-Identifier: BSD-3-Clause
import base64
import errno
import html.parser
import io
import os
import resource
import types

import matplotlib.image
import numpy as np
import pandas
import pytest
import rosbag
import yaml

import toy_robot
from ddm_model import report_figures
from ddm_model.model import load
from ddm_model.model_data import ModelData

WITH_BAGS = ["Principal components", "Pairs of image and torque", "Reconstructions", "A prediction: typical",
             "A prediction: worst", "Error by step", "Feature plane", "Coverage"]


class Page(html.parser.HTMLParser):
    """What a browser makes of a report."""

    def __init__(self, folder):
        super().__init__()
        self.tags, self.images, self.text = [], {}, ""
        with open(os.path.join(folder, "report.html"), encoding="utf-8") as stream:
            self.feed(stream.read())

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.tags.append(tag)
        if tag == "img":
            self.images[attrs["alt"]] = attrs["src"]
        else:
            assert not {"href", "src"} & set(attrs)

    def handle_data(self, data):
        self.text += data

    def image(self, title):
        data = self.images[title].split("data:image/png;base64,")[1]
        return matplotlib.image.imread(io.BytesIO(base64.b64decode(data)), format="png")


class Made:
    """A model of two bags, and the report of what it makes of a third."""

    def __init__(self, folder):
        bags = [str(folder / name) for name in ("first.bag", "second.bag", "unseen.bag")]
        for seed, bag in enumerate(bags):
            toy_robot.write_bag(bag, num_frames=200, seed=seed + 1)
        self.unseen, self.report = bags[2], str(folder / "report")
        self.model = toy_robot.train(folder, bags[:2], ", predictor: gp",
                                     ", num_starts: 4, prediction_steps: 4")
        self.code, self.words = toy_robot.call("inspect", "--model", self.model, "--out", self.report, "--steps", 6, self.unseen)


@pytest.fixture(name="made", scope="module")
def make(tmp_path_factory):
    return Made(tmp_path_factory.mktemp("made"))


@pytest.fixture(name="inspect")
def make_inspect(made, tmp_path):
    """A function that returns page, {check: ok} and output of a report."""
    def inspect(*arguments, model=made.model):
        out = str(tmp_path / "report")
        code, output = toy_robot.call("inspect", "--model", model, "--out", out, *arguments)
        assert code == 0, output
        return Page(out), read_verdict(out), output
    return inspect


def read_verdict(report):
    with open(os.path.join(report, "verdict.yaml")) as stream:
        return {check["name"]: check["ok"] for check in yaml.safe_load(stream)}


def assert_refused(out, words, *arguments, code=1):
    done, output = toy_robot.call("inspect", "--out", out, *arguments)
    assert done == code and all(word in output for word in words), output
    assert not os.path.exists(os.path.join(out, "report.html"))


def test_a_good_model_passes_on_a_bag_that_it_has_not_seen_and_the_numbers_are_there(made):
    assert made.code == 0, made.words
    assert [name for name, ok in read_verdict(made.report).items() if not ok] == [], made.words
    page = Page(made.report)
    assert "14 checks passed" in page.text and "what to do" not in page.text
    assert list(page.images) == WITH_BAGS
    assert all(np.ptp(page.image(title)[..., :3]) > 0.5 for title in WITH_BAGS)
    errors, frames, spectrum = (pandas.read_csv(os.path.join(made.report, name))
                                for name in ("prediction_errors.csv", "features.csv", "spectrum.csv"))
    assert list(errors.steps) == [1, 2, 3, 4, 5, 6] and errors.num_predictions[0] == 200 - 1 - 6
    assert np.all(errors.rmse < errors.rmse_repeat) and np.all(errors.rmse < errors.rmse_mean_torque)
    assert len(frames.z_1) == 200 and np.all(frames.pca_rms <= frames.mean_rms)
    kept = 1.0 - np.sum(frames.pca_rms ** 2) / np.sum(frames.mean_rms ** 2)
    assert np.sum(spectrum.share) == pytest.approx(kept, abs=1e-4)


def test_names_cannot_break_the_page_and_another_camera_is_brought_to_the_size_of_the_model(inspect, tmp_path):
    bag = str(tmp_path / "<script>alert('\"&'),.bag")
    toy_robot.write_bag(bag, num_frames=80, seed=3, size=48, channels=3)
    page, verdict, output = inspect(bag)
    assert bag in page.text and "script" not in page.tags and "48x48 rgb8" in page.text
    assert verdict["Enough components, for such images"], output


def test_a_motor_that_hardly_moves_is_found_under_whatever_name_of_its_topics(made, inspect, tmp_path):
    bag, names = str(tmp_path / "lazy.bag"), tmp_path / "names.yaml"
    toy_robot.write_bag(bag, num_frames=80, image_topic="eye", torque=lambda u: 0.05 * u)
    assert_refused(str(tmp_path / "report"), ["no topic camera/image_raw", "eye"], "--model", made.model, bag)
    names.write_text("data_set: {image_topic: eye}\n")
    page, verdict, output = inspect("--config", names, bag)
    assert inspect("--image-topic", "eye", bag)[0].text == page.text
    assert "what to do" in page.text and "Record trials" in page.text
    assert not verdict["Torques are excited"] and "FAILED     Torques are excited" in output


def test_bags_are_read_as_those_of_the_model_were(inspect, tmp_path):
    bag, options = str(tmp_path / "a.bag"), ["--image-topic", "eye", "--crop", "0,0,16,16"]
    toy_robot.write_bag(bag, num_frames=80, image_topic="eye", size=24)
    model = toy_robot.train(tmp_path, [bag], more=options)
    page = inspect(bag, model=model)[0]
    assert inspect(*options, bag, model=model)[0].text == page.text
    assert inspect("--crop", "0,0,24,24", bag, model=model)[0].text != page.text


def test_bags_of_trials_and_all_torques_and_features_are_shown():
    torques, features = np.zeros((5, 2)), np.zeros((5, 8))
    data = types.SimpleNamespace(torques=torques, features=features, max_torque=[1.0, 2.0], unpaired={},
                                 bags={"bag": ["run/trial_000/trial.bag", "run/trial_001/trial.bag"]},
                                 frames={"bag": np.arange(5) % 2, "time_s": np.arange(5)})
    labels = [axes.get_xlabel() for axes in report_figures.draw_coverage(data).axes]
    assert len(labels) == 10 and "torque $u_{2}$ [N m]" in labels
    names = [label.get_text() for label in report_figures.draw_pairing(data).axes[0].get_yticklabels()]
    assert names == ["trial_000/trial.bag", "trial_001/trial.bag"]


def test_a_model_alone_tells_what_it_is_and_a_bag_too_short_to_predict_is_drawn_as_far_as_it_goes(inspect, made, tmp_path):
    page, _, _ = inspect()
    assert list(page.images) == ["Principal components", "Feature plane"]
    assert "400" in page.text and "No bag" in page.text
    assert not os.path.exists(str(tmp_path / "report" / "bags.csv"))
    toy_robot.write_bag(str(tmp_path / "short.bag"), num_frames=2)
    model = toy_robot.train(tmp_path, [made.unseen], ", feature_dim: 1")
    page, verdict, _ = inspect(tmp_path / "short.bag", model=model)
    assert list(page.images) == ["Principal components", "Pairs of image and torque", "Reconstructions", "Coverage"]
    assert verdict["Predictions beat repeating the last frame"] is None


def test_what_could_not_be_paired_is_known_with_its_bag_and_time(made, tmp_path):
    images, torques = toy_robot.write_bag(str(tmp_path / "whole.bag"), num_frames=20)
    with rosbag.Bag(str(tmp_path / "whole.bag")) as whole, rosbag.Bag(str(tmp_path / "gaps.bag"), "w") as gaps:
        for topic, message, time in whole.read_messages():
            if (topic, round((time.to_sec() - 10.0) / 0.2)) not in (("torque", 5), ("camera/image_raw", 9)):
                gaps.write(topic, message, time)
    data = ModelData(load(made.model), [made.unseen, str(tmp_path / "gaps.bag")])
    np.testing.assert_allclose(data.unpaired["images without torque"], [[1.0], [1.0]], atol=1e-6)  # bag 1, after 1 s
    np.testing.assert_allclose(data.unpaired["torques without image"], [[1.0], [1.8]], atol=1e-6)
    paired = [k for k in range(20) if k not in (5, 9)]
    np.testing.assert_array_equal(data.images[200:], images[paired])
    np.testing.assert_array_equal(data.torques[200:, 0], torques[paired])
    np.testing.assert_array_equal(data.frames["segment"][200:], np.repeat([1, 2, 3], [5, 3, 10]))


def test_what_cannot_be_read_or_is_of_another_robot_is_named(made, tmp_path):
    out, model, two, pipe = str(tmp_path / "report"), ["--model", made.model], str(tmp_path / "two.bag"), str(tmp_path / "pipe.ddm")
    with rosbag.Bag(made.unseen) as bag, rosbag.Bag(two, "w") as of_two:
        for topic, message, time in bag.read_messages():
            if topic == "torque":
                message.torque = [0.0, 1.0]
            of_two.write(topic, message, time)
    os.mkfifo(pipe)
    assert_refused(out, ["inspect: bag %s: has 2 torque(s) a frame, the model has 1" % two], *model, made.unseen, two)
    assert_refused(out, ["missing.bag"], *model, made.unseen, tmp_path / "missing.bag")
    assert_refused(out, [made.unseen, "DDMMODEL"], "--model", made.unseen)
    assert_refused(out, ["missing.ddm"], "--model", tmp_path / "missing.ddm")
    assert_refused(out, ["pipe.ddm", "regular file"], "--model", pipe)
    assert_refused(out, ["--steps", "[1, 1000]", "got 0"], *model, "--steps", 0, code=2)


def test_what_cannot_be_written_is_named_and_there_is_no_report(made, tmp_path):
    blocked, small = str(tmp_path / "blocked"), str(tmp_path / "small")
    os.makedirs(os.path.join(blocked, "verdict.yaml"))
    assert_refused(blocked, ["inspect: ", os.path.join(blocked, "verdict.yaml"), "regular file"], "--model", made.model)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50000, limits[1]))  # as on a full disk
    try:
        assert_refused(small, [os.path.join(small, "report.html"), os.strerror(errno.EFBIG)], "--model", made.model)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert sorted(os.listdir(small)) == ["model.yaml", "verdict.yaml"]
