# Launch files with paths that mean something to a shell, to YAML or to roslaunch.
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess

import yaml

from processes import call, find_program, roslaunch
from run_files import expected_files, files_in, read_yaml
from scratch_case import ScratchCase

ODD = "it's a \"run\" #1: {x}, \\y & 100%"


class LaunchPathsTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.odd = self.file("home", ODD)
        os.makedirs(self.odd)
        self.variables = {"HOME": self.file("home"), "PWD": "/nowhere"}

    def parameters(self, launch, *arguments):
        """What a launch file would set; `configuration` also read as YAML."""
        done = subprocess.run(["roslaunch", "--dump-params", "ddm_launch", launch, *arguments], stdout=subprocess.PIPE,
                              env=dict(os.environ, **self.variables), cwd=self.scratch, check=True)
        values = yaml.safe_load(done.stdout)
        return values, yaml.safe_load(values["/configuration"])

    def test_launch_files_get_all_their_paths(self):
        there = "~/%s/" % ODD
        for name in ("more.yaml", "a.bag", "b.bag"):
            self.write(os.path.join(self.odd, name), "sim: {lockstep: false}\n" if name == "more.yaml" else "")
        values, blocks = self.parameters("experiment.launch", "runs:=010", "model:=" + there + "m.ddm",
                                         "bags:=" + there + "a.bag", "config:=" + there + "more.yaml")
        self.assertEqual(blocks["experiment"]["runs"], self.file("010"))
        self.assertEqual(blocks["start"], dict(blocks["start"], model=self.odd + "/m.ddm", bags=[self.odd + "/a.bag"]))
        self.assertEqual(values["/run_trial/actionlib_status_frequency"], 5.0)  # as the file says: real time
        self.assertIs(values["/use_sim_time"], False)
        _, blocks = self.parameters("robot.launch", "runs:=" + there + "run", "camera:=c", "goal:=" + there + "goal.png")
        self.assertEqual((blocks["robot"]["goal_file"], blocks["experiment"]["runs"]),
                         (self.odd + "/goal.png", self.odd + "/run"))
        values, blocks = self.parameters("record.launch", "bag:=" + there + "a.bag", "model:=true")
        self.assertEqual((values["/trial_node/run/bag"], values["/trial_node/run/model"]),
                         (self.odd + "/a.bag", self.file("true")))
        values, _ = self.parameters("control.launch", "model:=" + there + "m.ddm")
        self.assertEqual(values["/trial_node/run/model"], self.odd + "/m.ddm")
        self.assertNotIn("/trial_node/run/bag", values)
        values, _ = self.parameters("replay.launch", "bag:=" + there + "a.bag", "model:=7", "out:=" + there + "o.csv")
        self.assertEqual([values["/replay_node/replay/" + name] for name in ("bag", "model", "out")],
                         [self.odd + "/a.bag", self.file("7"), self.odd + "/o.csv"])

    def test_an_experiment_runs_and_its_model_is_evaluated_in_a_folder_with_such_a_name(self):
        _, output = roslaunch(self.file("ros"), "experiment.launch", "preset:=debug", "trials:=0", "runs:=~/%s" % ODD,
                              folder=self.scratch, variables=self.variables)
        self.assertEqual(files_in(self.odd), expected_files(0), output)
        out = self.file("20:40")
        code, output = call([find_program("evaluate"), "--preset", "debug", "--model", "~/%s/trial_000/model.ddm" % ODD,
                             "--seeds", "20:21", "--out=" + out], environment=dict(os.environ, **self.variables))
        self.assertEqual(code, 0, output)
        summary = read_yaml(out, "evaluation.yaml")
        self.assertEqual((summary["seeds"], summary["model"]), ("20:21", self.odd + "/trial_000/model.ddm"))
        self.assertIsInstance(summary["id"], str)
        self.assertIsInstance(summary["success_rate"], float)
