# Python interface of the simulated plants: environments with the interface of Gymnasium, which need not be installed.
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np

from ddm_sim import _core

try:
    import gymnasium
except ImportError:
    gymnasium = None


class _Box:
    """Stands in for gymnasium.spaces.Box."""

    def __init__(self, low, high, shape, dtype):
        self.low, self.high = (np.broadcast_to(limit, shape).astype(dtype) for limit in (low, high))
        self.shape, self.dtype = tuple(shape), np.dtype(dtype)
        self._random = np.random.RandomState()

    def seed(self, seed=None):
        self._random.seed(seed)

    def sample(self):
        if self.dtype == np.uint8:
            return self._random.randint(0, 256, self.shape).astype(np.uint8)
        return self._random.uniform(self.low, self.high)

    def contains(self, value):
        value = np.asarray(value)
        return value.shape == self.shape and bool(np.all((self.low <= value) & (value <= self.high)))


class Environment(gymnasium.Env if gymnasium else object):
    """A plant in front of its camera, with the interface of gymnasium.Env. make() makes it.

    observation_space: images, uint8 [H, W] or [H, W, 3] (red, green, blue).
    action_space: torques, float64 [m] within the limits of the motors [N m, or N].
    dt: time step [s]. max_steps: number of steps after which `truncated` is true, in this episode: trial/num_steps of
      the plant or 100; for an evaluation that of the plant, if it gives one.
    configuration: all blocks of the plant's file and the options, as a dictionary. ddm_model.train() and
      ddm_mpc.Controller() read it if they are called with plant=environment.
    """

    metadata = {"render_modes": ["rgb_array"]}
    render_mode = "rgb_array"

    def __init__(self, plant, options):
        self._core = _core.Environment(plant, options)
        self._seed, self._trial = 0, -1
        box = gymnasium.spaces.Box if gymnasium else _Box
        limit = self._core.max_torque
        self.observation_space = box(0, 255, self._core.image_shape, np.uint8)
        self.action_space = box(-limit, limit, limit.shape, np.float64)
        self.dt, self.configuration = self._core.dt, self._core.configuration
        self.metadata = dict(self.metadata, render_fps=1.0 / self.dt)

    @property
    def max_steps(self):
        return self._core.max_steps

    def reset(self, *, seed=None, options=None):
        """Begins an episode with an initial state that is drawn anew. Returns (image, info), as step() does.

        seed: selects all random draws from now on, >= 0. None: the next episode of the same seed.
        options: dictionary with trial (number of the episode; 0 after a seed, then 1, 2, ...), evaluation (true for
          the greedy episode after a trial, which has draws of its own), start (initial state, in place of a drawn one).
          With the same numbers, run_experiment draws the same initial state, goal and disturbances.
        Raises TypeError or ValueError.
        """
        if gymnasium:
            super().reset(seed=seed)  # for wrappers; no draw of the environment depends on it
        if not isinstance(options, (dict, type(None))):
            raise TypeError("options must be a dictionary, got %s" % type(options).__name__)
        options = dict(options or {})
        trial = options.pop("trial", 0 if seed is not None else self._trial + 1)
        evaluation, start = options.pop("evaluation", False), options.pop("start", None)
        if options:
            raise ValueError("options of reset() are trial, evaluation and start, got %s" % ", ".join(map(str, options)))
        result = self._core.reset(self._seed if seed is None else seed, trial, evaluation, start)
        self._seed, self._trial = self._seed if seed is None else seed, trial
        return result

    def step(self, torque):
        """Moves the plant by one time step under a constant torque, which the motors limit  [m, N m or N].

        If the camera loses an image, the torque acts for another time step. Returns (image, reward, terminated,
        truncated, info):
          image: uint8 [H, W] or [H, W, 3].
          reward: that of the plant, summed over physics steps; 1 at the goal and else 0 for plants without a reward.
          terminated: always false. truncated: true from step max_steps on.
          info: state (the true state), error (distance to the goal) and at_goal (the error is within the tolerance),
            which no learner may use; goal_image; time since the reset [s].
        Raises TypeError or ValueError; the environment is then unchanged.
        """
        return self._core.step(torque)

    def render(self):
        """An image for people, uint8 [H, W, 3]; large if the plant has a camera for it."""
        image = self._core.render()
        return image if image.ndim == 3 else np.repeat(image[..., None], 3, axis=2)

    def close(self):
        """Does nothing; Gymnasium calls it."""


def make(plant, /, **options):
    """Makes the environment of a plant.

    plant: name of a file in ddm_sim/config ("pendulum", "suite_cartpole"), PACKAGE/NAME for the folder config of
      another package, or path of a YAML file.
    options: keys of the blocks plant and camera (max_torque=3.0, noise_std=0.1), or whole blocks
      (camera={"delay": 1}). ddm_sim/config/pendulum.yaml and sim.yaml explain them.

    Raises TypeError or ValueError, which names argument, value and rule, and RuntimeError if the system cannot render.

    Example:
      env = ddm_sim.make("pendulum")
      image, info = env.reset(seed=0)
      image, reward, terminated, truncated, info = env.step([1.5])
    """
    return Environment(plant, options)


def _register():
    """Registers the plants of this package with Gymnasium, as ddm/NAME-v0."""
    for plant in _core.plants():
        name = "ddm/%s-v0" % plant
        if name not in gymnasium.registry:
            gymnasium.register(name, lambda plant=plant, render_mode=None, **options: make(plant, **options))


if gymnasium:
    _register()
