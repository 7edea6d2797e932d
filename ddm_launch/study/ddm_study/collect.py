# Collects from the folder of a sweep what tables and figures need of single runs.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re

from PIL import Image
import pandas

from ddm_launch.command import Failure
from ddm_launch.figure_style import save_picture
from ddm_launch.images import recorded_images
from ddm_launch.run_folder import Trajectory, read_trials
from ddm_launch.settings import read_yaml
from ddm_model.plain_file import write_file
from ddm_study.results import read_table

ABOUT = """\
Collects from the folder of a sweep what tables and figures need of single runs:
  angles         the angle in the greedy evaluations of the first 15 models of 16 seeds, as the paper's Fig. 7 has them
  policies       the policy search of each trial of PILCO
  distributions  the angle that PILCO on the state predicted and what happened, of three seeds
  last_models    success and mean return of the episodes that `evaluate` has left in each seed's folder last_model
  image          the image number 50 of the first trial"""
NUM_ANGLE_SEEDS, NUM_ANGLE_TRIALS = 16, 15
SEARCH_KEYS = ["gp_s", "policy_search_s", "sparse", "points", "iterations", "evaluations", "cost_before", "cost_after",
               "message"]  # of pilco.yaml
NUM_DISTRIBUTION_SEEDS, DISTRIBUTION_TRIALS = 3, (0, 1, 2, 3, 5, 7)  # after 125 to 1000 frames
IMAGE = 50  # the rod has left its start


def angles(runs):
    rows = []
    for seed, folder in list(runs.items())[:NUM_ANGLE_SEEDS]:
        for trial in read_trials(folder)[:NUM_ANGLE_TRIALS]:
            run = Trajectory(os.path.join(folder, "evaluation_%03d" % trial.trial))
            rows += [(seed, trial.frames, int(trial.success), k, "%.3f" % time_s, "%.4f" % angle_rad)
                     for k, (time_s, angle_rad) in enumerate(zip(run.time_s, run.angle_rad))]
    return pandas.DataFrame(rows, columns=["seed", "frames", "success", "step", "time_s", "angle_rad"])


def policies(runs):
    rows = []
    for seed, folder in runs.items():
        for trial in read_trials(folder):
            path = os.path.join(folder, "trial_%03d" % trial.trial, "pilco.yaml")
            search = read_yaml(path)
            if not set(SEARCH_KEYS) <= set(search):
                raise Failure("%s must have the keys %s: collect policies of a sweep of PILCO" % (
                    path, ", ".join(SEARCH_KEYS)))
            rows.append([seed, trial.trial, trial.frames] + [search[key] for key in SEARCH_KEYS])
    return pandas.DataFrame(rows, columns=["seed", "trial", "frames"] + SEARCH_KEYS)


def distributions(runs):
    """The policy of a trial is executed twice: in its evaluation and in the next recorded trial, where there is one."""
    rows = []
    for seed, folder in list(runs.items())[:NUM_DISTRIBUTION_SEEDS]:
        frames = {trial.trial: trial.frames for trial in read_trials(folder)}
        for trial in (trial for trial in DISTRIBUTION_TRIALS if trial in frames):
            predicted = read_table(folder, "trial_%03d" % trial, "prediction.csv")
            rows += [(seed, trial, frames[trial], "predicted", k, "%.3f" % row.time_s, "%.4f" % row.angle_rad_mean,
                      "%.4f" % row.angle_rad_std) for k, row in enumerate(predicted.itertuples())]
            actual = [("evaluation", trial)] + [("trial", trial + 1)] * (trial + 1 in frames)
            for kind, number in actual:
                run = Trajectory(os.path.join(folder, "%s_%03d" % (kind, number)))
                rows += [(seed, trial, frames[trial], kind, k, "%.3f" % time_s, "%.4f" % angle_rad, "")
                         for k, (time_s, angle_rad) in enumerate(zip(run.time_s, run.angle_rad))]
    return pandas.DataFrame(rows, columns=["seed", "trial", "frames", "kind", "step", "time_s", "angle_rad",
                                           "angle_std_rad"])


def last_models(runs):
    rows = []
    for seed, folder in runs.items():
        episodes = read_table(folder, "last_model", "evaluation.csv")
        rows.append((seed, len(episodes), episodes.success.mean(), episodes["return"].mean()))
    return pandas.DataFrame(rows, columns=["seed", "episodes", "success", "mean_return"])


TABLES = {"angles": angles, "policies": policies, "distributions": distributions, "last_models": last_models}


def work(options):
    folders = sorted(glob.glob(os.path.join(options.sweep, "seed_*")))
    runs = {int(re.search(r"\d+$", folder).group()): folder for folder in folders}
    if not runs:
        raise Failure("%s must hold folders seed_NNNN, it has none: give the folder of a sweep" % options.sweep)
    if options.kind == "image":
        images = recorded_images(os.path.join(folders[0], "trial_000", "trial.bag"))
        save_picture(Image.fromarray(images[min(IMAGE, len(images) - 1)]), options.out, "PNG", optimize=True)
    else:
        write_file(options.out, TABLES[options.kind](runs).to_csv(index=False, float_format="%.6g"))


def add_arguments(parser):
    parser.add_argument("kind", choices=[*TABLES, "image"], metavar="KIND", help="as above")
    parser.add_argument("sweep", metavar="DIR", help="folder of a sweep")
    parser.add_argument("--out", required=True, metavar="FILE", help="file to write")
