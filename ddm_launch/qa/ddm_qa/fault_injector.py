# fault_injector: relays the messages between plant and controller, and injects one fault at a given moment.
# SPDX-License-Identifier: BSD-3-Clause
"""The injector gets each reset, image and torque before the recipient does, and holds the message until the fault is
injected, so the moment of a fault is exact. The phase `training` is an exception: its fault comes when the first
progress of the training arrives. The report contains the trials that were finished at that moment, and the torques that
acted afterwards."""
import json
import multiprocessing
import os
import signal
import subprocess
import threading
import time

from ddm_msgs.msg import Model, RunTrialActionGoal, Torque, TrainActionFeedback, TrainActionGoal
from ddm_msgs.srv import Reset
import rosgraph
import rospy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image, JointState
from std_msgs.msg import Float64
import yaml

from ddm_launch.command import find_program
from ddm_model.plain_file import write_file
from ddm_qa.fault_cases import ON_A_ROBOT, REAL_TIME
from ddm_qa.fault_changes import CHANGES
from ddm_qa.processes import pid_of
from ddm_qa.run_comparison import digests_of_finished

# (trial, whether the phase belongs to the evaluation after the trial). `recording` begins with the last torque of the
# trial, when the recorder closes the bag.
RUN_OF_PHASE = {"random trial": (0, False), "exploring trial": (1, False), "recording": (1, False),
                "evaluation": (1, True)}
FRAME = 7  # frame of a trial or evaluation at which the fault begins
TRAINED_TRIAL = 1  # trial whose training the phase `training` means
QUEUE = 1000
IMAGE_BYTES = 1 << 24  # a robot's camera may send images larger than rospy's default buffer

# Duration of a stop, relative to the shortest time limit of a node that waits for the stopped node.
STOPS = {"pause": 0.6, "oversleep": 1.25, "hold": float("inf")}
LIMITS = {"sim_node": ("controller", "timeout"), "mpc_node": ("sim", "watchdog")}
OTHER_LIMIT = ("experiment", "timeout")

# Topics and message of a second publisher. On a robot, both torque topics are the same.
INTRUDED = {"torque": (["torque", "plant/torque"], lambda: Torque(torque=[6.0])),
            "image": (["camera/image_raw"], lambda: Image(width=51, height=51, encoding="mono8", step=51, data=bytes(51 * 51))),
            "model": (["model"], lambda: Model(id="00000000", data=b"no model at all")), "clock": (["/clock"], Clock)}


class Motor:
    """Records the torques that act, and judges whether they are zero after a fault."""

    def __init__(self):
        self.acted, self.stamp, self.since, self.until = [], None, float("inf"), float("inf")

    def acts(self):
        """Whether a torque other than zero acts now."""
        return bool(self.acted) and self.acted[-1][1] != 0.0

    def begin(self, stamp=None, lasts=float("inf")):
        """Marks the beginning of the fault. stamp: time stamp of the last image. lasts: time after which the motor may run
        again [s]."""
        self.stamp, self.since = stamp, time.time()
        self.until = self.since + lasts

    def torque_passes(self, now, stamp, may_run_again):
        """A torque that answers an image from before the fault may still act. A torque that answers a later image ends
        the fault, unless the fault is a refused torque, after which the motor must stay off."""
        if self.stamp is not None and stamp < self.stamp:
            self.since = now
        elif self.stamp is not None and may_run_again:
            self.until = min(self.until, now)

    def verdict(self, limit_s, periods, fewest):
        """Returns `zero`, or a description of other torques. limit_s, periods: time and number of torques after which
        no torque may act. fewest: number of torques that are needed for a verdict."""
        after = [torque for at, torque in self.acted if self.since + limit_s < at < self.until][periods:]
        if any(after):
            return "driven: " + " ".join("%g" % torque for torque in after if torque)[:60]
        return "zero" if len(after) >= fewest else "only %d torques seen" % len(after)


def intrude(connection, other_end):
    """Publishes a message from a second process. The connection first receives the topic, then the signal to
    publish."""
    os.setsid()  # keeps Ctrl-C away from this process
    other_end.close()
    try:
        topics, make = INTRUDED[connection.recv()]
        rospy.init_node("intruder", argv=[], disable_signals=True)
        stamps, message = [], make()
        rospy.Subscriber("plant/image_raw", Image, lambda image: stamps.append(image.header.stamp), queue_size=1)
        connection.send("ready")
        connection.recv()
        if isinstance(message, Clock):
            message.clock = stamps[-1] + rospy.Duration(1000.0)
        else:
            message.header.stamp = stamps[-1]
        publishers = {topic: rospy.Publisher(topic, type(message), queue_size=1) for topic in topics}
        _, subscribers, _ = rosgraph.Master(rospy.get_name()).getSystemState()
        for topic, publisher in publishers.items():
            while publisher.get_num_connections() < len(dict(subscribers).get(rospy.resolve_name(topic), [])):
                time.sleep(0.01)
        # Publishes after all subscribers have connected to both publishers. Otherwise the plant could accept a torque
        # before it notices the second publisher.
        for publisher in publishers.values():
            publisher.publish(message)
        connection.send("intruder is there")
        connection.recv()
    except EOFError:  # fault_injector has ended
        pass


