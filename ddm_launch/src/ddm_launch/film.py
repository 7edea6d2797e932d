# Draws evaluations as an animation of image, prediction and feature space, or as a strip of images.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import math
import os
import re

import numpy as np
from PIL import Image

from ddm_launch.command import Failure, number
from ddm_launch.figure_style import (BLUE, GREY, ORANGE, SCREEN, VERMILLION, Figure, argument, new_figure, save, save_image,
                                     show_image)
from ddm_launch.plant import draw_evaluation
from ddm_launch.run_folder import read_images, read_setting, read_trials, read_yaml
from ddm_model.model import load

SUFFIX = ".webp"
AHEAD_S = 1.0
# Text below the features: distance from the left edge as a share of the width, word, and colour.
FEATURES = ((0.0, "features:", "black"), (0.36, "now", BLUE), (0.52, "plan", ORANGE), (0.68, "goal", VERMILLION),
            (0.84, "seen", GREY))
LAST_MS = 1500  # duration of the last image of an evaluation [ms]
EVALUATION = re.compile(r"evaluation_(\d+)$")
STRIP_IMAGES = 12

# One evaluation. title: text. dt: time step [s]. episode: an Episode. expected: for each image the image that was seen in
# training and is nearest to the prediction, or None. features: projected features  [N x 2]. paths: for each image its
# feature and the features predicted from it  [steps + 1 x 2]. support_states, goal: projected features  [.. x 2].
Clip = collections.namedtuple("Clip", "title dt episode expected features paths support_states goal")


def plane_of(points):
    """Function that projects features to the two directions with the largest variance of these points."""
    mean, dim = points.mean(axis=0), points.shape[1]
    directions = np.zeros((2, dim))
    found = np.linalg.svd(points - mean, full_matrices=False)[2][:2]
    directions[:len(found)] = found
    return lambda features: (np.asarray(features) - mean) @ directions.T


def read_clip(evaluation):
    """Reads a folder RUN/evaluation_NNN and predicts its images. Returns a Clip. Raises Failure if the folder has
    another name, or if the model and the plant have different image sizes."""
    evaluation = os.path.normpath(evaluation)
    found = EVALUATION.search(evaluation)
    if not found:
        raise Failure("a film shows folders RUN/evaluation_NNN, got '%s'" % evaluation)
    run, trial = os.path.dirname(evaluation) or ".", int(found.group(1))
    model, trials = load(os.path.join(run, "trial_%03d" % trial, "model.ddm")), read_trials(os.path.join(run, "trials.csv"))
    episode = draw_evaluation(run, trial, with_views=True)
    images, torques = episode.images, episode.torques.values
    if images.shape[1] != model.image_size:
        raise Failure("the plant of %s draws %d pixels and the model sees %d: film runs in which both are equal" % (
            run, images.shape[1], model.image_size))
    dt = float(read_setting(run, "plant/dt"))
    steps, n = max(1, round(AHEAD_S / dt)), model.options["order"]
    features, paths, expected = model.encode(images), [], [None] * len(images)
    known = read_images(run, trial, model.image_size)
    known_features = model.encode(known)
    for now in range(len(images)):
        if now < n - 1:
            paths.append(features[now:now + 1])
            continue
        ahead = model.roll_out(features[now - n + 1:now + 1], torques[now - n + 1:now + steps])
        paths.append(np.concatenate([features[now:now + 1], ahead]))
        if now + steps < len(images):
            expected[now + steps] = known[np.argmin(np.linalg.norm(known_features - ahead[-1], axis=1))]
    seen = model.support_states if len(model.support_states) > 1 else features
    project = plane_of(seen)
    # If the goal is drawn in each trial, the goal in the model belongs to another trial.
    drawn = (read_yaml(run, "config.yaml").get("plant") or {}).get("goal_site")
    goal = None if drawn or model.goal_feature is None else project(model.goal_feature[None])
    title = re.sub(r".*/(.*)\.yaml$", r"\1", read_setting(run, "experiment/plant"))
    for count in trials[trials.trial == trial].frames:
        title += ", after {:,} images ({:g} s)".format(count, count * dt)
    return Clip(title, dt, episode, expected, project(features), [project(path) for path in paths], project(seen), goal)


def draw_view(axes, view, goal):
    """Draws the middle of an image for people, with the goal image in its corner."""
    left = (view.shape[1] - view.shape[0]) // 2
    axes.imshow(view[:, max(0, left):max(0, left) + view.shape[0]])
    inset = axes.inset_axes([0.02, 0.70, 0.28, 0.28])
    show_image(inset, goal)
    inset.set_xlabel("goal", color="white", fontsize=7, labelpad=1)
    for edge in inset.spines.values():
        edge.set_edgecolor("white")


def draw_plane(axes, clip, now, middle, reach):
    """Draws the feature space with states that the model has seen, the goal, the latest features and the predicted ones."""
    axes.plot(*clip.support_states.T, ".", color="#cccccc", markersize=2)
    if clip.goal is not None:
        axes.plot(*clip.goal.T, "o", color=VERMILLION, markersize=7)
    axes.plot(*clip.features[max(0, now - 10):now + 1].T, color=GREY, linewidth=1)
    axes.plot(*clip.paths[now].T, color=ORANGE, linewidth=2)
    axes.plot(*clip.paths[now][0], "o", color=BLUE, markersize=5)
    axes.set(xlim=(middle[0] - reach, middle[0] + reach), ylim=(middle[1] - reach, middle[1] + reach), aspect="equal")
    for left, word, colour in FEATURES:
        axes.text(left, -0.13, word, color=colour, fontsize=5.4, transform=axes.transAxes)


