# Makes small run folders for the tests of the figures and tables.
# SPDX-License-Identifier: BSD-3-Clause
import math
import os

TRIAL_COLUMNS = ("seed,trial,frames,success,success_strict,final_error,v_r,v_p,train_s,train_evaluations,"
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
        stream.write("experiment: {plant: %s, seed: 1}\nplant: {type: %s}\nevaluation: {tolerance: 10.0, error_unit: deg}\n" % (
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


def write_trajectory(folder, angles_rad, start_s=3.0):
    """Writes trajectory.csv, one frame per angle."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "trajectory.csv"), "w") as stream:
        stream.write("step,time_s,angle_rad,rate_rad_per_s\n")
        for k, angle_rad in enumerate(angles_rad):
            stream.write("%d,%.17g,%.17g,0\n" % (k, start_s + 0.2 * k, angle_rad))


def write_search(folder, trial, gp_s, policy_search_s):
    """Writes pilco.yaml of one trial."""
    os.makedirs(os.path.join(folder, "trial_%03d" % trial), exist_ok=True)
    with open(os.path.join(folder, "trial_%03d" % trial, "pilco.yaml"), "w") as stream:
        stream.write("gp_s: %g\npolicy_search_s: %g\nsparse: false\npoints: %d\niterations: 75\nevaluations: 190\n"
                     "cost_before: 80.5\ncost_after: 3.25\nmessage: line searches used up\nmore: 1\n"
                     % (gp_s, policy_search_s, 125 * (trial + 1)))


def write_prediction(folder, trial, means_rad, std_rad):
    """Writes prediction.csv of one trial on the true state, one row per mean of the angle."""
    os.makedirs(os.path.join(folder, "trial_%03d" % trial), exist_ok=True)
    with open(os.path.join(folder, "trial_%03d" % trial, "prediction.csv"), "w") as stream:
        stream.write("step,time_s,rate_rad_per_s_mean,rate_rad_per_s_std,angle_rad_mean,angle_rad_std,cost_mean,"
                     "cost_std\n")
        for k, mean_rad in enumerate(means_rad):
            cost = "," if k == 0 else "0.5,0.1"
            stream.write("%d,%.17g,0,0.1,%.17g,%.17g,%s\n" % (k, 0.2 * k, mean_rad, std_rad, cost))


def pilco_row(seed, trial, success, train_s):
    """A row of trials.csv; the columns of the deep dynamical model are empty."""
    return "%d,%d,%d,%d,%d,1.5,,,%g,190,0.01,0.02" % (seed, trial, 125 * (trial + 1), success, success, train_s)


def write_pilco_run(folder, seed=0, num_trials=3):
    """A run folder of PILCO on the true state. After trial k the angle is predicted to be 0.1 k + 1 at step 1 of 3,
    it is 0.1 k + 2 there in the evaluation, and 0.1 k + 3 in the next recorded trial."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "trials.csv"), "w") as stream:
        stream.write(TRIAL_COLUMNS + "\n")
        for k in range(num_trials):
            stream.write(pilco_row(seed, k, 1, 10.0 + k) + "\n")
    write_config(folder)
    for k in range(num_trials):
        write_search(folder, k, 1.0 + k, 9.0)
        write_prediction(folder, k, [0.0, 0.1 * k + 1.0, 3.0], 0.25)
        write_trajectory(os.path.join(folder, "evaluation_%03d" % k), [0.0, 0.1 * k + 2.0, 3.0])
        write_trajectory(os.path.join(folder, "trial_%03d" % k), [0.0, 0.1 * (k - 1) + 3.0, 3.0])
