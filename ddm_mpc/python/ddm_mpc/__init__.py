# Python interface of the controller.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_model.learner import layers

from ddm_mpc import _core


class Controller(_core.Controller):
    """Answers camera images with torques: model predictive control in the feature space of a model, or random torques.

    For each episode call reset(), then act() for each image. The torques equal those of run_experiment for the same
    model, configuration, images and numbers of seed and trial.

    Example:
      controller = ddm_mpc.Controller(model, plant="pendulum")
      controller.reset(seed=0, trial=1)
      torque = controller.act(image)
    """

    def __init__(self, model, preset="efficient", plant=None, **options):
        """model: ddm_model.Model. None: all torques are random, as in the first trial of an experiment.
        preset, plant: as for ddm_model.train(). Without a plant, the limits of the torques are those of the model.
        options: keys of the blocks mpc and controller (epsilon=0.2, max_torque=[4.0, 2.0]), or whole blocks
          (mpc={"horizon": 8}). They override preset and plant. ddm_mpc/config/mpc.yaml explains all keys.

        Raises TypeError or ValueError, which names argument, value and rule.
        """
        super().__init__(model, layers(preset, plant), options)
