# soak: runs long experiments with the real nodes, and checks the resources of each process and the loss of frames.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os
import re
import shutil
import socket
import time

import pandas
import rosgraph
from tqdm import tqdm

from ddm_launch.command import Failure, number, program_parser, run_program
from ddm_launch.run_folder import is_finished, num_finished, read_setting, read_trajectory
from ddm_model.model_data import read_bags
from ddm_model.plain_file import write_file
from ddm_qa.processes import free_port, pid_of, start_roslaunch

CALL_LIMIT_S = 30.0  # time limit of a call to a master or node
TRIAL_LIMIT_S = 300.0
LONG_TRAINING = "training: {max_iterations: 1000, function_tolerance: 1.0e-12}\n"
CONFIG = """\
image: {size: %d}
model: {pca_dim: 5, encoder_widths: [], predictor_widths: []}
trial: {num_steps: %d}
"""
GROWTH = 0.05  # largest growth of resident memory after the first tenth of the trials (trial 30 of 300)
IMAGE_SIZE = 5  # smallest images that are read from bags, whose content does not matter [pixels]
IMAGES = 2.0  # largest memory of model_node per frame [images]: one image, and other data of the frame

# trials, seconds: the run ends after this number of trials after the random one, or after this time since the first
# trial began; one of the two is None. image_bytes: size of an image if the stored images of model_node may increase its
# memory, else None.
Soak = collections.namedtuple("Soak", "name config arguments trials seconds image_bytes")

ABOUT = """\
Runs long experiments of the real nodes and looks at each process after each trial: lockstep, 300 trials in a few
minutes, and real_time, an hour at the paper's time step. Memory and open files must stay flat, but for the images that
model_node keeps in lockstep, and no frame may be lost."""

EPILOG = """\
DIR/soak.csv       run,node,trial,time_s,rss_kb,open_files: resident memory and open files of each node and of the master
DIR/frames.csv     run,trial,part,due,answered,lost: a row a trial, and one for its evaluation
DIR/targets.csv    run,target,measured,passed
Exit code: 0 all passed, 1 not, 2 bad options."""


