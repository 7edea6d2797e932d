# Random bad calls of the Python bindings: each raises an exception that names an argument, and none crashes.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re

import numpy as np
import pytest

import ddm_model

ddm_sim, ddm_mpc = pytest.importorskip("ddm_sim"), pytest.importorskip("ddm_mpc")

CALLS = int(os.environ.get("DDM_FUZZ_CALLS", "600"))
QUICK = {"pca_dim": 4, "encoder_widths": [4], "predictor_widths": [4], "max_iterations": 2, "num_starts": 1, "max_torque": 6.0}
LOOP = []
LOOP.append(LOOP)
BAD = [None, True, 3, -1, 2 ** 70, 0.5, float("nan"), float("-inf"), "", "x", "1", "a/b", "\ud800", "x.yaml", b"x", [], [[]], (), {},
       {"a": 1}, {"mpc": 1}, {1: {2: 3}}, {"model": {"order": [[[]]]}}, [1, [2, 3]], [None], LOOP, object(), len, set(), iter(()),
       np.array([]), np.array(1.0), np.array("x"), np.array([None]), np.zeros((0, 1)), np.zeros((3, 2, 1)), np.full((5, 1), np.nan),
       np.full((5, 1), np.inf), np.zeros((5, 1), complex), np.zeros((5, 1), "M8[s]"), np.zeros(4, [("a", "f8")]),
       np.zeros((51, 51)), np.zeros((51, 51), np.uint16), np.zeros((51, 51), bool), np.zeros((0, 51), np.uint8),
       np.zeros((51, 51, 4), np.uint8), np.zeros((1, 1), np.uint8), np.zeros((1, 20000), np.uint8), np.zeros((12, 0, 3), np.uint8),
       np.zeros((12, 51, 51), np.uint8)[::-1, ::2, ::3], np.zeros((2, 1), np.longdouble), np.zeros((1,) * 20), np.zeros((3, 3, 51, 51), np.uint8)]
OTHER_NAMES = r"episode 0|model/order|cannot (read|write) |:\d+: "  # the last two follow or precede a path
ALLOWED = (TypeError, ValueError, OSError, RuntimeError)


@pytest.fixture(name="functions", scope="module")
def make_functions():
    """Pairs (function, valid arguments by name)."""
    random = np.random.RandomState(0)
    images, torques = random.randint(0, 256, (12, 51, 51)).astype(np.uint8), random.uniform(-6.0, 6.0, (12, 1))
    model = ddm_model.train([(images, torques)], images[0], preset="debug", **QUICK)
    env, controller = ddm_sim.make("pendulum"), ddm_mpc.Controller(model, preset="debug")
    features = model.encode(images)

    def train(**arguments):
        return ddm_model.train(arguments.pop("episodes"), arguments.pop("goal"), **{**QUICK, **arguments})

    def act(**arguments):
        controller.reset()
        return controller.act(**arguments)

    def reset(**arguments):
        seed = arguments.pop("seed")
        return env.reset(seed=seed, options=arguments)

    return [(train, {"episodes": [(images, torques)], "goal": images[0], "preset": "debug", "plant": None, "progress": None, "seed": 0,
                     "trial": 0, "num_starts": 1, "training": {}, "blur": 0.0}),
            (lambda images, torques: train(episodes=[(images, torques)], goal=None, preset="debug"), {"images": images, "torques": torques}),
            (model.encode, {"images": images}), (model.decode, {"features": features}),
            (model.predict, {"features": features[:model.options["order"]], "torques": torques[:model.options["order"]]}),
            (model.roll_out, {"features": features[:model.options["order"]], "torques": torques}),
            (ddm_model.Model.load, {"path": "/nonexistent"}), (model.save, {"path": "/nonexistent/model.ddm"}),
            (ddm_mpc.Controller, {"model": model, "preset": "debug", "plant": None, "epsilon": 0.1, "mpc": {}, "max_torque": 6.0}),
            (controller.reset, {"seed": 0, "trial": 0}), (controller.set_goal, {"image": images[0]}),
            (act, {"image": images[0], "explore": False}), (controller.applied, {"torque": torques[0]}),
            (lambda plant, **options: ddm_sim.make(plant, **options), {"plant": "pendulum", "dt": 0.2, "camera": {}, "noise_std": 0.0}),
            (reset, {"seed": 0, "trial": 0, "evaluation": False, "start": None}), (env.reset, {"seed": 0, "options": {}}),
            (env.step, {"torque": torques[0]})]


def test_bad_arguments_raise_exceptions_that_name_an_argument(functions, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # some paths are valid
    random, raised = np.random.RandomState(1), 0
    for call in range(CALLS):
        function, valid = functions[random.randint(len(functions))]
        bad = {name: BAD[random.randint(len(BAD))] for name in random.choice(list(valid), random.randint(1, 3))}
        try:
            function(**{**valid, **bad})
        except ALLOWED as error:
            raised += 1
            message = str(error)
            named = any(name in message for name in [*bad, *valid]) or re.search(OTHER_NAMES, message)
            assert named, (call, function, bad, message)
    assert raised > 0.5 * CALLS
