# One experiment by the nodes and by run_experiment: both leave the same files, byte by byte but for times.
# SPDX-License-Identifier: BSD-3-Clause
import os

import pytest
import rosbag

from processes import has_mujoco, roslaunch, run_experiment
from run_files import differences, expected_files, read_bag, read_rows, read_yaml, torque_files

TRIALS, SEED = 1, 4
STEP_NS = 200000000
ALL_NUISANCES = """\
camera: {noise_std: 0.1, brightness_drift: 0.2, delay: 1, drop_rate: 0.15}
plant: {rod_half_width: 0.05}
model: {residual: true, increments: true, order: 3}
training: {num_starts: 2, selection_steps: 2, prediction_steps: 2, weight_decay: 0.1}
mpc: {offset_gain: 0.3}
"""
EPISODES = """\
model: {blur: 1.0}
training: {max_delay: 1}
mpc: {cost: time}
trial: {episodes: 2}
"""
QUICK = "training: {num_starts: 1, max_iterations: 20}\n"
DRAWN_GOALS = QUICK + "trial: {num_steps: 26, episodes: 1}\nplant: {episode_frames: 150}\nevaluation: {record: true}\n"


def check_paper(nodes, _):
    for name in torque_files(TRIALS):
        assert len(read_rows(nodes, name)) == 1 + 100


def check_nuisances(nodes, process):
    """Those of the argument and of the file are on; bags have gaps of whole steps, and a trial counts what is seen."""
    camera = read_yaml(nodes, "config.yaml")["camera"]
    assert (camera["clutter"], camera["noise_std"], camera["delay"]) == (0.6, 0.1, 1)
    for k in range(TRIALS + 1):
        gaps = []
        for folder in (nodes, process):
            stamps = read_bag(os.path.join(folder, "trial_%03d" % k, "trial.bag"))
            images = stamps["camera/image_raw"]
            assert len(images) == 30 and images == stamps["torque"]
            gaps.append([after - before for before, after in zip(images, images[1:])])
        assert gaps[0] == gaps[1]
        assert [gap % STEP_NS for gap in gaps[0]] == [0] * 29 and max(gaps[0]) > STEP_NS
    assert [row[2] for row in read_rows(nodes, "trials.csv")[1:]] == ["30", "60"]


def check_episodes(nodes, process):
    """A model learns from both episodes, which begin in different states."""
    names = ["trial_%03d/episode_001/%s" % (k, name) for k in range(TRIALS + 1) for name in ("torques.csv", "trajectory.csv")]
    assert differences(nodes, process, names) == []
    assert [row[2] for row in read_rows(nodes, "trials.csv")[1:]] == ["60", "120"]
    starts = {tuple(read_rows(nodes, "trial_%03d" % k, *episode, "trajectory.csv")[1][2:])
              for k in range(TRIALS + 1) for episode in ((), ("episode_001",))}
    assert len(starts) == 2 * (TRIALS + 1)


def check_tile(nodes, _):
    """Two torques and lengths stand under the plant's own names; the error is the distance to the goal in pixels."""
    torques = read_rows(nodes, "trial_001", "torques.csv")
    assert torques[0] == ["step", "dx_px", "dy_px", "exploratory"]
    assert all(abs(float(cell)) <= 5.0 for row in torques[1:] for cell in row[1:3])
    assert read_rows(nodes, "evaluation_001", "trajectory.csv")[0] == ["step", "time_s", "x_px", "y_px"]
    assert read_yaml(nodes, "config.yaml")["goal"] == {"error_unit": "px", "tolerance": 2.0}
    assert all(row[3] in ("0", "1") and 0.0 <= float(row[5]) <= 51.0 for row in read_rows(nodes, "trials.csv")[1:])


def goal_images(folder, name):
    with rosbag.Bag(os.path.join(folder, name, "trial.bag")) as bag:
        return [message.data for _, message, _ in bag.read_messages(topics=["goal_image"])]


def check_drawn_goals(nodes, process):
    """Each bag holds the goal of its trial or evaluation; an evaluation has its own length and a return."""
    names = ["%s_%03d" % (kind, k) for k in range(TRIALS + 1) for kind in ("trial", "evaluation")]
    goals = {name: goal_images(nodes, name) for name in names}
    assert {name: len(images) for name, images in goals.items()} == {name: 1 for name in names}
    assert len({images[0] for images in goals.values()}) == len(names)
    assert goals == {name: goal_images(process, name) for name in names}
    for k in range(TRIALS + 1):
        assert len(read_rows(nodes, "trial_%03d" % k, "torques.csv")) == 1 + 26
        assert len(read_rows(nodes, "evaluation_%03d" % k, "torques.csv")) == 1 + 30
    header, *rows = read_rows(nodes, "trials.csv")
    for row in (dict(zip(header, row)) for row in rows):
        assert 0.0 <= float(row["return"]) <= 30 * 5
        assert 0.0 < float(row["final_error"]) <= 0.44  # in metres, across the reach of the arm
    assert read_yaml(nodes, "config.yaml")["goal"]["error_unit"] == "m"


@pytest.mark.parametrize("arguments, config, check", [
    pytest.param({"preset": "paper", "plant": "pendulum"}, "", check_paper, id="paper"),
    pytest.param({"preset": "debug", "nuisance": "clutter"}, ALL_NUISANCES, check_nuisances, id="nuisances"),
    pytest.param({"preset": "debug", "plant": "pendulum"}, EPISODES, check_episodes, id="episodes"),
    pytest.param({"preset": "debug", "plant": "moving_tile"}, QUICK, check_tile, id="tile"),
    pytest.param({"preset": "debug", "plant": "suite_reacher_hard"}, DRAWN_GOALS, check_drawn_goals, id="drawn_goals",
                 marks=pytest.mark.skipif(not has_mujoco(), reason="ddm_sim was built without MuJoCo"))])
def test_the_nodes_and_one_process_leave_the_same_files(tmp_path, arguments, config, check):
    nodes, process = str(tmp_path / "nodes"), str(tmp_path / "process")
    (tmp_path / "config.yaml").write_text(config)
    arguments = dict(arguments, seed=SEED, trials=TRIALS, config=tmp_path / "config.yaml")
    _, output = roslaunch(str(tmp_path), "experiment.launch", "runs:=" + nodes,
                          *["%s:=%s" % item for item in arguments.items()])
    assert os.path.exists(os.path.join(nodes, "summary.yaml")), output
    code, output = run_experiment("--out", process, *[word for key, value in arguments.items() for word in ("--" + key, value)])
    assert code == 0, output
    # all files but the bags, whose stamps are another simulated time
    names = [name for name in expected_files(TRIALS) if not name.endswith(".bag")]
    assert len(names) > 8
    assert differences(nodes, process, names) == []
    check(nodes, process)
