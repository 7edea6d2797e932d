# robot_check: acts as the user of a simulated robot, and measures latencies and the success of evaluations.
# SPDX-License-Identifier: BSD-3-Clause
import math
import os
import signal
import subprocess
import tempfile
import threading

from ddm_msgs.msg import RunTrialActionGoal, RunTrialActionResult
from ddm_msgs.srv import Reset
import numpy as np
import rospy
from sensor_msgs.msg import Image, JointState
from std_msgs.msg import Float64, UInt32
from std_srvs.srv import SetBool, Trigger
import yaml

from ddm_launch.command import Failure, find_program
from ddm_launch.plant import Joints
from ddm_model.plain_file import write_file

LIMIT_S = 60.0
SETTLED_STEPS = 10  # steps at the end of an evaluation that count for success, as in an experiment
LATENCY_P99_MS = 50.0


def largest_error(joints, positions):
    """Largest error of a joint at the true positions, which robot.launch does not get: angles [deg], lengths in the
    plant's own unit."""
    distances = joints.distances(np.array(positions), joints.goal)
    return max(math.degrees(distance) if unit == "rad" else float(distance) for unit, distance in zip(joints.units, distances))


LOAD = """while sleep 0.5; do
  OMP_NUM_THREADS=1 "$0" --config "$1" --out "$2/model.ddm" "$3"/trial_*/trial.bag >"$2/output" 2>&1 && echo >>"$2/trained"
done"""


def start_load(runs, scratch):
    """Trains models on the recorded bags in an endless loop, in a separate process, to load the processor. The file
    SCRATCH/trained gets a byte for each training that has finished."""
    words = [find_program("train_from_bags", "ddm_model"), rospy.get_param("~preset_file"), scratch, runs]
    process = subprocess.Popen(["setpriv", "--pdeathsig", "KILL", "bash", "-c", LOAD, *words], stdin=subprocess.DEVNULL,
                               start_new_session=True)
    rospy.on_shutdown(lambda: os.killpg(process.pid, signal.SIGKILL))


def call(name, kind, *values, **fields):
    """Calls a service whose response has the fields success and message. Raises rospy.ServiceException if success is
    false, rospy.ROSException if the service does not appear within LIMIT_S."""
    rospy.wait_for_service(name, LIMIT_S)
    answer = rospy.ServiceProxy(name, kind)(*values, **fields)
    if not answer.success:
        raise rospy.ServiceException("%s: %s" % (name, answer.message))


def show_goal_and_enable(goal):
    call("plant/reset", Reset, start=goal)
    for _ in range(3):  # the camera is one image late, and robot_node may not have received one yet
        rospy.wait_for_message("camera/image_raw", Image, LIMIT_S)
    call("take_goal", Trigger)
    call("enable", SetBool, True)


class RobotCheck:
    """Records latencies, deadline misses and errors of evaluations. Writes RUNS/robot_check.yaml after each trial."""

    def __init__(self, joints):
        self._joints, self._runs = joints, rospy.get_param("~runs")
        self._lock = threading.Lock()
        # Goal of the running trial, and error of the plant by time stamp [ns].
        self._goal, self._truth = None, {}
        self._latencies_ms, self._misses = [], 0
        self._frames, self._control_s, self._evaluations = 0, 0.0, []
        self._scratch = tempfile.TemporaryDirectory()
        if rospy.get_param("~load"):
            start_load(self._runs, self._scratch.name)
        for name, kind, callback in (("plant/ground_truth/joint_states", JointState, self._on_truth),
                                     ("latency", Float64, lambda latency: self._latencies_ms.append(1e3 * latency.data)),
                                     ("deadline_misses", UInt32, self._on_misses),
                                     ("run_trial/goal", RunTrialActionGoal, self._on_goal),
                                     ("run_trial/result", RunTrialActionResult, self._on_result)):
            rospy.Subscriber(name, kind, callback, queue_size=1000)

    def _on_truth(self, joints):
        with self._lock:
            if self._goal is not None:
                self._truth[joints.header.stamp.to_nsec()] = largest_error(self._joints, joints.position)

    def _on_misses(self, misses):
        self._misses = misses.data

    def _on_goal(self, message):
        with self._lock:
            self._goal, self._truth = message.goal, {}

    def _on_result(self, message):
        with self._lock:
            goal, truth, self._goal = self._goal, self._truth, None
        stamps = [stamp.to_nsec() for stamp in message.result.stamp]
        if goal is None or len(stamps) < SETTLED_STEPS:
            return
        self._frames += len(stamps)
        self._control_s += 1e-9 * (stamps[-1] - stamps[0])
        if goal.evaluation:
            error = max((error for stamp, error in truth.items() if stamps[-SETTLED_STEPS] <= stamp <= stamps[-1]),
                        default=math.inf)
            self._evaluations.append({"trial": goal.trial, "largest_error": round(error, 4),
                                      "reached": error <= self._joints.facts["tolerance"]})
        write_file(os.path.join(self._runs, "robot_check.yaml"), yaml.safe_dump(self._result(), sort_keys=False))

    def _result(self):
        trained = os.path.join(self._scratch.name, "trained")
        median, p99, largest = map(float, np.quantile(self._latencies_ms or [math.nan], (0.5, 0.99, 1.0)))
        return {"frames": self._frames, "control_minutes": round(self._control_s / 60.0, 2),
                "deadline_misses": self._misses,
                "latency_ms": {"median": round(median, 2), "p99": round(p99, 2), "max": round(largest, 2)},
                "other_trainings": os.path.getsize(trained) if os.path.exists(trained) else 0,
                "error_unit": self._joints.facts["error_unit"], "evaluations": self._evaluations,
                "in_time": self._misses == 0 and p99 < LATENCY_P99_MS,
                "reached": bool(self._evaluations) and self._evaluations[-1]["reached"]}


def main():
    rospy.init_node("robot_check")
    try:
        joints = Joints(rospy.get_param("~plant"))
        RobotCheck(joints)  # its subscribers keep it
        show_goal_and_enable(joints.facts["goal"])
    except (Failure, rospy.ROSException, rospy.ServiceException) as error:
        rospy.logfatal("robot_check: %s", error)
        return 1
    rospy.spin()
    return 0
