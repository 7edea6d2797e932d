# The example of a plant in another package: it is built in a workspace on top of this one and works with both drivers.
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess

import pytest

from processes import find_program, output_of, roslaunch, run_experiment
from rooms import CHECKOUT
from run_files import differences, expected_files, read_rows, read_yaml

CART = ["--preset", "debug", "--plant", "ddm_cart/cart"]
PLANT_KEYS = ["type", "max_torque", "dt", "start_std", "image_size", "mass", "friction", "track", "goal"]


@pytest.fixture(name="example", scope="module", autouse=True)
def build(tmp_path_factory):
    """Builds the example as its page describes, and sources its workspace."""
    workspace = tmp_path_factory.mktemp("ws")
    (workspace / "src").mkdir()
    (workspace / "src" / "ddm_cart").symlink_to(os.path.join(CHECKOUT, "examples", "ddm_cart"))
    output_of(["catkin_make", "-C", workspace, "-j1"], 300.0)
    text = subprocess.check_output(["bash", "-c", '. "$1" && env -0', "bash", workspace / "devel" / "setup.bash"],
                                   universal_newlines=True)
    os.environ.update(line.split("=", 1) for line in text.split("\0") if line)


def test_both_drivers_and_sweep_run_it_with_its_own_keys_and_columns(tmp_path):
    process, nodes = str(tmp_path / "process"), str(tmp_path / "nodes")
    run_experiment(*CART, "--trials", 1, "--out", process)
    output = roslaunch(str(tmp_path), "experiment.launch", "preset:=debug", "plant:=ddm_cart/cart", "trials:=1",
                       "runs:=" + nodes)
    assert differences(process, nodes, [name for name in expected_files(1) if not name.endswith(".bag")]) == [], output
    header, *rows = read_rows(process, "evaluation_000", "torques.csv")
    assert header == ["step", "force_n", "exploratory"] and any(abs(float(row[1])) > 0.0 for row in rows)
    header, *rows = read_rows(process, "trial_000", "trajectory.csv")
    assert header == ["step", "time_s", "x_m", "rate_m_per_s"]
    assert len({row[2] for row in rows}) > 20  # the cart moves
    config = read_yaml(process, "config.yaml")
    assert list(config["plant"]) == PLANT_KEYS and config["goal"]["error_unit"] == "m"
    assert (config["plant"]["type"], config["plant"]["friction"]) == ("ddm_cart/Cart", 2.0)
    output = output_of([find_program("sweep"), *CART, "--seeds", "1:2", "--trials", "0", "--out", tmp_path / "sweep"])
    assert read_rows(tmp_path, "sweep", "sweep.csv")[1][:3] == ["1", "0", "30"], output


def test_simulate_knows_the_plant(tmp_path):
    (tmp_path / "torques.csv").write_text("force_n\n2\n2\n")
    with open(tmp_path / "torques.csv") as stream:
        text = subprocess.check_output([find_program("simulate", "ddm_sim"), "--plant", "ddm_cart/cart", "--start", "0.1,0"],
                                       stdin=stream, universal_newlines=True)
    assert text.startswith("step,time_s,x_m,rate_m_per_s\n0,0,0.1")
    # For a constant force of 2 N, x = 0.1 + t - (1 - exp(-2 t)) / 2.
    assert float(text.splitlines()[3].split(",")[2]) == pytest.approx(0.1 + 0.4 - (1.0 - 0.449328964) / 2.0, abs=1e-7)


def test_its_keys_are_checked_and_an_unknown_plugin_or_plant_is_told_what_there_is(tmp_path):
    for words, config, plant in (
            (["unknown key plant/masss", "mass?", "plant/goal", "mpc/horizon"],
             "plant: {masss: 1.0, goal: 3.0}\nmpc: {horizon: 0}\n", "ddm_cart/cart"),
            (["unknown key plant/gravity"], "plant: {gravity: 9.8}\n", "ddm_cart/cart"),
            (["ddm_cart/Kart", "moving_tile, mujoco, pendulum, two_link, ddm_cart/Cart"], "plant: {type: ddm_cart/Kart}\n", "ddm_cart/cart"),
            (["unknown plant 'ddm_cart/kart'", "package ddm_cart cart", "pendulum_gravity"], "", "ddm_cart/kart"),
            (["unknown plant 'no_cart/cart'", "package no_cart", "setup.bash"], "", "no_cart/cart")):
        (tmp_path / "refused.yaml").write_text(config)
        run_experiment("--preset", "debug", "--plant", plant, "--config", tmp_path / "refused.yaml", "--out", tmp_path / "out",
                       code=2, words=words)
        assert not (tmp_path / "out").exists()


def test_from_one_random_trial_the_model_learns_to_stop_the_cart_at_its_goal(tmp_path):
    run_experiment("--preset", "efficient", "--plant", "ddm_cart/cart", "--trials", 0, "--out", tmp_path / "out")
    x = [float(row[2]) for row in read_rows(tmp_path, "out", "evaluation_000", "trajectory.csv")[1:]]
    assert abs(x[0]) < 0.4 and max(abs(position - 0.6) for position in x[-10:]) < 0.05
