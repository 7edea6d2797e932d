# study: subcommands that make and check the committed results.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch.command import Failure, number, package_path, program_parser, run_program
from ddm_launch.figure import add_figures
from ddm_study import collect, compare, curves, diagnosis, features, pages

ABOUT = """\
Makes and checks the committed results, ddm_launch/results. `study SUBCOMMAND --help` explains each subcommand."""
REPRODUCE = """\
Runs the experiments and makes their tables and figures, by the rules in ddm_launch/study/Makefile. DIR gets a folder for
each goal, and runs/ with everything that the experiments left. Run the same command again to resume. A finished run is
not made again: after a change of code or settings, remove its folder in runs/ and its table first."""
GOALS = """\
goals: paper (the paper's experiments), efficient (as few images as possible), underactuated (the cart-pole), any file
that the Makefile has a rule for, and variables of make: SEEDS=2 (at most two seeds of each sweep), PAPER=debug or
EFFICIENT=debug (another preset), PILCO= (without PILCO, which takes hours)."""
FIGURES = {"angle_trajectories": curves.TRAJECTORIES, "feature_plane": features.PLANE,
           "pendulum_feature_space": features.SPACE, "prediction_strip": features.STRIP, "task": curves.TASK}


def reproduce(options):
    """Replaces this process by make with the rules of the study. Raises Failure if make is missing."""
    os.makedirs(options.out, exist_ok=True)
    words = ["make", "-f", package_path("study", "Makefile"), "-C", options.out, *options.goals]
    words += ["JOBS=%d" % options.jobs] if options.jobs else []
    words += ["--dry-run"] if options.dry_run else []
    try:
        os.execvp(words[0], words)  # make replaces this process, so that signals reach make
    except FileNotFoundError:
        raise Failure("the program make is missing: install the package make") from None


def add_commands(parser):
    commands = parser.add_subparsers(dest="command", metavar="SUBCOMMAND", required=True)

    def add(name, work, about, epilog=None):
        first_sentence = about.split(". ")[0].split(":\n")[0].replace("\n", " ")
        command = commands.add_parser(name, description=about, epilog=epilog, help=first_sentence,
                                      formatter_class=parser.formatter_class)
        command.set_defaults(work=work)
        return command

    command = add("reproduce", reproduce, REPRODUCE, GOALS)
    command.add_argument("goals", nargs="+", metavar="GOAL", help="paper, efficient, a file, or VARIABLE=VALUE")
    command.add_argument("--out", required=True, metavar="DIR", help="folder for the results")
    command.add_argument("--jobs", type=number(int, 1), metavar="N", help="seeds at a time; default one per core")
    command.add_argument("-n", "--dry-run", action="store_true", help="only print the commands")
    add_figures(add("figure", None, "Draws a figure of the results."), FIGURES)
    compare.add_arguments(add("compare", compare.work, compare.ABOUT))
    diagnosis.add_arguments(add("diagnose", diagnosis.work, diagnosis.ABOUT))
    collect.add_arguments(add("collect", collect.work, collect.ABOUT))
    pages.add_arguments(add("pages", pages.work, pages.ABOUT))


def main(arguments=None):
    parser = program_parser("study", ABOUT)
    add_commands(parser)
    options = parser.parse_args(arguments)
    return run_program("study " + options.command, lambda: options.work(options))
