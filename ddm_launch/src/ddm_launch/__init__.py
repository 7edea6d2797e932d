# Programs and figures of ddm_launch.
# SPDX-License-Identifier: BSD-3-Clause
import threading

# rospy of Debian 11 ends its threads with Thread.isAlive, which Python 3.9 has removed. Without this alias each node
# would end with a traceback.
if not hasattr(threading.Thread, "isAlive"):
    threading.Thread.isAlive = threading.Thread.is_alive
