# resolve, which computes the configuration of launch files. resolution_test.cpp tests the order of the layers.
# SPDX-License-Identifier: BSD-3-Clause
import os

import pytest
import roslib.packages
import yaml

from processes import find_program, has_mujoco, output_of


class Resolve:
    """Calls resolve in a folder, which is also the home folder."""

    def __init__(self, folder):
        self.folder = folder

    def file(self, name):
        return os.path.normpath(os.path.join(str(self.folder), name))

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)

    def run(self, *arguments, **expected):
        return output_of([find_program("experiment_node"), "resolve", *arguments], folder=str(self.folder),
                         environment=dict(os.environ, HOME=str(self.folder)), **expected)

    def __call__(self, *arguments):
        """Returns the output as YAML."""
        return yaml.safe_load(self.run(*arguments))


@pytest.fixture(name="resolve")
def make(tmp_path):
    return Resolve(tmp_path)


def test_values_win_over_files_and_an_option_with_an_empty_value_counts_as_not_given(resolve):
    resolve.write("more.yaml", "experiment: {seed: 3, trials: 4}\nsim: {lockstep: false}\n")
    blocks = resolve("--preset", "debug", "--config", "more.yaml", "--set", "experiment/trials=5")
    assert [blocks["experiment"][key] for key in ("preset", "seed")] == ["debug", 3]
    # num_steps is that of the preset
    assert int(blocks["experiment"]["trials"]) == 5 and blocks["trial"]["num_steps"] == 30
    assert resolve("--preset", "", "--plant", "", "--set", "experiment/seed=", "--model", "", "--bags",
                   "--config", "") == resolve()
    assert [resolve("--print", "sim/lockstep", *more) for more in ([], ["--config", "more.yaml"])] == [True, False]
    model = resolve("--set", "model/encoder_widths=[30, 12]", "--set", "model/max_torque=[2.5]")["model"]
    assert (model["encoder_widths"], model["max_torque"]) == ([30, 12], [2.5])


def test_a_saved_configuration_wins_over_the_defaults_of_a_launch_file_and_options_win_over_both(resolve):
    resolve.write("run/config.yaml", "version: 2\nexperiment: {preset: debug, plant: pendulum, method: ddm}\n"
                  "evaluation: {goal_distance: 0.7}\n")
    for words, distance in ((["--repeat", "run"], 0.7), (["--config", "run/config.yaml"], 0.7),
                            (["--repeat", "run", "--set", "evaluation/goal_distance=0.9"], 0.9), ([], 0.3)):
        blocks = resolve("--defaults", "launch/robot", *words)
        assert float(blocks["evaluation"]["goal_distance"]) == distance, words
        assert blocks["experiment"]["preset"] == ("debug" if words else "efficient")


def test_a_robot_has_the_motors_of_its_plant_and_a_controller_that_waits_for_two_time_steps(resolve):
    for plant, limits in (("pendulum", 6.0), ("moving_tile", [5.0, 5.0]), ("two_link", [4.0, 2.0])):
        blocks = resolve("--motors-of", plant)
        assert blocks["robot"]["max_torque"] == blocks["model"]["max_torque"] == limits, plant
    slow = ["--set", "robot/dt=3", "--set", "controller/timeout=6"]
    assert float(resolve(*slow)["controller"]["timeout"]) == 6.0