def images_of(clip, count):
    points, drawn = np.concatenate([clip.support_states, clip.features]), []
    middle, reach = 0.5 * (points.max(axis=0) + points.min(axis=0)), 0.55 * np.ptp(points, axis=0).max() + 1e-9
    with new_figure(5.6, 3.0, **SCREEN) as figure:
        grid = figure.add_gridspec(2, 4)
        robot = figure.add_subplot(grid[:, :2])
        small = [figure.add_subplot(grid[row, column]) for row in (0, 1) for column in (2, 3)]
        for now, image in enumerate(clip.episode.images[:count]):
            for axes in (robot, *small):
                axes.clear()
                axes.tick_params(left=False, bottom=False, labelleft=False, labelbottom=False)
            draw_view(robot, clip.episode.views[now], clip.episode.goal)
            expected = clip.expected[now]
            none = np.full_like(image, 238)  # no prediction exists yet in the first second
            show_image(small[0], image)
            show_image(small[1], none if expected is None else expected)
            show_image(small[3], none if expected is None else 255 - np.abs(image.astype(float) - expected))
            draw_plane(small[2], clip, now, middle, reach)
            small[0].set_xlabel("the learner sees", fontsize=7)
            small[1].set_xlabel("predicted %g s ago" % AHEAD_S, fontsize=7)
            small[3].set_xlabel("difference", fontsize=7)
            figure.suptitle("%s:   %4.1f s" % (clip.title, now * clip.dt), x=0.02, horizontalalignment="left", fontsize=9)
            figure.canvas.draw()
            drawn.append(Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB"))
    return drawn


def draw_film(options):
    if not options.out.lower().endswith(SUFFIX):
        raise Failure("a film must be a .webp, got '%s': give --out another name" % options.out)
    images, durations = [], []
    for evaluation in options.evaluations:
        clip = read_clip(evaluation)
        shown = images_of(clip, 1 + round(options.seconds / clip.dt))
        images += shown
        durations += [round(1000 * clip.dt)] * (len(shown) - 1) + [LAST_MS]
    save_image(images[0], options.out, "WEBP", save_all=True, append_images=images[1:], duration=durations, loop=0,
               quality=60, method=4)


def draw_strip(options):
    trials = read_trials(os.path.join(options.folder, "trials.csv"))
    successes = trials[trials.success > 0]
    trial = options.trial if options.trial is not None else (trials if successes.empty else successes).trial.iloc[-1]
    episode = draw_evaluation(options.folder, trial)
    images, torques = episode.images, episode.torques
    dt = float(read_setting(options.folder, "plant/dt"))
    shown = max(1, min(round(options.seconds / dt), len(images)))
    steps = range(0, shown, math.ceil(shown / STRIP_IMAGES))
    with new_figure(len(steps) * 1.0 + 0.6, 3.0, **SCREEN) as figure:
        grid = figure.add_gridspec(2, len(steps), height_ratios=[1.0, 1.1])
        for column, step in enumerate(steps):
            axes = figure.add_subplot(grid[0, column])
            show_image(axes, images[step])
            axes.set_title("%.1f s" % (step * dt), fontsize=10)
        axes = figure.add_subplot(grid[1, :])
        for motor, column in torques[:shown].items():
            axes.step(dt * np.arange(shown + 1), np.append(column, column.iloc[-1]), where="post", label=motor)
        for step in steps:
            axes.axvline(step * dt, color=GREY, linewidth=0.6, linestyle=":")
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        axes.set_xlim(0.0, shown * dt)
        axes.set_xlabel("time [s]")
        axes.legend(loc="best")
        save(figure, options.out)
    print("evaluation after trial %d" % trial)


FILM = Figure(
    "Greedy evaluations of run folders, one after the other. Left: the plant and the goal image. Right: the image of the learner, "
    "without nuisances of the camera; what the model predicted one second earlier, given the torques applied since, as the image "
    "seen in training whose feature is nearest to the predicted one; their difference; and the feature space, with states that "
    "the model has seen (grey), the goal (red), the current image (blue) and the features predicted from it under the torques "
    "to come (orange).",
    [argument("evaluations", metavar="RUN/evaluation_NNN", nargs="+", help="shown one after the other"),
     argument("--seconds", type=number(float, 0), default=10.0, help="of each, default %(default)g")], draw_film, SUFFIX)
STRIP = Figure(
    "A greedy evaluation of a run folder as a strip. At most %d images, and the torques below." % STRIP_IMAGES,
    [argument("folder", metavar="DIR", help="run folder (it holds trials.csv and evaluation_NNN)"),
     argument("--trial", type=int, metavar="N", help="default: the last that succeeded, else the last"),
     argument("--seconds", type=number(float, 0), default=3.0, help="from the start on, default %(default)g")], draw_strip)
