# study_figure NAME: every figure that only the committed results need.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_launch.figure import program
from ddm_study import (ablation_compared, angle_trajectories, feature_plane, nuisances_compared,
                       pendulum_feature_space, prediction_strip, schedules_compared, task_compared,
                       trajectory_distributions)

main = program("study_figure", "Draws a figure of the committed results; `study_figure FIGURE --help` lists its options.",
               (angle_trajectories, schedules_compared, trajectory_distributions, ablation_compared,
                nuisances_compared, task_compared, prediction_strip, feature_plane, pendulum_feature_space))
