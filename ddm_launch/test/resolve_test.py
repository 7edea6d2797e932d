# resolve: what the launch files take their configuration from.
# SPDX-License-Identifier: BSD-3-Clause
import os

import roslib.packages
import yaml

from processes import call, find_program, needs_mujoco
from scratch_case import ScratchCase


class ResolveTest(ScratchCase):
    def resolve(self, *arguments):
        """What is printed, read as YAML. The home folder is that of the test."""
        code, output = call([find_program("experiment_node"), "resolve"] + list(arguments), folder=self.scratch,
                            environment=dict(os.environ, HOME=self.scratch))
        self.assertEqual(code, 0, output)
        return yaml.safe_load(output)

    def assertRefused(self, words, *arguments, code=2):
        actual, output = call([find_program("experiment_node"), "resolve"] + list(arguments), folder=self.scratch)
        self.assertEqual(actual, code, output)
        for word in words:
            self.assertIn(word, output)

    def test_an_option_with_an_empty_value_counts_as_not_given(self):
        self.assertEqual(self.resolve("--preset", "", "--plant", "", "--set", "experiment/seed=", "--crop", "",
                                      "--model", "", "--bags", "--config", ""), self.resolve())

    def test_a_saved_configuration_wins_over_the_defaults_of_a_launch_file_and_options_win_over_both(self):
        self.write("run/config.yaml", "version: 2\nexperiment: {preset: debug, plant: pendulum, method: ddm}\n"
                   "evaluation: {goal_distance: 0.7}\n")
        for words, distance in ((["--repeat", "run"], 0.7), (["--config", "run/config.yaml"], 0.7),
                                (["--repeat", "run", "--set", "evaluation/goal_distance=0.9"], 0.9), ([], 0.3)):
            blocks = self.resolve("--defaults", "launch/robot", *words)
            self.assertEqual(float(blocks["evaluation"]["goal_distance"]), distance, words)
            self.assertEqual(blocks["experiment"]["preset"], "debug" if words else "efficient")
        self.assertRefused(["run/config.yaml", "preset debug, not paper"], "--repeat", "run", "--preset", "paper", code=1)

    def test_a_simulated_robot_has_the_motors_of_its_plant(self):
        for plant, limits in (("pendulum", 6.0), ("moving_tile", [5.0, 5.0]), ("two_link", [4.0, 2.0])):
            blocks = self.resolve("--motors-of", plant)
            self.assertEqual(blocks["robot"]["max_torque"], limits, plant)
            self.assertEqual(blocks["model"]["max_torque"], limits, plant)

    def test_paths_are_those_of_the_folder_where_it_was_called(self):
        blocks = self.resolve("--runs", "runs/one", "--model", "m.ddm", "--bags", "a.bag", "/b.bag",
                              "--set", "robot/goal_file=goal.png")
        bags = [self.file("a.bag"), "/b.bag"]
        self.assertEqual(blocks["experiment"]["runs"], self.file("runs/one"))
        self.assertEqual((blocks["start"]["model"], blocks["start"]["bags"]), (self.file("m.ddm"), bags))
        self.assertEqual(blocks["robot"]["goal_file"], self.file("goal.png"))

    @needs_mujoco
    def test_a_model_file_is_found_from_any_folder_and_brings_its_motors(self):
        with open(os.path.join(roslib.packages.get_pkg_dir("ddm_sim"), "models", "arm.urdf")) as urdf:
            self.write("robot.urdf", urdf.read())
        os.makedirs(self.file("here"))
        plant = {"type": "mujoco", "model": "robot.urdf", "motors": ["shoulder", "elbow"], "max_torque": [1.0, 0.4],
                 "dt": 0.2, "tolerance": 10.0, "camera_position": [0.0, -0.3, 1.6], "camera_look_at": [0.0, 0.0, 0.0]}
        for model in ("robot.urdf", "here/../robot.urdf", self.file("robot.urdf")):
            self.write("robot.yaml", yaml.dump({"plant": dict(plant, model=model)}))
            self.assertEqual(self.resolve("--plant", "robot.yaml")["plant"]["model"], self.file("robot.urdf"))
        mjcf = {"plant": {"type": "mujoco", "model": "package://ddm_sim/models/suite_reacher.xml", "dt": 0.1,
                          "tolerance": 5.0, "camera": "fixed"}}
        for limits in ({}, {"max_torque": []}, {"max_torque": 0.05}):
            mjcf["plant"].update(limits)
            self.write("mjcf.yaml", yaml.dump(mjcf))
            blocks = self.resolve("--plant", "./mjcf.yaml")
            self.assertEqual(blocks["experiment"]["plant"], self.file("mjcf.yaml"))
            self.assertEqual(blocks["plant"]["model"], mjcf["plant"]["model"])
            self.assertEqual([blocks[block]["max_torque"] for block in ("model", "mpc")], [[0.05, 0.05]] * 2)
            self.assertEqual(blocks["controller"]["torque_dim"], 2)

    def test_paths_in_a_file_start_at_its_folder_and_those_of_arguments_where_it_was_called(self):
        self.write("plants/robot.yaml", "plant: {max_torque: 2.0}\nrobot: {goal_file: goal.png}\n")
        self.write("more/start.yaml", "start: {bags: [a.bag]}\n")
        blocks = self.resolve("--plant", "plants/robot.yaml", "--config", "more/start.yaml")
        self.assertEqual(blocks["experiment"]["plant"], self.file("plants/robot.yaml"))
        self.assertEqual(blocks["robot"]["goal_file"], self.file("plants/goal.png"))
        self.assertEqual(blocks["start"]["bags"], [self.file("more/a.bag")])
        blocks = self.resolve("--plant", "plants/robot.yaml", "--set", "robot/goal_file=goal.png", "--bags", "a.bag")
        self.assertEqual(blocks["robot"]["goal_file"], self.file("goal.png"))
        self.assertEqual(blocks["start"]["bags"], [self.file("a.bag")])

    def test_a_controller_waits_at_least_two_time_steps_of_its_robot(self):
        slow = ["--set", "robot/dt=3"]
        self.assertRefused(["controller/timeout must be at least 2 robot/dt", "6 s", "got 5"], *slow, code=1)
        self.assertEqual(float(self.resolve(*slow, "--set", "controller/timeout=6")["controller"]["timeout"]), 6.0)
        self.assertEqual(float(self.resolve("--set", "robot/dt=2.5")["controller"]["timeout"]), 5.0)

    def test_a_crop_is_four_numbers(self):
        self.assertEqual(self.resolve("--crop", "1,2,30,40")["robot"]["crop"], [1, 2, 30, 40])
        for crop in ("1,2,3", "1,2,3,4,5", "a,2,3,4"):
            self.assertRefused(["--crop", crop], "--crop", crop)

    def test_one_value_can_be_printed_and_the_status_of_actions_is_rare_in_simulated_time(self):
        self.write("real_time.yaml", "sim: {lockstep: false}\n")
        for words, lockstep, frequency in (([], True, 0.1), (["--config", "real_time.yaml"], False, 5.0)):
            self.assertIs(self.resolve(*words, "--print", "sim/lockstep"), lockstep)
            self.assertEqual(self.resolve(*words, "--print", "status_frequency"), frequency)

    def test_a_value_may_be_a_list(self):
        model = self.resolve("--set", "model/encoder_widths=[30, 12]", "--set", "model/max_torque=[2.5]")["model"]
        self.assertEqual((model["encoder_widths"], model["max_torque"]), ([30, 12], [2.5]))
        self.assertRefused(["--set model/encoder_widths=[30"], "--set", "model/encoder_widths=[30, {]")

    def test_a_tilde_is_the_home_folder_where_no_shell_has_expanded_it(self):
        blocks = self.resolve("--runs=~/runs", "--model", "~/m.ddm", "--bags", "~/a.bag", "--set", "robot/goal_file=~/g.png")
        self.assertEqual(blocks["experiment"]["runs"], self.file("runs"))
        self.assertEqual((blocks["start"]["model"], blocks["start"]["bags"]), (self.file("m.ddm"), [self.file("a.bag")]))
        self.assertEqual(blocks["robot"]["goal_file"], self.file("g.png"))
        self.assertEqual(self.resolve("--path", "~root/a"), os.path.expanduser("~root/a"))
        self.assertEqual(self.resolve("--path", "./~/a"), self.file("~/a"))

    def test_bags_may_be_one_text(self):
        for name in ("a b.bag", "it's.bag", "c.bag"):
            self.write(name, "")
        for text, names in (("a b.bag", ["a b.bag"]), ("it's.bag  c.bag", ["it's.bag", "c.bag"]),
                            ("'no such.bag' \"it's.bag\"", ["no such.bag", "it's.bag"]), ("~/c.bag x.bag", ["c.bag", "x.bag"])):
            self.assertEqual(self.resolve("--bags", text)["start"]["bags"], [self.file(name) for name in names])

    def test_a_shipped_preset_is_known_where_no_workspace_is_sourced(self):
        preset = os.path.join(roslib.packages.get_pkg_dir("ddm_launch"), "config", "presets", "efficient.yaml")
        code, output = call([find_program("train_from_bags", "ddm_model"), "--config", preset, "--out", self.file("m.ddm"),
                             "no.bag"], environment={"HOME": self.scratch})
        self.assertEqual(code, 1)
        self.assertIn("no.bag", output)
        self.assertNotIn("unknown block", output)

    def test_bad_arguments_and_files_are_named(self):
        self.assertRefused(["--set", "seed"], "--set", "seed")
        self.assertRefused(["unknown preset 'papier'"], "--preset", "papier", code=1)
        self.assertRefused(["no.yaml"], "--config", "no.yaml", code=1)
        self.assertRefused(["mpc/horizon", "many"], "--set", "mpc/horizon=many", code=1)
