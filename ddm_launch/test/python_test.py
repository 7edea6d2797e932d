# Python bindings: the same results as run_experiment, the Gymnasium interface, Ctrl-C, threads and messages.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import signal
import subprocess
import sys
import threading
import types

import numpy as np
import pytest

import ddm_model
from processes import LIMIT_S, has_mujoco, output_of, run_experiment
from rooms import CHECKOUT
from run_files import read_rows

ddm_sim, ddm_mpc = pytest.importorskip("ddm_sim"), pytest.importorskip("ddm_mpc")

EXAMPLES = os.path.join(CHECKOUT, "examples", "python")


@pytest.fixture(name="episode", scope="module")
def record():
    env = ddm_sim.make("pendulum")
    images, torques = [env.reset(seed=3)[0]], np.random.RandomState(3).uniform(-6.0, 6.0, (100, 1))
    for torque in torques[:-1]:
        images.append(env.step(torque)[0])
    return np.array(images), torques


def torques_in(folder, run):
    header, *rows = read_rows(folder, run, "torques.csv")
    return [float(row[header.index("torque_nm")]) for row in rows]


def test_algorithm_1_in_python_gives_the_torques_and_models_of_run_experiment(tmp_path):
    arguments = ["--preset", "efficient", "--plant", "pendulum", "--seed", "1", "--trials", "1", "--out"]
    output = output_of([sys.executable, os.path.join(EXAMPLES, "algorithm1.py"), *arguments, tmp_path / "python"])
    run_experiment(*arguments, tmp_path / "process")
    header, *rows = read_rows(tmp_path / "process", "trials.csv")
    successes = [row[header.index("success")] for row in rows]
    assert re.findall(r"success (\d)", output) == successes
    for trial in (0, 1):
        saved = np.load(tmp_path / "python" / ("torques_%03d.npz" % trial))
        assert saved["episode"][:, 0].tolist() == torques_in(tmp_path / "process", "trial_%03d" % trial)
        assert saved["evaluation"][:, 0].tolist() == torques_in(tmp_path / "process", "evaluation_%03d" % trial)
        model = tmp_path / "process" / ("trial_%03d" % trial) / "model.ddm"
        assert (tmp_path / "python" / ("model_%03d.ddm" % trial)).read_bytes() == model.read_bytes()


@pytest.mark.parametrize("plant, options", [
    ("pendulum", {"dt": 0.1, "noise_std": 0.1}), ("two_link", {}),
    pytest.param("suite_cartpole", {}, marks=pytest.mark.skipif(not has_mujoco(), reason="without MuJoCo"))])
def test_an_environment_has_the_interface_of_gymnasium_and_repeats_its_draws(plant, options):
    env = ddm_sim.make(plant, **options)
    assert env.action_space.shape == env.action_space.high.shape and env.configuration["controller"]["dt"] == env.dt
    image, info = env.reset(seed=5)
    assert env.observation_space.contains(image) and image.shape == env.observation_space.shape
    assert info["goal_image"].shape == image.shape
    steps = [env.step(0.5 * env.action_space.high) for _ in range(env.max_steps)]
    assert [step[3] for step in steps] == [False] * (len(steps) - 1) + [True] and not any(step[2] for step in steps)
    assert steps[-1][4]["time"] == pytest.approx(len(steps) * env.dt) and isinstance(steps[0][1], float)
    np.testing.assert_array_equal(env.reset(seed=5)[0], image)
    second = env.reset()[1]["state"]
    assert not np.array_equal(second, info["state"])
    np.testing.assert_array_equal(env.reset(seed=5, options={"trial": 1})[1]["state"], second)
    np.testing.assert_array_equal(env.reset(options={"start": second})[1]["state"], second)
    assert env.render().dtype == np.uint8


