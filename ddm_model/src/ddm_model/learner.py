# Training in Python: finds the files of preset and plant, and calls the C++ core.
# SPDX-License-Identifier: BSD-3-Clause
import os

import roslib.packages

try:
    from ddm_model import _core
except ImportError as error:
    raise ImportError("the Python bindings of ddm_model cannot be loaded (%s): install pybind11-dev, then build with "
                      "-DDDM_PYTHON=ON" % error) from error

Model = _core.Model


def _file(kind, package, folder, name):
    """Path of the file FOLDER/NAME.yaml of a package."""
    try:
        folder = os.path.join(roslib.packages.get_pkg_dir(package), folder)
    except roslib.packages.InvalidROSPkgException:
        raise ValueError("%s %r is in package %s, which cannot be found: source the setup.bash of its workspace" % (
            kind, name, package)) from None
    path = os.path.join(folder, name + ".yaml")
    if os.path.dirname(name) or not os.path.isfile(path):
        raise ValueError("unknown %s %r: %s has %s" % (kind, name, folder, ", ".join(
            sorted(file[:-5] for file in os.listdir(folder) if file.endswith(".yaml")))))
    return path


def layers(preset, plant):
    """The configuration of preset and plant, for the C++ core: paths of YAML files, or dictionaries of blocks.

    preset, plant: as for train(). Raises TypeError or ValueError, and OSError if the file of the plant cannot be read.
    """
    plant = getattr(getattr(plant, "unwrapped", plant), "configuration", plant)  # Gymnasium wraps environments
    if not isinstance(preset, str) or not isinstance(plant, (str, dict, type(None))):
        raise TypeError("preset must be a name, and plant a name, a path or an environment, got %r and %r" % (preset, plant))
    found = [_file("preset", "ddm_launch", os.path.join("config", "presets"), preset)]
    if isinstance(plant, str) and plant.endswith(".yaml"):
        plant = os.path.abspath(plant)
        open(plant, "rb").close()  # raises OSError
    elif isinstance(plant, str):
        package, _, name = plant.rpartition("/")
        plant = _file("plant", package or "ddm_sim", "config", name)
    return found if plant is None else found + [plant]


def train(episodes, goal, preset="efficient", plant=None, progress=None, seed=0, trial=None, **options):
    """Trains a deep dynamical model on all episodes from new initial weights, and returns a Model.

    The result equals that of run_experiment, byte by byte, for the same images, torques, configuration and seed.

    episodes: sequence of pairs (images, torques). A gap in a recording begins a new episode.
      images: uint8 [T, H, W] or [T, H, W, 3] (red, green, blue), all of one camera.
      torques: float [T, m] for m motors [N m, or N]. Torque t acts from image t to image t + 1.
    goal: the goal image [H, W] or [H, W, 3]. None: the model predicts, but a controller needs set_goal().
    preset: name of a file in ddm_launch/config/presets.
    plant: name of a plant, PACKAGE/NAME, path of a YAML file, or an environment of ddm_sim.make(). The plant may
      override values of the preset, and its max_torque scales the torques. None: give max_torque as an option.
    progress: function that is called about 50 times per second with (fraction done, V_R, V_P). If it raises an
      exception, the training stops.
    seed, trial: select the random draws. trial is the number of the last trial in the data; None: the last episode.
    options: keys of the blocks image, model, training and data_set (num_starts=1, pca_dim=20), or whole blocks
      (training={"num_starts": 1}). They override preset and plant. ddm_model/config/model.yaml explains all keys.

    Other Python threads run during the training. Ctrl-C stops it and raises KeyboardInterrupt.
    Raises TypeError or ValueError, which names argument, value and rule, OSError if the file of the plant cannot be
    read, and RuntimeError if the training fails.

    Example:
      model = ddm_model.train([(images, torques)], goal, plant="pendulum")
      model.save("pendulum.ddm")
    """
    return _core.train(episodes, goal, layers(preset, plant), options, seed, trial, progress)
