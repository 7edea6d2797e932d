# The training schedules compared: means over paired seeds, the reference, and what is refused.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch.command import Failure
from ddm_launch.figure_style import PAGE_WIDTH, new_figure
from ddm_study import schedules, schedules_compared
import figure_case

NAMES = list(schedules.SCHEDULES)
TRIALS = "seed,trial,frames,success,final_error"
PREDICTIONS = "seed,steps,num_predictions,rmse,rmse_repeat,position_r2,v_r,v_p,train_s"


def prediction(seed, steps, rmse, rmse_repeat):
    return "%d,%d,90,%g,%g,0.9,1,1,1" % (seed, steps, rmse, rmse_repeat)


class SchedulesComparedTest(figure_case.FigureCase):
    def setUp(self):
        super().setUp()
        for k, name in enumerate(NAMES):
            self.writeLines(os.path.join("" if name == "joint" else name, "trials.csv"), TRIALS,
                            "0,0,100,0,90", "0,1,200,1,2", "1,0,100,%d,9" % (k == 0), "1,1,200,%d,9" % (k == 0))
            for plant in ("tile_predictions", "pendulum_predictions"):
                self.writePredictions(plant, name, range(2), 0.1 * (k + 1))

    def writePredictions(self, plant, name, seeds, rmse):
        self.writeLines(os.path.join(plant, name, "predictions.csv"), PREDICTIONS,
                        *(prediction(seed, steps, rmse * steps + 0.02 * seed, 0.5 * steps) for seed in seeds
                          for steps in range(1, 9)))

    def test_prediction_errors_are_means_over_seeds_with_standard_errors(self):
        results = schedules.read_predictions(self.file("tile_predictions"))
        with new_figure(PAGE_WIDTH, 3.0) as figure:
            axes = figure.add_subplot(1, 1, 1)
            schedules_compared.draw_predictions(axes, results)
            points = figure_case.drawn_points(axes, "sequential")
            repeat = figure_case.drawn_points(axes, "repeat the last frame")
            bars = [container.lines[2][0].get_segments()[2] for container in axes.containers
                    if container.get_label() == "sequential"][0]
            labels = (axes.get_xlabel(), axes.get_ylabel())
        self.assertEqual([point[0] for point in points], list(range(1, 9)))
        self.assertAlmostEqual(points[2][1], 0.2 * 3 + 0.01)
        self.assertAlmostEqual(bars[1][1] - bars[0][1], 2.0 * 0.01)  # s = 0.02 / sqrt(2), n = 2
        self.assertAlmostEqual(repeat[7][1], 4.0)
        self.assertEqual(labels, ("steps ahead [-]", "RMSE over pixels [grey]"))

    def test_only_seeds_that_all_schedules_have_are_compared(self):
        self.writePredictions("tile_predictions", "joint", range(1, 5), 9.0)
        results = schedules.read_predictions(self.file("tile_predictions"))
        self.assertEqual([sorted(results[name]) for name in NAMES], [[1]] * 4)
        self.assertEqual(schedules_compared.seeds_text(results), "1 seed")

    def test_schedules_without_a_common_seed_are_refused(self):
        self.writePredictions("tile_predictions", "joint", [77], 9.0)
        with self.assertRaisesRegex(Failure, "predictions.*schedules"):
            schedules.read_predictions(self.file("tile_predictions"))

    def test_a_results_folder_makes_a_picture_as_wide_as_a_page(self):
        self.assertDrawn(schedules_compared, [self.scratch], PAGE_WIDTH)

    def test_each_missing_file_is_named_with_the_remedy(self):
        for path in ("trials.csv", "v_p_only/trials.csv", "tile_predictions/joint/predictions.csv",
                     "pendulum_predictions/joint_random_init/predictions.csv"):
            whole = self.file(path)
            os.rename(whole, whole + ".away")
            self.assertRefused(schedules_compared, [self.scratch], whole, "rosrun ddm_launch reproduce_paper")
            os.rename(whole + ".away", whole)

    def test_a_seed_that_is_there_twice_is_refused(self):
        self.writeLines("tile_predictions/joint/predictions.csv", PREDICTIONS, prediction(3, 1, 0.1, 0.1),
                        prediction(3, 1, 0.2, 0.1))
        self.assertRefused(schedules_compared, [self.scratch], "seed 3, steps 1")
