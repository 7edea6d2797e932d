# Runs the experiments about data-efficiency and turns them into tables and figures, with one command.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os

from PIL import Image

from ddm_launch.command import Failure, find_program, number, package_path, program_parser
from ddm_launch.figure_style import save_picture
from ddm_launch.images import recorded_images
from ddm_launch.settings import flat, read_yaml
from ddm_launch.sweep import seed_range
from ddm_study.efficient_tables import (FEW_SEEDS, PRESET, SUITE, TASKS, write_targets, write_gravity, write_last_models,
                                        write_nuisances, write_success, write_tasks, write_variants)
from ddm_study.step_runner import Part, StepRunner, SweepStep, verdict_lines

PARTS = ("efficient", "ablation", "tried", "gravity", "nuisances", "tasks")
VARIANTS = {"ablation": "ablations", "tried": "tried"}  # part: folder of config/ with variants of the preset
TRIALS, ABLATION_TRIALS, TRIED_TRIALS, GRAVITY_TRIALS, NUISANCE_TRIALS = 15, 3, 1, 19, 4
PILCO_TABLE = "gravity/pilco_state/trials.csv"
PILCO_TRIALS = 15  # of 125 frames: 2000 as the others
FULL_LABEL = "Full preset"
IMAGE = 50  # number of the image that shows a nuisance: the rod has left its start
EPISODES = "350:360"  # seeds of evaluate, for the last model of each seed of a task of the suite

ABOUT = """\
Makes the results about data-efficiency: the preset `efficient` on the pendulum next to the paper's curves, what each of
its ingredients is worth, what else was tried, the swing-up with gravity, nuisances of the camera, and harder tasks, with
tables and figures. All of it takes hours; the same command resumes, and --only chooses parts."""

EPILOG = """\
parts (--only), in this order, and what they leave in DIR:
  efficient    trials.csv, config.yaml, success_rate.csv, times.csv, success_rate.png
  ablation     ablation/NAME/trials.csv, ablation.csv, ablation.png: without what each file of config/ablations takes away
  tried        tried/NAME/trials.csv, tried.csv, tried.png: with what each file of config/tried changes, to 200 frames
  gravity      gravity/trials.csv of the plant `pendulum_gravity`, gravity/oracle/ and gravity/pilco_state/,
               gravity.csv, gravity.png
  nuisances    nuisances/NAME/trials.csv, image.png, nuisances.csv, nuisances.png: under each file of config/nuisances
               that is not one of a scene
  tasks        tasks/TASK/trials.csv of harder plants, and of one with another camera and other colours (%s); tasks.csv;
               tasks/TASK/diagnosis.csv of task_diagnosis; of those of the DeepMind Control Suite
               tasks/TASK/last_models.csv, ten episodes of each seed's last model, and TASK.png
targets.csv holds what the results must reach and whether they do, machine.yaml how each step was made, runs/ and logs/
everything that the programs left. A step whose files have changed since it was made is refused. The columns are explained
in doc/reference/run_folder.md.""" % ", ".join(TASKS)


def yaml_names(folder):
    """{name: path} of the files NAME.yaml in a folder of config/."""
    path = package_path("config", folder)
    names = sorted(os.listdir(path)) if os.path.isdir(path) else []
    found = {name[:-len(".yaml")]: os.path.join(path, name) for name in names if name.endswith(".yaml")}
    if not found:
        raise Failure("%s must hold a file NAME.yaml, got none: leave this part out with --only" % path)
    return found


def label_of(path):
    """What a file takes away: its first line, a comment."""
    with open(path) as stream:
        line = stream.readline().strip()
    label = line.lstrip("#").strip().rstrip(".")
    if not (line.startswith("#") and label):
        raise Failure("%s must begin with a comment that says what it is, got '%s': tables and figures show it" % (
            path, line))
    return label


