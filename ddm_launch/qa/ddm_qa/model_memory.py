# Has model_node learn from a folder of bags and writes down its peak memory.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os

import actionlib
from actionlib_msgs.msg import GoalStatus
from ddm_msgs.msg import TrainAction, TrainGoal
import rosgraph
import rospy
import yaml

from ddm_qa.processes import memory_kb, pid_of
from ddm_model.plain_file import write_file

LIMIT_S = 600.0


def main():
    rospy.init_node("model_memory")
    client = actionlib.SimpleActionClient("train", TrainAction)
    goal = TrainGoal(bags=sorted(glob.glob(os.path.join(rospy.get_param("~bags"), "*.bag"))), seed=0, trial=0)
    limit = rospy.Duration(LIMIT_S)
    if not (client.wait_for_server(limit) and client.send_goal_and_wait(goal, limit) == GoalStatus.SUCCEEDED):
        rospy.logfatal("model_memory: the action %s did not succeed within %g s" % (rospy.resolve_name("train"), LIMIT_S))
        return 1
    pid = pid_of(rosgraph.Master(rospy.get_name()), rospy.resolve_name("model_node"))
    result = {"frames": client.get_result().frames, "peak_memory_mb": memory_kb(pid, "VmHWM") / 1024.0}
    write_file(rospy.get_param("~out"), yaml.safe_dump(result))
    return 0
