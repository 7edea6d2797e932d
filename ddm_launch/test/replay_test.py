# replay.launch: mpc_node plans on the images of a bag, and no motor can move.
# SPDX-License-Identifier: BSD-3-Clause
import os
import threading

from ddm_msgs.msg import Torque
import pytest
import rosbag
import rosgraph
import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import Float64

from processes import find_program, output_of, run_experiment, start_roslaunch
from rooms import PRESETS
from run_files import read_rows

STEPS = 30


@pytest.fixture(name="trial", scope="module")
def make_trial(master, tmp_path_factory):
    """Returns (bag, model) of a trial."""
    run = str(tmp_path_factory.mktemp("trial") / "run")
    run_experiment("--preset", "debug", "--seed", 1, "--trials", 0, "--out", run)
    return [os.path.join(run, "trial_000", name) for name in ("trial.bag", "model.ddm")]


def replay(folder, *arguments):
    """Returns the output of replay.launch, and the publishers of all topics while its nodes ran."""
    publishers = {}
    with start_roslaunch(str(folder), "replay.launch", "preset:=debug", *arguments, port=0) as launch:
        while launch.isRunning() and not any("mpc_node" in nodes for nodes in publishers.get("/plan", [])):
            publishers = dict(rosgraph.Master("/test").getSystemState()[0])
        launch.waitForEnd(120.0)
    return launch.output, publishers


def test_proposals_come_for_each_frame_and_nothing_where_motors_listen(trial, tmp_path):
    heard, lock, out = {}, threading.Lock(), str(tmp_path / "torques.csv")

    def hear(message, topic):
        with lock:
            heard.setdefault(topic, []).append(message)

    for topic, kind in (("torque", Torque), ("effort_command", Float64), ("replay/torque", Torque),
                        ("replay/proposed_torque", Torque)):
        rospy.Subscriber(topic, kind, hear, topic)
    output, publishers = replay(tmp_path, "bag:=" + trial[0], "model:=" + trial[1], "out:=" + out, "rate:=20")
    assert "%d frames replayed" % STEPS in output
    assert "/mpc_node" in publishers["/replay/proposed_torque"]
    assert not {"/torque", "/effort_command"} & set(publishers)
    with lock:
        assert sorted(heard) == ["replay/proposed_torque", "replay/torque"]
        proposed, recorded = ({message.header.stamp: message.torque[0] for message in heard["replay/" + name]}
                              for name in ("proposed_torque", "torque"))
    header, *rows = read_rows(out)
    assert header == ["frame", "segment", "time_s", "recorded_1", "proposed_1"]
    assert [row[3] for row in rows] == [row[1] for row in read_rows(os.path.dirname(trial[0]), "torques.csv")[1:]]
    told = {float(row[4]) for row in rows}
    assert set(recorded) & set(proposed) and set(proposed.values()) <= told and len(told) > STEPS // 2


def test_the_zero_of_a_last_image_that_is_refused_is_no_proposal(trial, tmp_path):
    bag, out = str(tmp_path / "one.bag"), str(tmp_path / "torques.csv")
    with rosbag.Bag(trial[0]) as whole, rosbag.Bag(bag, "w") as one:
        for wanted in ("camera/image_raw", "torque"):  # messages of the first image, which is also the last one here
            one.write(*next(whole.read_messages([wanted])))
    camera = rospy.Publisher("camera/image_raw", Image, queue_size=1)  # mpc_node refuses images of two publishers
    output, _ = replay(tmp_path, "bag:=" + bag, "model:=" + trial[1], "out:=" + out)
    camera.unregister()
    assert "FATAL" in output and "only one node may publish images" in output
    assert not os.path.exists(out)


def test_time_that_does_not_come_a_bag_of_another_robot_and_a_file_that_cannot_be_written_are_named(trial, tmp_path):
    rospy.set_param("/use_sim_time", True)
    output_of([find_program("experiment_node"), "replay", "_replay/bag:=" + trial[0], "_replay/model:=" + trial[1],
               "_replay/timeout:=0.5"], code=1, words=("0.5 s", "nobody", "/clock"))
    rospy.delete_param("/use_sim_time")
    model = str(tmp_path / "small.ddm")
    output_of([find_program("train_from_bags", "ddm_model"), "--config", PRESETS + "/debug.yaml", "--set",
               "image/size=20", "--out", model, trial[0]])
    output, _ = replay(tmp_path, "bag:=" + trial[0], "model:=" + model)
    assert "FATAL" in output and "image/size 51" in output
    output_of([find_program("experiment_node"), "replay", "_replay/bag:=missing.bag", "_replay/model:=missing.ddm",
               "_replay/out:=/no_folder/torques.csv"], code=1, words=("cannot write /no_folder/torques.csv", "No such file"))
