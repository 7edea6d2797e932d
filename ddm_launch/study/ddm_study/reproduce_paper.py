# Runs the paper's experiments and turns them into tables and figures, with one command.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch.command import find_program, number, package_path, program_parser
from ddm_launch.run_folder import Evaluation, read_trials
from ddm_launch.tables import write_csv
from ddm_study import pilco_runs, pilco_tables
from ddm_study.paper_tables import write_tables
from ddm_study.schedules import SCHEDULES
from ddm_study.step_runner import Part, StepRunner, SweepStep, verdict_lines

NUM_ANGLE_SEEDS = 16  # as in the paper's Fig. 7
NUM_SCHEDULE_SEEDS = 25  # of each schedule but the paper's own
NUM_PREDICTION_SEEDS = 20
NUM_BFGS_SEEDS = 10
BFGS_TRIALS = 4  # a training takes a minute
FIGURE_SEED = 0  # which seed the figures of a single model show
FIGURE_STEP = 1
TRIALS = 15
PAPER_TRIALS = range(15)  # ours that have the 100 to 1500 frames of the paper's figures
# Name of the step, --method, seeds, --trials, file of config/ for --config.
PILCO = (("pilco_state", "pilco_state", 12, 9, None),
         ("pilco_state_sparse", "pilco_state", 2, 9, "sparse_gp.yaml"),
         ("pilco_features", "pilco_features", 5, 15, None),
         ("pilco_pca", "pilco_pca", 1, 5, None))
NUM_DISTRIBUTION_SEEDS = 3
DISTRIBUTION_TRIALS = (0, 1, 2, 3, 5, 7)  # after 125 to 1000 frames
DISTRIBUTION_SECONDS = 3  # a swing-up takes one; what happens later shows in the success rate

ABOUT = """\
Reproduces the paper's experiments: success on the pendulum (Fig. 7 and 8) with the oracle, PILCO and other training
schedules and BFGS for comparison, predictions of the moving tile (Fig. 4 and 5) and of the pendulum, the feature space (Fig. 6),
tables and figures. PILCO takes hours, all else minutes: --without-pilco leaves it out. The same command resumes;
without that option it adds PILCO."""

EPILOG = """\
DIR gets the rows of all seeds, tables and figures; the files are explained in ddm_launch/results/paper/PROVENANCE.md.
agreement.csv: what holds of the paper's claims. machine.yaml: how each step was made. runs/, logs/: everything that the
programs left, which the figures do not need."""


def config_option(*names):
    return ["--config", package_path("config", *names)]


def sweep_steps(preset, num_seeds, configs, with_pilco):
    """All sweeps, the paper's own first, PILCO's, the long ones, last. configs: words that come last in each."""
    steps = []

    def add(name, table, most_seeds, words, more=()):
        steps.append(SweepStep(name, table, range(min(num_seeds, most_seeds)), ["--preset", preset] + words,
                               more + configs))

    def add_trials(name, folder, most_seeds, trials, more):
        add(name, os.path.join(folder, "trials.csv"), most_seeds, ["--plant", "pendulum", "--trials", str(trials)], more)

    def add_predictions(name, folder, plant, more):
        add(name, folder + "/predictions.csv", NUM_PREDICTION_SEEDS,
            ["--program", "prediction_experiment", "--plant", plant], more)

    options = {schedule: [] if schedule == "joint" else config_option("schedules", schedule + ".yaml")
               for schedule in SCHEDULES}
    add_trials("joint", "", num_seeds, TRIALS, [])
    add_trials("oracle", "oracle", num_seeds, TRIALS, ["--method", "oracle"])
    for schedule in SCHEDULES[1:]:
        add_trials(schedule, schedule, NUM_SCHEDULE_SEEDS, TRIALS, options[schedule])
    add_trials("bfgs", "bfgs", NUM_BFGS_SEEDS, BFGS_TRIALS, config_option("bfgs.yaml"))
    add_predictions("tile", "tile", "moving_tile", [])
    for plant, folder in (("moving_tile", "tile_predictions"), ("pendulum", "pendulum_predictions")):
        for schedule in SCHEDULES:  # one start each: the best of several would be a random one of most schedules
            add_predictions("%s_%s" % (folder, schedule), "%s/%s" % (folder, schedule), plant,
                            config_option("single_start.yaml") + options[schedule])
    for name, method, most_seeds, trials, config in PILCO if with_pilco else ():
        add_trials(name, name, most_seeds, trials, ["--method", method] + (config_option(config) if config else []))
    return steps


