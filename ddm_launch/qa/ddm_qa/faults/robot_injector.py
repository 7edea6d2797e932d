# fault_injector on a robot: stands between its sensors and robot_node, does one thing wrong, and watches the motor.
# SPDX-License-Identifier: BSD-3-Clause
"""It also plays the robot's user, who shows the goal and enables the motors."""
import os
import threading
import time

from ddm_msgs.msg import RunTrialActionGoal, Torque
import rospy
from sensor_msgs.msg import Image, JointState
from std_msgs.msg import Float64

from ddm_qa.faults.configuration import configuration
from ddm_qa.faults.finished import Finished
from ddm_launch.robot_check import PlantGoal, show_goal_and_enable

ON_A_ROBOT = " on a robot"
# (trial, whether it is the evaluation after it), by phase without ON_A_ROBOT.
RUN_OF_PHASE = {"exploring trial": (1, False), "evaluation": (1, True)}
FRAME = 7  # of a trial or evaluation: later if no torque acts there
HOUR = rospy.Duration(3600)
CLOCK_IS_WRONG_S = 1.5
BEYOND = 1.0e4  # position and speed [rad, rad/s]
FEWEST = 20     # torques that must have been seen; they come at 100 Hz
QUEUE = 1000
IMAGE_BYTES = 1 << 24  # a camera's image is larger than what rospy reads at once


class Effort:
    """What the motor got, and when."""

    def __init__(self):
        self._lock, self._efforts, self._fault, self._until = threading.Lock(), [], None, float("inf")

    def acts(self):
        with self._lock:
            return bool(self._efforts) and self._efforts[-1][1] != 0.0

    def take(self, effort):
        with self._lock:
            self._efforts.append((time.monotonic(), effort.data))

    def fault_begins(self, lasts=float("inf")):
        with self._lock:
            self._fault = time.monotonic()
            self._until = self._fault + lasts

    def verdict(self, limit):
        """`zero`, or what was seen instead. limit: after which there may be no torque [s]."""
        with self._lock:
            if self._fault is None:
                return "no fault"
            after = [effort for now, effort in self._efforts if self._fault + limit < now < self._until]
        if any(after):
            return "driven: " + " ".join("%g" % effort for effort in after if effort)[:60]
        return "zero" if len(after) >= FEWEST else "only %d torques seen" % len(after)


class RobotInjector:
    def __init__(self):
        self.phase, self.fault = rospy.get_param("~phase").replace(ON_A_ROBOT, ""), rospy.get_param("~fault")
        self.report, self.runs = rospy.get_param("~report"), rospy.get_param("~runs")
        self.effort = Effort()
        self.run, self.frame, self.done, self.ends = None, 0, False, 0.0
        self.images = rospy.Publisher("faults/image_raw", Image, queue_size=2, tcp_nodelay=True)
        self.joints = rospy.Publisher("faults/joint_states", JointState, queue_size=QUEUE, tcp_nodelay=True)
        rospy.Subscriber("effort_command", Float64, self.effort.take, queue_size=QUEUE, tcp_nodelay=True)
        rospy.Subscriber("run_trial/goal", RunTrialActionGoal, self.on_goal, queue_size=QUEUE)
        rospy.Subscriber("torque", Torque, self.on_torque, queue_size=QUEUE)
        rospy.Subscriber("plant/ground_truth/joint_states", JointState, self.on_joints, queue_size=QUEUE)
        rospy.Subscriber("stand_in/image_raw", Image, self.on_image, queue_size=2, buff_size=IMAGE_BYTES)

    def on_goal(self, message):
        self.run, self.frame = (message.goal.trial, message.goal.evaluation), 0

    def on_torque(self, _):
        self.frame += 1

    def is_due(self):
        return (not self.done and RUN_OF_PHASE.get(self.phase) == self.run and self.frame >= FRAME and
                self.effort.acts())

    def on_image(self, image):
        if self.fault == "future image":
            if self.done:
                return
            if self.is_due():
                image.header.stamp += HOUR
                self.tell()
        elif self.fault.startswith("set clock"):
            if self.is_due():
                self.ends = time.monotonic() + CLOCK_IS_WRONG_S
                self.tell(CLOCK_IS_WRONG_S)
            if time.monotonic() < self.ends:
                image.header.stamp += HOUR if self.fault.endswith("forward") else -HOUR
        self.pass_on(self.images, image)

    def on_joints(self, joints):
        if self.fault.startswith("exceed") and self.is_due():
            if self.fault == "exceed position":
                joints.position = [BEYOND]
            else:
                joints.velocity = [BEYOND]
            self.tell()
        self.pass_on(self.joints, joints)

    @staticmethod
    def pass_on(publisher, message):
        try:
            publisher.publish(message)
        except rospy.ROSException:
            if not rospy.core.is_shutdown_requested():  # the plant goes on while this node ends
                raise

    def tell(self, lasts=float("inf")):
        """The fault begins."""
        self.done = True
        self.effort.fault_begins(lasts)
        Finished.of(self.runs).write(os.path.dirname(self.report))
        with open(self.report, "w") as stream:
            stream.write("\n")

    def end(self, limit):
        if not self.done:
            return
        with open(self.report, "a") as stream:
            stream.write("motor: %s\n" % self.effort.verdict(limit))


def main():
    injector = RobotInjector()
    limit = rospy.get_param("~slack")
    if not injector.fault.startswith("exceed"):  # which is seen at once: nothing has to stay away first
        limit += 2.0 * configuration()["robot"]["dt"]
    show_goal_and_enable(PlantGoal("pendulum"))
    rospy.spin()
    injector.end(limit)
    return 0
