# The ROS nodes and run_experiment write the same files in one experiment, byte by byte except for times.
# SPDX-License-Identifier: BSD-3-Clause
import os

import pytest
import rosbag

from processes import has_mujoco, roslaunch, run_experiment
from run_files import differences, expected_files, files_in, read_rows, read_yaml

TRIALS, SEED = 1, 4
STEP_S = 0.2
ALL_NUISANCES = """\
camera: {noise_std: 0.1, brightness_drift: 0.2, delay: 1, drop_rate: 0.15}
plant: {rod_half_width: 0.05}
model: {predictor: gp, order: 3}
training: {num_starts: 2, prediction_steps: 2, weight_decay: 0.1}
mpc: {offset_gain: 0.3}
"""
EPISODES = """\
model: {blur: 1.0}
mpc: {cost: time}
trial: {episodes: 2}
"""
QUICK = "training: {num_starts: 1, max_iterations: 20}\n"
DRAWN_GOALS = QUICK + "trial: {num_steps: 26, episodes: 1}\nplant: {episode_frames: 150}\nevaluation: {record: true}\n"


def bag_of(folder, name):
    """Returns (times of the images since the first image [steps], times of the torques likewise, contents of the
    goal images)."""
    times, goals = {"camera/image_raw": [], "torque": []}, []
    with rosbag.Bag(os.path.join(folder, name)) as bag:
        for topic, message, _ in bag.read_messages():
            if topic == "goal_image":
                goals.append(message.data)
            else:
                times[topic].append(message.header.stamp.to_sec())
    first = min(times["torque"])
    return [[round((time - first) / STEP_S, 6) for time in times[topic]] for topic in sorted(times)], goals


def check_nuisances(nodes, bags):
    """The disturbances of the argument and of the file are active, and some images are lost."""
    camera = read_yaml(nodes, "config.yaml")["camera"]
    assert (camera["clutter"], camera["noise_std"], camera["delay"]) == (0.6, 0.1, 1)
    for images, torques in (bag[0] for bag in bags.values()):
        assert len(images) == 30 and images == torques and images[-1] > 29 and all(time == int(time) for time in images)
    assert [row[2] for row in read_rows(nodes, "trials.csv")[1:]] == ["30", "60"]


def check_episodes(nodes, bags):
    assert len(bags) == 2 * (TRIALS + 1)
    assert [row[2] for row in read_rows(nodes, "trials.csv")[1:]] == ["60", "120"]


def check_tile(nodes, _):
    """The two torques and the two lengths have the plant's own names; the error is the distance to the goal in
    pixels."""
    assert read_rows(nodes, "trial_001", "torques.csv")[0] == ["step", "dx_px", "dy_px", "exploratory"]
    assert read_rows(nodes, "evaluation_001", "trajectory.csv")[0] == ["step", "time_s", "x_px", "y_px"]
    assert read_yaml(nodes, "config.yaml")["goal"] == {"error_unit": "px", "tolerance": 2.0}


def check_drawn_goals(nodes, bags):
    """Each bag holds the goal of its trial or evaluation. An evaluation has its own length and a return."""
    goals = [goals for _, goals in bags.values()]
    assert len(goals) == 2 * (TRIALS + 1) == len({images[0] for images in goals}) and {len(images) for images in goals} == {1}
    for k in range(TRIALS + 1):
        assert len(read_rows(nodes, "trial_%03d" % k, "torques.csv")) == 1 + 26
        assert len(read_rows(nodes, "evaluation_%03d" % k, "torques.csv")) == 1 + 30
    header, *rows = read_rows(nodes, "trials.csv")
    assert all(0.0 <= float(row[header.index("return")]) <= 30 * 5 for row in rows)


@pytest.mark.parametrize("arguments, config, check", [
    pytest.param({"nuisance": "clutter"}, ALL_NUISANCES, check_nuisances, id="nuisances"),
    pytest.param({"plant": "pendulum"}, EPISODES, check_episodes, id="episodes"),
    pytest.param({"plant": "moving_tile"}, QUICK, check_tile, id="tile"),
    pytest.param({"plant": "suite_reacher_hard"}, DRAWN_GOALS, check_drawn_goals, id="drawn_goals",
                 marks=pytest.mark.skipif(not has_mujoco(), reason="ddm_sim was built without MuJoCo"))])
def test_the_nodes_and_one_process_leave_the_same_files(tmp_path, arguments, config, check):
    nodes, process = str(tmp_path / "nodes"), str(tmp_path / "process")
    (tmp_path / "config.yaml").write_text(config)
    arguments = dict(arguments, preset="debug", seed=SEED, trials=TRIALS, config=tmp_path / "config.yaml")
    output = roslaunch(str(tmp_path), "experiment.launch", "runs:=" + nodes,
                       *["%s:=%s" % item for item in arguments.items()])
    run_experiment("--out", process, *[word for key, value in arguments.items() for word in ("--" + key, value)])
    names = files_in(nodes)
    assert names == files_in(process) and set(expected_files(TRIALS)) <= set(names), output
    assert differences(nodes, process, [name for name in names if not name.endswith(".bag")]) == []
    bags = {name: bag_of(nodes, name) for name in names if name.endswith(".bag")}
    assert bags == {name: bag_of(process, name) for name in bags}
    check(nodes, bags)
