#!/usr/bin/python3
# What soak says of leaks and lost frames, from made-up samples and trials.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import rooms  # noqa: E402, F401
from ddm_qa.soak_targets import Sample, count_recorded, count_seen, judge  # noqa: E402
from ddm_qa.soak import write_results  # noqa: E402
from run_files import read_rows  # noqa: E402
from scratch_case import ScratchCase  # noqa: E402

LAST = 300
DT_NS = 200000000


def samples_of(rss_kb, open_files, node="node"):
    """Of one node; both are functions of the trial."""
    return [Sample("lockstep", node, trial, 0.5 * trial, rss_kb(trial), open_files(trial))
            for trial in range(LAST + 1)]


def lost_frame(lost):
    return {"run": "lockstep", "trial": 0, "part": "trial", "due": 20, "published": 20, "recorded": 20,
            "answered": 20 - lost, "lost": lost}


def verdicts(samples, lost=0):
    """passed of memory, open files and frames."""
    return [target.passed for target in judge("lockstep", LAST, samples, [lost_frame(lost)])]


class SoakTargetsTest(ScratchCase):
    """The made-up trial: twenty frames, dt apart, with two frames before and after it that nobody answers."""

    def setUp(self):
        super().setUp()
        self.images = [(100 + k, k * DT_NS) for k in range(24)]
        self.torques = {k * DT_NS for k in range(2, 22)}

    def test_a_node_that_stays_as_it_is_passes(self):
        self.assertEqual(verdicts(samples_of(lambda _: 60000, lambda trial: 17 + trial % 2)), [1, 1, 1])

    def test_growth_since_trial_30_is_a_leak_from_five_percent_on(self):
        def grown(share):
            return verdicts(samples_of(lambda trial: int(60000 * (1.0 + share * (trial - 30) / 270.0)), lambda _: 17))
        self.assertEqual(grown(0.049), [1, 1, 1])
        self.assertEqual(grown(0.051), [0, 1, 1])

    def test_growth_before_trial_30_is_no_leak(self):
        self.assertEqual(verdicts(samples_of(lambda trial: 30000 + 1000 * min(trial, 30), lambda _: 17)), [1, 1, 1])

    def test_the_images_that_model_node_keeps_are_no_leak(self):
        def passed(kb_a_trial, node="model_node", image_bytes=1024):
            frames = [dict(lost_frame(0), trial=trial, part=part) for trial in range(LAST + 1)
                      for part in ("trial", "evaluation")]  # 20 images each
            samples = samples_of(lambda trial: 60000 + kb_a_trial * trial, lambda _: 17, node)
            return judge("lockstep", LAST, samples, frames, image_bytes)[0].passed
        self.assertEqual([passed(kb) for kb in (0, 20, 40, 41)], [1, 1, 1, 0])
        self.assertEqual((passed(20, node="mpc_node"), passed(20, image_bytes=None)), (0, 0))

    def test_a_file_that_stays_open_every_hundred_trials_is_noticed(self):
        self.assertEqual(verdicts(samples_of(lambda _: 60000, lambda trial: 17 + trial // 100)), [1, 0, 1])

    def test_a_file_that_is_open_now_and_then_is_no_leak(self):
        self.assertEqual(verdicts(samples_of(lambda _: 60000, lambda trial: 17 + (trial in (10, 280, 281)))), [1, 1, 1])

    def test_a_node_that_was_not_seen_after_the_last_trial_does_not_pass(self):
        self.assertEqual(verdicts(samples_of(lambda _: 60000, lambda _: 17)[:-1]), [0, 1, 1])

    def test_one_lost_frame_fails(self):
        self.assertEqual(verdicts(samples_of(lambda _: 60000, lambda _: 17), lost=1), [1, 1, 0])

    def test_no_frame_at_all_is_no_success(self):
        self.assertEqual(judge("lockstep", LAST, samples_of(lambda _: 60000, lambda _: 17), [])[-1].passed, 0)

    def count(self):
        counted = count_recorded(self.images, self.torques, 0.2, 20)
        return [counted[key] for key in ("due", "published", "recorded", "answered", "lost")]

    def test_frames_beside_the_trial_do_not_count(self):
        self.assertEqual(self.count(), [20, 20, 20, 20, 0])

    def test_a_frame_that_was_published_but_did_not_arrive_is_lost(self):
        del self.images[9]
        self.assertEqual(self.count(), [20, 20, 19, 19, 1])

    def test_a_frame_that_the_camera_did_not_show_is_lost(self):
        self.images[9:] = [(number - 1, stamp) for number, stamp in self.images[10:]]
        self.assertEqual(self.count(), [20, 19, 19, 19, 1])

    def test_a_frame_without_a_torque_is_lost(self):
        self.torques.remove(9 * DT_NS)
        self.assertEqual(self.count(), [20, 20, 20, 19, 1])

    def test_a_trial_that_is_too_short_has_lost_the_rest(self):
        self.torques -= {20 * DT_NS, 21 * DT_NS}
        self.assertEqual(self.count(), [20, 18, 18, 18, 2])

    def test_stamps_may_be_late_by_less_than_half_a_step(self):
        self.images = [(number, stamp + number % 2 * DT_NS // 3) for number, stamp in self.images]
        self.torques = {stamp for _, stamp in self.images[2:22]}
        self.assertEqual(self.count()[-1], 0)

    def test_a_gap_in_an_evaluation_is_a_lost_frame(self):
        times = [0.2 * k for k in range(21) if k != 9]
        self.assertEqual([count_seen(times, 0.2, 20)[key] for key in ("due", "answered", "lost")], [21, 20, 1])

    def test_results_of_the_other_run_stay(self):
        for run in ("real_time", "lockstep", "lockstep"):
            samples = [sample._replace(run=run) for sample in samples_of(lambda _: 60000, lambda _: 17)]
            frames = [dict(lost_frame(0), run=run)]
            write_results(self.scratch, run, samples, frames, judge(run, LAST, samples, frames))
        self.assertEqual([len(read_rows(self.scratch, name)) for name in ("soak.csv", "frames.csv", "targets.csv")],
                         [2 * (LAST + 1) + 1, 3, 7])
        self.assertEqual([row[0] for row in read_rows(self.scratch, "frames.csv")], ["run", "lockstep", "real_time"])


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "soak_targets", SoakTargetsTest)
