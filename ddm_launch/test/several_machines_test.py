# Plant, controller and trainer on three machines without a shared disk give the same result as one process.
# SPDX-License-Identifier: BSD-3-Clause
import signal

import pytest

from namespaces import Network, nft_rule, why_no_nft
from processes import Process, line_by_line, run_experiment
from run_files import differences, expected_files, files_in

HINDRANCE = why_no_nft()


@pytest.mark.skipif(bool(HINDRANCE), reason="SEVERAL MACHINES ARE NOT TESTED: %s" % HINDRANCE)
def test_three_machines_give_the_torques_and_models_of_one_process(tmp_path):
    disk, reference = tmp_path / "disk", str(tmp_path / "reference")
    disk.mkdir()
    runs = str(disk / "runs")
    with Network() as network:
        trainer = network.addMachine([])
        plant, controller = network.addMachine([str(disk)]), network.addMachine([str(disk)])
        for _, enter in (trainer, plant, controller):
            network.load(enter, nft_rule(peers=True))

        def start(machine, *words):
            """Starts roslaunch on a machine, with the environment that doc/reference/network.md describes."""
            environment = dict(line_by_line(), ROS_MASTER_URI="http://%s:11311" % trainer[0], ROS_IP=machine[0],
                               ROS_HOME=str(disk / "ros"))
            environment.pop("ROS_HOSTNAME", None)
            return Process(machine[1] + ["roslaunch", *words, "preset:=debug"], environment)

        with start(plant, "--wait", "ddm_launch", "part.launch", "simulator:=true") as first, \
                start(controller, "--wait", "ddm_launch", "part.launch", "controller:=true") as second, \
                start(trainer, "ddm_launch", "experiment.launch", "simulator_here:=false", "controller_here:=false", "seed:=1",
                      "trials:=1", "runs:=" + runs) as experiment:
            experiment.waitForEnd(200.0)
            for part in (first, second):
                part.send_signal(signal.SIGINT)
                part.waitForEnd(120.0)
    assert files_in(runs) == expected_files(1), experiment.output + first.output + second.output
    for part, started in ((first, ["sim_node"]), (second, ["mpc_node"])):
        assert [name for name in ("sim_node", "mpc_node", "model_node", "trial_recorder")
                if "process[%s-" % name in part.output] == started
    run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", reference)
    names = [name for name in expected_files(1) if not name.endswith((".bag", "config.yaml"))]
    assert differences(reference, runs, names) == []
