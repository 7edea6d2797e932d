# figure FIGURE: draws a figure from run folders or from tables.
# SPDX-License-Identifier: BSD-3-Clause
import sys

from ddm_launch import film, learning_curve, success_rate
from ddm_launch.command import Parser, run_program

FIGURES = {"film": film.FILM, "film_strip": film.STRIP, "learning_curve": learning_curve.FIGURE,
           "success_rate": success_rate.FIGURE}


def add_figures(parser, figures):
    """Adds a subcommand for each figure to a parser. The parsed options have a function `work` that draws the
    figure."""
    names = parser.add_subparsers(dest="figure", metavar="FIGURE", required=True)
    for name, figure in figures.items():
        of_figure = names.add_parser(name, description=figure.about,
                                     help=figure.about.split(". ")[0].replace("%", "%%"))
        for words, settings in figure.arguments:
            of_figure.add_argument(*words, **settings)
        of_figure.add_argument("--out", metavar="FILE" + figure.suffix, default=name + figure.suffix,
                               help="image to write; default %(default)s")

        def work(options, draw=figure.draw):
            draw(options)
            print("wrote %s" % options.out)
        of_figure.set_defaults(work=work)


def main(arguments=None):
    if arguments is None and sys.argv[1:2] == ["learning_curve_node"]:  # for launch files
        return learning_curve.main_of_node()
    parser = Parser(prog="figure", description="Draws a figure; `figure FIGURE --help` lists its options.")
    add_figures(parser, FIGURES)
    options = parser.parse_args(arguments)
    return run_program(options.figure, lambda: options.work(options))
