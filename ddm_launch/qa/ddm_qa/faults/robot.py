# fault_injector on a robot: stands between its sensors and robot_node, does one thing wrong, and watches the motor.
# SPDX-License-Identifier: BSD-3-Clause
import time

from ddm_msgs.msg import RunTrialActionGoal, Torque
import rosgraph
import rospy
from sensor_msgs.msg import Image, JointState
from std_msgs.msg import Float64

from ddm_qa.faults.injection import FRAME, Injection, configuration, lose
from ddm_qa.faults.watches import Effort
from ddm_qa.processes import pid_of

ON_A_ROBOT = " on a robot"  # end of a phase
SLACK_S = 0.05  # that the last torque may take, apart from two dt
HOUR = rospy.Duration(3600)
CLOCK_IS_WRONG_S = 1.5
OLD_JOINTS_S, AGE = 1.5, rospy.Duration(2)
BEYOND = 1.0e4  # position and speed [rad, rad/s]
QUEUE = 1000
IMAGE_BYTES = 1 << 24  # a camera's image is larger than what rospy reads at once


class RobotInjection(Injection):
    def __init__(self):
        super().__init__(ON_A_ROBOT)
        self.effort, self.ends, self.pids = Effort(), 0.0, None
        self.images = rospy.Publisher("faults/image_raw", Image, queue_size=2, tcp_nodelay=True)
        self.joints = rospy.Publisher("faults/joint_states", JointState, queue_size=QUEUE, tcp_nodelay=True)
        rospy.Subscriber("plant/effort_command", Float64, self.effort.take, queue_size=QUEUE, tcp_nodelay=True)
        rospy.Subscriber("run_trial/goal", RunTrialActionGoal, self.on_goal, queue_size=QUEUE)
        rospy.Subscriber("torque", Torque, self.on_torque, queue_size=QUEUE)
        rospy.Subscriber("plant/ground_truth/joint_states", JointState, self.on_joints, queue_size=QUEUE)
        rospy.Subscriber("plant/camera/image_raw", Image, self.on_image, queue_size=2, buff_size=IMAGE_BYTES)

    def on_goal(self, message):
        if self.fault == "lose mpc_node" and self.pids is None:
            master = rosgraph.Master(rospy.get_name())  # only now all nodes are sure to be there
            self.pids = [pid_of(master, name) for name in ("mpc_node", "experiment_node")]
        self.run, self.frame = (message.goal.trial, message.goal.evaluation), 0

    def on_torque(self, _):
        self.frame += 1

    def is_due(self):
        return not self.done and self.is_in_phase() and self.frame >= FRAME and self.effort.acts()

    def on_image(self, image):
        if self.fault == "future image":
            if self.done:
                return
            if self.is_due():
                image.header.stamp += HOUR
                self.begin()
        elif self.fault.startswith("set clock"):
            if self.is_due():
                self.ends = time.monotonic() + CLOCK_IS_WRONG_S
                self.begin(CLOCK_IS_WRONG_S)
            if time.monotonic() < self.ends:
                image.header.stamp += HOUR if self.fault.endswith("forward") else -HOUR
        elif self.fault == "lose mpc_node":
            if self.is_due():
                self.begin()
                lose(*self.pids)
        elif self.fault == "resize image":
            if self.is_due():
                self.begin()
            if self.done:  # the upper half, as after a change of the camera's resolution
                image.height //= 2
                image.data = image.data[:image.step * image.height]
        self.publish(self.images, image)

    def on_joints(self, joints):
        if self.fault.startswith("exceed") and self.is_due():
            setattr(joints, "position" if self.fault == "exceed position" else "velocity", [BEYOND])
            self.begin()
        elif self.fault == "age joints":
            if self.is_due():
                self.ends = time.monotonic() + OLD_JOINTS_S
                self.begin(OLD_JOINTS_S)
            if time.monotonic() < self.ends:
                joints.header.stamp -= AGE
        self.publish(self.joints, joints)

    def begin(self, lasts=float("inf")):
        self.effort.fault_begins(lasts)
        self.tell()

    def spin(self):
        limit = SLACK_S
        if not self.fault.startswith("exceed"):  # which is seen at once: nothing has to stay away first
            limit += 2.0 * configuration()["robot"]["dt"]
        rospy.spin()
        if self.done:
            self.add_to_report(motor=self.effort.verdict(limit))
