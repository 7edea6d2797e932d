# fault_injector: relays between plant and controller, and does one thing wrong at one moment.
# SPDX-License-Identifier: BSD-3-Clause
"""The moment is exact: the injector sees each reset, image and torque before it arrives, and holds it until its fault
is done. Only a training is hit wherever it is when its first progress is heard. What the experiment has finished at that
moment is in the report. In real time that also says what the motor has done since."""
import copy
import os
import signal
import subprocess
import sys
import threading
import time

from ddm_msgs.msg import Torque, TrainActionFeedback, TrainActionGoal
from ddm_msgs.srv import Reset
import rosgraph
import rospy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image, JointState

from ddm_launch.command import find_program
from ddm_qa.faults import intruder
from ddm_qa.faults.injection import FRAME, Injection, configuration, lose
from ddm_qa.faults.robot import ON_A_ROBOT, RobotInjection
from ddm_qa.faults.watches import MotorWatch
from ddm_qa.processes import pid_of

REAL_TIME = " in real time"  # end of a phase
TRAINED_TRIAL = 1            # of the phase `training`
LATE_S = 1.0
QUEUE = 100

# How long a node stops, in terms of the first limit that somebody who waits for it has.
STOPS = {"pause": 0.6, "oversleep": 1.25, "hold": float("inf")}
LIMITS = {"sim_node": ("controller", "timeout"), "mpc_node": ("sim", "watchdog")}
OTHER_LIMIT = ("experiment", "timeout")

