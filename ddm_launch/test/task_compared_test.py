# The figure of a task: our returns over physics frames and those of published methods, and what is refused.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_launch.command import package_path
from ddm_launch.figure_style import COLUMN_WIDTH, METHOD_STYLES, new_figure
from ddm_study import task_compared
import figure_case

PUBLISHED = package_path("results", "published", "suite_returns.csv")


class TaskComparedTest(figure_case.FigureCase):
    def setUp(self):
        super().setUp()
        self.table = self.writeLines(
            "tasks.csv", "task,frames,physics_frames,robot_s,runs,success,low,high,mean_return,return_se",
            "two_link,100,,10,20,0.5,0.3,0.7,,", "suite_pendulum,400,2000,40,20,0.5,0.3,0.7,300,20",
            "suite_pendulum,800,4000,80,20,1,0.8,1,800,10", "suite_reacher,400,2000,40,20,0.5,0.3,0.7,7,1")

    def test_ours_and_the_published_ones_of_the_task_are_drawn(self):
        published = task_compared.read_published(PUBLISHED, "pendulum_swingup")
        with new_figure(COLUMN_WIDTH, 3.0) as figure:
            axes = figure.add_subplot()
            task_compared.draw_curves(axes, task_compared.read_ours(self.table, "suite_pendulum"), published, 0.02)
            self.assertEqual(figure_case.drawn_points(axes, task_compared.OURS), [(2000, 300), (4000, 800)])
            self.assertEqual(figure_case.drawn_points(axes, "MR.Q")[0], (10000, 6.1))
            self.assertEqual(axes.get_xscale(), "log")

    def test_the_same_four_published_methods_are_drawn_for_each_task(self):
        self.assertEqual(len({METHOD_STYLES[method] for method in task_compared.DRAWN + (task_compared.OURS,)}), 5)
        for task in task_compared.SUITE.values():
            self.assertEqual(set(task_compared.read_published(PUBLISHED, task.name)), set(task_compared.DRAWN))

    def test_the_program_draws_it(self):
        self.assertDrawn(task_compared, [self.table, "--task", "suite_pendulum", "--published", PUBLISHED], COLUMN_WIDTH)

    def test_a_table_without_returns_of_the_task_is_refused(self):
        empty = self.writeLines("empty.csv", "task,physics_frames,mean_return,return_se", "suite_reacher,2000,,")
        self.assertRefused(task_compared, [empty, "--task", "suite_reacher", "--published", PUBLISHED],
                           "empty.csv", "suite_reacher", "--only tasks")
