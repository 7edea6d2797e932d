# reproduce_efficient with a stand-in for sweep: what it runs, keeps, resumes and refuses, and what it makes of it.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import contextlib
import io
import os
import shutil
from unittest import mock

from ddm_study import reproduce_efficient, step_runner
from processes import call_main
from run_files import read_bytes, read_rows, read_yaml
from scratch_case import ScratchCase

TEST = os.path.dirname(os.path.abspath(__file__))
PACKAGE = os.path.dirname(TEST)
WIDTHS = "encoder_widths: [25, 12, 6]"  # those of the stand-in's config.yaml
# Two episodes of what is asked for by: --config FILE --model FILE --seeds A:B --out DIR.
EVALUATE = """mkdir -p "$8" && echo "$4 $6" > "$8/asked" && printf 'seed,success,return\\n350,1,900\\n351,0,600\\n' > "$8/evaluation.csv"
"""
# Keeps the run folders that are given before the last two words, --out FILE.csv.
DIAGNOSIS = """while [ $# -gt 2 ]; do echo "$1"; shift; done > "$out"
"""
PLANTS = sorted({task.plant for task in reproduce_efficient.TASKS.values()})
SEEDS = ["--seeds", "100:125", "--ablation-seeds", "0:4"]
class EfficientReproductionTest(ScratchCase):
    def setUp(self):
        super().setUp()
        for name, text in (("presets/efficient", "model: {residual: true}\n"),
                           ("methods/pilco_state", "trial: {num_steps: 125}\n"),
                           ("methods/oracle", "mpc: {horizon: 15}\n"),
                           ("pendulum", "plant: {length: 1.0}\n"), ("pendulum_gravity", "plant: {gravity: 9.82}\n"),
                           *((plant, "plant: {dt: 0.1}\n") for plant in PLANTS),
                           ("ablations/widths", "# Narrow.\n\nmodel: {%s}\n" % WIDTHS),
                           ("ablations/residual", "# Without residual.\n\nmodel: {residual: false, %s}\n" % WIDTHS),
                           ("tried/starts", "# 8 starts.\n\ntraining: {num_starts: 8}\n"),
                           ("sparse_gp", "sparse_gp: {max_points: 300}\n"),
                           ("nuisances/thin_rod", "# A rod half as wide.\n"), ("nuisances/noise", "# Noise.\n"),
                           ("nuisances/scene_camera", "# Elsewhere.\n"), ("nuisances/scene_colours", "# Others.\n")):
            self.writeConfig(name, text)

        self.writeRunExperiment(code=1)
        self.evaluate = self.writeProgram("evaluate", EVALUATE)
        self.diagnosis = self.writeProgram("task_diagnosis", 'for out; do :; done\n' + DIAGNOSIS)

        def find_program(name):
            return {"sweep": os.path.join(TEST, "stand_in_sweep.py"), "run_experiment": self.run_experiment,
                    "evaluate": self.evaluate, "task_diagnosis": self.diagnosis,
                    "study_figure": os.path.join(PACKAGE, "study", "scripts", name)}.get(
                name, os.path.join(PACKAGE, "scripts", name))

        def package_path(*names, package="ddm_launch"):
            plants = ["pendulum", "pendulum_gravity"] + PLANTS
            self.assertEqual(package == "ddm_sim", names[-1][:-len(".yaml")] in plants, names)
            return os.path.join(self.scratch if names[0] == "config" else PACKAGE, *names)

        for module, name, stand_in in ((step_runner, "find_program", find_program),
                                       (reproduce_efficient, "find_program", find_program),
                                       (step_runner, "package_path", package_path),
                                       (reproduce_efficient, "package_path", package_path)):
            patch = mock.patch.object(module, name, stand_in)
            patch.start()
            self.addCleanup(patch.stop)

    def writeConfig(self, name, text):
        self.write("config/%s.yaml" % name, text)

    def writeRunExperiment(self, code):
        """A stand-in that knows all methods (1), or refuses its options (2)."""
        self.run_experiment = self.writeProgram("run_experiment", "exit %d\n" % code)

    def writeProgram(self, name, text):
        path = self.write(name, "#!/bin/sh\n" + text)
        os.chmod(path, 0o755)
        return path

    def call(self, *arguments, stops=None):
        """Returns (exit code, output) of reproduce_efficient."""
        environment = {} if stops is None else {"STAND_IN_STOPS": stops}
        with mock.patch.dict(os.environ, environment):
            return call_main(reproduce_efficient.main, SEEDS + ["--out", self.out] + list(arguments))

    def assertWorks(self, *arguments, **kwargs):
        code, output = self.call(*arguments, **kwargs)
        self.assertEqual(code, 0, output)
        return output

    def assertFails(self, words, *arguments, **kwargs):
        code, output = self.call(*arguments, **kwargs)
        self.assertEqual(code, 1, output)
        for word in words:
            self.assertIn(word, output)

    def rows(self, *names):
        return read_rows(self.out, *names)[1:]

    def steps(self, part, *arguments):
        """{step: (table, time limit, options of the sweep)} of a part."""
        found = {}

        def run_sweep(runner, step, _):
            words = step.command(runner.out, None)[1:]
            del words[words.index("--out"):words.index("--out") + 2]
            found[step.name] = (step.table, step.limit_s, " ".join(words).replace(self.scratch, ""))

        with mock.patch.object(step_runner.StepRunner, "run_sweep", run_sweep):
            self.call("--only", part, *arguments)
        return found

    def test_the_headline_is_the_preset_on_the_seeds_given(self):
        self.assertEqual(self.steps("efficient"), {"efficient": (
            "trials.csv", None, "--seeds 100:125 --preset efficient --plant pendulum --trials 15")})

    def test_each_ablation_runs_seeds_of_its_own(self):
        words = "--seeds 0:4 --preset efficient --plant pendulum --trials 3"
        self.assertEqual(self.steps("ablation"), {
            "ablation_preset": ("ablation/preset/trials.csv", None, words),
            "ablation_residual": ("ablation/residual/trials.csv", None,
                                  words + " -- --config /config/ablations/residual.yaml"),
            "ablation_widths": ("ablation/widths/trials.csv", None,
                                words + " -- --config /config/ablations/widths.yaml")})

    def test_what_was_tried_stands_beside_the_reference_of_the_ablation(self):
        words = "--seeds 0:4 --preset efficient --plant pendulum --trials "
        self.assertEqual(self.steps("tried"), {
            "ablation_preset": ("ablation/preset/trials.csv", None, words + "3"),
            "tried_starts": ("tried/starts/trials.csv", None, words + "1 -- --config /config/tried/starts.yaml")})

    def test_gravity_has_the_oracle_and_pilco_beside_it(self):
        words = " --preset efficient --plant pendulum_gravity --trials "
        self.assertEqual(self.steps("gravity", "--pilco-seeds", "3", "--pilco-minutes", "30"), {
            "gravity": ("gravity/trials.csv", None, "--seeds 100:120" + words + "19"),
            "gravity_oracle": ("gravity/oracle/trials.csv", None,
                               "--seeds 100:120" + words + "19 -- --method oracle"),
            "gravity_pilco_state": ("gravity/pilco_state/trials.csv", 1800.0,
                                    "--seeds 100:103" + words + "15 -- --method pilco_state --config /config/sparse_gp.yaml")})

    def test_scene_nuisances_have_ten_seeds_and_the_same_frames(self):
        steps = self.steps("tasks")
        self.assertEqual(steps["task_suite_pendulum"][2], "--seeds 100:120 --preset efficient --plant suite_pendulum --trials 9")
        for name in ("scene_camera", "scene_colours"):
            self.assertEqual(steps["task_suite_pendulum_" + name][2], "--seeds 100:110 --preset efficient --plant "
                             "suite_pendulum --trials 9 -- --nuisance " + name)

    def test_each_nuisance_has_twenty_seeds_and_500_frames(self):
        words = "--seeds 100:120 --preset efficient --plant pendulum --trials 4 -- --nuisance "
        self.assertEqual(self.steps("nuisances"), {
            "nuisance_noise": ("nuisances/noise/trials.csv", None, words + "noise"),
            "nuisance_thin_rod": ("nuisances/thin_rod/trials.csv", None, words + "thin_rod")})

    def test_each_task_is_a_plant_of_its_own(self):
        words = "--seeds 100:120 --preset efficient --plant "
        self.assertEqual(self.steps("tasks")["task_two_link"], (
            "tasks/two_link/trials.csv", None, words + "two_link --trials 19"))

    def test_all_parts_leave_their_tables_and_figures(self):
        output = self.assertWorks()
        self.assertEqual(len(self.rows("trials.csv")), 25 * 16)
        self.assertEqual(self.rows("success_rate.csv")[0][:3], ["100", "25", "0.52"])  # 13 even seeds
        self.assertEqual(self.rows("times.csv")[-2:], [["median", "32", "212", "4"], ["largest", "32", "224", "4"]])
        differences = {(row[0], row[2]): row[4:] for row in self.rows("ablation.csv")}
        self.assertEqual(differences["residual", "100"][:3], ["0", "0", "-0.5"])
        self.assertEqual(differences["widths", "200 to 400"], ["0", "0", "-1", "0", "0.125", "0.25"])
        self.assertEqual(differences["preset", "200 to 400"][2:], ["0", "0", "", ""])
        self.assertEqual({row[0]: row[1] for row in self.rows("ablation.csv")},
                         {"preset": "Full preset", "residual": "Without residual", "widths": "Narrow"})
        self.assertEqual([row[0] for row in self.rows("gravity.csv")],
                         20 * ["ddm"] + 16 * ["pilco_state"] + 20 * ["oracle"])
        self.assertEqual([row[:4] for row in self.rows("nuisances.csv") if row[1] == "500"], [
            ["none", "500", "20", "1"], ["noise", "500", "20", "0"], ["thin_rod", "500", "20", "0"]])
        self.assertEqual([row[:3] for row in self.rows("tried.csv")], [
            [name, label, frames] for name, label in (("preset", "Full preset"), ("starts", "8 starts"))
            for frames in ("100", "200", "100 to 200")])
        self.assertEqual([row[1:6] for row in self.rows("tasks.csv") if row[0] == "two_link"][:2], [
            ["100", "", "10", "20", "0.5"], ["200", "", "20", "20", "1"]])
        self.assertEqual([row[1:6] + row[8:] for row in self.rows("tasks.csv") if row[0] == "suite_reacher"][1], [
            "200", "1000", "20", "20", "1", "100", "0"])
        self.assertEqual(self.rows("tasks", "suite_pendulum", "last_models.csv")[0], ["100", "2", "0.5", "750"])
        asked = self.file(self.out, "runs", "task_suite_pendulum", "seed_0100", "last_model", "asked")
        with open(asked) as stream:
            self.assertRegex(stream.read(), "seed_0100/trial_009/model.ddm 350:360")
        with open(self.file(self.out, "tasks", "two_link", "diagnosis.csv")) as stream:
            folders = stream.read().split()
        self.assertEqual([os.path.basename(folder) for folder in folders], ["seed_%04d" % seed for seed in range(100, 120)])
        for name in ("success_rate", "ablation", "tried", "gravity", "nuisances", "suite_pendulum", "suite_reacher",
                     "suite_reacher_hard", "suite_cartpole", "suite_acrobot"):
            self.assertEqual(read_bytes(self.out, name + ".png")[:4], b"\x89PNG", name)
        for folder in ("", "gravity"):
            config = read_yaml(self.out, folder, "config.yaml")
            self.assertEqual(config["version"], "made up")
            self.assertEqual(config["experiment"]["runs"], "runs/%s/seed_0100" % (folder or "efficient"))
        machine = read_yaml(self.out, "machine.yaml")
        self.assertEqual(machine["preset"], "efficient")
        self.assertEqual({name: step["seeds_run"] for name, step in machine["steps"].items()}, {
            "efficient": 25, "ablation_preset": 4, "ablation_residual": 4, "ablation_widths": 4, "tried_starts": 4, "gravity": 20,
            "gravity_oracle": 20, "gravity_pilco_state": 4, "nuisance_noise": 20, "nuisance_thin_rod": 20, "task_two_link": 20,
            "task_suite_pendulum": 20, "task_suite_reacher": 20, "task_suite_reacher_hard": 20,
            "task_suite_pendulum_scene_camera": 10, "task_suite_pendulum_scene_colours": 10, "task_suite_cartpole": 20,
            "task_suite_acrobot": 20})
        self.assertRegex(output, r"(?m)^no .*nuisances, 200 to 500 frames.*0.000")
        self.assertRegex(output, r"(?m)^yes .*suite_pendulum with a mean return of 700: >= 16 of 20; here 20 of 20")
        self.assertRegex(output, r"(?m)^yes .*suite_pendulum_scene_camera with a mean return of 700: >= 5 of 10; here 10 of 10")
        self.assertRegex(output, r"(?m)^no .*suite_reacher with a mean return of 800: >= 16 of 20; here 0 of 20")
        self.assertRegex(output, r"(?m)^yes .*mean success of two_link, 1000 to 2000 frames.*1.000")

    def test_one_task_with_its_nuisance_alone(self):
        self.assertWorks("--only", "tasks", "--tasks", "suite_pendulum_scene_camera")
        self.assertEqual(os.listdir(self.file(self.out, "tasks")), ["suite_pendulum_scene_camera"])
        self.assertEqual(list(read_yaml(self.out, "machine.yaml")["steps"]), ["task_suite_pendulum_scene_camera"])

    def test_an_ablation_that_changes_nothing_is_told(self):
        output = self.assertWorks("--only", "ablation")
        self.assertIn("config/ablations/widths.yaml", output)
        self.assertNotIn("config/ablations/residual.yaml", output)

    def test_only_the_parts_that_are_named_are_made(self):
        self.assertWorks("--only", "nuisances", "ablation")
        self.assertEqual(sorted(name for name in os.listdir(self.out) if name.endswith(".png")),
                         ["ablation.png", "nuisances.png"])
        self.assertEqual([row[0] for row in self.rows("nuisances.csv")], 5 * ["noise"] + 5 * ["thin_rod"])

    def test_a_step_that_fails_names_its_log_and_the_same_command_goes_on(self):
        self.assertFails(["logs/efficient.log"],
                         "--only", "efficient", stops="fail:10")
        self.assertFalse(os.path.exists(os.path.join(self.out, "trials.csv")))
        self.assertEqual(read_yaml(self.out, "machine.yaml")["steps"]["efficient"]["seeds_run"], 10)
        self.assertWorks("--only", "efficient")
        self.assertEqual(read_yaml(self.out, "machine.yaml")["steps"]["efficient"]["seeds_run"], 25)

    def test_finished_results_of_changed_settings_are_refused(self):
        self.assertWorks("--only", "ablation")
        self.writeConfig("ablations/residual", "# Another label.\n\nmodel: {residual: false, %s}\n" % WIDTHS)
        self.assertWorks("--only", "ablation")  # a comment is no setting
        self.assertIn("Another label", {row[1] for row in self.rows("ablation.csv")})
        self.writeConfig("ablations/residual",
                         "# Without residual.\n\nmodel: {residual: false, order: 3, %s}\n" % WIDTHS)
        self.assertFails(["runs/ablation_residual",
                          "residual.yaml/model/order"], "--only", "ablation")
        shutil.rmtree(os.path.join(self.out, "runs", "ablation_residual"))
        self.assertWorks("--only", "ablation")
        self.writeConfig("presets/efficient", "model: {residual: false}\n")
        self.assertFails(["runs/ablation_preset", "preset efficient/model/residual"],
                         "--only", "ablation")

    def test_finished_results_of_a_changed_plant_are_refused(self):
        self.assertWorks("--only", "nuisances")
        self.writeConfig("pendulum", "plant: {length: 1.5}\n")
        self.assertFails(["runs/nuisance_noise", "plant pendulum/plant/length", "1.0", "1.5"],
                         "--only", "nuisances")

    def test_finished_seeds_of_unknown_settings_are_refused(self):
        self.assertWorks("--only", "nuisances")
        folder = os.path.join(self.out, "runs", "nuisance_noise")
        os.remove(os.path.join(folder, "settings.yaml"))
        self.assertFails([folder, "settings.yaml"],
                         "--only", "nuisances")
        for seed in range(100, 120):
            os.remove(os.path.join(folder, "seed_%04d" % seed, "summary.yaml"))
        self.assertWorks("--only", "nuisances")

    def test_configurations_of_the_same_name_are_both_settings(self):
        self.writeConfig("a/more", "model: {order: 2}\n")
        self.writeConfig("b/more", "model: {order: 3}\n")
        paths = [self.file("config", name, "more.yaml") for name in "ab"]
        step = step_runner.SweepStep("step", "trials.csv", range(1), [], ["--config", paths[0], "--config", paths[1]])
        self.assertEqual(step.settings(), {"config 1 more.yaml": {"model": {"order": 2}},
                                           "config 2 more.yaml": {"model": {"order": 3}}})

    def test_seeds_that_did_not_run_are_bound_to_no_settings(self):
        with mock.patch.object(step_runner, "find_program", lambda name: "/bin/false"):
            self.assertFails(["logs/ablation_preset.log"], "--only", "ablation")
        self.writeConfig("presets/efficient", "model: {residual: true, order: 3}\n")
        self.assertWorks("--only", "ablation")

    def runSweep(self, runner, step, stops=""):
        """Returns by how much the bar has moved."""
        bar = mock.Mock()
        with mock.patch.dict(os.environ, {"STAND_IN_STOPS": stops or ":-1"}), \
                contextlib.redirect_stdout(io.StringIO()):
            runner.run_sweep(step, bar)
        return sum(call[0][0] for call in bar.update.call_args_list)

    def test_a_sweep_ends_when_its_time_is_up_and_keeps_the_trials_that_are_finished(self):
        step = step_runner.SweepStep("limited", "limited/trials.csv", range(5, 8), ["--trials", "2"], limit_s=6.0)
        runner = step_runner.StepRunner("test", self.out, {}, None)
        os.makedirs(runner.path("logs"))
        expected = [["5", "0"], ["5", "1"], ["5", "2"], ["6", "0"]]
        self.assertEqual(self.runSweep(runner, step, stops="wait:1"), 3)
        self.assertEqual([row[:2] for row in self.rows("limited", "trials.csv")], expected)
        self.assertGreater(runner.measured["limited"]["wall_s"], 5.5)

        os.remove(runner.path("limited", "trials.csv"))
        self.assertEqual(self.runSweep(runner, step), 3)  # no time is left: it only keeps what there is
        self.assertEqual([row[:2] for row in self.rows("limited", "trials.csv")], expected)

        step.limit_s = 60.0
        self.assertEqual(self.runSweep(runner, step), 3)
        self.assertEqual(len(self.rows("limited", "trials.csv")), 9)

    def test_a_sweep_whose_folder_was_removed_has_all_its_time_again(self):
        step = step_runner.SweepStep("limited", "limited/trials.csv", range(5, 8), ["--trials", "2"], limit_s=30.0)
        runner = step_runner.StepRunner("test", self.out, {}, None)
        os.makedirs(runner.path("logs"))
        self.runSweep(runner, step)
        runner.measured["limited"].update(wall_s=30.0, seeds_run=7)
        shutil.rmtree(step.folder(self.out))
        self.runSweep(runner, step)
        self.assertEqual(len(self.rows("limited", "trials.csv")), 9)
        self.assertEqual(runner.measured["limited"]["seeds_run"], 3)
        self.assertLess(runner.measured["limited"]["wall_s"], 30.0)

    def test_time_that_a_removed_folder_had_used_is_gone_from_the_file_before_the_sweep_runs(self):
        step = step_runner.SweepStep("limited", "limited/trials.csv", range(5, 8), ["--trials", "2"], limit_s=30.0)
        runner = step_runner.StepRunner("test", self.out, {}, None)
        os.makedirs(runner.path("logs"))
        runner.measured = {"limited": {"wall_s": 30.0}, "other": {"wall_s": 1.0}}

        def call_sweep(*_):
            self.assertEqual(read_yaml(self.out, "machine.yaml")["steps"], {"other": {"wall_s": 1.0}})
            raise KeyboardInterrupt

        with mock.patch.object(runner, "call_sweep", call_sweep):
            self.assertRaises(KeyboardInterrupt, self.runSweep, runner, step)

    def test_a_sweep_whose_time_is_up_keeps_no_table_of_removed_seeds(self):
        step = step_runner.SweepStep("limited", "limited/trials.csv", range(5, 8), ["--trials", "2"], limit_s=30.0)
        runner = step_runner.StepRunner("test", self.out, {}, None)
        os.makedirs(runner.path("logs"))
        self.runSweep(runner, step)
        shutil.rmtree(step.folder(self.out))
        step.limit_s = 0.5  # too little to begin
        self.runSweep(runner, step)
        self.assertFalse(os.path.exists(runner.path("limited", "trials.csv")))

    def test_time_counts_even_if_no_seed_is_finished_in_it(self):
        step = step_runner.SweepStep("limited", "limited/trials.csv", range(5, 8), ["--trials", "2"], limit_s=2.0)
        runner = step_runner.StepRunner("test", self.out, {}, None)
        os.makedirs(runner.path("logs"))
        self.assertEqual(self.runSweep(runner, step, stops="wait:0"), 3)
        self.assertEqual(runner.measured["limited"]["seeds_run"], 0)
        self.assertGreater(runner.measured["limited"]["wall_s"], 1.5)

    def test_a_sweep_whose_time_is_up_before_the_first_trial_has_no_table(self):
        step = step_runner.SweepStep("limited", "limited/trials.csv", range(5, 8), ["--trials", "2"], limit_s=0.5)
        runner = step_runner.StepRunner("test", self.out, {}, None)
        self.assertEqual(self.runSweep(runner, step), 3)
        self.assertFalse(os.path.exists(runner.path("limited")))

    def test_a_method_without_a_table_has_no_curve(self):
        for folder in ("gravity", "gravity/oracle"):
            os.makedirs(os.path.join(self.out, folder), exist_ok=True)
            open(os.path.join(self.out, folder, "trials.csv"), "w").close()
        reproduction = reproduce_efficient.EfficientReproduction(argparse.Namespace(
            preset="efficient", out=self.out, jobs=None, seeds=range(2), pilco_seeds=0, only=["gravity"]))
        self.assertEqual([word.split("=")[0] for word in reproduction.gravity().figures()["gravity"][2:4]],
                         ["efficient", "oracle"])

    def test_a_method_a_plant_or_a_nuisance_that_is_not_there_is_told_before_anything_runs(self):
        for name, part in (("methods/pilco_state", "gravity"), ("methods/oracle", "gravity"),
                           ("pendulum_gravity", "gravity"),
                           ("pendulum", "nuisances")):
            path = self.file("config", name + ".yaml")
            os.rename(path, path + ".away")
            self.assertFails([part, path], "--only", "gravity", "nuisances")
            os.rename(path + ".away", path)
        path = self.file("config", "nuisances", "noise.yaml")
        os.remove(path)
        with mock.patch.object(reproduce_efficient, "yaml_names", lambda _: {"noise": path}):
            self.assertFails(["nuisances", path], "--only", "nuisances")
        self.assertFalse(os.path.exists(os.path.join(self.out, "runs")))

    def test_a_preset_that_no_part_can_do_without_must_be_another(self):
        self.assertFails(["presets/nowhere.yaml", "--preset"], "--preset", "nowhere")

    def test_a_build_without_pilco_is_told_before_anything_runs_unless_pilco_is_left_out(self):
        self.writeRunExperiment(code=2)
        self.assertFails(["DDM_PILCO", "--pilco-seeds 0"])
        self.assertFalse(os.path.exists(os.path.join(self.out, "runs")))
        self.assertWorks("--only", "nuisances")
        self.assertWorks("--only", "gravity", "--pilco-seeds", "0")
        self.assertEqual({row[0] for row in self.rows("gravity.csv")}, {"ddm", "oracle"})

    def test_results_of_pilco_that_would_be_left_out_are_refused(self):
        self.assertWorks("--only", "gravity")
        self.assertFails(["gravity/pilco_state/trials.csv", "--pilco-seeds 0"],
                         "--only", "gravity", "--pilco-seeds", "0")

    def test_an_ablation_without_a_label_is_refused_before_anything_runs(self):
        self.writeConfig("ablations/residual", "model: {residual: false}\n")
        self.assertFails(["ablations/residual.yaml", "model: {residual: false}"])
        self.assertFalse(os.path.exists(os.path.join(self.out, "runs")))

    def test_an_ablation_with_the_name_of_the_reference_is_refused(self):
        self.writeConfig("ablations/preset", "# Preset.\n")
        self.assertFails(["ablations/preset.yaml"], "--only", "ablation")

    def test_a_part_without_files_is_refused_before_anything_runs(self):
        shutil.rmtree(self.file("config", "nuisances"))
        self.assertFails(["config/nuisances", "--only"])
        self.assertFalse(os.path.exists(os.path.join(self.out, "runs")))

    def test_another_preset_takes_the_place_of_both(self):
        self.writeConfig("presets/debug", "model: {residual: true}\n")
        _, _, words = self.steps("gravity", "--preset", "debug")["gravity"]
        self.assertIn("--preset debug --plant pendulum_gravity", words)

    def test_wrong_options_end_with_code_2(self):
        for arguments in (["--only", "figures"], ["--seeds", "100"], ["--pilco-minutes", "0"], ["--pilco-seeds", "-1"]):
            self.assertEqual(self.call(*arguments)[0], 2)
        self.assertFalse(os.path.exists(self.out))
