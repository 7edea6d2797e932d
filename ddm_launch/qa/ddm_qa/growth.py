# How time and memory of learning grow with frames and pixels: a table, a figure, and the trainer's own peak.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import sys
import tempfile

import numpy as np
from tqdm import tqdm
import yaml

from ddm_launch.command import Failure, find_program, package_path, processor, program_parser, run_program
from ddm_launch.figure_style import BLUE, COLUMN_WIDTH, GREEN, VERMILLION, new_figure, save
from ddm_launch.settings import read_yaml
from ddm_launch.tables import read_csv
from ddm_model.plain_file import write_file
from ddm_qa.processes import Programs

COLUMNS = "frames,size_px,pca_us,objective_gradient_us,peak_memory_mb"
FRAMES, SIZES = (1000, 3000, 10000, 30000, 100000), (51, 71, 101, 142, 201)
SIZE, NUM_FRAMES = 51, 1600  # of the rows in which the other one grows
RETRAIN_COLUMNS = "frames,train_s,peak_memory_mb"
RETRAIN_FRAMES = (1000, 3000, 10000, 20000)
# Runs a command and prints its peak memory.
WITH_PEAK_MEMORY = """import resource, subprocess, sys
code = subprocess.call(sys.argv[1:])
print("peak_memory_mb: %.1f" % (resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0))
sys.exit(code)"""
REMEDY = "rosrun ddm_launch growth writes it"

ABOUT = """\
Times PCA and one objective with its gradient on 1,000 to 100,000 frames of 51 x 51 pixels, and on 1600 frames of up to
201 x 201, preset paper, on one core; a whole training of the preset efficient on bags of 1,000 to 20,000 frames, on all cores; then has
model_node learn from bags of 100,000 frames, and reads its peak memory. Takes a few minutes."""

EPILOG = """\
DIR/growth.csv    frames, size [pixels], PCA and objective with gradient [us], peak memory of the process [MB]
DIR/retrain.csv   frames, time of a training from its bags [s], peak memory of the process [MB]
DIR/growth.png    all these times over frames and over pixels
DIR/growth.yaml   exponent of the objective's time over frames, peak memory of model_node [MB], processor"""


def write_table(out, programs, progress):
    lines = [COLUMNS]
    for frames, size in [(frames, SIZE) for frames in FRAMES] + [(NUM_FRAMES, size) for size in SIZES]:
        progress.set_description("%d frames of %d x %d pixels" % (frames, size, size))
        lines.append(programs.call("growth", [find_program("speed_growth"), "--frames", str(frames), "--size",
                                              str(size)]).strip())
        progress.update(1)
    write_file(os.path.join(out, "growth.csv"), "\n".join(lines) + "\n")


def read_table(path):
    """Arrays [rows x columns] of the rows that grow in frames, and in pixels."""
    names = COLUMNS.split(",")
    rows = np.array([[row[name] for name in names] for row in read_csv(path, dict.fromkeys(names, float), REMEDY)])
    in_frames = rows[:, 0] != NUM_FRAMES
    return rows[in_frames], rows[~in_frames]


def exponent(xs, ys):
    """Slope of log y over log x by least squares."""
    return float(np.polyfit(np.log(xs), np.log(ys), 1)[0])


def value_of(text, name):
    """Of a line `name: value`."""
    return next(float(line.split(":")[1]) for line in text.splitlines() if line.startswith(name + ":"))


def write_bags(programs, frames):
    """Their paths, 1000 frames in each."""
    folder = os.path.join(programs.scratch, "bags_%d" % frames)
    os.makedirs(folder)
    programs.call("bags", [find_program("speed_growth"), "--frames", str(frames), "--bags", folder])
    return sorted(glob.glob(os.path.join(folder, "*.bag")))


