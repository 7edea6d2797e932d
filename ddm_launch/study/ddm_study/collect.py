# study collect: collects data of single experiments from the folder of a sweep, for tables and figures.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re

import pandas

from ddm_launch.command import Failure
from ddm_launch.run_folder import read_trajectory, read_trials, read_yaml
from ddm_model.plain_file import write_file
from ddm_study.results import read_table

ABOUT = """\
Collects from the folder of a sweep what tables and figures need of single runs:
  angles         the angle in the greedy evaluations of the first 15 models of 16 seeds, as the paper's Fig. 7 has them
  policies       the policy search of each trial of PILCO
  last_models    success and mean return of the episodes that `evaluate` has left in each seed's folder last_model"""
NUM_ANGLE_SEEDS, NUM_ANGLE_TRIALS = 16, 15
SEARCH_KEYS = ["gp_s", "policy_search_s", "sparse", "points", "iterations", "evaluations", "cost_before", "cost_after",
               "message"]  # keys of pilco.yaml


def angles(runs):
    """Angles over time in the evaluations of the first seeds. runs: {seed: run folder}."""
    parts = []
    for seed, folder in list(runs.items())[:NUM_ANGLE_SEEDS]:
        for trial in read_trials(os.path.join(folder, "trials.csv")).head(NUM_ANGLE_TRIALS).itertuples():
            run = read_trajectory(os.path.join(folder, "evaluation_%03d" % trial.trial))
            parts.append(pandas.DataFrame({
                "seed": seed, "frames": trial.frames, "success": int(trial.success), "step": range(len(run)),
                "time_s": run.time_s.map("{:.3f}".format), "angle_rad": run.angle_rad.map("{:.4f}".format)}))
    return pandas.concat(parts)


def policies(runs):
    """Times and results of the policy search in each trial of PILCO. Raises Failure if a trial has none."""
    rows = []
    for seed, folder in runs.items():
        for trial in read_trials(os.path.join(folder, "trials.csv")).itertuples():
            path = os.path.join(folder, "trial_%03d" % trial.trial, "pilco.yaml")
            rows.append(dict(read_yaml(path), seed=seed, trial=trial.trial, frames=trial.frames))
            if not set(SEARCH_KEYS) <= set(rows[-1]):
                raise Failure("%s must have the keys %s: collect policies of a sweep of PILCO" % (path, ", ".join(SEARCH_KEYS)))
    return pandas.DataFrame(rows)[["seed", "trial", "frames"] + SEARCH_KEYS]


def last_models(runs):
    rows = []
    for seed, folder in runs.items():
        episodes = read_table(folder, "last_model", "evaluation.csv")
        rows.append((seed, len(episodes), episodes.success.mean(), episodes["return"].mean()))
    return pandas.DataFrame(rows, columns=["seed", "episodes", "success", "mean_return"])


TABLES = {"angles": angles, "policies": policies, "last_models": last_models}


def work(options):
    folders = sorted(glob.glob(os.path.join(options.sweep, "seed_*")))
    runs = {int(re.search(r"\d+$", folder).group()): folder for folder in folders}
    if not runs:
        raise Failure("%s must hold folders seed_NNNN, it has none: give the folder of a sweep" % options.sweep)
    write_file(options.out, TABLES[options.kind](runs).to_csv(index=False, float_format="%.6g"))


def add_arguments(parser):
    parser.add_argument("kind", choices=TABLES, metavar="KIND", help="as above")
    parser.add_argument("sweep", metavar="DIR", help="folder of a sweep")
    parser.add_argument("--out", required=True, metavar="FILE", help="table to write")