class Injector:
    """The node fault_injector. intruder: connection to the process of intrude()."""

    def __init__(self, intruder):
        phase, self.fault, self.runs, self.path = (rospy.get_param("~" + name) for name in ("phase", "fault", "runs", "report"))
        self.real_time, self.robot = phase.endswith(REAL_TIME), phase.endswith(ON_A_ROBOT)
        self.phase = phase.replace(REAL_TIME, "").replace(ON_A_ROBOT, "")
        self.verb, self.what, *_ = words = self.fault.split()
        self.how = words[-1]
        self.change = CHANGES.get(self.verb)
        self.trigger = self.change and (self.change.topic or self.what) or (
            "torque" if self.phase == "recording" else "image")
        self.configuration = yaml.safe_load(rospy.get_param("configuration"))
        self.lock, self.report, self.done, self.changes_until = threading.Lock(), {}, False, 0.0
        self.run, self.frame, self.num_steps, self.stamp, self.last = None, -1, 0, None, {}
        # stamps: time stamps of the images before which the torques acted [ns].
        self.motor, self.stamps = Motor(), []
        self.trained, self.pids, self.killed, self.intruder = -1, None, False, intruder
        if self.verb == "publish":
            intruder.send(self.what)
            intruder.recv()
        self.connect_robot() if self.robot else self.connect_simulator()

    def connect_robot(self):
        self.pass_on("image", "plant/camera/image_raw", "faults/image_raw", Image, 2)
        self.pass_on("joints", "plant/ground_truth/joint_states", "faults/joint_states", JointState)
        rospy.Subscriber("plant/effort_command", Float64, lambda effort: self.motor.acted.append((time.time(), effort.data)),
                         queue_size=QUEUE, tcp_nodelay=True)
        rospy.Subscriber("torque", Torque, self.count_torque, queue_size=QUEUE)
        rospy.Subscriber("run_trial/goal", RunTrialActionGoal, lambda goal: self.begin_run(goal.goal, 0), queue_size=QUEUE)

    def connect_simulator(self):
        """Relays messages between the simulator and the other nodes. Offers the service `reset` last, because the
        experiment waits for this service and then needs all other connections."""
        ends = self.pass_on("image", "plant/image_raw", "camera/image_raw", Image)
        ends += self.pass_on("torque", "torque", "plant/torque", Torque)
        self.pass_on("clock", "plant/clock", "/clock", Clock, latch=True)
        rospy.Subscriber("ground_truth/joint_states", JointState, self.on_ground_truth, queue_size=QUEUE)
        rospy.Subscriber("train/goal", TrainActionGoal, self.on_training, queue_size=QUEUE)
        rospy.Subscriber("train/feedback", TrainActionFeedback, self.on_progress, queue_size=QUEUE)
        while not rospy.is_shutdown() and not all(end.get_num_connections() for end in ends):
            time.sleep(0.01)
        rospy.wait_for_service("plant/reset")
        # A persistent connection needs no master.
        self.reset = rospy.ServiceProxy("plant/reset", Reset, persistent=True)
        rospy.Service("reset", Reset, self.on_reset)

    def pass_on(self, name, source, destination, kind, queue_size=QUEUE, latch=False):
        """Relays a topic. Returns publisher and subscriber."""
        publisher = rospy.Publisher(destination, kind, queue_size=queue_size, tcp_nodelay=True, latch=latch)
        return [publisher, rospy.Subscriber(source, kind, lambda message: self.relay(name, message, publisher),
                                            queue_size=queue_size, buff_size=IMAGE_BYTES, tcp_nodelay=True)]

    def begin_run(self, request, frame):
        """Called when a trial or evaluation begins. frame: index of the last image."""
        if self.pids is None and (self.verb in ("kill", "lose") or self.verb in STOPS):
            master = rosgraph.Master(rospy.get_name())  # only now do all nodes certainly exist
            self.pids = [pid_of(master, node) for node in (self.what, "experiment_node")]
        with self.lock:
            self.run, self.frame = (request.trial, request.evaluation), frame

    def on_reset(self, request):
        self.num_steps = request.num_steps
        self.begin_run(request, -1)
        self.wait_for_end()
        return self.reset(request)

    def count_torque(self, _):
        self.frame += 1

    def on_ground_truth(self, state):
        self.motor.acted.append((state.header.stamp.to_sec(), state.effort[0]))
        self.stamps.append(state.header.stamp.to_nsec())

    def on_training(self, goal):
        self.trained = goal.goal.trial

    def on_progress(self, _):
        with self.lock:
            due = not self.done and self.phase == "training" and self.trained == TRAINED_TRIAL
            self.done = self.done or due
        if due:
            self.inject()

    def wait_for_end(self):
        """Holds messages after a node was killed, until roslaunch notices the dead process and ends this node."""
        while self.killed and not rospy.is_shutdown():
            time.sleep(0.01)

    def is_due(self, topic, message):
        frame = self.num_steps - 1 if self.phase == "recording" else FRAME
        return (not self.done and topic == self.trigger and RUN_OF_PHASE.get(self.phase) == self.run and self.frame >= frame
                and (topic != "torque" or message.header.stamp == self.stamp)
                and (not (self.real_time or self.robot) or self.motor.acts()))

    def relay(self, topic, message, publisher):
        self.wait_for_end()
        with self.lock:
            if topic == "image" and not self.robot:
                self.frame, self.stamp = self.frame + 1, message.header.stamp
            due = self.is_due(topic, message)
            self.done = self.done or due
        before, self.last[topic] = self.last.get(topic, message), message
        if due:
            self.inject()
            self.wait_for_end()
        messages = [message]
        if self.change and topic == self.trigger and (due or time.monotonic() < self.changes_until):
            messages = self.change.messages(message, before, self.how)
        elif self.done and self.fault == "future image" and topic == "image":
            messages = []
        for each in messages:
            if topic == "torque":
                self.motor.torque_passes(time.time(), each.header.stamp, self.verb not in ("alter", "publish"))
            try:
                publisher.publish(each)
            except rospy.ROSException:
                if not rospy.core.is_shutdown_requested():  # the plant goes on in real time while this node ends
                    raise

    def inject(self):
        lasts = self.change.lasts if self.change else 0
        self.motor.begin(None if self.robot else self.stamp, lasts if self.robot and lasts else float("inf"))
        self.changes_until = time.monotonic() + lasts
        # The report is written first, because the fault may end this node.
        self.add_to_report(said="", finished=digests_of_finished(self.runs))
        if not self.change:
            self.add_to_report(said=(self.do_stop if self.verb in STOPS else getattr(self, "do_" + self.verb))() or "")

    def add_to_report(self, **facts):
        self.report.update(facts)
        write_file(self.path, json.dumps(self.report))

    def do_kill(self):
        self.killed = True
        os.kill(self.pids[0], signal.SIGKILL)

    def do_stop(self):
        """Stops the process of a node. The process continues after the time in STOPS."""
        block, key = LIMITS.get(self.what, OTHER_LIMIT)
        os.kill(self.pids[0], signal.SIGSTOP)
        if self.verb != "hold":  # a separate process sends SIGCONT even if this one has ended
            seconds = STOPS[self.verb] * self.configuration[block][key]
            subprocess.Popen(["sh", "-c", "sleep %g; kill -CONT %d" % (seconds, self.pids[0])], start_new_session=True)

    def do_lose(self):
        """Kills a node without roslaunch's notice, as if the node ran on another machine, so that the other nodes must
        notice the loss. The roslaunch that started all nodes is stopped until the experiment has ended."""
        node, experiment = self.pids
        os.kill(os.getppid(), signal.SIGSTOP)
        os.kill(node, signal.SIGKILL)
        subprocess.Popen(["sh", "-c", "while grep -qs '^State:.[^Z]' /proc/%d/status; do sleep 0.05; done; kill -CONT %d" % (
            experiment, os.getppid())], start_new_session=True)

    def do_fill(self):
        """Fills the disk of the run folder. Returns the error message of the full disk."""
        with open(os.path.join(self.runs, "filler"), "wb", buffering=0) as stream:
            try:
                while True:
                    stream.write(bytes(4096))
            except OSError as error:
                return str(error)

    def do_publish(self):
        self.intruder.send("now")
        return self.intruder.recv()

    def do_begin(self):
        """Starts a second experiment in the same folder and returns its output."""
        return subprocess.run([find_program("run_experiment"), "--preset", "debug", "--out", self.runs],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True).stdout

    def spin(self):
        rospy.spin()
        if self.done and self.robot:
            # The last torque may arrive within 50 ms. A joint beyond its limits is visible at once. All other faults
            # become visible after two time steps without a message.
            limit_s = 0.05 + (0.0 if self.verb == "exceed" else 2.0 * self.configuration["robot"]["dt"])
            self.add_to_report(motor=self.motor.verdict(limit_s, 0, 20))
        elif self.done and self.real_time:
            # The plant holds a torque for two periods.
            acted = sorted(zip(self.stamps, (torque for _, torque in self.motor.acted)))
            self.add_to_report(motor=self.motor.verdict(0.0, 2, 3), acted=acted)


def main():
    ours, theirs = multiprocessing.Pipe()
    multiprocessing.Process(target=intrude, args=(theirs, ours), daemon=True).start()
    rospy.init_node("fault_injector")
    Injector(ours).spin()
    return 0
