# Runs the experiments about data-efficiency and turns them into tables and figures, with one command.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import os
import re

from ddm_launch.command import Failure, find_program, package_path
from ddm_launch.settings import flat, read_yaml
from ddm_launch.sweep import positive, seed_range
from ddm_study.efficient_bars import write_bars
from ddm_study.efficient_tables import PRESET, write_gravity, write_nuisances, write_success, write_variants
from ddm_study.step_runner import StepRunner, SweepStep, require_pilco_in_build, verdict_lines

PARTS = ("efficient", "ablation", "tried", "gravity", "nuisances")
VARIANTS = {"ablation": "ablations", "tried": "tried"}  # part: folder of config/ with variants of the preset
TRIALS, ABLATION_TRIALS, TRIED_TRIALS, GRAVITY_TRIALS, NUISANCE_TRIALS = 15, 5, 1, 19, 4
PILCO_TABLE = "gravity/pilco_state/trials.csv"
PILCO_TRIALS = 15  # of 125 frames: 2000 as the others
NUM_FEW_SEEDS = 20  # with gravity, and of each nuisance
FULL_LABEL = "Full preset"

ABOUT = """\
Makes the results about data-efficiency: the preset `efficient` on the pendulum beside the paper's curves, what each of
its ingredients is worth, what else was tried, the swing-up with gravity, and nuisances of the camera, with tables and
figures. All of it takes hours; the same command resumes, and --only chooses parts."""

EPILOG = """\
parts (--only), in this order, and what they leave in DIR:
  efficient    trials.csv, config.yaml; success_rate.csv: success, success_strict and Wilson's 95 % intervals;
               success_rate.png; times.csv: of each seed's experiment training and wall time in all [s] (empty if it
               was interrupted) and the time that 99 % of the plans of its slowest greedy run keep [ms]
  ablation     ablation/NAME/trials.csv without what each file of ddm_launch/config/ablations takes away, and of the
               preset itself; ablation.csv: success and differences paired by seed; ablation.png
  tried        tried/NAME/trials.csv with what each file of ddm_launch/config/tried changes, to 200 frames; tried.csv
               and tried.png: as those of the ablation, and compared with the same runs of the preset
  gravity      gravity/trials.csv of the preset `efficient_gravity`; gravity/oracle/, gravity/pilco_state/: trials.csv
               of the same planner on the true plant, and of PILCO on the true state with sparse GPs; gravity.csv,
               gravity.png
  nuisances    nuisances/NAME/trials.csv for each file of ddm_launch/config/nuisances; nuisances.csv,
               nuisances.png

beside them:
  bars.csv             what the results must reach, and whether they do
  machine.yaml         of each step: version of the code, processor, time, peak memory of a process
  runs/, logs/         everything that the programs left behind; runs/*/settings.yaml: what the preset, the plant's and the
                       other files of a step said. A step whose files have changed since is refused"""


