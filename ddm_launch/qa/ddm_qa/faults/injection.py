# What an injector of any fault does: knows its moment, passes messages on, and reports.
# SPDX-License-Identifier: BSD-3-Clause
import json
import os
import signal
import threading
import time

import rospy
import yaml

from ddm_model.plain_file import write_file
from ddm_qa.run_comparison import Finished

# (trial, whether it is the evaluation after it). `recording` is when the last torque has been sent: the bag is closed.
RUN_OF_PHASE = {"random trial": (0, False), "exploring trial": (1, False), "recording": (1, False),
                "evaluation": (1, True)}
FRAME = 7  # of a trial or evaluation


def configuration():
    """{block: {key: value}}, as all nodes of the launch have it."""
    return yaml.safe_load(rospy.get_param("configuration"))


def has_ended(pid):
    """Also of a process whose parent has not asked for its exit code yet."""
    try:
        with open("/proc/%d/stat" % pid) as stream:
            return stream.read().rsplit(")", 1)[1].split()[0] == "Z"
    except OSError:
        return True


def lose(pid, experiment_pid):
    """Kills a node where no roslaunch sees it, as on another machine: the others must notice. roslaunch, which has
    started all of them, sleeps until the experiment has ended."""
    roslaunch = os.getppid()
    os.kill(roslaunch, signal.SIGSTOP)
    os.kill(pid, signal.SIGKILL)

    def wake():
        while not has_ended(experiment_pid):
            time.sleep(0.05)
        os.kill(roslaunch, signal.SIGCONT)
    threading.Thread(target=wake, daemon=True).start()


class Injection:
    def __init__(self, place):
        """place: what the name of the phase ends with, if anything."""
        self.phase, self.fault = rospy.get_param("~phase").replace(place, ""), rospy.get_param("~fault")
        self.runs, self.path, self.report = rospy.get_param("~runs"), rospy.get_param("~report"), {}
        self.run, self.frame, self.done = None, -1, False

    def is_in_phase(self):
        return RUN_OF_PHASE.get(self.phase) == self.run

    def tell(self, said=""):
        """The fault has begun. What the experiment has finished so far must be there in the end."""
        self.done = True
        self.add_to_report(said=said, finished=Finished.of(self.runs))

    def add_to_report(self, **facts):
        self.report.update(facts)
        write_file(self.path, json.dumps(self.report))

    @staticmethod
    def publish(publisher, message):
        try:
            publisher.publish(message)
        except rospy.ROSException:
            if not rospy.core.is_shutdown_requested():  # in real time the plant goes on while this node ends
                raise
