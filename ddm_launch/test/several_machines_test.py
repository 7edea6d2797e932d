# Plant, controller and trainer on three machines without a shared disk: the experiment is that of one process.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import unittest

from namespaces import Network, nft_rule, why_no_nft
from processes import Process, line_by_line, run_experiment
from run_files import differences, expected_files, files_in
from scratch_case import ScratchCase

TRIALS = 1
HINDRANCE = why_no_nft()


@unittest.skipIf(HINDRANCE, "SEVERAL MACHINES ARE NOT TESTED: %s" % HINDRANCE)
class SeveralMachinesTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.disk, self.reference = self.file("disk"), self.file("reference")
        os.mkdir(self.disk)
        self.network = Network()
        self.addCleanup(self.network.close)

    def startOn(self, machine, master, *words):
        """roslaunch on a machine, with what doc/reference/network.md says to set there."""
        address, enter = machine
        environment = dict(line_by_line(), ROS_MASTER_URI="http://%s:11311" % master, ROS_IP=address,
                           ROS_HOME=os.path.join(self.disk, "ros"))
        environment.pop("ROS_HOSTNAME", None)
        launch = Process(enter + ["roslaunch"] + list(words), environment)
        self.addCleanup(launch.stop)
        return launch

    def test_three_machines_give_the_torques_and_models_of_one_process(self):
        trainer = self.network.addMachine([])
        plant, controller = self.network.addMachine([self.disk]), self.network.addMachine([self.disk])
        for _, enter in (trainer, plant, controller):
            self.network.load(enter, nft_rule(peers=True))
        runs = os.path.join(self.disk, "runs")
        same = ["preset:=debug"]
        parts = [self.startOn(machine, trainer[0], "--wait", "ddm_launch", "part.launch", part + ":=true", *same)
                 for machine, part in ((plant, "simulator"), (controller, "controller"))]
        experiment = self.startOn(trainer, trainer[0], "ddm_launch", "experiment.launch", "simulator_here:=false",
                                  "controller_here:=false", "seed:=1", "trials:=%d" % TRIALS, "runs:=" + runs, *same)
        experiment.waitForEnd(90.0)
        for part in parts:
            part.send(signal.SIGINT)
            part.waitForEnd(20.0)
        output = "\n".join(launch.output for launch in [experiment] + parts)
        self.assertEqual(files_in(runs), expected_files(TRIALS), output)
        for started, launch in zip((["sim_node"], ["mpc_node"]), parts):
            self.assertEqual([name for name in ("sim_node", "mpc_node", "model_node", "trial_recorder")
                              if "process[%s-" % name in launch.output], started)
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", TRIALS, "--out", self.reference)
        self.assertEqual(code, 0, output)
        names = [name for name in expected_files(TRIALS) if not name.endswith((".bag", "config.yaml"))]
        self.assertEqual(differences(self.reference, runs, names), [])
