# A launch whose nodes are running already, under the same master.
# SPDX-License-Identifier: BSD-3-Clause
import os

from processes import free_port, start_roslaunch
from run_files import files_in
from scratch_case import ScratchCase
from sweeps import wait_for


class SecondLaunchTest(ScratchCase):
    def setUp(self):
        super().setUp()
        port = free_port()
        self.first = start_roslaunch(self.file("ros"), "experiment.launch", "preset:=debug", "trials:=999", "view:=true",
                                     "runs:=" + self.out, port=port)
        self.addCleanup(self.first.stop)
        self.master = {"ROS_MASTER_URI": "http://localhost:%d" % port}

    def waitForModel(self):
        """The first launch has trained one more model."""
        models = len([name for name in files_in(self.out) if name.endswith("model.ddm")]) if os.path.exists(self.out) else 0
        wait_for(lambda: os.path.exists(os.path.join(self.out, "trial_%03d" % models, "model.ddm")), "a model", 60.0)

    def test_the_second_is_refused_and_the_first_goes_on(self):
        self.waitForModel()
        second = start_roslaunch(self.file("ros"), "experiment.launch", "preset:=debug", "view:=true",
                                 "runs:=" + self.file("second"), port=0, variables=self.master)
        self.addCleanup(second.stop)
        second.waitForEnd(60.0)
        self.assertRegex(second.output, r"node /\w+ is running already")
        self.assertFalse(os.path.exists(self.file("second")))
        self.waitForModel()
        self.waitForModel()
        self.assertNotIn("has died", self.first.output)
        self.assertNotIn("finished cleanly", self.first.output)
