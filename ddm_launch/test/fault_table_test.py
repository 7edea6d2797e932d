# Faults of each class come to what is expected of them, and a case that does not fails.
# SPDX-License-Identifier: BSD-3-Clause
import os

from std_msgs.msg import Float64

from ddm_qa import fault_table as table
from ddm_qa.faults.cases import RECOVERS, STAYS, Case
from ddm_qa.faults.damage import damage, find_record
from ddm_qa.faults.finished import Finished
from ddm_qa.faults.run import FaultBench
from ddm_qa.faults.watches import Effort, MotorWatch, OrderWatch
from processes import call, find_program, run_experiment
from run_files import read_rows
from scratch_case import ScratchCase


class FaultTableTest(ScratchCase):
    def test_all_quick_cases_pass(self):
        code, output = call([find_program("fault_table"), "--subset", "quick", "--out", self.scratch],
                            limit_s=500.0)
        rows = read_rows(self.scratch, "faults.csv")
        self.assertEqual(rows[0], table.COLUMNS)
        self.assertEqual([row for row in rows[1:] if row[3] != row[4] or row[5] != "1"], [], output)
        self.assertGreaterEqual(len(rows), 21)
        self.assertIn("%d passed, 0 failed" % (len(rows) - 1), output)
        self.assertEqual(code, 0, output)

    def test_a_case_whose_phase_never_comes_or_whose_words_are_not_said_is_no_success(self):
        bench = FaultBench(self.scratch)
        bench.make_reference()
        never = Case("never", "no such phase", "drop image", RECOVERS, (), False, False)
        self.assertEqual(bench.run(never), "not injected")
        silent = Case("silent", "at rest", "remove trial.bag", STAYS, ("nobody says this",), False, False)
        self.assertEqual(bench.run(silent), STAYS.replace("named", "not named: nobody says this"))
        rows = table.table([never, silent], {"never": "not injected", "silent": "ended"})
        self.assertEqual([row[-1] for row in rows], [0, 0])

    def test_where_nothing_was_finished_nothing_can_be_called_undamaged(self):
        bench = FaultBench(self.scratch)
        bench.make_reference()
        first = Case("first", "random trial", "kill sim_node", "ended, undamaged, resumes, equal", (), False, False)
        facts = bench.run(first).split(", ")
        self.assertEqual(facts[:1] + facts[2:], ["ended", "resumes", "equal"])
        self.assertIn("compare", facts[1])

    def test_files_of_finished_trials_that_change_or_vanish_are_named(self):
        code, output = run_experiment("--preset", "debug", "--trials", 0, "--out", self.out)
        self.assertEqual(code, 0, output)
        before = Finished.of(self.out)
        self.assertEqual(before.lost(self.out), [])
        self.write(os.path.join(self.out, "trial_000", "torques.csv"), "changed")
        os.remove(os.path.join(self.out, "evaluation_000", "torques.csv"))
        with open(os.path.join(self.out, "trials.csv"), "a") as stream:
            stream.write("another row\n")
        self.assertEqual(before.lost(self.out), ["evaluation_000/torques.csv", "trial_000/torques.csv"])
        os.remove(os.path.join(self.out, "trials.csv"))
        self.assertIn("trials.csv", before.lost(self.out))

    def test_the_older_of_two_torques_may_not_act_and_the_older_of_two_images_may_not_be_answered_late(self):
        for torque, acted, answers, verdict in (
                (2.0, [3.0, 3.0, 4.0], [], "in order"), (2.0, [2.0, 3.0, 4.0], [], "older torque"),
                (2.0, [3.0], [], "1 frames"), (None, [1.0] * 3, [7, 9], "in order"),
                (None, [1.0] * 3, [8, 7, 9], "older image")):
            watch = OrderWatch()
            watch.torque_has_acted(6, 2.0)
            watch.swap(7, torque)
            for each in acted:
                watch.torque_has_acted(8, each)
            for each in answers:
                watch.torque_passes(8, each)
            self.assertIn(verdict, watch.verdict())

    def test_a_robot_must_have_zero_torque_from_the_limit_to_the_end_of_the_fault(self):
        for efforts, verdict in (([0.0] * 30, "zero"), ([0.0] * 29 + [1.5], "driven: 1.5"),
                                 ([0.0] * 5, "5 torques")):
            effort = Effort()
            effort.fault_begins()
            for each in efforts:
                effort.take(Float64(data=each))
            self.assertIn(verdict, effort.verdict(0.0))
            self.assertIn("0 torques", effort.verdict(60.0))

    @staticmethod
    def motor(torques, passed=(), stays_off=False):
        """The verdict on a motor with these torques in periods of a second, after a fault at 3.5 s, the first image being
        that of 0 s. passed: (time, stamp) of torques other than those that answer images 0 to 3 at once."""
        watch = MotorWatch(stays_off)
        for now, stamp in [(k + 0.1, k) for k in range(3)] + list(passed):
            watch.torque_passes(now, stamp)
        watch.fault_begins(3.5, 3)
        for k, torque in enumerate(torques):
            watch.torque_has_acted(k + 1.0, torque)
        return watch.verdict()

    def test_a_motor_must_stop_two_periods_after_the_last_torque(self):
        self.assertEqual(self.motor([1, 2, 3, 4, 4, 0, 0, 0]), "zero")
        self.assertEqual(self.motor([1, 2, 3, 4, 4, 4, 0, 0]), "driven: 4 0 0")
        self.assertIn("2 frames", self.motor([1, 2, 3, 4, 4, 0, 0]))
        self.assertIn("no torque", self.motor([0, 0, 0, 0, 0, 0, 0, 0]))

    def test_a_torque_that_answers_an_image_before_the_fault_may_still_act(self):
        self.assertEqual(self.motor([1, 2, 3, 4, 5, 5, 0, 0, 0], [(4.2, 2)]), "zero")

    def test_a_motor_may_run_again_with_the_next_torque_unless_one_was_refused(self):
        again = [1, 2, 3, 4, 4, 0, 0, 0, 9]
        self.assertEqual(self.motor(again, [(8.1, 8)]), "zero")
        self.assertEqual(self.motor(again, [(8.1, 8)], stays_off=True), "driven: 0 0 0 9")

    def test_each_kind_of_record_of_a_bag_is_cut_in_its_middle(self):
        code, output = run_experiment("--preset", "debug", "--trials", 0, "--out", self.scratch)
        self.assertEqual(code, 0, output)
        sizes = set()
        for record in ("version", "header", "chunk", "index", "connection", "chunk_info"):
            path, content = damage("cut %s of trial.bag" % record, self.scratch)
            begin, end = find_record(content, record)
            self.assertTrue(begin < os.path.getsize(path) < end, record)
            sizes.add(os.path.getsize(path))
            with open(path, "wb") as stream:
                stream.write(content)
        self.assertEqual(len(sizes), 6)
