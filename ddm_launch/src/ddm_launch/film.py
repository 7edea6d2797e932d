# Draws greedy evaluations as one animation: the camera, what the model expected, and the feature space.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os
import re

from matplotlib import font_manager
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from ddm_launch.command import Failure, number
from ddm_launch.figure_style import BLUE, GREY, ORANGE, VERMILLION, Figure, argument, save_picture
from ddm_launch.images import draw_images, read_model
from ddm_launch.plant import describe_plant, simulator
from ddm_launch.run_folder import read_setting, read_trials
from ddm_launch.settings import read_yaml
from ddm_launch.tables import motors_of, read_columns

ABOUT = ("Greedy evaluations of run folders, one after the other. Left: the image, without nuisances of the camera. Middle: the "
         "image that the model predicted one second earlier, given the torques applied since. Right: the feature space, with states "
         "that the model has seen (grey), the goal (red), the current image (blue) and the features predicted from it under the "
         "torques to come (orange).")
SUFFIX = ".webp"
AHEAD_S = 1.0
PANEL, MARGIN, HEADER, FOOTER = 200, 8, 26, 24  # [pixels]
LAST_MS = 1500  # the last picture of an evaluation stays
# Below each panel: words, their distance from its left edge [pixels] and their colour.
TITLES = ([("image", 0, "black")], [("predicted a second ago", 0, "black")],
          [("features:", 0, "black"), ("now", 66, BLUE), ("plan", 98, ORANGE), ("goal", 132, VERMILLION), ("seen", 166, GREY)])
EVALUATION = re.compile(r"evaluation_(\d+)$")

# One evaluation. title; dt [s]; images [N x size x size] and what was expected of them, None at first; features [N x 2]; paths:
# for each frame the features that are expected from it on; support_states, goal: features  [.. x 2].
Clip = collections.namedtuple("Clip", "title dt images expected features paths support_states goal")


def simulate(run, evaluation):
    """Images of an evaluation as the plant draws them, one for each torque, and the torques [N x motors, N m]."""
    program = simulator(read_setting(run, "experiment", "plant", "plant"), "--config", os.path.join(run, "config.yaml"))
    plant, trajectory = describe_plant(program), os.path.join(evaluation, "trajectory.csv")
    if np.any(np.diff(read_columns(trajectory, ["time_s"])[:, 0]) > 1.5 * plant["dt"]):
        raise Failure("in %s the camera has lost frames: only runs without camera/drop_rate can be filmed" % trajectory)
    start = read_columns(trajectory, plant["state"])[0]
    motors = motors_of(os.path.join(evaluation, "torques.csv"))
    torques = read_columns(os.path.join(evaluation, "torques.csv"), motors)
    text = "\n".join([",".join(motors)] + [",".join(map(repr, map(float, row))) for row in torques]) + "\n"
    pictures = draw_images(program + ["--start", ",".join(map(repr, map(float, start)))], text)[:len(torques)]
    return np.array([np.asarray(picture) for picture in pictures]), torques


def plane_of(points):
    """Projection of features to the two directions in which these points vary most."""
    mean, dim = points.mean(axis=0), points.shape[1]
    directions = np.zeros((2, dim))
    found = np.linalg.svd(points - mean, full_matrices=False)[2][:2]
    directions[:len(found)] = found
    return lambda features: (np.asarray(features) - mean) @ directions.T


def read_clip(evaluation):
    evaluation = os.path.normpath(evaluation)
    found = EVALUATION.search(evaluation)
    if not found:
        raise Failure("a film shows folders RUN/evaluation_NNN, got '%s'" % evaluation)
    run, trial = os.path.dirname(evaluation) or ".", int(found.group(1))
    model = read_model(os.path.join(run, "trial_%03d" % trial, "model.ddm"))
    frames = next((row.frames for row in read_trials(run) if row.trial == trial), None)
    images, torques = simulate(run, evaluation)
    if images.shape[1] != model.image_size:
        raise Failure("the plant of %s draws %d pixels and the model sees %d: film runs in which both are equal" % (
            run, images.shape[1], model.image_size))
    dt = float(read_setting(run, "plant", "dt", "time step"))
    steps, n = max(1, round(AHEAD_S / dt)), model.options["order"]
    memory = n + model.options["delay"]
    features, paths, expected = model.encode(images), [], [None] * len(images)
    for now in range(len(images)):
        if now < memory - 1:
            paths.append(features[now:now + 1])
            continue
        ahead = model.roll_out(features[now - n + 1:now + 1], torques[now - memory + 1:now + steps])
        paths.append(np.concatenate([features[now:now + 1], ahead]))
        if now + steps < len(images):
            expected[now + steps] = np.clip(255.0 * model.decode(ahead[-1:])[0], 0, 255)
    seen = model.support_states if len(model.support_states) > 1 else features
    project = plane_of(seen)
    # Where each trial has a goal of its own, the model's is that of another.
    drawn = (read_yaml(os.path.join(run, "config.yaml")).get("plant") or {}).get("goal_site")
    goal = None if drawn or model.goal_feature is None else project(model.goal_feature[None])
    title = read_setting(run, "experiment", "plant", "plant")
    if title.endswith(".yaml"):
        title = os.path.basename(title)[:-len(".yaml")]
    if frames:
        title += ", after {:,} images ({:g} s)".format(frames, frames * dt)
    return Clip(title, dt, images, expected, project(features), [project(path) for path in paths], project(seen), goal)


