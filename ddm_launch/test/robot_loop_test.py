# Complete experiments on a simulated robot: stopped and resumed robot_check.launch, and the rehearsal of the tutorial.
# SPDX-License-Identifier: BSD-3-Clause
import os
import time

import rosbag
import rosgraph
import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import Float64, Header
from std_srvs.srv import SetBool, Trigger

from processes import roslaunch, start_roslaunch
from run_files import files_in, read_bag, read_bytes, read_rows, read_yaml

STEPS, DT = 30, 0.1
LIMIT_S = 120.0


def wait_for_success(service, kind, *arguments):
    """Calls a service until it succeeds, because the robot needs all of its peers before."""
    deadline = time.monotonic() + LIMIT_S
    while not rospy.ServiceProxy(service, kind)(*arguments).success:
        assert time.monotonic() < deadline, service
        time.sleep(0.1)


def test_an_experiment_on_a_robot_is_stopped_and_resumed_with_another_crop(master, tmp_path):
    """The user tunes crop and goal_distance until the first trial is finished, as the tutorial describes."""
    out = str(tmp_path / "out")
    arguments = ["robot_check.launch", "preset:=debug", "trials:=0", "dt:=%g" % DT, "load:=false", "runs:=" + out]
    with start_roslaunch(str(tmp_path), *arguments, "crop:=10,10,180,180", "goal_distance:=0.5", port=0) as launch:
        launch.waitForText("motors follow", LIMIT_S)
        assert rospy.ServiceProxy("enable", SetBool)(False).success
        launch.waitForEnd(LIMIT_S)
    assert "cancelled" in launch.output and "resumes" in launch.output
    assert "summary.yaml" not in files_in(out)
    output = roslaunch(str(tmp_path), *arguments, limit_s=LIMIT_S)
    assert files_in(out) == sorted(
        [".trials.crc32", "config.yaml", "robot_check.yaml", "summary.yaml", "trials.csv", "evaluation_000/goal_distance.csv",
         "evaluation_000/torques.csv", "evaluation_000/trial.bag", "trial_000/model.ddm", "trial_000/torques.csv",
         # bag of the stopped trial
         "trial_000/training.yaml", "trial_000/trial.bag", "trial_000/trial.1.bag.active"]), output
    config = read_yaml(out, "config.yaml")
    assert (config["evaluation"]["goal_distance"], config["robot"]["crop"][0]) == (0.3, 5)
    bag = os.path.join(out, "trial_000", "trial.bag")
    stamps = read_bag(bag)
    assert set(stamps["torque"]) <= set(stamps["camera/image_raw"]) and len(stamps["goal_image"]) == 1
    assert STEPS // 2 <= len(stamps["torque"]) <= STEPS  # all torques are in time on an idle machine
    steps = sorted(1e-9 * (after - before) for before, after in zip(stamps["torque"], stamps["torque"][1:]))
    assert abs(steps[len(steps) // 2] - DT) < 0.3 * DT
    with rosbag.Bag(bag) as messages:
        image = next(message for _, message, _ in messages.read_messages(["camera/image_raw"]))
    assert (image.width, image.height, image.encoding) == (51, 51, "mono8")
    assert len(read_rows(out, "evaluation_000", "goal_distance.csv")) == 1 + STEPS
    row = read_rows(out, "trials.csv")[1]
    assert row[3] in ("0", "1") and row[5] == ""  # success is known without ground truth
    check = read_yaml(out, "robot_check.yaml")
    assert check["frames"] == 2 * STEPS and [row["trial"] for row in check["evaluations"]] == [0]
    assert check["latency_ms"]["median"] < 1e3 * DT and check["deadline_misses"] < STEPS

    rows = read_bytes(out, "trials.csv")
    output = roslaunch(str(tmp_path), *arguments, "crop:=10,10,180,180", limit_s=LIMIT_S)
    assert "robot/crop: [5, 5, 190, 190] there, [10, 10, 180, 180] here" in output and "first trial" in output
    assert read_bytes(out, "trials.csv") == rows


def test_a_rehearsal_runs_to_its_end_with_a_listener_in_the_place_of_the_motor(master, tmp_path):
    """Runs the rehearsal of the tutorial with enabled motors, and replays the recorded bag."""
    out, config = str(tmp_path / "out"), tmp_path / "my_robot.yaml"
    config.write_text("robot: {max_torque: 2.0, dt: %g}\n" % DT)
    rospy.Subscriber("/rehearsal", Float64, lambda _: None)
    camera = rospy.Publisher("/usb_cam/image_raw", Image, queue_size=1)
    shown = rospy.Timer(rospy.Duration(0.04), lambda _: camera.publish(Image(
        header=Header(stamp=rospy.Time.now()), width=64, height=64, step=64, encoding="mono8", data=os.urandom(64 * 64))))
    with start_roslaunch(str(tmp_path), "robot.launch", "camera:=/usb_cam/image_raw", "effort:=/rehearsal", "preset:=debug",
                         "trials:=0", "config:=%s" % config, "runs:=" + out, port=0) as launch:
        launch.waitForText("call service take_goal", LIMIT_S)
        assert rospy.ServiceProxy("take_goal", Trigger)().success
        wait_for_success("enable", SetBool, True)
        launch.waitForText("reset_done", LIMIT_S)
        assert rospy.ServiceProxy("reset_done", Trigger)().success
        launch.waitForText("motors follow", LIMIT_S)
        publishers, _, _ = rosgraph.Master("/test").getSystemState()
        assert dict(publishers)["/rehearsal"] == ["/robot_node"]
        assert [name for name, _ in publishers if name.endswith("effort_command")] == []
        wait_for_success("reset_done", Trigger)  # reset for the evaluation, after the training
        launch.waitForEnd(LIMIT_S)
    shown.shutdown()
    assert "summary.yaml" in files_in(out), launch.output
    trial = os.path.join(out, "trial_000")
    output = roslaunch(str(tmp_path), "replay.launch", "bag:=" + os.path.join(trial, "trial.bag"), "rate:=0", "preset:=debug",
                       "model:=" + os.path.join(trial, "model.ddm"), "config:=%s" % config, limit_s=LIMIT_S)
    assert "frames replayed" in output
