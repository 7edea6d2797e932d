# Results of the training schedules, as they lie in the folder of reproduce_paper.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch.run_folder import RunFolderError, number, read_csv, read_sweep

SCHEDULES = ("joint", "sequential", "v_p_only", "joint_random_init")  # of training/schedule
REMEDY = "rosrun ddm_launch reproduce_paper writes it"


class Prediction:
    """A row of predictions.csv: errors of all predictions that many steps ahead [grey], and of the model itself."""

    def __init__(self, row, path):
        self.rmse = number(row, "rmse", path)
        self.rmse_repeat = number(row, "rmse_repeat", path)
        self.position_r2 = number(row, "position_r2", path)
        if not self.rmse_repeat > 0.0:
            raise RunFolderError("%s: column rmse_repeat must be > 0, got %g" % (path, self.rmse_repeat))

    @property
    def ratio(self):
        return self.rmse / self.rmse_repeat


def read_predictions_csv(path):
    """The rows of a predictions.csv, as {seed: {steps: Prediction}}."""
    predictions = {}
    for row in read_csv(path, ["seed", "steps", "rmse", "rmse_repeat", "position_r2"], REMEDY):
        seed, steps = int(number(row, "seed", path)), int(number(row, "steps", path))
        if steps in predictions.setdefault(seed, {}):
            raise RunFolderError("%s holds %d steps of seed %d twice: give each seed once" % (path, steps, seed))
        predictions[seed][steps] = Prediction(row, path)
    return predictions


def paired(results, what):
    """Only the seeds that all schedules have: the draws of a seed are the same for each schedule.

    results: {schedule: {seed: anything}}. Raises RunFolderError if there is no such seed.
    """
    common = set.intersection(*(set(by_seed) for by_seed in results.values()))
    if not common:
        raise RunFolderError("no seed has %s of all schedules (%s): run the same seeds with each" % (
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
