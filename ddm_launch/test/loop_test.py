# Experiments with ROS nodes: files, terminal and bags, interruptions, and launches that are refused.
# SPDX-License-Identifier: BSD-3-Clause
import signal

import pytest

from processes import free_port, roslaunch, run_experiment, start_roslaunch
from run_files import differences, expected_files, files_in, read_rows, read_yaml

TRIALS = 1


def experiment(out, trials, *more):
    return ["experiment.launch", "preset:=debug", "plant:=pendulum", "seed:=1", "trials:=%d" % trials, "runs:=%s" % out, *more]


def test_all_files_of_the_contract_are_written_and_the_terminal_shows_each_trial(tmp_path):
    out = str(tmp_path / "out")
    # relative to the folder of the call
    output = roslaunch(str(tmp_path), *experiment("out", TRIALS), folder=str(tmp_path))
    assert files_in(out) == expected_files(TRIALS), output
    assert read_yaml(out, "summary.yaml")["finished"] is True
    for k in range(TRIALS + 1):
        assert "trial  %d/%d" % (k, TRIALS) in output
    assert "results: %s/trials.csv" % out in output
    assert not [word for word in ("WARN", "ERROR", "FATAL", "Traceback") if word in output], output


def test_a_second_launch_is_refused_and_an_interrupted_experiment_goes_on_later(tmp_path):
    port, out = free_port(), str(tmp_path / "out")
    with start_roslaunch(str(tmp_path), *experiment(out, 999, "view:=true"), port=port) as launch:
        launch.waitForText("trial  0/999", 120.0)
        second = start_roslaunch(str(tmp_path), *experiment(tmp_path / "second", 1, "view:=true"), port=0,
                                 variables={"ROS_MASTER_URI": "http://localhost:%d" % port})
        second.waitForEnd(120.0)
        assert "is running already" in second.output
        assert not (tmp_path / "second").exists()
        launch.waitForText("trial %2d/999" % (len(read_rows(out, "trials.csv")) + 1), 120.0)
        assert "has died" not in launch.output and "finished cleanly" not in launch.output
        launch.send_signal(signal.SIGINT)
        launch.waitForEnd(120.0)
    assert "summary.yaml" not in files_in(out)
    finished = len(read_rows(out, "trials.csv")) - 1
    output = roslaunch(str(tmp_path), *experiment(out, finished))
    assert "after trial %d" % (finished - 1) in output
    run_experiment("--preset", "debug", "--seed", 1, "--trials", finished, "--out", tmp_path / "process")
    # The stamps in bags are another simulated time.
    names = [name for name in expected_files(finished) if not name.endswith((".bag", "config.yaml"))]
    assert differences(tmp_path / "process", out, names) == []


# This test makes one mistake of each kind. resolve_test.py and configuration_test.cpp test more mistakes.
@pytest.mark.parametrize("words, arguments, config", [
    (["unknown plant 'windmill'", "pendulum_gravity"], ["plant:=windmill"], ""),
    (["controller/timeot", "timeout"], [], "controller: {timeot: 1.0}\n"),
    (["experiment/method", "oracle"], [], "experiment: {method: oracle}\n")])
def test_a_mistake_is_named_on_the_terminal_and_leaves_no_folder(tmp_path, words, arguments, config):
    (tmp_path / "differs.yaml").write_text(config)
    output = roslaunch(str(tmp_path), "experiment.launch", "preset:=debug", "trials:=0", "config:=%s" % (tmp_path / "differs.yaml"),
                       "runs:=%s" % (tmp_path / "out"), *arguments)
    assert all(word in output for word in words), output
    assert not (tmp_path / "out").exists()


def test_nodes_that_never_appear_are_named_and_leave_no_folder(tmp_path):
    (tmp_path / "impatient.yaml").write_text("experiment: {timeout: 2.0}\n")
    output = roslaunch(str(tmp_path), *experiment(tmp_path / "out", 1, "config:=%s" % (tmp_path / "impatient.yaml"),
                                                  "simulator_here:=false"))
    assert "REQUIRED process [experiment_node" in output and "exit code 1" in output
    assert not (tmp_path / "out").exists()
