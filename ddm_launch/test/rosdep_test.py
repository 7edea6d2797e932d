# `rosdep install` finds everything that the packages ask for, on Debian, and with Noetic or ROS-O.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import unittest
import xml.etree.ElementTree

import yaml

TEST = os.path.dirname(os.path.realpath(__file__))
MANIFESTS = glob.glob(os.path.join(TEST, "..", "..", "*", "package.xml")) + \
    glob.glob(os.path.join(TEST, "..", "..", "examples", "*", "package.xml"))


def tags(end):
    """Texts of the tags in all manifests whose names end like this."""
    return {element.text.strip() for path in MANIFESTS for element in xml.etree.ElementTree.parse(path).getroot()
            if element.tag.endswith(end)}


class RosdepTest(unittest.TestCase):
    def test_every_key_exists_in_the_lists_of_rosdep(self):
        with open(os.path.join(TEST, "rosdep_keys.yaml")) as stream:
            known = yaml.safe_load(stream)
        keys = set(known["system"]).union(*known["ros"].values())
        used = tags("depend") - tags("name")
        self.assertGreater(len(used), 40)
        self.assertEqual(sorted(used - keys), [], "rosdep has no such key, or rosdep_keys.yaml lacks it")
        self.assertEqual(sorted(keys - used), [], "no package.xml names these any more")

    def test_what_some_systems_do_not_have_is_no_dependency(self):
        self.assertEqual([key for key in tags("depend") if "mujoco" in key or "egl" in key], [])
