# Makes the Python packages of study and qa importable for all tests of this folder, and provides a ROS master.
# SPDX-License-Identifier: BSD-3-Clause
import os

import pytest

import rooms  # noqa: F401: Python packages that are not installed
import ddm_launch  # noqa: F401: fixes rospy for Python 3.9
from ddm_qa.processes import Process, free_port, on_this_machine


@pytest.fixture(scope="session")
def master():
    """A ROS master for all tests of this process. The process is the node `/test`."""
    import rospy  # pylint: disable=import-outside-toplevel
    port = free_port()
    os.environ.update(on_this_machine(ROS_MASTER_URI="http://localhost:%d" % port))
    with Process(["roscore", "-p", port]) as core:
        core.waitForText("started core service", 60.0)
        rospy.init_node("test", disable_signals=True)
        yield
        rospy.signal_shutdown("the tests are over")
