# Topics for watching an experiment without rviz. Watching does not change the experiment.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import math
import time

from ddm_msgs.msg import PlanScalars
import numpy as np
import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import String
import yaml

from processes import Process, find_program, roslaunch, run_experiment
from run_files import differences, expected_files

FRAMES, RATE = 2 * 30 * 2, 30.0  # so low that starting the other nodes takes less time than these images
TOPICS = {"trials": String, "prediction_image": Image, "feature_space_image": Image, "plan_scalars": PlanScalars}


def test_all_of_a_watched_experiment_is_on_topics_and_watching_changes_nothing(master, tmp_path):
    heard = collections.defaultdict(list)
    for topic, message in TOPICS.items():
        rospy.Subscriber(topic, message, heard[topic].append)
    start = time.monotonic()
    output = roslaunch(str(tmp_path), "experiment.launch", "preset:=debug", "seed:=1", "trials:=1", "view:=true",
                       "frame_rate:=%g" % RATE, "runs:=%s" % (tmp_path / "watched"), port=0, limit_s=110.0)
    assert time.monotonic() - start > FRAMES / RATE
    run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", tmp_path / "alone")
    names = [name for name in expected_files(1) if not name.endswith((".bag", "config.yaml"))]
    assert differences(tmp_path / "alone", tmp_path / "watched", names) == [], output

    tables = [yaml.safe_load(message.data) for message in heard["trials"]]
    assert [table["trials_csv"].count("\n") for table in tables] == [1, 2, 3]
    assert {table["frames"] for table in tables} == {60}
    prediction, plane, scalars = heard["prediction_image"], heard["feature_space_image"], heard["plan_scalars"]
    assert (prediction[-1].width, prediction[-1].encoding) == (3 * 255 + 6, "mono8")
    assert (plane[-1].width, plane[-1].height, plane[-1].encoding) == (605, 605, "rgb8")
    assert len(scalars) > 60  # all steps of the evaluations, and some others
    assert all(number.goal_distance >= 0.0 and number.solve_time > 0.0 for number in scalars)
    assert any(math.isnan(number.prediction_error) for number in scalars)
    assert any(number.prediction_error > 0.0 for number in scalars)

    rospy.Publisher("trials", String, queue_size=1, latch=True).publish(heard["trials"][-1])
    with Process([find_program("figure"), "learning_curve_node"]) as node:
        image = rospy.wait_for_message("learning_curve_image", Image, 60.0)
        assert (image.width, image.height, image.encoding) == (640, 480, "rgb8"), node.output
        assert np.mean(np.frombuffer(image.data, np.uint8) < 200) > 0.01