def write_retrain_table(out, programs, progress):
    lines = [RETRAIN_COLUMNS]
    for frames in RETRAIN_FRAMES:
        progress.set_description("training on %d frames" % frames)
        said = programs.call("retrain", [
            sys.executable, "-c", WITH_PEAK_MEMORY, find_program("train_from_bags", package="ddm_model"), "--config",
            package_path("config", "presets", "efficient.yaml"), "--seed", "1", "--out",
            os.path.join(programs.scratch, "model.ddm")] + write_bags(programs, frames), OMP_NUM_THREADS=str(os.cpu_count()))
        lines.append("%d,%g,%g" % (frames, value_of(said, "train_s"), value_of(said, "peak_memory_mb")))
        progress.update(1)
    write_file(os.path.join(out, "retrain.csv"), "\n".join(lines) + "\n")


def draw(path, retrain_path, out):
    by_frames, by_size = read_table(path)
    retrain = read_csv(retrain_path, {"frames": float, "train_s": float}, REMEDY)
    with new_figure(COLUMN_WIDTH, 1.9) as figure:
        left, right = figure.subplots(1, 2, sharey=True)
        for axes, rows, xs in ((left, by_frames, by_frames[:, 0]), (right, by_size, by_size[:, 1] ** 2)):
            axes.loglog(xs, 1e-6 * rows[:, 2], color=VERMILLION, marker="s", label="PCA")
            axes.loglog(xs, 1e-6 * rows[:, 3], color=BLUE, marker="o", label="objective, gradient")
            axes.grid(True)
        left.loglog([row["frames"] for row in retrain], [row["train_s"] for row in retrain], color=GREEN, marker="^")
        right.plot([], [], color=GREEN, marker="^", label="training, efficient")
        left.set_xlabel("frames of 51 x 51 pixels")
        right.set_xlabel("pixels, %d frames" % NUM_FRAMES)
        left.set_ylabel("time [s]")
        right.legend(loc="center", bbox_to_anchor=(0.5, 0.28))  # between the curves
        save(figure, out)


def node_memory(programs, progress):
    """Peak memory of model_node that has learned from as many frames [MB]."""
    progress.set_description("model_node, %d frames" % FRAMES[-1])
    write_bags(programs, FRAMES[-1])
    bags, result = os.path.join(programs.scratch, "bags_%d" % FRAMES[-1]), os.path.join(programs.scratch, "memory.yaml")
    programs.roslaunch("model_node", package_path("qa", "benchmark", "model_memory.launch"), "bags:=" + bags,
                       "out:=" + result)
    progress.update(1)
    measured = read_yaml(result)
    if measured.get("frames") != FRAMES[-1]:
        raise Failure("model_node: it did not learn from %d frames, but left %s" % (FRAMES[-1], measured or "nothing"))
    return measured["peak_memory_mb"]


def make(out):
    os.makedirs(out, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch, tqdm(
            total=len(FRAMES) + len(SIZES) + len(RETRAIN_FRAMES) + 1, unit="step", dynamic_ncols=True, disable=None) as progress:
        programs = Programs(scratch)
        write_table(out, programs, progress)
        write_retrain_table(out, programs, progress)
        memory_mb = node_memory(programs, progress)
    table = os.path.join(out, "growth.csv")
    draw(table, os.path.join(out, "retrain.csv"), os.path.join(out, "growth.png"))
    by_frames, _ = read_table(table)
    found = {"exponent": round(exponent(by_frames[:, 0], by_frames[:, 3]), 3),
             "model_node_peak_memory_mb": round(memory_mb, 1), "cpu": processor()}
    write_file(os.path.join(out, "growth.yaml"), yaml.safe_dump(found, sort_keys=False))
    return found


def main(arguments=None):
    parser = program_parser("growth", ABOUT, EPILOG)
    parser.add_argument("--out", default="speed", metavar="DIR", help="default speed")
    options = parser.parse_args(arguments)

    def work():
        found = make(os.path.abspath(options.out))
        print("objective: time grows with the %.2f-th power of the frames; model_node at %d frames: %.0f MB" % (
            found["exponent"], FRAMES[-1], found["model_node_peak_memory_mb"]))
        print("results: %s" % options.out)
    return run_program("growth", work)
