# Algorithm 1 of the paper without ROS: a random trial, then training, evaluation and exploration in turn.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import os

import numpy as np

import ddm_model
import ddm_mpc
import ddm_sim


def run_episode(env, controller, seed, trial, explore=False):
    """Returns images [T, H, W] and torques [T, m], whether the plant was at the goal [T], and the goal image."""
    image, info = env.reset(seed=seed, options={"trial": trial, "evaluation": not explore})
    controller.reset(seed=seed, trial=trial)
    controller.set_goal(info["goal_image"])
    images, torques, at_goal, truncated = [], [], [], False
    while not truncated:
        images.append(image)
        torques.append(controller.act(image, explore=explore))
        at_goal.append(info["at_goal"])
        image, _, _, truncated, info = env.step(torques[-1])
    return (np.array(images), np.array(torques)), np.array(at_goal), info["goal_image"]


def main():
    parser = argparse.ArgumentParser(description="Runs Algorithm 1 and prints the success after each trial.")
    parser.add_argument("--plant", default="pendulum")
    parser.add_argument("--preset", default="efficient")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--trials", type=int, default=3, help="trials after the random one")
    parser.add_argument("--out", help="folder for models and torques")
    args = parser.parse_args()

    env = ddm_sim.make(args.plant)
    num_episodes = env.configuration.get("trial", {}).get("episodes", 1)  # in each trial
    setting = {"preset": args.preset, "plant": env}
    controller, episodes = ddm_mpc.Controller(None, **setting), []  # without a model, all torques are random
    for trial in range(args.trials + 1):
        for number in range(trial * num_episodes, (trial + 1) * num_episodes):
            episode, _, goal = run_episode(env, controller, args.seed, number, explore=True)
            episodes.append(episode)
        model = ddm_model.train(episodes, goal, seed=args.seed, trial=trial, **setting)
        controller = ddm_mpc.Controller(model, **setting)
        evaluation, at_goal, _ = run_episode(env, controller, args.seed, trial)
        num_images = sum(len(images) for images, _ in episodes)
        print("trial %d: %d images, success %d" % (trial, num_images, all(at_goal[-10:])))
        if args.out:
            os.makedirs(args.out, exist_ok=True)
            model.save(os.path.join(args.out, "model_%03d.ddm" % trial))
            np.savez(os.path.join(args.out, "torques_%03d.npz" % trial), episode=episode[1], evaluation=evaluation[1])


if __name__ == "__main__":
    main()
