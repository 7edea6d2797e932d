# Launch files accept paths with characters that are special in a shell, in YAML or for roslaunch.
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess

import yaml

from processes import find_program, output_of, roslaunch
from run_files import expected_files, files_in, read_yaml

ODD = "it's a \"run\" #1: {x}, \\y & 100%"


def test_launch_files_get_all_their_paths(tmp_path):
    odd, there, home = tmp_path / ODD, "~/%s/" % ODD, dict(os.environ, HOME=str(tmp_path), PWD="/nowhere")
    odd.mkdir()
    (odd / "more.yaml").write_text("sim: {lockstep: false}\n")
    for name in ("a.bag", "b.bag"):
        (odd / name).write_text("")

    def parameters(launch, *arguments):
        """Returns (parameters that a launch file would set, content of the parameter `configuration`)."""
        values = yaml.safe_load(subprocess.check_output(["roslaunch", "--dump-params", "ddm_launch", launch, *arguments], env=home,
                                                        cwd=tmp_path))
        return values, yaml.safe_load(values["/configuration"])

    values, blocks = parameters("experiment.launch", "runs:=010", "model:=" + there + "m.ddm", "bags:=" + there + "a.bag",
                                "config:=" + there + "more.yaml")
    assert blocks["experiment"]["runs"] == str(tmp_path / "010")
    assert (blocks["start"]["model"], blocks["start"]["bags"]) == (str(odd / "m.ddm"), [str(odd / "a.bag")])
    assert values["/use_sim_time"] is False  # from the file
    _, blocks = parameters("robot.launch", "runs:=" + there + "run", "camera:=c", "crop:=1,2,30,40", "goal:=" + there + "goal.png")
    assert (blocks["robot"]["goal_file"], blocks["experiment"]["runs"]) == (str(odd / "goal.png"), str(odd / "run"))
    assert blocks["robot"]["crop"] == [1, 2, 30, 40]
    values, _ = parameters("record.launch", "bag:=" + there + "a.bag", "model:=true")
    assert (values["/trial_node/run/bag"], values["/trial_node/run/model"]) == (str(odd / "a.bag"), str(tmp_path / "true"))
    values, _ = parameters("control.launch", "model:=" + there + "m.ddm")
    assert values["/trial_node/run/model"] == str(odd / "m.ddm") and "/trial_node/run/bag" not in values
    values, _ = parameters("replay.launch", "bag:=" + there + "a.bag", "model:=7", "out:=" + there + "o.csv")
    assert [values["/replay_node/replay/" + name] for name in ("bag", "model", "out")] == [
        str(odd / "a.bag"), str(tmp_path / "7"), str(odd / "o.csv")]


def test_an_experiment_runs_and_its_model_is_evaluated_in_a_folder_with_such_a_name(tmp_path):
    odd, home, out = str(tmp_path / ODD), {"HOME": str(tmp_path)}, str(tmp_path / "20:40")
    output = roslaunch(str(tmp_path / "ros"), "experiment.launch", "preset:=debug", "trials:=0", "runs:=~/%s" % ODD,
                       folder=str(tmp_path), variables=home)
    assert files_in(odd) == expected_files(0), output
    output_of([find_program("evaluate"), "--preset", "debug", "--model", "~/%s/trial_000/model.ddm" % ODD, "--seeds",
               "20:21", "--out=" + out], environment=dict(os.environ, **home))
    summary = read_yaml(out, "evaluation.yaml")
    assert (summary["seeds"], summary["model"]) == ("20:21", odd + "/trial_000/model.ddm")
    assert isinstance(summary["id"], str) and isinstance(summary["success_rate"], float)
