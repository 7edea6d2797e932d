# run_experiment: its files, that a seed fixes them, that an interruption changes nothing, and what it refuses.
# SPDX-License-Identifier: BSD-3-Clause
import os
import pty
import signal
import time

from processes import Process, call, find_program, run_experiment
from run_files import COLUMNS, differences, expected_files, files_in, read_bag, read_bytes, read_rows, read_yaml
from scratch_case import SharedScratchCase

TRIALS = 2


def wait_for_file(path, limit_s):
    end = time.monotonic() + limit_s
    while not os.path.exists(path):
        if time.monotonic() > end:
            raise TimeoutError("%s was not written within %g s" % (path, limit_s))
        time.sleep(0.001)


class RunExperimentTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.reference = os.path.join(cls.class_scratch, "reference")
        cls.code, cls.output = run_experiment("--preset", "debug", "--seed", 1, "--trials", TRIALS,
                                              "--out", cls.reference)

    def debug(self, trials=TRIALS, seed=1, out=None):
        """Arguments of the reference run, into another folder."""
        return ["--preset", "debug", "--seed", seed, "--trials", trials, "--out", out or self.out]

    def assertRuns(self, *arguments):
        code, output = run_experiment(*arguments)
        self.assertEqual(code, 0, output)
        return output

    def assertRefused(self, code, words, *arguments):
        actual, output = run_experiment(*arguments)
        self.assertEqual(actual, code, output)
        for word in words:
            self.assertIn(word, output)

    def test_all_files_of_the_contract_are_written_and_no_other(self):
        self.assertEqual(self.code, 0, self.output)
        self.assertEqual(files_in(self.reference), expected_files(TRIALS))

    def test_trials_csv_has_one_row_more_than_trials(self):
        rows = read_rows(self.reference, "trials.csv")
        self.assertEqual(rows[0], COLUMNS)
        self.assertEqual([row[:3] for row in rows[1:]], [["1", "0", "30"], ["1", "1", "60"], ["1", "2", "90"]])
        for row in rows[1:]:
            self.assertIn(row[3], ("0", "1"))
            self.assertTrue(all(float(value) >= 0.0 for value in row[:-2]))
            self.assertEqual(row[-2:], [read_yaml(self.reference, "config.yaml")["version"], ""])  # it has no reward

    def test_torques_are_exact_bounded_and_tell_which_are_random(self):
        for k in range(TRIALS + 1):
            for kind, exploratory in (("trial", {"1"} if k == 0 else {"0", "1"}), ("evaluation", {"0"})):
                rows = read_rows(self.reference, "%s_%03d" % (kind, k), "torques.csv")
                self.assertEqual(rows[0], ["step", "torque_nm", "exploratory"])
                self.assertEqual([row[0] for row in rows[1:]], [str(step) for step in range(30)])
                self.assertTrue(all(abs(float(row[1])) <= 6.0 for row in rows[1:]))
                self.assertTrue(all("%.17g" % float(row[1]) == row[1] for row in rows[1:]))
                self.assertLessEqual({row[2] for row in rows[1:]}, exploratory)

    def test_the_trajectory_has_a_state_for_each_torque(self):
        rows = read_rows(self.reference, "evaluation_000", "trajectory.csv")
        self.assertEqual(rows[0], ["step", "time_s", "angle_rad", "rate_rad_per_s"])
        self.assertEqual(len(rows), 31)
        self.assertAlmostEqual(float(rows[30][1]), 29 * 0.2)

    def test_each_bag_holds_a_torque_for_each_image_and_the_goal(self):
        for k in range(TRIALS + 1):
            stamps = read_bag(os.path.join(self.reference, "trial_%03d" % k, "trial.bag"))
            self.assertEqual(len(stamps["camera/image_raw"]), 30)
            self.assertEqual(stamps["camera/image_raw"], stamps["torque"])
            self.assertEqual(len(stamps["goal_image"]), 1)

    def test_the_saved_configuration_is_the_effective_one(self):
        config = read_yaml(self.reference, "config.yaml")
        self.assertRegex(config["version"], r"^[0-9.]+ \(")
        self.assertEqual(config["experiment"]["preset"], "debug")
        self.assertEqual(config["experiment"]["seed"], 1)
        self.assertEqual(config["trial"]["num_steps"], 30)
        self.assertEqual(config["model"]["feature_dim"], 2)

    def test_the_same_seed_gives_the_same_files_but_for_times(self):
        self.assertRuns(*self.debug())
        self.assertEqual(differences(self.reference, self.out, expected_files(TRIALS)), [])

    def test_another_seed_gives_other_torques(self):
        self.assertRuns(*self.debug(seed=2, trials=0))
        for name in ("trial_000/torques.csv", "evaluation_000/torques.csv"):
            self.assertNotEqual(read_bytes(self.reference, name), read_bytes(self.out, name))

    def test_a_run_that_was_killed_goes_on_as_if_nothing_had_happened(self):
        trials = 12
        for finished in (0, 3, 6):
            process = Process([find_program("run_experiment")] + self.debug(trials))
            process.waitForText("trial %2d/%d" % (finished, trials), 30.0)
            process.send(signal.SIGKILL)
            process.waitForEnd(10.0)
            self.assertNotIn("summary.yaml", files_in(self.out))
        self.assertRuns(*self.debug(trials))
        uninterrupted = self.file("uninterrupted")
        self.assertRuns(*self.debug(trials, out=uninterrupted))
        self.assertEqual(differences(uninterrupted, self.out, expected_files(trials)), [])

    def test_a_run_that_was_killed_in_a_training_or_evaluation_does_not_repeat_the_recording(self):
        slow = self.write("slow.yaml", "training: {max_iterations: 1000, function_tolerance: 0.0}\n"
                                       "trial: {num_steps: 1000}\n")
        for trial, last, said in ((0, "torques.csv", "is recorded already"), (1, "training.yaml", "is trained already")):
            arguments = ["--config", slow] + self.debug(trials=trial)
            folder = os.path.join(self.out, "trial_%03d" % trial)
            process = Process([find_program("run_experiment")] + arguments)
            wait_for_file(os.path.join(folder, last), 60.0)
            process.send(signal.SIGKILL)
            process.waitForEnd(10.0)
            before = read_bytes(folder, "trial.bag")
            self.assertIn(said, self.assertRuns(*arguments))
            self.assertEqual(read_bytes(folder, "trial.bag"), before)
        uninterrupted = self.file("uninterrupted")
        self.assertRuns("--config", slow, *self.debug(trials=1, out=uninterrupted))
        self.assertEqual(differences(uninterrupted, self.out, expected_files(1)), [])

    def test_a_saved_configuration_can_be_given_again(self):
        self.assertRuns("--repeat", self.reference, "--seed", 1, "--trials", 1, "--out", self.out)
        names = ["trial_001/torques.csv", "evaluation_001/torques.csv"]
        self.assertEqual(differences(self.reference, self.out, names), [])

    def test_help_names_every_option(self):
        code, output = run_experiment("--help")
        self.assertEqual(code, 0)
        for option in ("--preset", "--plant", "--nuisance", "--seed", "--trials", "--out", "--config", "--method",
                       "--help"):
            self.assertIn(option, output)
        for method in ("ddm", "oracle"):
            self.assertIn(method + ": ", output)

    def test_bad_options_are_refused_by_name(self):
        out = ["--out", self.out]
        for words, arguments in (
                (["--nonsense"], out + ["--nonsense"]),
                (["'--out'"], ["--preset", "debug"]),
                (["unknown preset 'papier'", "debug, efficient, paper"], out + ["--preset", "papier"]),
                (["unknown plant 'sim'", "pendulum, pendulum_gravity"], out + ["--plant", "sim"]),
                (["unknown configuration 'nuisance/fog'", "nuisance/drops, nuisance/noise"], out + ["--nuisance", "noise", "--nuisance", "fog"]),
                (["unknown method 'pilko'", "ddm, oracle"], out + ["--method", "pilko"]),
                (["experiment/seed", "-1"], out + ["--seed", "-1"]),
                (["experiment/trials", "-2"], out + ["--trials", "-2"]),
                (["experiment/trials", "1000"], out + ["--trials", "1000"]),
                (["--seed", "one"], out + ["--seed", "one"]),
                (["--seed", "1.5"], out + ["--seed", "1.5"]),
                (["--seed", "99999999999"], out + ["--seed", "99999999999"]),
                (["--trials"], out + ["--trials", ""]),
                (["--trials", "3x"], out + ["--trials", "3x"]),
                (["positional"], out + ["paper"])):
            self.assertRefused(2, words, *arguments)
        self.assertFalse(os.path.exists(self.out))

    def test_nuisances_add_up_and_a_configuration_knows_better(self):
        mild = self.write("mild.yaml", "camera: {noise_std: 0.02}\n")
        self.assertRuns("--nuisance", "noise", "--nuisance", "delay", "--config", mild, *self.debug(0))
        camera = read_yaml(self.out, "config.yaml")["camera"]
        self.assertEqual((camera["noise_std"], camera["delay"], camera["clutter"]), (0.02, 1, 0.0))

    def test_a_trial_counts_the_frames_that_are_seen(self):
        self.assertRuns("--nuisance", "drops", *self.debug(0))
        self.assertEqual(read_rows(self.out, "trials.csv")[1][2], "30")
        times = [float(row[1]) for row in read_rows(self.out, "trial_000", "trajectory.csv")[1:]]
        stamps = read_bag(os.path.join(self.out, "trial_000", "trial.bag"))["camera/image_raw"]
        self.assertEqual(len(times), 30)
        self.assertGreater(times[-1], 29 * 0.2 + 0.1)
        for seen, stamp in zip(times, stamps):
            self.assertAlmostEqual(seen, (stamp - stamps[0]) * 1e-9, places=6)

    def test_real_time_is_refused(self):
        real_time = self.write("real_time.yaml", "sim: {lockstep: false}\n")
        code, output = run_experiment("--config", real_time, *self.debug())
        self.assertIn(code, (1, 2))
        self.assertIn("sim/lockstep", output)
        self.assertFalse(os.path.exists(self.out))

    def test_a_folder_that_cannot_be_written_is_named(self):
        for out in (self.write("plain_file", ""), "/proc/ddm"):
            self.assertRefused(1, ["cannot", out], *self.debug(out=out))

    def test_a_terminal_shows_a_bar_and_a_file_does_not(self):
        self.assertNotIn("\033", self.output)
        self.assertNotIn("[###", self.output)
        try:
            master, slave = pty.openpty()
        except OSError as error:  # a bare chroot; what is drawn on a terminal is also tested in progress_test.cpp
            self.skipTest("this system gives no terminal: %s" % error)
        self.addCleanup(os.close, master)
        code, _ = call([find_program("run_experiment")] + self.debug(0), output=slave)
        os.close(slave)
        shown = b""
        while b"results:" not in shown:
            shown += os.read(master, 4096)
        self.assertEqual(code, 0)
        for part in (b"random", b"train", b"evaluate", b"[....", b"\r"):
            self.assertIn(part, shown)
