#!/usr/bin/python3
# replay.launch: a bag goes through mpc_node, and no motor can move.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys
import threading

from ddm_msgs.msg import Torque
import rosbag
import rosgraph
import rospy
import rosunit
from sensor_msgs.msg import Image
from std_msgs.msg import Float64

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from processes import call, find_program, run_experiment, start_roslaunch  # noqa: E402
from run_files import read_rows  # noqa: E402
from scratch_case import SharedScratchCase  # noqa: E402

DEBUG = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "config", "presets", "debug.yaml")
STEPS = 30


class ReplayTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        """A trial of an experiment and its model; ears on every topic on which a motor might listen."""
        super().setUpClass()
        run = os.path.join(cls.class_scratch, "run")
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 0, "--out", run)
        assert code == 0, output
        cls.bag, cls.model = (os.path.join(run, "trial_000", name) for name in ("trial.bag", "model.ddm"))
        rospy.init_node("replay_test", disable_signals=True)
        cls.heard, cls.lock = {}, threading.Lock()
        for topic, kind in (("torque", Torque), ("effort_command", Float64), ("replay/torque", Torque),
                            ("replay/proposed_torque", Torque)):
            rospy.Subscriber(topic, kind, cls.hear, topic)

    def setUp(self):
        super().setUp()
        with self.lock:
            self.heard.clear()

    @classmethod
    def hear(cls, message, topic):
        with cls.lock:
            cls.heard.setdefault(topic, []).append(message)

    def replay(self, *arguments):
        """Output of replay.launch, and the publishers of all topics while its nodes answered."""
        launch = start_roslaunch(self.scratch, "replay.launch", "preset:=debug", *arguments, port=0)
        self.addCleanup(launch.stop)
        publishers = {}
        while launch.isRunning() and not any("mpc_node" in nodes for nodes in publishers.get("/plan", [])):
            publishers = dict(rosgraph.Master("/replay_test").getSystemState()[0])
        launch.waitForEnd(60.0)
        return launch.output, publishers

    def test_proposals_come_for_each_frame_and_nothing_where_motors_listen(self):
        out = self.file("torques.csv")
        output, publishers = self.replay("bag:=" + self.bag, "model:=" + self.model, "out:=" + out, "rate:=20")
        self.assertIn("%d frames replayed" % STEPS, output)
        self.assertIn("/mpc_node", publishers["/replay/proposed_torque"])
        self.assertNotIn("/torque", publishers)
        self.assertNotIn("/effort_command", publishers)
        with self.lock:
            heard = dict(self.heard)
        self.assertEqual(sorted(heard), ["replay/proposed_torque", "replay/torque"])
        rows = read_rows(out)
        self.assertEqual(rows[0], ["frame", "segment", "time_s", "recorded_1", "proposed_1"])
        self.assertEqual([row[3] for row in rows[1:]],
                         [row[1] for row in read_rows(os.path.dirname(self.bag), "torques.csv")[1:]])
        proposed = {message.header.stamp: message.torque[0] for message in heard["replay/proposed_torque"]}
        recorded = {message.header.stamp: message.torque[0] for message in heard["replay/torque"]}
        self.assertGreater(len(set(recorded) & set(proposed)), 0)
        told = [float(row[4]) for row in rows[1:]]
        self.assertTrue(set(proposed.values()) <= set(told))
        self.assertGreater(len(set(told)), STEPS // 2)

    def test_the_zero_of_a_last_image_that_is_refused_is_no_proposal(self):
        bag, out = self.file("one.bag"), self.file("torques.csv")
        with rosbag.Bag(self.bag) as whole, rosbag.Bag(bag, "w") as one:
            for wanted in ("camera/image_raw", "torque"):  # of the first frame, which is the last here
                one.write(*next(whole.read_messages([wanted])))
        camera = rospy.Publisher("camera/image_raw", Image, queue_size=1)  # mpc_node refuses images of two publishers
        self.addCleanup(camera.unregister)
        output, _ = self.replay("bag:=" + bag, "model:=" + self.model, "out:=" + out)
        self.assertRegex(output, r"FATAL.*only one node may publish images")
        self.assertFalse(os.path.exists(out))

    def test_time_that_does_not_come_is_named(self):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.delete_param, "/use_sim_time")
        code, output = call([find_program("experiment_node"), "replay", "_replay/bag:=" + self.bag,
                             "_replay/model:=" + self.model, "_replay/timeout:=0.5"])
        self.assertEqual(code, 1, output)
        for word in ("0.5 s", "nobody", "/clock"):
            self.assertIn(word, output)

    def test_a_bag_of_another_robot_is_refused(self):
        code, output = call([find_program("train_from_bags", "ddm_model"), "--config", DEBUG, "--config",
                             self.write("small.yaml", "image: {size: 20}\n"), "--out", self.file("small.ddm"),
                             self.bag])
        self.assertEqual(code, 0, output)
        output, _ = self.replay("bag:=" + self.bag, "model:=" + self.file("small.ddm"))
        self.assertRegex(output, r"(?s)FATAL.*image/size 51")


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "replay_test", ReplayTest)
