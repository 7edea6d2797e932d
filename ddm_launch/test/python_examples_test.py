# The programs of the page about Python run as the page prints them.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import shutil
import signal
import subprocess
import sys

import numpy as np
import pytest

import pages
from processes import output_of, run_experiment

ddm_sim = pytest.importorskip("ddm_sim")
cv2 = pytest.importorskip("cv2")

PAGE, FOLDER = "doc/python.md", os.path.join("examples", "python")


def run_commands(folder, example, *replacements):
    """Runs the commands of the page that begin with an example. Returns the output."""
    block = next(block for block in pages.blocks(pages.read(PAGE), "bash") if example in block)
    for old, new in (("python3 examples", "%s examples" % sys.executable), *replacements):
        assert old in block
        block = block.replace(old, new)
    os.symlink(os.path.join(pages.CHECKOUT, "examples"), str(folder / "examples"))
    output = output_of(["bash", "-c", "set -e\n" + block], 900.0, folder=str(folder))
    return output


def test_the_first_program_of_the_pages_learns_to_swing_up():
    texts = [pages.blocks(pages.read(page), "python")[0] for page in (PAGE, "README.md")]
    assert texts[0] == texts[1]
    names = {}
    exec(texts[0].replace("range(4)", "range(2)"), names)  # pylint: disable=exec-used
    assert names["model"].info["frames"] == 200 and names["env"].step([0.0])[4]["error"] < 90.0


def test_algorithm_1_prints_the_success_after_each_trial(tmp_path):
    output = run_commands(tmp_path, "algorithm1.py", ("--trials 3", "--trials 1"))
    assert re.findall(r"^trial (\d): (\d+) images, success (\d)$", output, re.MULTILINE) == [("0", "100", "1"), ("1", "200", "1")]


def test_compare_method_writes_tables_that_the_figure_draws(tmp_path):
    run_commands(tmp_path, "compare_method.py", ("--seeds 5", "--seeds 2"))
    tables = [(tmp_path / name).read_text().splitlines() for name in ("ddm.csv", "other.csv")]
    assert [[row.split(",")[:3] for row in table[1:]] for table in tables] == [[["2000", "0", "100"], ["2001", "0", "100"]]] * 2
    assert "1" in [row.split(",")[3] for row in tables[0][1:]] and (tmp_path / "comparison.png").exists()


def write_video(tmp_path):
    env = ddm_sim.make("pendulum")
    image, info = env.reset(seed=1)
    cv2.imwrite(str(tmp_path / "goal.png"), cv2.resize(info["goal_image"], (52, 52)))
    video = cv2.VideoWriter(str(tmp_path / "video.avi"), cv2.VideoWriter_fourcc(*"MJPG"), 5.0, (52, 52))
    random = np.random.RandomState(0)
    for _ in range(100):
        video.write(cv2.cvtColor(cv2.resize(image, (52, 52)), cv2.COLOR_GRAY2BGR))
        image = env.step(random.uniform(-6.0, 6.0, 1))[0]
    video.release()


def test_webcam_robot_learns_from_a_video_and_then_acts(tmp_path):
    write_video(tmp_path)
    run_commands(tmp_path, "webcam_robot.py", (" 0 goal.png", " video.avi goal.png --dt 0"))
    assert cv2.imread(str(tmp_path / "predictions.png")).shape[:2] == (102, 510)


def test_webcam_robot_checks_the_goal_first_and_stops_the_motors_when_it_is_terminated(tmp_path):
    write_video(tmp_path)
    program = "import webcam_robot; webcam_robot.send_torque = lambda u: print(u[0], flush=True); webcam_robot.main()"
    environment = dict(os.environ, PYTHONPATH=os.path.join(pages.CHECKOUT, FOLDER) + ":" + os.environ["PYTHONPATH"])

    def start(goal):
        return subprocess.Popen([sys.executable, "-c", program, "video.avi", goal], cwd=str(tmp_path), env=environment,
                                universal_newlines=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    cv2.imwrite(str(tmp_path / "small.png"), np.zeros((20, 20), np.uint8))
    for goal in ("missing.png", "small.png"):
        output, errors = start(goal).communicate(timeout=100.0)
        assert output == "" and goal in errors and "52 x 52" in errors
    robot = start("goal.png")
    assert float(robot.stdout.readline()) != 0.0
    robot.send_signal(signal.SIGTERM)
    assert float(robot.communicate(timeout=100.0)[0].splitlines()[-1]) == 0.0


def test_from_bags_writes_a_model_and_its_report(tmp_path):
    for seed in (1, 2, 3):
        run = tmp_path / ("run_%d" % seed)
        run_experiment("--preset", "debug", "--trials", 0, "--set", "trial/num_steps=60", "--seed", seed, "--out", run)
        shutil.copy(str(run / "trial_000" / "trial.bag"), str(tmp_path / ("%d.bag" % seed)))
    command = [sys.executable, os.path.join(pages.CHECKOUT, FOLDER, "from_bags.py"), tmp_path / "1.bag"]
    output_of(command + ["--max-torque", "6"], code=2, words=("at least two bags", "1.bag"))
    (tmp_path / "names.yaml").write_text("data_set: {image_topic: eye}")
    output_of(command + [tmp_path / "2.bag", "--max-torque", "6", "--config", tmp_path / "names.yaml"], code=1,
              words=("no topic eye",))
    output = run_commands(tmp_path, "from_bags.py")
    assert "2 episodes with 120 images" in output and (tmp_path / "report" / "report.html").exists()
