# The pendulum's feature space: experience, current frame, goal and plan over the decoded grid.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_launch.command import Failure
from ddm_launch.figure_style import COLUMN_WIDTH, new_figure
import figure_case
from ddm_study import pendulum_feature_space

HEADER = "kind,step,z_1,z_2"
ROWS = ["experience,0,0.5,0.5", "experience,1,-0.5,0.5", "current,7,0.1,0.2", "goal,,0.9,0.8",
        "plan,10,0.4,0.4", "plan,9,0.3,0.3", "plan,8,0.2,0.2"]


class PendulumFeatureSpaceTest(figure_case.FigureCase):
    def draw(self, rows):
        """Draws and returns ({label: points}, limits of the axes, the line of the plan)."""
        space = pendulum_feature_space.read_space(self.writeLines("space.csv", HEADER, *rows))
        with new_figure(COLUMN_WIDTH, 3.0) as figure:
            axes = figure.add_subplot(1, 1, 1)
            pendulum_feature_space.draw_space(axes, space, figure_case.GreyDecoder(""))
            labels = axes.get_legend_handles_labels()[1]
            points = {label: figure_case.drawn_points(axes, label) for label in labels}
            return points, axes.get_xlim() + axes.get_ylim(), list(zip(*axes.lines[0].get_data()))

    def test_each_kind_is_drawn_where_it_is(self):
        points, _, _ = self.draw(ROWS)
        self.assertEqual(points, {"experience": [(0.5, 0.5), (-0.5, 0.5)], "current": [(0.1, 0.2)],
                                  "goal": [(0.9, 0.8)], "plan, 3 steps": [(0.2, 0.2), (0.3, 0.3), (0.4, 0.4)]})

    def test_the_plan_is_a_line_from_the_current_frame_in_the_order_of_its_steps(self):
        self.assertEqual(self.draw(ROWS)[2], [(0.1, 0.2), (0.2, 0.2), (0.3, 0.3), (0.4, 0.4)])

    def test_a_real_model_makes_a_picture(self):
        model = figure_case.make_run(self.file("run"))
        path = self.writeLines("space.csv", HEADER, *ROWS)
        self.assertDrawn(pendulum_feature_space, [path, "--model", model], COLUMN_WIDTH)

    def test_a_kind_that_is_missing_or_unknown_is_named(self):
        with self.assertRaisesRegex(Failure, "kind goal"):
            self.draw([row for row in ROWS if not row.startswith("goal")])
        with self.assertRaisesRegex(Failure, "got 'dream'"):
            self.draw(ROWS + ["dream,0,0,0"])

    def test_a_file_or_model_that_is_missing_is_named(self):
        self.assertRefused(pendulum_feature_space, ["missing.csv", "--model", "m.ddm"], "missing.csv",
                           "rosrun ddm_launch feature_space")
        path = self.writeLines("space.csv", HEADER, *ROWS)
        self.assertRefused(pendulum_feature_space, [path, "--model", "no.ddm"], "no.ddm")
