# soak: both long experiments, and what they must reach.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import os
import socket

from tqdm import tqdm

from ddm_launch.command import run_program
from ddm_launch.tables import read_csv, write_csv
from ddm_qa.soak_bars import Bar, Sample, judge
from ddm_qa.soak_figure import draw
from ddm_qa.soak_frames import COLUMNS
from ddm_qa.soak_run import SoakRun, lockstep, real_time

RUNS = ("lockstep", "real_time")
CALL_LIMIT_S = 30.0  # of a question to a master or node

ABOUT = """\
Runs long experiments of the real nodes and looks at each process after each trial: lockstep, 300 trials in a few
minutes, and real_time, an hour at the paper's time step. Memory and open files must stay flat, and no frame be lost."""

EPILOG = """\
DIR/soak.csv    run,node,trial,time_s,rss_kb,open_files: resident memory and open files of each node and of the master
DIR/frames.csv  run,trial,part,due,published,recorded,answered,lost: a row a trial, and one for its evaluation
DIR/bars.csv    run,bar,measured,passed
DIR/soak.png    memory and open files over the trials
Results of a run that is not asked for stay. Exit code: 0 all passed, 1 not, 2 bad options."""


def keep_others(path, columns, run):
    """Rows of other runs, as lists of texts; none if there is no table yet."""
    if not os.path.exists(path):
        return []
    return [[row[column] for column in columns] for row in read_csv(path, columns) if row["run"] != run]


def write_results(out, run, samples, frames, bars):
    for name, columns, rows in (("soak.csv", Sample._fields, samples), ("bars.csv", Bar._fields, bars),
                                ("frames.csv", COLUMNS, [[row[column] for column in COLUMNS] for row in frames])):
        path = os.path.join(out, name)
        write_csv(path, columns, sorted(keep_others(path, columns, run) + [list(map(str, row)) for row in rows],
                                        key=lambda row: RUNS.index(row[0])))
    draw(read_samples(os.path.join(out, "soak.csv")), os.path.join(out, "soak.png"))


def read_samples(path):
    kinds = dict(zip(Sample._fields, (str, str, int, float, int, int)))
    return [Sample(*(row[name] for name in Sample._fields)) for row in read_csv(path, kinds)]


def make(soak, out):
    """Runs one and writes what came of it. Returns its bars."""
    with tqdm(total=soak.seconds or soak.last + 2, unit="s" if soak.seconds else "trial", desc=soak.name,
              dynamic_ncols=True, disable=None, bar_format="{l_bar}{bar}| {n:.0f}/{total:.0f} {unit}") as progress:
        def on_progress(done):
            progress.update(done - progress.n)
        samples, frames = SoakRun(soak, out).make(on_progress)
    bars = judge(soak.name, samples[-1].trial if soak.last is None else soak.last, samples, frames)
    write_results(out, soak.name, samples, frames, bars)
    return bars


def run(arguments):
    out = os.path.abspath(arguments.out)
    os.makedirs(out, exist_ok=True)
    soaks = {"lockstep": lockstep(arguments.trials), "real_time": real_time(arguments.minutes, arguments.steps)}
    bars = [bar for name in arguments.runs for bar in make(soaks[name], out)]
    for bar in bars:
        print("%-6s  %s: %s: %s" % ("passed" if bar.passed else "failed", bar.run, bar.bar, bar.measured))
    num_passed = sum(bar.passed for bar in bars)
    print("results: %s" % out)
    print("%d passed, %d failed" % (num_passed, len(bars) - num_passed))
    return 0 if num_passed == len(bars) else 1


def main():
    parser = argparse.ArgumentParser(prog="soak", description=ABOUT, epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for tables, figure and the experiments")
    parser.add_argument("--runs", nargs="+", choices=RUNS, default=RUNS, help="which (default: both, one by one)")
    parser.add_argument("--trials", type=int, default=300, metavar="N", help="of lockstep (default: %(default)s)")
    parser.add_argument("--minutes", type=float, default=60.0, metavar="M", help="of real_time (default: %(default)g)")
    parser.add_argument("--steps", type=int, default=100, metavar="K",
                        help="frames of a trial of real_time, 5 a second (default: %(default)s)")
    arguments = parser.parse_args()
    if not 1 <= arguments.trials <= 998:
        parser.error("--trials must be 1 ... 998, got %d" % arguments.trials)
    if not arguments.minutes > 0.0:
        parser.error("--minutes must be > 0, got %g" % arguments.minutes)
    if arguments.steps < 10:
        parser.error("--steps must be >= 10, got %d" % arguments.steps)
    socket.setdefaulttimeout(CALL_LIMIT_S)
    return run_program("soak", lambda: run(arguments))