class EfficientReproduction(StepRunner):
    """Each of PARTS is a method that returns a Part."""

    def __init__(self, options):
        self.preset = options.preset
        super().__init__("reproduce_efficient", options.out, {"preset": self.preset}, options.jobs)
        self.options, self.few_seeds = options, options.seeds[:FEW_SEEDS]
        self.variants = {}  # {part: {name: path}}

    def parts(self):
        parts, missing = {name: getattr(self, name)() for name in PARTS if name in self.options.only}, {}
        for name, part in parts.items():
            paths = {path for step in part.steps for path in step.files().values() if not os.path.isfile(path)}
            if paths:
                missing[name] = sorted(paths)
        if missing:
            rest = [name for name in parts if name not in missing]
            raise Failure("%s: %s" % (
                "; ".join("the part %s needs %s, which is not there" % (name, " and ".join(paths))
                          for name, paths in missing.items()),
                "leave it out with --only %s" % " ".join(rest) if rest else "name another --preset"))
        if "gravity" in parts:
            self.require_pilco(PILCO_TABLE, self.options.pilco_seeds > 0, "--pilco-seeds 0")
        return parts

    def verdict(self):
        return self.idle_variants() + verdict_lines(write_targets(self.out))

    def step(self, name, folder, seeds, trials, more=(), plant="pendulum", limit_s=None):
        words = ["--preset", self.preset, "--plant", plant, "--trials", str(trials)]
        return SweepStep(name, os.path.join(folder, "trials.csv"), seeds, words, more, limit_s)

    def efficient_step(self):
        return self.step("efficient", "", self.options.seeds, TRIALS)

    def efficient(self):
        step = self.efficient_step()

        def write_tables():
            self.keep_config(step, "config.yaml")
            write_success(self.out, step.folder(self.out), self.resumed(step))

        return Part([step], write_tables, lambda: self.success_figure(
            "success_rate", [(self.preset, self.path("trials.csv")),
                             ("DDM + MPC", package_path("results", "paper", "trials.csv"))],
            ["--published", package_path("results", "published", "success_rate.csv")]))

    def reference_step(self):
        """The preset itself, which variants are compared with."""
        return self.variant_step("ablation", PRESET, ABLATION_TRIALS)

    def variant_step(self, part, name, trials, more=()):
        return self.step("%s_%s" % (part, name), os.path.join(part, name), self.options.ablation_seeds, trials, more)

    def ablation(self, part="ablation", trials=ABLATION_TRIALS):
        paths = self.variants[part] = yaml_names(VARIANTS[part])
        if PRESET in paths:
            raise Failure("%s: the name is that of the reference, the preset itself: rename the file" % paths[PRESET])
        labels = dict({PRESET: FULL_LABEL}, **{name: label_of(path) for name, path in paths.items()})
        steps = [self.reference_step()] + [self.variant_step(part, name, trials, ["--config", path])
                                           for name, path in paths.items()]
        return Part(steps, lambda: write_variants(self.out, part, labels), lambda: {
            part: self.figure("study_figure", "ablation_compared", [self.path(part + ".csv")], part)})

    def tried(self):
        return self.ablation("tried", TRIED_TRIALS)

    def gravity(self):
        def step(name, folder, seeds, trials, more=(), limit_s=None):
            return self.step(name, folder, seeds, trials, more, "pendulum_gravity", limit_s)

        steps = [step("gravity", "gravity", self.few_seeds, GRAVITY_TRIALS),
                 step("gravity_oracle", "gravity/oracle", self.few_seeds, GRAVITY_TRIALS, ["--method", "oracle"])]
        pilco_seeds = self.few_seeds[:self.options.pilco_seeds]
        if pilco_seeds:
            steps.append(step("gravity_pilco_state", os.path.dirname(PILCO_TABLE), pilco_seeds, PILCO_TRIALS,
                              ["--method", "pilco_state", "--config", package_path("config", "sparse_gp.yaml")],
                              60.0 * self.options.pilco_minutes))

        def write_tables():
            self.keep_config(steps[0], "gravity/config.yaml")
            write_gravity(self.out)

        return Part(steps, write_tables, lambda: self.success_figure("gravity", [
            (self.preset, self.path("gravity", "trials.csv")),
            ("PILCO, state, sparse GP", self.path(PILCO_TABLE)),
            ("oracle", self.path("gravity", "oracle", "trials.csv"))]))

    def nuisances(self):
        names = [name for name in yaml_names("nuisances") if not name.startswith("scene_")]  # the plant has no scene
        steps = [self.step("nuisance_" + name, os.path.join("nuisances", name), self.few_seeds, NUISANCE_TRIALS,
                           ["--nuisance", name]) for name in names]

        def write_tables():
            write_nuisances(self.out, names)
            for name, step in zip(names, steps):
                self.keep_image(step, os.path.join("nuisances", name, "image.png"))
            self.keep_image(self.efficient_step(), os.path.join("nuisances", "none", "image.png"))

        return Part(steps, write_tables, lambda: {
            "nuisances": self.figure("study_figure", "nuisances_compared", [self.path("nuisances.csv")], "nuisances")})

    def keep_image(self, step, name):
        """An image of the first trial of a sweep, if it was recorded: what the learner was shown."""
        bag = os.path.join(step.seed_folder(self.out, step.seeds[0]), "trial_000", "trial.bag")
        if os.path.exists(bag):
            os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
            images = recorded_images(bag)
            save_picture(Image.fromarray(images[min(IMAGE, len(images) - 1)]), self.path(name), "PNG", optimize=True)

    def tasks(self):
        tasks = {name: TASKS[name] for name in self.options.tasks}
        steps = {name: self.step("task_" + name, os.path.join("tasks", name), self.options.seeds[:task.num_seeds],
                                 task.num_trials, ["--nuisance", task.nuisance] if task.nuisance else [], task.plant)
                 for name, task in tasks.items()}
        suite = [name for name in tasks if name in SUITE]

        def write_tables():
            for name, step in steps.items():
                self.keep_config(step, os.path.join("tasks", name, "config.yaml"))
                self.call("diagnosis_of_" + name, [
                    find_program("task_diagnosis"), *step.seed_folders(self.out).values(),
                    "--out", self.path("tasks", name, "diagnosis.csv")])
            for name in suite:
                write_last_models(self.out, name, self.evaluate_last_models(steps[name]))
            write_tasks(self.out, list(steps))

        return Part(list(steps.values()), write_tables, lambda: {
            name: self.figure("study_figure", "task_compared", [
                self.path("tasks.csv"), "--task", name, "--published",
                package_path("results", "published", "suite_returns.csv")], name) for name in suite})

    def evaluate_last_models(self, step):
        """{seed: folder of evaluate} of a sweep; what is there is not made again."""
        folders = {}
        for seed, run in step.seed_folders(self.out).items():
            folders[seed] = os.path.join(run, "last_model")
            if os.path.exists(os.path.join(folders[seed], "evaluation.csv")):
                continue
            model = sorted(glob.glob(os.path.join(run, "trial_*", "model.ddm")))[-1]
            self.call("%s_last_model_%04d" % (step.name, seed), [
                find_program("evaluate"), "--config", os.path.join(run, "config.yaml"), "--model", model, "--seeds",
                EPISODES, "--out", folders[seed]])
        return folders

    def success_figure(self, name, curves, more=()):
        """Of those of the curves (label, path) that are there."""
        return {name: self.figure("figure", "success_rate", [
            "%s=%s" % curve for curve in curves if os.path.exists(curve[1])] + ["--wilson"] + list(more), name)}

    def idle_variants(self):
        """Lines about those that change nothing of the preset: there is nothing to compare."""
        if not self.variants:
            return []
        step = self.reference_step()
        config = flat(read_yaml(os.path.join(step.seed_folder(self.out, step.seeds[0]), "config.yaml")))
        return ["note: config/%s/%s.yaml changes nothing of the preset %s: its differences mean nothing" % (
            VARIANTS[part], name, self.preset) for part, variants in self.variants.items()
                for name, path in variants.items()
                if all(config.get(key) == value for key, value in flat(read_yaml(path)).items())]


