# The verdict: each rule is broken by the fault that it is for, and by no other.
# SPDX-License-Identifier: BSD-3-Clause
import types

import numpy as np
import pytest

from ddm_model import verdict

FAR_GOAL = (0.0, 1.56)  # of no frame


class GoodData:
    """A model that is good at good bags; what the rules look at, as ModelData has it."""

    def __init__(self, num_frames=400):
        random = np.random.RandomState(1)
        half = num_frames // 2
        self.model = types.SimpleNamespace(info={"frames": 500}, options={"pca_dim": 50, "feature_dim": 2},
                                           support_states=np.zeros((0, 2)), goal_feature=np.array([0.0, 1.0]))
        self.max_torque = np.array([6.0])
        self.variation = 0.1
        angle = np.linspace(0.0, 6.3, num_frames)
        self.features = np.column_stack([np.sin(angle), np.cos(angle)])
        self.torques = random.uniform(-6.0, 6.0, (num_frames, 1))
        self.bags = {"camera": ["51x51 mono8"] * 2, "interval_s": np.full(2, 0.2)}
        self.unpaired = {"images without torque": np.zeros((2, 0))}
        self.frames = {"bag": np.repeat([0.0, 1.0], half), "time_s": np.tile(0.2 * np.arange(half), 2),
                       "mean_rms": np.full(num_frames, 0.1), "pca_rms": np.full(num_frames, 0.02),
                       "reconstruction_rms": np.full(num_frames, 0.04)}
        steps = np.arange(1.0, 16.0)
        self.errors = {"steps": steps, "rmse": 0.03 + 0.005 * steps, "rmse_repeat": np.full(15, 0.1),
                       "rmse_mean_torque": 0.03 + 0.008 * steps}


# Name of a rule, and a function that spoils the data so that they break this rule.
FAULTS = [
    ("Images have their torques", lambda data: data.unpaired.update(
        {"images without torque": np.array([np.zeros(20), np.linspace(1.1, 38.9, 20)])})),
    ("Frames come at one rate", lambda data: data.frames.update(
        time_s=data.frames["time_s"] + 0.1 * (np.arange(len(data.features)) % 4 == 0))),
    ("Frames come at one rate", lambda data: data.bags.update(interval_s=np.array([0.2, 0.1]))),
    ("One camera setting", lambda data: data.bags.update(camera=["51x51 mono8", "640x480 rgb8"])),
    ("Images differ", lambda data: setattr(data, "variation", 0.004)),
    ("Torques are excited", lambda data: setattr(data, "torques", 0.1 * data.torques)),
    ("Torques are within the model's range", lambda data: data.torques.put(3, 8.0)),
    ("Enough frames to learn from", lambda data: data.model.info.update(frames=90)),
    ("Enough components, for such images", lambda data: data.frames.update(pca_rms=data.frames["pca_rms"] + 0.02)),
    ("Features hold the image",
     lambda data: data.frames.update(reconstruction_rms=data.frames["reconstruction_rms"] + 0.02)),
    ("Predictions beat repeating the last frame", lambda data: data.errors.update(
        rmse=0.95 * data.errors["rmse_repeat"], rmse_mean_torque=1.9 * data.errors["rmse_repeat"])),
    ("The model responds to the torque", lambda data: data.errors.update(rmse_mean_torque=1.001 * data.errors["rmse"])),
    ("The goal has been seen", lambda data: setattr(data.model, "goal_feature", np.array(FAR_GOAL))),
    ("The goal has been seen", lambda data: setattr(data.model, "goal_feature", None))]


def check_of(data, name):
    return next(check for check in verdict.verdict(data) if check.name == name)


def failed(data):
    return [check.name for check in verdict.verdict(data) if check.ok is False]


def test_good_bags_and_a_good_model_pass():
    assert failed(GoodData()) == []
    assert verdict.summary(verdict.verdict(GoodData())) == "All 14 checks passed."


@pytest.mark.parametrize("rule, spoil", FAULTS)
def test_each_fault_breaks_its_rule_and_no_other(rule, spoil):
    data = GoodData()
    spoil(data)
    assert failed(data) == [rule]


def test_images_before_the_first_torque_and_after_the_last_are_not_of_the_trial():
    data = GoodData()
    first, last = data.frames["time_s"][0], data.frames["time_s"][-1]
    times = np.concatenate([first - 0.2 * np.arange(1, 1500), last + 0.2 * np.arange(1, 20)])  # five minutes of waiting
    data.unpaired["images without torque"] = np.array([(bag, time) for bag in (0, 1) for time in times]).T
    assert failed(data) == [] and check_of(data, "Images have their torques").figure.startswith("0 of 400 ")


def test_the_goal_may_have_been_seen_in_bags_that_are_not_these():
    for with_bags in (True, False):
        data = GoodData()
        if not with_bags:
            data.bags = data.features = None
        data.model.goal_feature = np.array(FAR_GOAL)
        for seen in (1.5, 0.4):
            data.model.support_states = np.array([[0.0, -1.0], [0.0, seen]])
            assert check_of(data, "The goal has been seen").ok == (seen == 1.5)


def test_what_could_not_be_predicted_is_not_known_and_a_model_alone_is_judged_by_what_it_says_of_itself():
    data = GoodData()
    data.errors = {name: np.zeros(0) for name in data.errors}
    unknown = [check.name for check in verdict.verdict(data) if check.ok is None]
    assert unknown == ["Predictions beat repeating the last frame", "The model responds to the torque"]
    assert failed(data) == [] and "2 of 14 " in verdict.summary(verdict.verdict(data))
    data.bags = data.features = None
    assert len(verdict.verdict(data)) == 2
    data.model.info["frames"] = 90
    assert failed(data) == ["Enough frames to learn from"]