def count(text):
    if not re.match(r"\d{1,6}$", text):
        raise argparse.ArgumentTypeError("must be a whole number >= 0, got '%s'" % text)
    return int(text)


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
    """Each of PARTS is three methods: PART_steps, the sweeps; PART_tables; PART_figure, the command that draws it from
    nothing but what is kept."""

    def __init__(self, options):
        self.preset = options.preset
        self.gravity_preset = "efficient_gravity" if options.preset == "efficient" else options.preset
        super().__init__("reproduce_efficient", options.out,
                         {"preset": self.preset, "gravity_preset": self.gravity_preset}, options.jobs)
        self.options, self.few_seeds = options, options.seeds[:NUM_FEW_SEEDS]
        self.parts = [part for part in PARTS if part in options.only]
        self.variants, self.labels = {}, {}  # {part: {name: path}}, {part: {name: label}}
        self.nuisances = {}  # {name: path}

    def work(self):
        for part in VARIANTS:
            if part in self.parts:
                self.find_variants(part)
        if "nuisances" in self.parts:
            self.nuisances = yaml_names("nuisances")
        steps = {part: getattr(self, part + "_steps")() for part in self.parts}
        self.require_files(steps)
        if "gravity" in self.parts:
            self.require_pilco()
        with self.progress(sum(len(step.seeds) for of_part in steps.values() for step in of_part) +
                           2 * len(self.parts)) as bar:
            for part in self.parts:
                for step in steps[part]:
                    self.run_sweep(step, bar)
                bar.set_description(part + ": tables")
                getattr(self, part + "_tables")(steps[part][0])
                bar.update(1)
                self.draw({"figure_of_" + part: getattr(self, part + "_figure")()}, bar)
            bar.set_description("done")
        return self.idle_variants() + verdict_lines(write_bars(self.out))

    def find_variants(self, part):
        """Files that change the preset, and what tables and figures call each."""
        paths = yaml_names(VARIANTS[part])
        if PRESET in paths:
            raise Failure("%s: the name is that of the reference, the preset itself: rename the file" % paths[PRESET])
        self.variants[part] = paths
        self.labels[part] = dict({PRESET: FULL_LABEL}, **{name: label_of(path) for name, path in paths.items()})

    def require_files(self, steps):
        """Before hours have passed: all parts must have their presets and other files."""
        missing = {}  # part: paths
        for part, of_part in steps.items():
            paths = [path for step in of_part for path in step.files().values() if not os.path.isfile(path)]
            if paths:
                missing[part] = sorted(set(paths))
        if missing:
            rest = [part for part in self.parts if part not in missing]
            raise Failure("%s: %s" % (
                "; ".join("the part %s needs %s, which is not there" % (part, " and ".join(paths))
                          for part, paths in missing.items()),
                "leave it out with --only %s" % " ".join(rest) if rest else "name another --preset"))

    def require_pilco(self):
        """Before hours have passed: PILCO must be there where it is wanted, and no results of it where it is not."""
        if self.options.pilco_seeds:
            require_pilco_in_build("--pilco-seeds 0")
        elif os.path.exists(self.path(PILCO_TABLE)):
            raise Failure("%s holds results of PILCO, which --pilco-seeds 0 leaves out: remove it, leave out that "
                          "option, or use another --out" % self.path(PILCO_TABLE))

    def sweep_step(self, name, folder, seeds, trials, more=(), preset=None, plant="pendulum", limit_s=None):
        words = ["--preset", preset or self.preset, "--plant", plant, "--trials", str(trials)]
        return SweepStep(name, os.path.join(folder, "trials.csv"), seeds, words, list(more), limit_s)

    def efficient_steps(self):
        return [self.sweep_step("efficient", "", self.options.seeds, TRIALS)]

    def variant_step(self, part, name, trials, more):
        return self.sweep_step("%s_%s" % (part, name), os.path.join(part, name), self.options.ablation_seeds, trials,
                               more)

    def reference_step(self):
        """The preset itself, which variants are compared with."""
        return self.variant_step("ablation", PRESET, ABLATION_TRIALS, [])

    def ablation_steps(self, part="ablation", trials=ABLATION_TRIALS):
        return [self.reference_step()] + [self.variant_step(part, name, trials, ["--config", path])
                                          for name, path in self.variants[part].items()]

    def tried_steps(self):
        return self.ablation_steps("tried", TRIED_TRIALS)

    def gravity_steps(self):
        def step(name, folder, seeds, trials, more, limit_s=None):
            return self.sweep_step(name, folder, seeds, trials, more, self.gravity_preset, "pendulum_gravity", limit_s)

        steps = [step("gravity", "gravity", self.few_seeds, GRAVITY_TRIALS, []),
                 step("gravity_oracle", "gravity/oracle", self.few_seeds, GRAVITY_TRIALS, ["--method", "oracle"])]
        pilco_seeds = self.few_seeds[:self.options.pilco_seeds]
        if pilco_seeds:
            steps.append(step("gravity_pilco_state", os.path.dirname(PILCO_TABLE), pilco_seeds, PILCO_TRIALS,
                              ["--method", "pilco_state", "--config", package_path("config", "sparse_gp.yaml")],
                              60.0 * self.options.pilco_minutes))
        return steps

    def nuisances_steps(self):
        return [self.sweep_step("nuisance_" + name, os.path.join("nuisances", name), self.few_seeds, NUISANCE_TRIALS,
                                ["--nuisance", name]) for name in self.nuisances]

    def efficient_tables(self, step):
        self.keep_config(step, "config.yaml")
        write_success(self.out, step.folder(self.out), self.resumed(step))

    def ablation_tables(self, _, part="ablation"):
        write_variants(self.out, part, self.labels[part])

    def tried_tables(self, step):
        self.ablation_tables(step, "tried")

    def gravity_tables(self, step):
        self.keep_config(step, "gravity/config.yaml")
        write_gravity(self.out)

    def nuisances_tables(self, _):
        write_nuisances(self.out, list(self.nuisances))

    def keep_config(self, step, name):
        self.keep(os.path.join(step.seed_folder(self.out, step.seeds[0]), "config.yaml"), name)

    def efficient_figure(self):
        curves = [(self.preset, self.path("trials.csv")), ("DDM + MPC", package_path("results", "paper", "trials.csv"))]
        return self.success_figure("success_rate", curves) + ["--published", package_path("results", "published",
                                                                                          "success_rate.csv")]

    def ablation_figure(self, part="ablation"):
        return [find_program("study_figure"), "ablation_compared", self.path(part + ".csv"), "--out",
                self.path(part + ".png")]

    def tried_figure(self):
        return self.ablation_figure("tried")

    def gravity_figure(self):
        return self.success_figure("gravity", [(self.gravity_preset, self.path("gravity", "trials.csv")),
                                               ("PILCO, state, sparse GP", self.path(PILCO_TABLE)),
                                               ("oracle", self.path("gravity", "oracle", "trials.csv"))])

    def nuisances_figure(self):
        return [find_program("study_figure"), "nuisances_compared", self.path("nuisances.csv"), "--out",
                self.path("nuisances.png")]

    def success_figure(self, name, curves):
        """The command that draws those of the curves (label, path) that are there."""
        return ([find_program("figure"), "success_rate"] +
                ["%s=%s" % curve for curve in curves if os.path.exists(curve[1])] +
                ["--wilson", "--out", self.path(name + ".png")])

    def idle_variants(self):
        """Lines about those that change nothing of the preset: there is nothing to compare."""
        if not self.variants:
            return []
        step = self.reference_step()
        config = flat(read_yaml(os.path.join(step.seed_folder(self.out, step.seeds[0]), "config.yaml")))
        return ["note: config/%s/%s.yaml changes nothing of the preset %s: its differences are no result" % (
            VARIANTS[part], name, self.preset) for part, variants in self.variants.items()
                for name, path in variants.items()
                if all(config.get(key) == value for key, value in flat(read_yaml(path)).items())]


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="reproduce_efficient", description=ABOUT, epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=seed_range, default=range(100, 150), metavar="A:B",
                        help="seeds A ... B - 1, default 100:150; the first %d of them with gravity and under each "
                        "nuisance" % NUM_FEW_SEEDS)
    parser.add_argument("--ablation-seeds", type=seed_range, default=range(0, 50), metavar="A:B",
                        help="of the ablation and of what was tried, default 0:50: those that the preset was chosen on")
    parser.add_argument("--out", default="efficient_results", metavar="DIR", help="default efficient_results")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS, metavar="PART",
                        help="make only these parts: %s" % ", ".join(PARTS))
    parser.add_argument("--preset", default="efficient",
                        help="default efficient, and efficient_gravity with gravity; debug is for a quick look at the "
                        "path")
    parser.add_argument("--pilco-seeds", type=count, default=4, metavar="N",
                        help="PILCO with gravity has the first N seeds, default 4; 0: without PILCO")
    parser.add_argument("--pilco-minutes", type=positive, default=240, metavar="M",
                        help="end PILCO after M minutes in all, default 240: then it has the rows of the trials that "
                        "are finished, and fewer seeds at more frames")
    parser.add_argument("--jobs", type=positive, metavar="N", help="seeds at a time; default one per core")
    return EfficientReproduction(parser.parse_args(arguments)).run()
