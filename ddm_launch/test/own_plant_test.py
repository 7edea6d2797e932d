# The example of a plant from outside: built in a workspace of its own on top of ours, it works in both drivers.
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess

from processes import call, find_program, roslaunch, run_experiment
from run_files import differences, expected_files, read_rows, read_yaml
from scratch_case import SharedScratchCase

EXAMPLE = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../examples/ddm_cart"))
PLANT_KEYS = ["type", "max_torque", "dt", "start_std", "picture_size", "mass", "friction", "track", "goal", "half_width",
              "half_extent", "edge_softness"]
TRIALS = 1


def build(workspace):
    """Builds the example as its page says."""
    os.makedirs(os.path.join(workspace, "src"))
    os.symlink(EXAMPLE, os.path.join(workspace, "src", "ddm_cart"))
    code, output = call(["catkin_make", "-C", workspace, "-j1"], 300.0)
    if code != 0:
        raise AssertionError(output)


def environment_of(setup):
    """The variables after sourcing a setup.bash."""
    text = subprocess.check_output(["bash", "-c", '. "$1" && env -0', "bash", setup], universal_newlines=True)
    return dict(line.split("=", 1) for line in text.split("\0") if line)


class OwnPlantTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        workspace = os.path.join(cls.class_scratch, "ws")
        build(workspace)
        os.environ.update(environment_of(os.path.join(workspace, "devel", "setup.bash")))
        cls.process = os.path.join(cls.class_scratch, "process")
        code, output = run_experiment("--preset", "debug", "--plant", "ddm_cart/cart", "--trials", TRIALS, "--out", cls.process)
        assert code == 0, output

    def assertRefused(self, words, *arguments, config=""):
        code, output = run_experiment("--preset", "debug", "--out", self.out, "--config",
                                      self.write("refused.yaml", config),
                                      *(arguments or ["--plant", "ddm_cart/cart"]))
        self.assertNotEqual(code, 0, output)
        for word in words:
            self.assertIn(word, output)
        self.assertFalse(os.path.exists(self.out))

    def test_the_nodes_do_the_same(self):
        _, output = roslaunch(self.scratch, "experiment.launch", "preset:=debug", "plant:=ddm_cart/cart",
                              "trials:=%d" % TRIALS, "runs:=" + self.out)
        names = [name for name in expected_files(TRIALS) if not name.endswith(".bag")]
        self.assertEqual(differences(self.process, self.out, names), [], output)

    def test_files_have_the_columns_of_the_plant(self):
        rows = read_rows(self.process, "evaluation_000", "torques.csv")
        self.assertEqual(rows[0], ["step", "force_n", "exploratory"])
        self.assertTrue(any(abs(float(row[1])) > 0.0 for row in rows[1:]))
        self.assertEqual(read_yaml(self.process, "config.yaml")["goal"]["error_unit"], "m")
        rows = read_rows(self.process, "trial_000", "trajectory.csv")
        self.assertEqual(rows[0], ["step", "time_s", "x_m", "rate_m_per_s"])
        self.assertGreater(len({row[2] for row in rows[1:]}), 20)  # it moves

    def test_the_saved_configuration_has_the_keys_of_the_plant_and_no_other(self):
        plant = read_yaml(self.process, "config.yaml")["plant"]
        self.assertEqual(list(plant), PLANT_KEYS)
        self.assertEqual((plant["type"], plant["friction"]), ("ddm_cart/Cart", 2.0))

    def test_a_sweep_finds_the_plant_in_the_workspace_that_is_sourced(self):
        code, output = call([find_program("sweep"), "--preset", "debug", "--plant", "ddm_cart/cart",
                             "--seeds", "1:2", "--trials", "0", "--out", self.out])
        self.assertEqual(code, 0, output)
        self.assertEqual(read_rows(self.out, "sweep.csv")[1][:3], ["1", "0", "30"])

    def test_simulate_knows_the_plant(self):
        with open(self.write("torques.csv", "force_n\n2\n2\n")) as stream:
            text = subprocess.check_output([find_program("simulate", "ddm_sim"), "--plant", "ddm_cart/cart", "--start",
                                            "0.1,0"], stdin=stream, universal_newlines=True)
        self.assertTrue(text.startswith("step,time_s,x_m,rate_m_per_s\n0,0,0.1"), text)
        # a constant force of 2 N: x = 0.1 + t - (1 - exp(-2 t)) / 2
        self.assertAlmostEqual(float(text.splitlines()[3].split(",")[2]), 0.1 + 0.4 - (1.0 - 0.449328964) / 2.0)

    def test_its_keys_are_checked_as_strictly_as_ours(self):
        self.assertRefused(["unknown key plant/masss", "mass?", "plant/goal", "mpc/horizon"],
                           config="plant: {masss: 1.0, goal: 3.0}\nmpc: {horizon: 0}\n")
        self.assertRefused(["unknown key plant/gravity"], config="plant: {gravity: 9.8}\n")
        self.assertRefused(["plant/dt", "got 0"], config="plant: {dt: 0.0}\n")

    def test_an_unknown_plugin_or_plant_is_told_what_there_is(self):
        self.assertRefused(["ddm_cart/Kart", "ddm_cart/Cart, moving_tile, mujoco, pendulum, two_link"],
                           config="plant: {type: ddm_cart/Kart}\n")
        self.assertRefused(["unknown plant 'ddm_cart/kart'", "package ddm_cart cart", "pendulum_gravity"],
                           "--plant", "ddm_cart/kart")
        self.assertRefused(["unknown plant 'no_cart/cart'", "package no_cart", "setup.bash"],
                           "--plant", "no_cart/cart")

    def test_from_one_random_trial_the_model_learns_to_stop_the_cart_at_its_goal(self):
        config = self.write("quick.yaml", "training: {num_starts: 2, max_iterations: 150}\n")
        code, output = run_experiment("--preset", "efficient", "--plant", "ddm_cart/cart", "--trials", 0, "--config",
                                      config, "--out", self.out)
        self.assertEqual(code, 0, output)
        x = [float(row[2]) for row in read_rows(self.out, "evaluation_000", "trajectory.csv")[1:]]
        self.assertLess(abs(x[0]), 0.4)
        self.assertLess(max(abs(position - 0.6) for position in x[-25:]), 0.05)