def test_options_and_messages_are_those_of_the_yaml_files(episode, tmp_path):
    images, torques = episode
    for options, words in (({"num_starts": 0}, "training/num_starts must lie in [1, 1000], got 0"),
                           ({"training": {"num_starts": "x"}}, "training/num_starts must be an integer (32 bit), got x"),
                           ({"training": {"num_start": 1}}, "unknown key training/num_start (did you mean num_starts?"),
                           ({"num_start": 1}, "did you mean num_starts?"), ({"trainig": {}}, "did you mean training?"),
                           ({"preset": "fast"}, "efficient"), ({"plant": "pendulun"}, "pendulum_gravity"), ({"plant": "no_cart/cart"}, "no_cart")):
        with pytest.raises((TypeError, ValueError)) as error:
            ddm_model.train([episode], images[0], **options)
        assert words in str(error.value)
    (tmp_path / "own.yaml").write_text("plant: {max_torque: 7.0}\nmodel: {pca_dim: 5}\ntraining: {max_iterations: 3}\n")
    model = ddm_model.train([episode], None, preset="debug", plant=str(tmp_path / "own.yaml"), order=3)
    assert [model.options[name] for name in ("max_torque", "pca_dim", "order")] == [7.0, 5, 3]
    assert ddm_mpc.Controller(model, preset="debug").options["max_torque"] == 7.0
    with pytest.raises(ValueError, match="call set_goal"):
        ddm_mpc.Controller(model, preset="debug").act(images[0])
    with pytest.raises(ValueError, match="images of episode 1 must have the size of episode 0, 51 x 51, got 50 x 51"):
        ddm_model.train([episode, (images[:, 1:], torques)], None)
    with pytest.raises(ValueError, match=r"torques of episode 1 must be an array \[T x 1\] of finite numbers, got float64 \[100 x 2\]"):
        ddm_model.train([episode, (images, np.hstack([torques, torques]))], None)
    for without_limit in (lambda: ddm_model.train([episode], None), lambda: ddm_mpc.Controller(None)):
        with pytest.raises(ValueError, match="max_torque must be given"):
            without_limit()


def test_an_environment_may_be_wrapped_as_by_gymnasium():
    wrapper = types.SimpleNamespace(unwrapped=ddm_sim.make("pendulum"))
    assert ddm_mpc.Controller(None, plant=wrapper).options["max_torque"] == 6.0


def test_other_threads_run_during_a_training_and_an_error_of_progress_stops_it(episode):
    counts, stop = [0], threading.Event()

    def count():
        while not stop.wait(0.001):
            counts[0] += 1

    def progress(fraction, v_r, v_p):
        assert 0.0 <= fraction <= 1.0 and v_r >= 0.0 and v_p >= 0.0
        if counts[0] > 20:
            raise KeyError("enough")

    thread = threading.Thread(target=count)
    thread.start()
    try:
        with pytest.raises(KeyError, match="enough"):
            ddm_model.train([episode], None, progress=progress, num_starts=1000, max_iterations=100000, max_torque=6.0)
    finally:
        stop.set()
        thread.join()


def test_ctrl_c_stops_a_training(episode, tmp_path):
    np.savez(tmp_path / "episode.npz", images=episode[0], torques=episode[1])
    script = ("import sys, numpy, ddm_model\nepisode = numpy.load(sys.argv[1])\n"
              "def progress(fraction, v_r, v_p):\n    print(fraction, flush=True)\n"
              "ddm_model.train([(episode['images'], episode['torques'])], None, progress=progress, num_starts=1000, max_torque=6.0)")
    process = subprocess.Popen([sys.executable, "-c", script, str(tmp_path / "episode.npz")], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, universal_newlines=True)
    process.stdout.readline()
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=LIMIT_S)
    assert process.returncode != 0 and "KeyboardInterrupt" in errors


def test_the_report_of_a_torque_that_acted_changes_the_next_answer(episode):
    images, _ = episode
    model = ddm_model.train([episode], images[0], preset="debug", max_torque=6.0)
    controller, torques = ddm_mpc.Controller(model, preset="debug", offset_gain=0.0), []
    for acted in (None, None, [-6.0]):
        controller.reset(seed=2)
        controller.act(images[10])
        if acted is not None:
            controller.applied(acted)
        torques.append(controller.act(images[11]))
    np.testing.assert_array_equal(torques[0], torques[1])
    assert not np.array_equal(torques[0], torques[2])
    with pytest.raises(ValueError, match="explore must be the same"):
        controller.act(images[12], explore=True)


def test_gymnasium_makes_registered_plants():
    gymnasium = pytest.importorskip("gymnasium")
    env = gymnasium.make("ddm/pendulum-v0", dt=0.1)
    observation, info = env.reset(seed=1)
    assert env.observation_space.contains(observation) and "state" in info
    assert env.step(env.action_space.sample())[0].shape == observation.shape and env.unwrapped.dt == 0.1