# What an image or a torque has that is not as it should be.
ALTERED = {
    "nan": lambda torque: {"torque": [float("nan")]}, "inf": lambda torque: {"torque": [float("inf")]},
    "1e300": lambda torque: {"torque": [1e300]}, "none": lambda torque: {"torque": []},
    "twice": lambda torque: {"torque": list(torque.torque) * 2},
    "size": lambda image: dict(dict.fromkeys(("width", "height", "step"), image.width // 2),
                               data=image.data[:(image.width // 2) ** 2]),
    "encoding": lambda image: {"encoding": "rgb8", "step": 3 * image.step, "data": 3 * image.data},
    "unknown": lambda image: {"encoding": "smell"},
    "cut": lambda image: {"data": image.data[:len(image.data) // 2]},
    "unstamped": lambda image: {"header": type(image.header)(frame_id=image.header.frame_id)}}


def altered(message, how):
    result = copy.deepcopy(message)
    for field, value in ALTERED[how](message).items():
        setattr(result, field, value)
    return result


def late(message):
    time.sleep(LATE_S)
    return [message]


# What is passed on in the place of a message, given the one before it.
MESSAGE_FAULTS = {"drop": lambda message, before, how: [], "double": lambda message, before, how: [message, message],
                  "late": lambda message, before, how: late(message),
                  "repeat": lambda message, before, how: [before, message],
                  "alter": lambda message, before, how: [altered(message, how)]}


class Injector(Injection):
    def __init__(self):
        super().__init__(REAL_TIME)
        self.real_time = rospy.get_param("~phase").endswith(REAL_TIME)
        self.verb, self.what, self.how = (self.fault.split() + ["", ""])[:3]
        self.lock = threading.Lock()
        self.num_steps, self.stamp = 0, None
        self.last, self.muted = {}, None  # topic: the message before; topic that is no longer passed on
        self.acted = []                   # (stamp of an image [ns], torque that acted before it)
        self.motor = MotorWatch(stays_off=self.verb in ("alter", "publish"))
        self.trained, self.pid, self.experiment_pid, self.killed = -1, None, None, False
        self.intruder = None
        if self.verb == "publish":
            self.intruder = subprocess.Popen(
                [sys.executable, intruder.__file__, self.what], stdin=subprocess.PIPE,
                stdout=subprocess.PIPE, universal_newlines=True, start_new_session=True)  # Ctrl-C is not for it
            self.intruder.stdout.readline()
        self.connect()

    def connect(self):
        """The service comes last: the experiment waits for it, and then finds everything else in place."""
        self.images = rospy.Publisher("camera/image_raw", Image, queue_size=QUEUE)
        self.torques = rospy.Publisher("plant/torque", Torque, queue_size=QUEUE)
        from_plant = rospy.Subscriber("plant/image_raw", Image, self.on_image, queue_size=QUEUE, tcp_nodelay=True)
        from_controller = rospy.Subscriber("torque", Torque, self.on_torque, queue_size=QUEUE, tcp_nodelay=True)
        self.clocks = rospy.Publisher("/clock", Clock, queue_size=QUEUE, latch=True)
        rospy.Subscriber("plant/clock", Clock, lambda clock: self.relay("clock", clock, self.clocks, False))
        rospy.Subscriber("ground_truth/joint_states", JointState, self.on_ground_truth, queue_size=QUEUE)
        rospy.Subscriber("train/goal", TrainActionGoal, self.on_training, queue_size=QUEUE)
        rospy.Subscriber("train/feedback", TrainActionFeedback, self.on_progress, queue_size=QUEUE)
        ends = (from_plant, from_controller, self.torques, self.images)
        while not rospy.is_shutdown() and not all(end.get_num_connections() for end in ends):
            time.sleep(0.01)
        rospy.wait_for_service("plant/reset")
        self.reset = rospy.ServiceProxy("plant/reset", Reset, persistent=True)  # needs no master
        rospy.Service("reset", Reset, self.on_reset)

    def on_reset(self, request):
        if self.pid is None and (self.verb in ("kill", "lose") or self.verb in STOPS):
            master = rosgraph.Master(rospy.get_name())  # only now all nodes are sure to be there
            self.pid, self.experiment_pid = pid_of(master, self.what), pid_of(master, "experiment_node")
        with self.lock:
            self.run, self.frame, self.num_steps = (request.trial, request.evaluation), -1, request.num_steps
        self.wait_for_end()
        return self.reset(request)

    def wait_for_end(self):
        """roslaunch takes a moment to notice that a process is dead: meanwhile nobody gets any further."""
        while self.killed and not rospy.is_shutdown():
            time.sleep(0.01)

    def is_due(self):
        """Whether the frame on show is the one of the phase."""
        frame = self.num_steps - 1 if self.phase == "recording" else FRAME
        # in real time the torque of that frame may have been late
        return self.is_in_phase() and (self.frame >= frame if self.real_time else self.frame == frame)

    def on_image(self, image):
        with self.lock:
            self.frame, self.stamp = self.frame + 1, image.header.stamp
            due = self.is_due()
        if due and self.phase != "recording" and self.verb not in MESSAGE_FAULTS:
            self.inject()
        self.relay("image", image, self.images, due)

    def on_torque(self, torque):
        with self.lock:
            due = self.is_due() and torque.header.stamp == self.stamp
        if due and self.phase == "recording":
            self.inject()
        self.relay("torque", torque, self.torques, due)

    def on_ground_truth(self, state):
        self.motor.torque_has_acted(state.header.stamp.to_sec(), state.effort[0])
        self.acted.append((state.header.stamp.to_nsec(), state.effort[0]))

    def relay(self, topic, message, publisher, due):
        self.wait_for_end()
        before, self.last[topic] = self.last.get(topic), message
        messages = [message]
        if self.what == topic and not self.done:
            if due and self.verb in MESSAGE_FAULTS:
                self.motor.fault_begins(time.time(), self.stamp.to_sec())
                messages = MESSAGE_FAULTS[self.verb](message, before, self.how)
                self.tell()
        if topic == self.muted:
            return
        for each in messages:
            if topic == "torque":
                self.motor.torque_passes(time.time(), each.header.stamp.to_sec())
            self.publish(publisher, each)

    def on_training(self, goal):
        self.trained = goal.goal.trial

    def on_progress(self, _):
        if self.phase == "training" and self.trained == TRAINED_TRIAL:
            self.inject()

    def inject(self):
        """Faults that do not change a message. Once only."""
        with self.lock:
            if self.done:
                return
            self.done = True
            self.motor.fault_begins(time.time(), self.stamp.to_sec())
        self.tell()  # first: the fault may end this node
        if self.verb == "kill":
            self.killed = True
            os.kill(self.pid, signal.SIGKILL)
        else:
            said = (self.stop if self.verb in STOPS else getattr(self, "do_" + self.verb))()
            if said:
                self.add_to_report(said=said)

    def stop(self):
        block, key = LIMITS.get(self.what, OTHER_LIMIT)
        limit = configuration()[block][key]  # first: it comes from the master, which may be the one to stop
        os.kill(self.pid, signal.SIGSTOP)
        if self.verb != "hold":  # goes on even if this process has ended by then
            subprocess.Popen(["sh", "-c", "sleep %g; kill -CONT %d" % (STOPS[self.verb] * limit, self.pid)],
                             start_new_session=True)

    def do_lose(self):
        lose(self.pid, self.experiment_pid)

    def do_mute(self):
        self.muted = self.what

    def do_fill(self):
        with open(os.path.join(self.runs, "filler"), "wb", buffering=0) as stream:
            try:
                while True:
                    stream.write(bytes(4096))
            except OSError as error:
                return str(error)

    def do_publish(self):
        self.intruder.stdin.write("now\n")
        self.intruder.stdin.flush()
        return self.intruder.stdout.readline()

    def do_begin(self):
        """A second experiment in the same folder."""
        return subprocess.run([find_program("run_experiment"), "--preset", "debug", "--out", self.runs],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True).stdout

    def spin(self):
        rospy.spin()
        if self.done and self.real_time:
            self.add_to_report(motor=self.motor.verdict(), acted=sorted(self.acted))
        if self.intruder:
            self.intruder.stdin.close()  # it ends, too


def main():
    rospy.init_node("fault_injector")
    (RobotInjection if rospy.get_param("~phase").endswith(ON_A_ROBOT) else Injector)().spin()
    return 0
