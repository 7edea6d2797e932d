# Compares another method with DDM on the same environment with the same number of images, and writes both as tables.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import csv
import os

import numpy as np

import ddm_model
import ddm_mpc
import ddm_sim
from algorithm1 import run_episode


class RandomShooting:
    """Put your method here. This one simulates random torques from the true state and applies the best first torque."""

    def __init__(self, plant, num_plans=40, horizon=6):
        self._simulator, self._random = ddm_sim.make(plant), np.random.RandomState(0)
        self._shape = (num_plans, horizon, len(self._simulator.action_space.high))

    def error(self, state, plan):
        self._simulator.reset(options={"start": state})
        return sum(self._simulator.step(torque)[4]["error"] for torque in plan)

    def act(self, info):
        scale = self._random.uniform(0.0, 1.0, (self._shape[0], 1, 1)) ** 2  # holding the goal needs small torques
        plans = scale * self._random.uniform(-1.0, 1.0, self._shape) * self._simulator.action_space.high
        return min(plans, key=lambda plan: self.error(info["state"], plan))[0]


def main():
    parser = argparse.ArgumentParser(description="Writes ddm.csv and other.csv, which `figure success_rate` draws.")
    parser.add_argument("--plant", default="pendulum")
    parser.add_argument("--preset", default="efficient")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--out", default=".", help="folder of the tables")
    args = parser.parse_args()
    env, other = ddm_sim.make(args.plant), RandomShooting(args.plant)
    rows = {"ddm": [], "other": []}
    for seed in range(2000, 2000 + args.seeds):  # no setting of DDM was chosen on these seeds
        episode, _, goal = run_episode(env, ddm_mpc.Controller(None, plant=env), seed, trial=0, explore=True)
        model = ddm_model.train([episode], goal, preset=args.preset, plant=env, seed=seed)
        _, at_goal, _ = run_episode(env, ddm_mpc.Controller(model, preset=args.preset, plant=env), seed, trial=0)
        rows["ddm"].append([seed, 0, len(episode[0]), int(all(at_goal[-10:])), ""])
        info, at_goal = env.reset(seed=seed, options={"trial": 0, "evaluation": True})[1], []
        for _ in range(env.max_steps):
            at_goal.append(info["at_goal"])
            info = env.step(other.act(info))[4]
        rows["other"].append([seed, 0, len(episode[0]), int(all(at_goal[-10:])), ""])
    for name, table in rows.items():
        with open(os.path.join(args.out, name + ".csv"), "w", newline="") as stream:
            csv.writer(stream).writerows([["seed", "trial", "frames", "success", "final_error"], *table])


if __name__ == "__main__":
    main()
