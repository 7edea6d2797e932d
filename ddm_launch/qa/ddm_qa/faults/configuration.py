# The configuration of a launch that is running.
# SPDX-License-Identifier: BSD-3-Clause
import rospy
import yaml


def configuration():
    """{block: {key: value}}, as all nodes of the launch have it."""
    return yaml.safe_load(rospy.get_param("configuration"))
