# Faults of each class come to what is expected of them, and a case that does not fails.
# SPDX-License-Identifier: BSD-3-Clause
import os

from std_msgs.msg import Float64

from ddm_qa import fault_table as table
from ddm_qa.faults.cases import RECOVERS, Case
from ddm_qa.faults.run import FaultBench
from ddm_qa.faults.watches import Effort, MotorWatch
from ddm_qa.run_comparison import Finished
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
        self.assertGreaterEqual(len(rows), 12)
        self.assertIn("%d passed, 0 failed" % (len(rows) - 1), output)
        self.assertEqual(code, 0, output)

    def test_a_fault_whose_phase_never_comes_is_no_success(self):
        bench = FaultBench(self.scratch)
        never = Case("never", "no such phase", "drop image", RECOVERS, (), False, False)
        self.assertEqual(bench.run(never), "not injected")
        self.assertEqual(table.table([never], {"never": "not injected"})[0][-1], 0)

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
        # one that answers an image before the fault may still act
        self.assertEqual(self.motor([1, 2, 3, 4, 5, 5, 0, 0, 0], [(4.2, 2)]), "zero")

    def test_a_motor_may_run_again_with_the_next_torque_unless_one_was_refused(self):
        again = [1, 2, 3, 4, 4, 0, 0, 0, 9]
        self.assertEqual(self.motor(again, [(8.1, 8)]), "zero")
        self.assertEqual(self.motor(again, [(8.1, 8)], stays_off=True), "driven: 0 0 0 9")