def test_paths_start_at_the_folder_of_their_file_and_those_of_arguments_where_it_was_called(resolve):
    resolve.write("plants/robot.yaml", "plant: {max_torque: 2.0}\nrobot: {goal_file: goal.png}\n")
    resolve.write("more/start.yaml", "start: {bags: [a.bag, /b.bag]}\nexperiment: {plant: ../plants/robot.yaml}\n")
    for name in ("a b.bag", "it's.bag", "c.bag"):
        resolve.write(name, "")
    for arguments, block, key, value in (
            (["--runs", "runs/one"], "experiment", "runs", "runs/one"), (["--runs=~/runs"], "experiment", "runs", "runs"),
            (["--model", "m.ddm"], "start", "model", "m.ddm"), (["--model", "~/m.ddm"], "start", "model", "m.ddm"),
            (["--set", "robot/goal_file=a: #1 = {x}.png"], "robot", "goal_file", "a: #1 = {x}.png"),
            (["--set", "robot/goal_file=~/g.png"], "robot", "goal_file", "g.png"),
            (["--plant", "plants/robot.yaml"], "robot", "goal_file", "plants/goal.png"),
            (["--plant", "plants/robot.yaml"], "experiment", "plant", "plants/robot.yaml"),
            (["--plant", "plants/robot.yaml", "--set", "robot/goal_file=goal.png"], "robot", "goal_file", "goal.png"),
            (["--config", "more/start.yaml"], "start", "bags", ["more/a.bag", "/b.bag"]),
            (["--config", "more/start.yaml"], "experiment", "plant", "plants/robot.yaml"),
            (["--bags", "a.bag", "/b.bag"], "start", "bags", ["a.bag", "/b.bag"]),
            # Several bags may be given in one text.
            (["--bags", "a b.bag"], "start", "bags", ["a b.bag"]), (["--bags", "it's.bag\nc.bag"], "start", "bags", ["it's.bag", "c.bag"]),
            (["--bags", "'no such.bag' \"it's.bag\""], "start", "bags", ["no such.bag", "it's.bag"]),
            (["--bags", "~/c.bag x.bag"], "start", "bags", ["c.bag", "x.bag"])):
        expected = [resolve.file(name) for name in value] if isinstance(value, list) else resolve.file(value)
        assert resolve(*arguments)[block][key] == expected, arguments
    assert resolve("--path", "~root/a") == os.path.expanduser("~root/a")
    for path, expected in (("~", ""), ("./~/a", "~/a"), ("a~", "a~")):
        assert resolve("--path", path) == resolve.file(expected)


@pytest.mark.skipif(not has_mujoco(), reason="ddm_sim was built without MuJoCo")
def test_a_model_file_is_found_from_any_folder_and_brings_its_motors(resolve):
    with open(os.path.join(roslib.packages.get_pkg_dir("ddm_sim"), "models", "arm.urdf")) as urdf:
        resolve.write("robot.urdf", urdf.read())
    plant = {"type": "mujoco", "motors": ["shoulder", "elbow"], "max_torque": [1.0, 0.4], "dt": 0.2, "tolerance": 10.0,
             "camera_position": [0.0, -0.3, 1.6], "camera_look_at": [0.0, 0.0, 0.0]}
    for model in ("robot.urdf", "../%s/robot.urdf" % resolve.folder.name, resolve.file("robot.urdf")):
        resolve.write("robot.yaml", yaml.dump({"plant": dict(plant, model=model)}))
        assert resolve("--plant", "robot.yaml")["plant"]["model"] == resolve.file("robot.urdf")
    mjcf = {"type": "mujoco", "model": "package://ddm_sim/models/suite_reacher.xml", "dt": 0.1, "tolerance": 5.0, "camera": "fixed"}
    for limits in ({}, {"max_torque": []}, {"max_torque": 0.05}):
        resolve.write("mjcf.yaml", yaml.dump({"plant": dict(mjcf, **limits)}))
        blocks = resolve("--plant", "./mjcf.yaml")
        assert blocks["plant"]["model"] == mjcf["model"] and blocks["controller"]["torque_dim"] == 2
        assert [blocks[block]["max_torque"] for block in ("model", "mpc")] == [[0.05, 0.05]] * 2


def test_bad_arguments_and_files_are_named(resolve):
    resolve.write("run/config.yaml", "version: 2\nexperiment: {preset: debug, plant: pendulum, method: ddm}\n")
    for code, words, arguments in (
            *((2, ["--set must be BLOCK/KEY=VALUE, got '%s'" % text], ["--set", text])
              for text in ("seed", "seed=2", "mpc/horizon", "mpc=a/b", "/horizon=2", "mpc/=2")),
            (2, ["--set model/encoder_widths=[30"], ["--set", "model/encoder_widths=[30, {]"]),
            (1, ["unknown preset 'papier'"], ["--preset", "papier"]), (1, ["no.yaml"], ["--config", "no.yaml"]),
            (1, ["mpc/horizon", "many"], ["--set", "mpc/horizon=many"]),
            (1, ["controller/timeout must be at least 2 robot/dt", "6 s", "got 5"], ["--set", "robot/dt=3"]),
            (1, ["run/config.yaml", "preset debug, not paper"], ["--repeat", "run", "--preset", "paper"])):
        resolve.run(*arguments, code=code, words=words)
