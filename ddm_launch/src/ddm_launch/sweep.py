# sweep: runs an experiment for many seeds, with GNU parallel or as a Slurm job array, and collects their tables.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import os
import re
import sys
import time

import pandas

from ddm_launch.command import Interrupted, expand_home, number, program_parser, run_program
from ddm_launch.gnu_parallel import GnuParallel
from ddm_launch.slurm import SlurmArray, how_to_go_on
from ddm_launch.sweep_folder import TABLES, SweepFolder

MAX_SEEDS = 100000

ABOUT = """\
Runs an experiment for each seed, several at a time, and collects the rows of all seeds in DIR/sweep.csv. The same
command again runs only the seeds that are not finished, and those from their last finished trial on; --seeds and
--trials may grow. Returns 0 if all seeds are finished in the end."""

EPILOG = """\
example:
  rosrun ddm_launch sweep --preset paper --plant pendulum --seeds 0:50 --trials 15 --out ~/runs/paper
  rosrun ddm_launch sweep --seeds 0:50 --trials 15 --out ~/runs/oracle --method oracle

in DIR:
  sweep.csv has the rows of trials.csv (predictions.csv) of all finished seeds, seed_NNNN/ all that the program writes for a
  seed, and logs/ what it said. `bash run_seed.sh SEED` runs one seed by hand.

hosts (--hosts FILE):
  GNU parallel's --sshloginfile: one ssh host a line, ':' is this machine. Hosts that do not answer in 20 s are left out. Each
  needs GNU parallel, a login without password, and this workspace, DIR and the folder that the sweep is called from
  under the same paths (a shared file system): the workspace's setup.bash is sourced there, files are not copied. The
  ssh command is $PARALLEL_SSH.

Slurm (--slurm):
  One task of one core for each seed. Everything else that sbatch must know goes into the variables that it reads itself:
  SBATCH_PARTITION, SBATCH_TIMELIMIT, SBATCH_ACCOUNT, SBATCH_QOS, SBATCH_MEM_PER_CPU and so on. Tasks see this workspace
  and DIR under the same paths. Ctrl-C cancels the job array. It goes on if the sweep ends otherwise, for example because
  the connection drops; the same command then waits for it again."""


def seed_range(text):
    match = re.match(r"(\d{1,10}):(\d{1,10})$", text)
    seeds = range(int(match.group(1)), int(match.group(2))) if match else ()
    if not 1 <= len(seeds) <= MAX_SEEDS:
        raise argparse.ArgumentTypeError("must be A:B with whole numbers 0 <= A < B (B excluded) and at most %d seeds, "
                                         "got '%s'" % (MAX_SEEDS, text))
    return seeds


def parse(arguments):
    """Returns (options, arguments of the program). If the arguments are wrong, prints a message and ends the process
    with code 2."""
    parser = program_parser(
        "sweep", ABOUT, EPILOG, allow_abbrev=False,
        usage="rosrun ddm_launch sweep --seeds A:B --out DIR [options] [options of the program, also after --]")
    parser.add_argument("--seeds", type=seed_range, required=True, metavar="A:B", help="seeds A ... B - 1")
    parser.add_argument("--trials", type=int, metavar="T", help="of run_experiment; default 15")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for the results")
    parser.add_argument("--jobs", type=number(int, 1), metavar="N",
                        help="seeds at a time on each host, default one per core; with --slurm in all, default any")
    parser.add_argument("--hosts", metavar="FILE", help="spread over ssh hosts")
    parser.add_argument("--slurm", action="store_true", help="run as a Slurm job array")
    parser.add_argument("--program", choices=sorted(TABLES), default="run_experiment",
                        help="default run_experiment")
    split = arguments.index("--") if "--" in arguments else len(arguments)
    options, more = parser.parse_known_args(arguments[:split])
    more += [expand_home(word) for word in arguments[split + 1:]]
    if options.program != "run_experiment" and options.trials is not None:
        parser.error("--trials is an option of run_experiment, %s has none: leave it out" % options.program)
    if options.program == "run_experiment" and options.trials is None:
        options.trials = 15
    if options.hosts is not None and options.slurm:
        parser.error("--hosts and --slurm exclude each other: a Slurm cluster chooses its hosts itself")
    if options.hosts is not None and not os.path.isfile(options.hosts):
        parser.error("--hosts must name a file of ssh hosts, got '%s', which is not a file" % options.hosts)
    return options, more


def run_seeds(engine, folder, seeds):
    pending = [seed for seed in seeds if not folder.is_finished(seed)]

    def tell():
        for seed in [seed for seed in pending if folder.is_finished(seed)]:
            pending.remove(seed)
            print("seed %d finished (%d of %d)" % (seed, len(seeds) - len(pending), len(seeds)), flush=True)

    engine.resume(folder, tell)
    tell()
    print("%s: %d of %d seeds to run" % (folder.title, len(pending), len(seeds)), flush=True)
    if pending:
        folder.prepare(pending)
        engine.run(folder, list(pending), tell)
        tell()


def report(folder, seeds, start):
    """Collects the tables of all seeds and prints a summary. Returns whether all seeds are finished."""
    finished, problems = folder.collect(seeds)
    if how_to_go_on(folder):
        print("sweep: %s" % how_to_go_on(folder), file=sys.stderr)
    elif problems:
        print("\n".join(["sweep: not finished:"] + ["  seed %d: %s" % problem for problem in problems.items()]
                        + ["sweep: the same command resumes where this one ended"]), file=sys.stderr)
    versions = sorted({version for table in finished.values() for version in table.get("version", ())})
    if len(versions) > 1:
        print("sweep: warning: the seeds come from %d versions of the code, they may not be comparable: %s"
              % (len(versions), ", ".join(versions)), file=sys.stderr)
    last = [table.get("success", pandas.Series([""])).iloc[-1] for table in finished.values()]
    known = [float(success) for success in last if success]
    print("%d of %d seeds finished%s; this call took %.1f s" % (
        len(finished), len(seeds), ", mean success at the last trial %.2f" % (sum(known) / len(known)) if known else "",
        time.monotonic() - start))
    if finished:
        print("results: %s" % folder.table)
    return not problems


def sweep(options, more):
    """Runs the sweep and returns the exit code. After a signal, prints the report and raises Interrupted."""
    start = time.monotonic()
    engine = SlurmArray(options.jobs) if options.slurm else GnuParallel(options.jobs, options.hosts)
    with SweepFolder(options.out, options.program, options.trials, more, options.seeds[0]) as folder:
        interruption = None
        try:
            run_seeds(engine, folder, options.seeds)
        except Interrupted as error:
            interruption = error
        complete = report(folder, options.seeds, start)
    if interruption:
        raise interruption
    return 0 if complete else 1


def main(arguments=None):
    options, more = parse(sys.argv[1:] if arguments is None else arguments)
    return run_program("sweep", lambda: sweep(options, more))
