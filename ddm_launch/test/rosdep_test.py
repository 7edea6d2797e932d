# `rosdep install` finds all dependencies of the packages on Debian, with Noetic and with ROS-O.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import xml.etree.ElementTree

import yaml

from rooms import CHECKOUT, PACKAGE

MANIFESTS = [path for pattern in ("*", "examples/*") for path in glob.glob(os.path.join(CHECKOUT, pattern, "package.xml"))]


def tags(end):
    """Texts of all tags in the manifests whose names end with `end`."""
    return {element.text.strip() for path in MANIFESTS for element in xml.etree.ElementTree.parse(path).getroot()
            if element.tag.endswith(end)}


def test_every_key_exists_in_the_lists_of_rosdep():
    with open(os.path.join(PACKAGE, "test", "rosdep_keys.yaml")) as stream:
        known = yaml.safe_load(stream)
    keys, used = set(known["system"]).union(*known["ros"].values()), tags("depend") - tags("name")
    assert len(used) > 40
    assert used == keys, "rosdep has no such key, rosdep_keys.yaml lacks it, or no package.xml names it any more"
    # Some systems do not have these packages, so they must not be dependencies.
    assert not [key for key in used if "mujoco" in key or "egl" in key]