class Reproduction(StepRunner):
    def __init__(self, options):
        super().__init__("reproduce_paper", options.out, {"preset": options.preset}, options.jobs)
        configs = [word for path in options.config for word in ("--config", os.path.abspath(path))]
        self.steps = sweep_steps(options.preset, options.seeds, configs, not options.without_pilco)
        self.by_name = {step.name: step for step in self.steps}
        self.pilco = [self.by_name[row[0]] for row in PILCO if row[0] in self.by_name]
        self.agreement = []

    def parts(self):
        self.require_pilco("pilco.csv", bool(self.pilco), "--without-pilco")
        return {"paper": Part(self.steps, self.write_tables, self.figure_commands)}

    def verdict(self):
        return verdict_lines(self.agreement)

    def write_tables(self):
        self.collect()
        self.agreement = write_tables(self.out, package_path("results", "published", "success_rate.csv"),
                                      [step.name for step in self.pilco])

    def collect(self):
        """What the figures need of single runs."""
        joint = self.by_name["joint"]
        self.write_angles(joint)
        folder = joint.seed_folder(self.out, FIGURE_SEED)
        self.keep_config(joint, "config.yaml")
        trial = PAPER_TRIALS[-1]
        self.keep(os.path.join(folder, "trial_%03d" % trial, "model.ddm"), "pendulum/model.ddm")
        self.call("feature_space", [find_program("feature_space"), folder, "--trial", str(trial), "--step",
                                    str(FIGURE_STEP), "--out", self.path("pendulum", "feature_space.csv")])
        for step, kept in (("tile", "tile"), ("tile_predictions_sequential", "tile_predictions/sequential")):
            self.keep_config(self.by_name[step], kept + "/config.yaml")
            folder = self.by_name[step].seed_folder(self.out, FIGURE_SEED)
            for name in ("features.csv", "model.ddm", "strip.csv"):
                self.keep(os.path.join(folder, name), "%s/%s" % (kept, name))
        if self.pilco:
            self.collect_pilco()

    def collect_pilco(self):
        for step in self.pilco:
            self.keep_config(step, step.name + "/config.yaml")
            write_csv(self.path(step.name, "policy_search.csv"), ["seed", "trial", "frames"] + pilco_runs.SEARCH_KEYS,
                      pilco_runs.search_rows(step.seed_folders(self.out)))
        folders = self.by_name["pilco_state"].seed_folders(self.out, NUM_DISTRIBUTION_SEEDS)
        write_csv(self.path("trajectory_distributions.csv"), pilco_runs.DISTRIBUTION_COLUMNS,
                  pilco_runs.distribution_rows(folders, DISTRIBUTION_TRIALS))

    def write_angles(self, step):
        rows = []
        for seed, folder in step.seed_folders(self.out, NUM_ANGLE_SEEDS).items():
            trials = read_trials(folder)
            for trial in PAPER_TRIALS:
                run = Evaluation(folder, trial)
                for k, (time_s, angle_rad) in enumerate(zip(run.time_s, run.angle_rad)):
                    rows.append((seed, trials[trial].frames, int(trials[trial].success), k, "%.3f" % time_s,
                                 "%.4f" % angle_rad))
        write_csv(self.path("angle_trajectories.csv"), ["seed", "frames", "success", "step", "time_s", "angle_rad"],
                  rows)

    def figure_commands(self):
        """{name: command} of the figures; all read nothing but what is kept."""
        methods = [("DDM + MPC", "trials.csv")]
        methods += [(pilco_tables.LABELS[step.name], step.table) for step in self.pilco
                    if step.name != "pilco_state_sparse"]  # that one is in the tables
        methods.append(("oracle", "oracle/trials.csv"))
        product = {
            "success_rate": ["%s=%s" % (label, self.path(table)) for label, table in methods] +
            ["--published", package_path("results", "published", "success_rate.csv")]}
        study = {"angle_trajectories": [self.path("angle_trajectories.csv")], "schedules_compared": [self.out],
                 "pendulum_feature_space": [self.path("pendulum", "feature_space.csv"), "--model",
                                            self.path("pendulum", "model.ddm")],
                 "prediction_strip": [self.path("tile")],
                 "feature_plane": [self.path("tile"), self.path("tile_predictions", "sequential")]}
        if self.pilco:
            study["trajectory_distributions"] = [self.path("trajectory_distributions.csv"), "--seconds",
                                                 str(DISTRIBUTION_SECONDS)]
        return {name: self.figure(program, name, words)
                for program, figures in (("figure", product), ("study_figure", study)) for name, words in figures.items()}


def main(arguments=None):
    parser = program_parser("reproduce_paper", ABOUT, EPILOG)
    parser.add_argument("--seeds", type=number(int, 1), default=50, metavar="N",
                        help="seeds 0 ... N - 1 of the paper's experiment, default 50; at most %d of each other "
                        "schedule, %d of BFGS, %d of each prediction experiment, and %s of PILCO" % (
                            NUM_SCHEDULE_SEEDS, NUM_BFGS_SEEDS, NUM_PREDICTION_SEEDS, ", ".join(str(row[2]) for row in PILCO)))
    parser.add_argument("--out", default="paper_results", metavar="DIR", help="default paper_results")
    parser.add_argument("--preset", default="paper", help="default paper; debug is for a quick look at the path")
    parser.add_argument("--without-pilco", action="store_true", help="leave out PILCO, which takes hours")
    parser.add_argument("--config", action="append", default=[], metavar="FILE",
                        help="YAML file with overrides for all experiments; repeatable, later files win")
    parser.add_argument("--jobs", type=number(int, 1), metavar="N", help="seeds at a time; default one per core")
    return Reproduction(parser.parse_args(arguments)).run()
