#!/usr/bin/python3
# Stands in for `sweep`: makes up the rows of each seed at once. $STAND_IN_STOPS says where it fails or waits.
# SPDX-License-Identifier: BSD-3-Clause
"""In trial 0 those seeds succeed that can be divided by 2, later all; with options after '--' none does. The return of a
suite's plant is 100 more with each trial.

STAND_IN_STOPS=fail:N ends it with code 1 after N seeds, wait:N makes it wait for a signal there, with one trial of the
next seed.
"""
import os
import signal
import sys

from ddm_launch.sweep import parse

COLUMNS = ("seed,trial,frames,success,success_strict,final_error,v_r,v_p,train_s,train_evaluations,plan_ms_median,"
           "plan_ms_p99,version,return")


def write(path, *lines):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w") as stream:
        stream.writelines(line + "\n" for line in lines)


def write_trials(path, seed, num_trials, plain, plant):
    rows = []
    for trial in range(num_trials):
        success = plain and (trial > 0 or seed % 2 == 0)
        rows.append("%d,%d,%d,%d,%d,1.5,1,1,2,50,1,4,made up,%s" % (
            seed, trial, 100 * (trial + 1), success, success, 100 * trial if plant.startswith("suite_") else ""))
        write(os.path.join(os.path.dirname(path), "trial_%03d" % trial, "model.ddm"), "model %d" % trial)
    write(path, COLUMNS, *rows)
    return rows


def main():
    options, more = parse(sys.argv[1:])
    stop, _, count = os.environ.get("STAND_IN_STOPS", ":-1").partition(":")
    folders = {seed: os.path.join(options.out, "seed_%04d" % seed) for seed in options.seeds}
    os.makedirs(options.out, exist_ok=True)
    pending = [seed for seed, folder in folders.items() if not os.path.exists(os.path.join(folder, "summary.yaml"))]
    print("run_experiment, preset %s, plant %s: %d of %d seeds to run" % (
        options.preset, options.plant, len(pending), len(folders)), flush=True)
    for k, seed in enumerate(pending):
        if k == int(count):
            if stop == "wait":
                write_trials(os.path.join(folders[seed], "trials.csv"), seed, 1, not more, options.plant)
                signal.pause()
            return 1
        write(os.path.join(options.out, "logs", "seed_%04d.log" % seed), "seed %d" % seed)
        write(os.path.join(folders[seed], "config.yaml"), "version: made up",
              "model: {residual: true, encoder_widths: [25, 12, 6]}", "plant: {dt: 0.1}",
              "experiment: {runs: %s}" % os.path.abspath(folders[seed]))
        write_trials(os.path.join(folders[seed], "trials.csv"), seed, options.trials + 1, not more, options.plant)
        write(os.path.join(folders[seed], "summary.yaml"), "finished: true", "wall_s: %d" % (100 + seed))
        print("seed %d finished (of some)" % seed, flush=True)
    rows = []
    for seed in folders:
        rows += write_trials(os.path.join(folders[seed], "trials.csv"), seed, options.trials + 1, not more,
                             options.plant)
    write(os.path.join(options.out, "sweep.csv"), COLUMNS, *rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
