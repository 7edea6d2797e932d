# Has model_node learn from a folder of bags and writes down its peak memory.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os

import actionlib
from ddm_msgs.msg import TrainAction, TrainGoal
import rosgraph
import rospy
import yaml

from ddm_qa.node_processes import memory_kb, pid_of
from ddm_model.plain_file import write_file

LIMIT_S = 600.0


def main():
    rospy.init_node("model_memory")
    client = actionlib.SimpleActionClient("train", TrainAction)
    if not client.wait_for_server(rospy.Duration(LIMIT_S)):
        rospy.logfatal("model_memory: nobody offers the action %s" % rospy.resolve_name("train"))
        return 1
    goal = TrainGoal(bags=sorted(glob.glob(os.path.join(rospy.get_param("~bags"), "*.bag"))), seed=0, trial=0)
    client.send_goal(goal)
    if not client.wait_for_result(rospy.Duration(LIMIT_S)):
        rospy.logfatal("model_memory: no result within %g s" % LIMIT_S)
        return 1
    pid = pid_of(rosgraph.Master(rospy.get_name()), rospy.resolve_name("model_node"))
    result = {"frames": client.get_result().frames, "peak_memory_mb": memory_kb(pid, "VmHWM") / 1024.0}
    write_file(rospy.get_param("~out"), yaml.safe_dump(result))
    return 0
