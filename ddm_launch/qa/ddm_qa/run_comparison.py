# Compares two runs of the same experiment, and detects lost files.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import hashlib
import os
import pathlib

import yaml

from ddm_launch.run_folder import num_finished

COLUMNS = ["seed", "trial", "frames", "success", "success_strict", "final_error", "v_r", "v_p", "train_s",
           "train_evaluations", "plan_ms_median", "plan_ms_p99", "version", "return"]
TIME_COLUMNS = ["train_s", "plan_ms_median", "plan_ms_p99"]
CHECKSUMS = ".trials.crc32"  # checksums of trials.csv, including its times


def expected_files(num_trials):
    """Names of all files of a finished experiment with this number of epsilon-greedy trials."""
    files = [CHECKSUMS, "config.yaml", "summary.yaml", "trials.csv"]
    for k in range(num_trials + 1):
        files += ["trial_%03d/%s" % (k, name)
                  for name in ("model.ddm", "torques.csv", "training.yaml", "trajectory.csv", "trial.bag")]
        files += ["evaluation_%03d/%s" % (k, name) for name in ("torques.csv", "trajectory.csv")]
    return sorted(files)


def files_in(folder):
    return sorted(str(path.relative_to(folder)) for path in pathlib.Path(folder).rglob("*") if path.is_file())


def read_bytes(*path):
    with open(os.path.join(*path), "rb") as stream:
        return stream.read()


def read_rows(*path):
    with open(os.path.join(*path), newline="") as stream:
        return list(csv.reader(stream))


def comparable(folder, name):
    """Content of a file without times, paths and versions. The rest must be equal in two runs of the same
    experiment."""
    if name == "trials.csv":
        keep = [k for k, column in enumerate(COLUMNS) if column not in TIME_COLUMNS + ["version"]]
        return [[row[k] for k in keep] for row in read_rows(folder, name)]
    content = read_bytes(folder, name)
    if name == CHECKSUMS:
        return len(content)
    if name.endswith(".yaml"):
        tree = yaml.safe_load(content)
        for key in ("wall_s", "train_s"):
            tree.pop(key, None)
        tree.get("experiment", {}).pop("runs", None)
        return tree
    return content


def differences(first, second, names):
    return [name for name in names if comparable(first, name) != comparable(second, name)]


def digest(content):
    return hashlib.sha256(content).hexdigest()


def digests_of_finished(folder):
    """{name: digest} of all files of finished trials, and {"row k": digest} of their rows in trials.csv."""
    count = num_finished(folder)
    folders = tuple("%s_%03d/" % (kind, k) for kind in ("trial", "evaluation") for k in range(count))
    found = {name: digest(read_bytes(folder, name)) for name in files_in(folder) if name.startswith(folders)}
    rows = read_bytes(folder, "trials.csv").splitlines() if count > 0 else []
    return dict(found, **{"row %d" % k: digest(row) for k, row in enumerate(rows)})


def lost_files(before, folder):
    """Names in digests_of_finished() of an earlier time that are missing now or have changed."""
    now = digests_of_finished(folder)
    return sorted(name for name, value in before.items() if now.get(name) != value)
