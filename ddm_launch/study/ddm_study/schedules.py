# Results of the training schedules, as they lie in the folder of reproduce_paper.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os

from ddm_launch.command import Failure
from ddm_launch.run_folder import read_sweep
from ddm_launch.tables import read_csv

SCHEDULES = ("joint", "sequential", "v_p_only", "joint_random_init")  # of training/schedule
REMEDY = "rosrun ddm_launch reproduce_paper writes it"


class Prediction(collections.namedtuple("Prediction", "rmse rmse_repeat position_r2")):
    """A row of predictions.csv: errors of all predictions that many steps ahead [grey], and of the model itself."""

    @property
    def ratio(self):
        return self.rmse / self.rmse_repeat


def read_predictions_csv(path):
    """The rows of a predictions.csv, as {seed: {steps: Prediction}}."""
    predictions = {}
    columns = {"seed": int, "steps": int, "rmse": float, "rmse_repeat": float, "position_r2": float}
    for row in read_csv(path, columns, REMEDY, once=("seed", "steps")):
        if not row["rmse_repeat"] > 0.0:
            raise Failure("%s: column rmse_repeat must be > 0, got %g" % (path, row["rmse_repeat"]))
        predictions.setdefault(row["seed"], {})[row["steps"]] = Prediction(
            row["rmse"], row["rmse_repeat"], row["position_r2"])
    return predictions


def paired(results, what):
    """Only the seeds that all schedules have: the draws of a seed are the same for each schedule.

    results: {schedule: {seed: anything}}. Raises Failure if there is no such seed.
    """
    common = set.intersection(*(set(by_seed) for by_seed in results.values()))
    if not common:
        raise Failure("no seed has %s of all schedules (%s): run the same seeds with each" % (
            what, ", ".join(results)))
    return {schedule: {seed: by_seed[seed] for seed in sorted(common)} for schedule, by_seed in results.items()}


def read_success(folder):
    """{schedule: {seed: list of Trial}} of the results folder."""
    paths = {name: os.path.join(folder, "" if name == "joint" else name, "trials.csv") for name in SCHEDULES}
    return paired({name: read_sweep(path, REMEDY) for name, path in paths.items()}, "trials")


def read_predictions(folder):
    """{schedule: {seed: {steps: Prediction}}} of one plant's folder, like FOLDER/tile_predictions."""
    return paired({name: read_predictions_csv(os.path.join(folder, name, "predictions.csv")) for name in SCHEDULES},
                  "predictions")
