# record.launch, train_from_bags and control.launch: a model is trained from bags and controls the plant.
# SPDX-License-Identifier: BSD-3-Clause
import re
import signal

import rosbag

from processes import Process, find_program, output_of, roslaunch, run_experiment
from rooms import PRESETS
from run_files import read_bag, read_bytes, read_rows

STEPS = 30
SHORT = ["preset:=debug", "num_steps:=%d" % STEPS]


def train(out, *bags):
    output = output_of([find_program("train_from_bags", "ddm_model"), "--config", PRESETS + "/debug.yaml", "--out", out, *bags])
    assert "frames: %d" % (len(bags) * STEPS) in output and "goal: yes" in output, output


def assert_is_trial(bag):
    stamps = read_bag(str(bag))
    assert len(stamps["camera/image_raw"]) == STEPS and stamps["camera/image_raw"] == stamps["torque"]
    assert len(stamps["goal_image"]) == 1


def test_bags_become_a_model_that_drives_the_plant_and_explores(master, tmp_path):
    bag, plain, model, explored = (tmp_path / name for name in ("random.bag", "plain.bag", "model.ddm", "explored.bag"))
    # trial_recorder and plain rosbag record at the same time. The master runs before the launch, so that rosbag misses
    # nothing.
    with Process([find_program("record", "rosbag"), "-O", plain, "/camera/image_raw", "/torque", "/goal_image"]) as recorder:
        recorder.waitForText("Subscribing to /goal_image", 120.0)
        output = roslaunch(str(tmp_path), "record.launch", *SHORT, "seed:=1", "bag:=%s" % bag, port=0)
        recorder.send_signal(signal.SIGINT)
        recorder.waitForEnd(120.0)
    assert "recorded: %s" % bag in output
    assert_is_trial(bag)
    run_experiment("--preset", "debug", "--seed", 1, "--trials", 0, "--out", tmp_path / "run")
    with rosbag.Bag(str(bag)) as messages:
        torques = ["%.17g" % message.torque[0] for _, message, _ in messages.read_messages(["torque"])]
    assert torques == [row[1] for row in read_rows(tmp_path, "run", "trial_000", "torques.csv")[1:]]
    train(model, bag)
    train(tmp_path / "plain.ddm", plain)
    assert read_bytes(model) == read_bytes(tmp_path / "plain.ddm")

    output = roslaunch(str(tmp_path), "control.launch", *SHORT, "model:=%s" % model)
    assert re.search(r"final error \d+\.\d+ deg: .*reached", output) and "%d torques" % STEPS in output, output
    # The path of the bag may be relative.
    output = roslaunch(str(tmp_path), "record.launch", *SHORT, "epsilon:=0.5", "bag:=explored.bag", "model:=%s" % model,
                       folder=str(tmp_path))
    assert "recorded: %s" % explored in output
    assert_is_trial(explored)
    train(tmp_path / "both.ddm", bag, explored)


def test_a_bag_that_cannot_be_written_is_named(tmp_path):
    bag = str(tmp_path / "no" / "such" / "folder" / "x.bag")
    output = roslaunch(str(tmp_path), "record.launch", *SHORT, "bag:=" + bag)
    assert re.search("FATAL.*" + bag, output) and "exit code 1" in output, output