def judge(soak, samples, frames):
    last, rows = samples.trial.max(), []
    tenth = max(1, last // 10)
    for node, of_node in samples.groupby("node"):
        first, end = of_node[of_node.trial >= tenth].iloc[0], of_node.iloc[-1]
        most_kb = (1.0 + GROWTH) * first.rss_kb
        if soak.image_bytes and node == "model_node":
            kept = frames[(frames.part == "trial") & (frames.trial > first.trial) & (frames.trial <= end.trial)]
            most_kb = first.rss_kb + IMAGES * kept.answered.sum() * soak.image_bytes / 1024.0
        rows.append(("resident memory of " + node, "%.1f MB after trial %d, %.1f MB after trial %d, at most %.1f MB" % (
            first.rss_kb / 1024.0, first.trial, end.rss_kb / 1024.0, end.trial, most_kb / 1024.0), end.rss_kb <= most_kb))
        # The maximum depends on whether a bag happens to be open when a sample is taken. The minimum does not, and a leak
        # raises it.
        early = of_node[of_node.trial.between(tenth, 2 * tenth)].open_files.min()
        late = of_node[of_node.trial >= last - tenth].open_files.min()
        rows.append(("open files of " + node, "at least %d in trials %d to %d, %d in trials %d to %d" % (
            early, tenth, 2 * tenth, late, last - tenth, last), late <= early))
    rows.append(("lost frames", "%d of %d" % (frames.lost.sum(), frames.due.sum()), frames.lost.sum() == 0))
    return pandas.DataFrame([(soak.name, target, measured, int(passed)) for target, measured, passed in rows],
                            columns=["run", "target", "measured", "passed"])


def count_frames(run, folder, num_trials):
    """Counts the frames of the first trials of a run folder and of their evaluations, which are not recorded. Returns
    the rows of frames.csv.

    A frame is lost if the camera did not publish its image, if the image did not arrive, or if no torque answered it.
    Each loss leaves a gap between the times of the answered frames, which are otherwise dt apart.
    """
    dt = float(read_setting(folder, "plant/dt"))
    num_steps, rows = int(read_setting(folder, "trial/num_steps")), []
    for trial in range(num_trials):
        bag, = read_bags([os.path.join(folder, "trial_%03d" % trial, "trial.bag")], IMAGE_SIZE)
        evaluation = read_trajectory(os.path.join(folder, "evaluation_%03d" % trial))
        for part, times in (("trial", bag["times"].tolist()), ("evaluation", evaluation.time_s.tolist())):
            due = max(num_steps, int(round((times[-1] - times[0]) / dt)) + 1 if len(times) else 0)
            rows.append((run, trial, part, due, len(times), due - len(times)))
    return pandas.DataFrame(rows, columns=["run", "trial", "part", "due", "answered", "lost"])


def look(soak, processes, trial, seconds):
    for name, pid in processes.items():
        with open("/proc/%d/status" % pid) as stream:
            rss_kb = int(re.search(r"VmRSS:\s+(\d+) kB", stream.read()).group(1))
        yield {"run": soak.name, "node": name, "trial": trial, "time_s": round(seconds, 2), "rss_kb": rss_kb,
               "open_files": len(os.listdir("/proc/%d/fd" % pid))}


def follow(soak, launch, master, run_folder):
    """Returns the rows of soak.csv. Takes samples of a launch until the launch ends or its time is over. Raises Failure
    if a trial takes too long or the launch ends early."""
    begin, news, count, processes, samples = None, time.monotonic(), 0, {}, []
    while launch.isRunning() and (soak.seconds is None or begin is None or time.monotonic() - begin < soak.seconds):
        time.sleep(0.02)
        if begin is None and os.path.isdir(os.path.join(run_folder, "trial_000")):  # all nodes exist and are connected
            begin = news = time.monotonic()
            nodes = sorted({name for topics in master.getSystemState() for _, names in topics for name in names})
            processes = {name.lstrip("/"): pid_of(master, name) for name in nodes + ["master"]}
        if num_finished(run_folder) > count:
            news, count = time.monotonic(), num_finished(run_folder)
            if soak.trials is None or count <= soak.trials + 1:
                samples += look(soak, processes, count - 1, news - begin)
        if time.monotonic() - news > TRIAL_LIMIT_S:
            raise Failure("no trial has ended within %g s" % TRIAL_LIMIT_S)
    if launch.isRunning() == is_finished(run_folder) or not samples or samples[-1]["trial"] == 0:
        raise Failure("it ended before its time, or fewer than two trials ended: raise --minutes or --trials")
    return pandas.DataFrame(samples)


def make(soak, out):
    """Runs a Soak in OUT/NAME and returns its tables by name. run: folder of the experiment. ros: logs of its nodes.
    output.txt: output of the launch."""
    folder, port = os.path.join(out, soak.name), free_port()
    config, run_folder = os.path.join(folder, "config.yaml"), os.path.join(folder, "run")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    with open(config, "w") as stream:
        stream.write(soak.config)
    # Runs one trial more than judged, so that the nodes still exist after the last judged trial.
    launch = start_roslaunch(os.path.join(folder, "ros"), "experiment.launch", "preset:=debug", "seed:=1", "config:=" + config,
                             "trials:=%d" % (soak.trials + 1 if soak.trials else 999), "runs:=" + run_folder, *soak.arguments,
                             port=port)
    try:
        samples = follow(soak, launch, rosgraph.Master("/soak", "http://localhost:%d" % port), run_folder)
    except Failure as error:
        raise Failure("%s: %s. Its last words:\n%s" % (soak.name, error, launch.output[-2000:]))
    finally:
        launch.stop()
        with open(os.path.join(folder, "output.txt"), "w") as stream:
            stream.write(launch.output)
    frames = count_frames(soak.name, run_folder, samples.trial.max() + 1)
    return {"soak.csv": samples, "frames.csv": frames, "targets.csv": judge(soak, samples, frames)}


def run(options):
    out = os.path.abspath(options.out)
    # model_node stores all images, so its memory grows. The run lockstep has images of the usual size and measures this
    # growth; the run real_time has the smallest images, so that other growth becomes visible. The camera's own images
    # have the usual size in both runs.
    soaks = (Soak("lockstep", CONFIG % (51, 20), [], options.trials, None, 51 ** 2),
             Soak("real_time", CONFIG % (5, options.steps) + LONG_TRAINING, ["real_time:=true"], None, 60.0 * options.minutes, None))
    made = [make(soak, out) for soak in tqdm(soaks, unit="run", disable=None)]
    tables = {name: pandas.concat([of_run[name] for of_run in made]) for name in made[0]}
    for name, table in tables.items():
        write_file(os.path.join(out, name), table.to_csv(index=False))
    targets = tables["targets.csv"]
    for target in targets.itertuples():
        print("%-6s  %s: %s: %s" % ("passed" if target.passed else "failed", target.run, target.target, target.measured))
    print("results: %s" % out)
    print("%d passed, %d failed" % (targets.passed.sum(), (1 - targets.passed).sum()))
    return 0 if targets.passed.all() else 1


def main():
    parser = program_parser("soak", ABOUT, EPILOG)
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for tables and the experiments")
    parser.add_argument("--trials", type=number(int, 1), default=300, metavar="N",
                        help="of lockstep (default: %(default)s)")
    parser.add_argument("--minutes", type=number(float, 0.01), default=60.0, metavar="M",
                        help="of real_time (default: %(default)g)")
    parser.add_argument("--steps", type=number(int, 10), default=100, metavar="K",
                        help="frames of a trial of real_time, 5 a second (default: %(default)s)")
    options = parser.parse_args()
    socket.setdefaulttimeout(CALL_LIMIT_S)
    return run_program("soak", lambda: run(options))
