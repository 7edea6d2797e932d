# Makes small run folders for the tests of the figures.
# SPDX-License-Identifier: BSD-3-Clause
import math
import os

TRIAL_COLUMNS = ("seed,trial,frames,success,success_strict,final_error_deg,v_r,v_p,train_s,train_evaluations,"
                 "plan_ms_median,plan_ms_p99")


def write_trials(folder, successes, errors_deg, seed=1):
    """Writes trials.csv: row k has 100 (k + 1) frames. successes: "0", "1" or "" each."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "trials.csv"), "w") as stream:
        stream.write(TRIAL_COLUMNS + "\n")
        for k, (success, error) in enumerate(zip(successes, errors_deg)):
            stream.write("%d,%d,%d,%s,%s,%s,0.01,0.02,0.5,500,2.0,4.0\n"
                         % (seed, k, 100 * (k + 1), success, success, error))


def write_config(folder, plant="pendulum"):
    with open(os.path.join(folder, "config.yaml"), "w") as stream:
        stream.write("experiment: {plant: %s, seed: 1}\nplant: {type: %s}\n" % (
            plant, plant if plant == "moving_tile" else "pendulum"))


def write_evaluation(folder, trial, num_steps=40, arrival=16, start_s=3.0):
    """Writes a swing-up that reaches the target at step `arrival` and stays there."""
    evaluation = os.path.join(folder, "evaluation_%03d" % trial)
    os.makedirs(evaluation, exist_ok=True)
    with open(os.path.join(evaluation, "trajectory.csv"), "w") as stream:
        stream.write("step,time_s,angle_rad,rate_rad_per_s\n")
        for k in range(num_steps):
            stream.write("%d,%.17g,%.17g,0\n" % (k, start_s + 0.2 * k, math.pi * min(1.0, k / arrival)))
    with open(os.path.join(evaluation, "torques.csv"), "w") as stream:
        stream.write("step,torque_nm,exploratory\n")
        for k in range(num_steps):
            stream.write("%d,%.17g,0\n" % (k, 6.0 * math.cos(k / 5.0)))


def write_run(folder, successes=("0", "1", "0"), errors_deg=("170", "3", "90")):
    """A whole run folder with an evaluation for each trial."""
    write_trials(folder, successes, errors_deg)
    write_config(folder)
    for trial in range(len(successes)):
        write_evaluation(folder, trial)
