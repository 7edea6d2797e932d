# study pages: fills marked blocks of pages with numbers from the committed tables.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re

from ddm_launch.averages import mean_and_error, success_rates
from ddm_launch.command import Failure, package_path
from ddm_launch.run_folder import read_trials
from ddm_study import results

ABOUT = """\
Fills the marked blocks of pages with numbers of ddm_launch/results. A block is

  <!-- fill
  text with {expressions}
  -->

  text with the numbers

  <!-- filled -->

The text is an f-string of Python. Its expressions read tables below results by table(FILE), a data frame of pandas;
ddm_launch/study/ddm_study/pages.py has the other functions, such as of(FILE, ROWS), which gives '48 of 50'."""
BLOCK = re.compile(r"(<!-- fill\n(.*?)\n-->\n\n).*?(\n\n<!-- filled -->)", re.DOTALL)
# Descriptions of the variants in efficient/ablation.
LABELS = {"auto_encoder_widths": "the paper's auto-encoder", "blur": "no blur", "cost": "the paper's cost and horizon",
          "epsilon": "the paper's share of random torques",
          "held_torques": "no held torques", "offset": "no offset correction",
          "predictor": "f as a network", "solver": "plain L-BFGS", "starts": "one start",
          "steps": "no multi-step loss", "weight_decay": "no weight decay"}


def plus_minus(mean, error, digits=2, sign=False):
    """Formats a mean and its standard error, with a minus sign in place of a hyphen."""
    return (("%+.*f ± %.*f" if sign else "%.*f ± %.*f") % (digits, mean, digits, error)).replace("-", "−")


def table_row(*cells):
    """Row of a Markdown table."""
    return "| %s |" % " | ".join(map(str, cells))


class Functions:
    """Functions that expressions in pages can use. Paths are relative to a folder of results."""

    def __init__(self, folder):
        self._folder = folder

    def path(self, name):
        return os.path.join(self._folder, name)

    def table(self, name):
        return results.read_table(self.path(name))

    def rates(self, name):
        return success_rates(read_trials(self.path(name)))

    def of(self, name, rows="", holds="success > 0"):
        """Number of rows that satisfy a condition, as '48 of 50'. rows: condition that selects the rows to count."""
        table = self.table(name)
        table = table.query(rows) if rows else table
        return "%d of %d" % (len(table.query(holds)), len(table))

    def value(self, name, rows, column):
        """Value in a column of the only row that satisfies a condition."""
        return self.table(name).query(rows)[column].item()

    def rows(self, name, text):
        """Formats each row as a line of text, in which {COLUMN} is replaced by the row's value."""
        return "\n".join(text.format(**row) for row in self.table(name).to_dict("records"))

    def minutes(self, method):
        """Training time of each seed until the tenth policy of PILCO [min]."""
        return self.table("paper/%s/trials.csv" % method).query("trial < 10").groupby("seed").train_s.sum() / 60.0

    def paper_difference(self):
        """Success rate of the preset `paper` minus that of the paper, in standard errors of the paper."""
        paper = self.table("published/success_rate.csv").set_index("frames")
        return ((self.rates("paper/trials.csv").rate - paper.ddm_mpc) / paper.ddm_mpc_se).loc[100:].dropna()

    def nuisances(self, rows):
        """Number of successful evaluations over all disturbances, as '48 of 50'."""
        tables = [self.table(path).query(rows) for path in results.variants(self.path("efficient/nuisances")).values()]
        return "%d of %d" % (sum(table.success.sum() for table in tables), sum(map(len, tables)))

    def each_nuisance(self, *frames):
        """Table rows with the successes under each disturbance after these numbers of images."""
        return "\n".join(table_row(name.replace("_", " "), *(self.of(path, "frames == %d" % count) for count in frames))
                         for name, path in results.variants(self.path("efficient/nuisances")).items())

    def variants(self, *frames):
        """Table rows of all variants of a preset, with differences of success rates and p-values at these frames. Rows
        are sorted by the sum of the differences at the first number of frames and over all later ones; the most harmful
        variants come first."""
        table = results.differences(self.path("efficient/ablation"), self.path("efficient/ablation/preset/trials.csv"))
        drawn = table[table.frames.isin((table.frames.iloc[0], table.frames.iloc[-1]))]
        lines = []
        for variant in drawn.groupby("variant").difference.sum().sort_values(kind="stable").index:
            rows = table[table.variant == variant].set_index("frames")
            lines.append(table_row(LABELS[variant], *(cell for text in frames for cell in (
                plus_minus(rows.difference[text], rows.se[text], 3, True), "%.3f" % rows.p_holm[text]))))
        return "\n".join(lines)

    def schedules(self):
        """Table rows with several measures of the training schedules, and differences from joint training, paired by
        seed."""
        folder = self.path("paper")
        pendulum, tile = (results.predictions(folder, plant) for plant in ("pendulum", "tile"))
        lines = []
        for name, table in (("pendulum: mean success, 900 to 1500 frames", results.late_success(folder)),
                            ("pendulum: error 8 steps ahead over repeating the last frame", pendulum["ratio"].loc[8]),
                            ("tile: error 8 steps ahead over repeating the last frame", tile["ratio"].loc[8]),
                            ("tile: R² of the position", tile["position_r2"].loc[1])):
            differences = [(table[schedule].mean(), mean_and_error(list(table[schedule] - table.joint)))
                           for schedule in results.SCHEDULES[1:]]
            lines.append(table_row(name, len(table), plus_minus(*mean_and_error(list(table.joint)), 3), *(
                "%.3f (%s)" % (mean, plus_minus(*difference, 3, True)) for mean, difference in differences)))
        return "\n".join(lines)

    def solvers(self):
        """Table rows that compare L-BFGS (the preset's solver) and BFGS (the paper's solver) on the models that both
        have trained."""
        tables = {"L-BFGS": self.table("paper/trials.csv"), "BFGS": self.table("paper/bfgs/trials.csv")}
        both = tables["BFGS"].set_index(["seed", "frames"]).index
        lines = []
        for frames in (100, 500):
            for solver, table in tables.items():
                models = table[table.set_index(["seed", "frames"]).index.isin(both) & (table.frames == frames)]
                lines.append(table_row(frames, solver, "%d of %d" % (models.success.sum(), len(models)), *(
                    "%.1f" % (error / frames).median() for error in (models.v_r, models.v_p)),
                    "%.3g s" % models.train_s.median()))
        return "\n".join(lines)

    def names(self):
        """Dictionary {name: function} of all functions."""
        public = {name: getattr(self, name) for name in dir(self) if not name.startswith("_")}
        return dict(public, mean_and_error=mean_and_error, plus_minus=plus_minus)


def filled(text, functions):
    """Fills the blocks of a page and returns the text."""
    def fill(match):
        return match.group(1) + eval('f"""%s"""' % match.group(2), functions.names()) + match.group(3)
    return BLOCK.sub(fill, text)


def work(options):
    pages = options.pages or glob.glob(os.path.join(package_path(), "..", "**", "*.md"), recursive=True)
    for path in sorted(pages):
        with open(path, encoding="utf-8") as stream:
            text = stream.read()
        try:
            new = filled(text, Functions(package_path("results")))
        except Exception as error:  # expressions can raise anything
            raise Failure("%s: a block cannot be filled (%s: %s): correct its expression" % (
                path, type(error).__name__, error)) from error
        if new != text:
            with open(path, "w", encoding="utf-8") as stream:
                stream.write(new)
            print("wrote %s" % path)


def add_arguments(parser):
    parser.add_argument("pages", nargs="*", metavar="PAGE.md", help="default: all pages with a marked block")