class Plane:
    """The right panel: features as points and ways in a square of PANEL pixels."""

    def __init__(self, clip):
        points = np.concatenate([clip.support_states, clip.features])
        self._middle = 0.5 * (points.max(axis=0) + points.min(axis=0))
        self._scale = 0.44 * PANEL / max(1e-9, 0.5 * float(np.max(np.ptp(points, axis=0))))
        self._background = Image.new("RGB", (PANEL, PANEL), "white")
        pen = ImageDraw.Draw(self._background)
        for point in clip.support_states:
            self._dot(pen, point, 1, "#cccccc")
        if clip.goal is not None:
            self._dot(pen, clip.goal[0], 6, VERMILLION)

    def _at(self, point):
        x, y = self._scale * (np.asarray(point) - self._middle)
        return PANEL / 2 + x, PANEL / 2 - y

    def _dot(self, pen, point, radius, colour):
        x, y = self._at(point)
        pen.ellipse([x - radius, y - radius, x + radius, y + radius], fill=colour)

    def draw(self, past, path):
        picture = self._background.copy()
        pen = ImageDraw.Draw(picture)
        pen.line([self._at(point) for point in past], fill=GREY, width=1)
        pen.line([self._at(point) for point in path], fill=ORANGE, width=3)
        self._dot(pen, path[0], 5, BLUE)
        return picture


def font(size):
    return ImageFont.truetype(font_manager.findfont("DejaVu Sans"), size)


def pictures_of(clip):
    """RGB pictures of all frames."""
    width = 3 * PANEL + 4 * MARGIN
    plane, pictures = Plane(clip), []
    for now, image in enumerate(clip.images):
        picture = Image.new("RGB", (width, HEADER + PANEL + FOOTER + MARGIN), "white")
        pen = ImageDraw.Draw(picture)
        pen.text((MARGIN, 5), "%s:   %4.1f s" % (clip.title, now * clip.dt), fill="black", font=font(14))
        panels = [as_panel(image), as_panel(clip.expected[now]),
                  plane.draw(clip.features[max(0, now - 10):now + 1] if now else clip.features[:2], clip.paths[now])]
        for column, (panel, title) in enumerate(zip(panels, TITLES)):
            left = MARGIN + column * (PANEL + MARGIN)
            picture.paste(panel, (left, HEADER))
            pen.rectangle([left, HEADER, left + PANEL - 1, HEADER + PANEL - 1], outline="#dddddd")
            for word, shift, colour in title:
                pen.text((left + shift, HEADER + PANEL + 4), word, fill=colour, font=font(13))
        pictures.append(picture)
    return pictures


def as_panel(image):
    """None: nothing is expected yet."""
    if image is None:
        return Image.new("RGB", (PANEL, PANEL), "#eeeeee")
    return Image.fromarray(np.asarray(image, dtype=np.uint8)).resize((PANEL, PANEL), Image.BICUBIC).convert("RGB")


def draw(options):
    if not options.out.lower().endswith(SUFFIX):
        raise Failure("a film must be a .webp, got '%s': give --out another name" % options.out)
    pictures, durations = [], []
    for evaluation in options.evaluations:
        clip = read_clip(evaluation)
        shown = pictures_of(clip)[:1 + round(options.seconds / clip.dt)]
        pictures += shown
        durations += [round(1000 * clip.dt)] * (len(shown) - 1) + [LAST_MS]
    save_picture(pictures[0], options.out, "WEBP", save_all=True, append_images=pictures[1:], duration=durations, loop=0,
                 quality=60, method=4)


FIGURE = Figure(ABOUT, [
    argument("evaluations", metavar="RUN/evaluation_NNN", nargs="+", help="shown one after the other"),
    argument("--seconds", type=number(float, 0), default=10.0, help="of each, default %(default)g")], draw, SUFFIX)