def main(arguments=None):
    parser = program_parser("reproduce_efficient", ABOUT, EPILOG)
    parser.add_argument("--seeds", type=seed_range, default=range(300, 350), metavar="A:B",
                        help="seeds A ... B - 1, default 300:350; the first %d of them with gravity, under each "
                        "nuisance, and of each task" % FEW_SEEDS)
    parser.add_argument("--ablation-seeds", type=seed_range, default=range(400, 450), metavar="A:B",
                        help="of the ablation and of what was tried, default 400:450: nothing was chosen on them")
    parser.add_argument("--out", default="efficient_results", metavar="DIR", help="default efficient_results")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS, metavar="PART",
                        help="make only these parts: %s" % ", ".join(PARTS))
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=list(TASKS), metavar="TASK",
                        help="make only these of the part tasks: %s" % ", ".join(TASKS))
    parser.add_argument("--preset", default="efficient",
                        help="default efficient; debug is for a quick look at the path")
    parser.add_argument("--pilco-seeds", type=number(int, 0), default=4, metavar="N",
                        help="PILCO with gravity has the first N seeds, default 4; 0: without PILCO")
    parser.add_argument("--pilco-minutes", type=number(int, 1), default=240, metavar="M",
                        help="end PILCO after M minutes in all, default 240: then it has the rows of the trials that "
                        "are finished, and fewer seeds at more frames")
    parser.add_argument("--jobs", type=number(int, 1), metavar="N", help="seeds at a time; default one per core")
    return EfficientReproduction(parser.parse_args(arguments)).run()
