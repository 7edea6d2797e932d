# figure NAME: every figure that is made of run folders and of what programs leave.
# SPDX-License-Identifier: BSD-3-Clause
import sys

from ddm_launch import film, film_strip, learning_curve, success_rate
from ddm_launch.command import Parser, run_program


def program(name, about, figures):
    """The main function of a program that draws figures. A figure is a module with

      ABOUT                  what it draws; --help lists its first sentence
      add_arguments(parser)  of its own; every figure has --out, by default FIGURE.png in the working folder
      draw(options)          writes options.out
      SUFFIX                 of that file, where it is not .png
    """
    def main(arguments=None):
        parser = Parser(prog=name, description=about)
        names = parser.add_subparsers(dest="figure", metavar="FIGURE", required=True)
        for module in figures:
            figure = module.__name__.split(".")[-1]
            of_figure = names.add_parser(figure, description=module.ABOUT,
                                         help=module.ABOUT.split(". ")[0].replace("%", "%%"))
            module.add_arguments(of_figure)
            suffix = getattr(module, "SUFFIX", ".png")
            of_figure.add_argument("--out", metavar="FILE" + suffix, default=figure + suffix,
                                   help="picture to write; default %(default)s")
            of_figure.set_defaults(draw=module.draw)
        options = parser.parse_args(sys.argv[1:] if arguments is None else arguments)

        def work():
            options.draw(options)
            print("wrote %s" % options.out)
        return run_program(options.figure, work)
    return main


main = program("figure", "Draws a figure; `figure FIGURE --help` lists its options.",
               (film, film_strip, learning_curve, success_rate))
