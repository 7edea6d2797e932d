# new_plant: its plant file works as it is, in every program and from every folder; what cannot be a plant is refused.
# SPDX-License-Identifier: BSD-3-Clause
import os
import struct
import subprocess
import unittest

import yaml

from processes import call, find_program, has_mujoco, run_experiment
from run_files import read_rows, read_yaml
from scratch_case import ScratchCase

INERTIAL = ('<inertial><origin xyz="0 0 -0.2"/><mass value="0.5"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" '
            'ixz="0" iyz="0"/></inertial>')
SHAPE = '<visual><origin xyz="0 0 -0.2"/><geometry><box size="0.06 0.06 0.4"/></geometry></visual>'
LINK = '<link name="%s">' + INERTIAL + SHAPE + '</link>'
JOINT = ('<joint name="%s" type="continuous"><parent link="%s"/><child link="%s"/><origin xyz="0 0 %g"/>'
         '<axis xyz="0 1 0"/><limit effort="%g" velocity="9"/><dynamics damping="0.05"/></joint>')


def swing(effort=2.0):
    """A URDF with one motor."""
    return ('<robot name="swing"><link name="base"/>' + LINK % "rod" + JOINT % ("pivot", "base", "rod", 0, effort)
            + "</robot>")


def arm(effort=0.0):
    """A URDF with two joints."""
    return ('<robot name="arm"><link name="base"/>' + LINK % "upper" + LINK % "lower"
            + JOINT % ("shoulder", "base", "upper", 0, effort) + JOINT % ("elbow", "upper", "lower", -0.4, effort)
            + "</robot>")


TABLE = """<mujoco model="table"><option gravity="0 0 -9.81"/><worldbody><light pos="0 0 3"/>
  <body><joint name="first" axis="0 0 1" damping="0.02"/><geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.03"/>
    <body pos="0.2 0 0"><joint name="second" axis="0 0 1" damping="0.02" limited="true" range="-120 120"/>
      <geom type="capsule" fromto="0 0 0.07 0.2 0 0.07" size="0.03"/></body></body>
  </worldbody><actuator><motor joint="first" ctrllimited="true" ctrlrange="-0.3 0.3"/>
    <motor joint="second" ctrllimited="true" ctrlrange="-0.2 0.2"/></actuator></mujoco>"""


class NewPlantTest(ScratchCase):
    def setUp(self):
        super().setUp()
        if not has_mujoco():
            raise unittest.SkipTest("ddm_sim was built without MuJoCo")
        os.makedirs(self.file("elsewhere"))

    def newPlant(self, *arguments):
        return call([find_program("new_plant", "ddm_sim")] + list(arguments), folder=self.scratch)

    def make(self, model, text, *options):
        """(block `plant` of the plant file, what was printed)."""
        self.write(model, text)
        code, output = self.newPlant(model, "--out", "my_plant.yaml", *options)
        self.assertEqual(code, 0, output)
        return read_yaml(self.scratch, "my_plant.yaml")["plant"], output

    def simulate(self, header, row):
        """The rows of a trajectory, simulated in another folder."""
        with open(self.write("torques.csv", "%s\n%s\n%s\n" % (header, row, row))) as torques:
            text = subprocess.check_output([find_program("simulate", "ddm_sim"), "--plant", "../my_plant.yaml"],
                                           stdin=torques, cwd=self.file("elsewhere"), universal_newlines=True)
        return [line.split(",") for line in text.splitlines()]

    def assertRefused(self, code, words, *arguments):
        actual, output = self.newPlant(*arguments)
        self.assertEqual(actual, code, output)
        for word in words:
            self.assertIn(word, output)
        self.assertFalse(os.path.exists(self.file("my_plant.yaml")))
        self.assertEqual([name for name in os.listdir(self.scratch) if "unfinished" in name], [])

    def test_a_urdf_with_one_motor_becomes_a_plant_that_learns_from_any_folder(self):
        plant, output = self.make("swing.urdf", swing())
        self.assertEqual((plant["model"], plant["motors"], plant["max_torque"]), ("swing.urdf", ["pivot"], [2]))
        for word in ("pivot", "hinge", "effort limit 2 N m", "plant/goal", "plant/tolerance", "run_experiment",
                     "my_plant.png", "stable"):
            self.assertIn(word, output)
        with open(self.file("my_plant.yaml")) as stream:
            text = stream.read()
        self.assertEqual(text.count("SET: "), 2, text)
        with open(self.file("my_plant.png"), "rb") as stream:
            self.assertGreater(min(struct.unpack(">II", stream.read(24)[16:])), 800)
        self.assertEqual(self.simulate("pivot_nm", "2")[0], ["step", "time_s", "pivot_rad", "pivot_rad_per_s"])

        elsewhere = {"folder": self.file("elsewhere")}
        debug = ["--preset", "debug", "--plant", "../my_plant.yaml"]
        code, output = run_experiment(*debug, "--trials", 1, "--out", "run", **elsewhere)
        self.assertEqual(code, 0, output)
        saved = read_yaml(self.file("elsewhere", "run"), "config.yaml")
        self.assertEqual(saved["plant"]["model"], self.file("swing.urdf"))
        self.assertEqual(saved["experiment"]["plant"], self.file("my_plant.yaml"))
        code, output = run_experiment("--config", self.file("elsewhere", "run", "config.yaml"), "--out", self.out,
                                      folder="/")
        self.assertEqual(code, 0, output)
        self.assertEqual(read_rows(self.out, "trial_001", "torques.csv"),
                         read_rows(self.file("elsewhere", "run"), "trial_001", "torques.csv"))
        code, output = call([find_program("evaluate"), "--model", "run/trial_000/model.ddm", "--seeds", "0:1"] + debug,
                            **elsewhere)
        self.assertEqual(code, 0, output)
        code, output = call([find_program("sweep"), "--seeds", "0:1", "--trials", 0, "--out", "sweep"] + debug,
                            **elsewhere)
        self.assertEqual(code, 0, output)
        parameters = subprocess.check_output(["roslaunch", "--dump-params", "ddm_launch", "experiment.launch",
                                              "plant:=../my_plant.yaml", "runs:=run"], cwd=self.file("elsewhere"),
                                             stderr=subprocess.DEVNULL)
        blocks = yaml.safe_load(yaml.safe_load(parameters)["/configuration"])
        self.assertEqual(blocks["plant"]["model"], self.file("swing.urdf"))

    def test_an_mjcf_file_with_two_motors_is_seen_from_above(self):
        plant, _ = self.make("table.xml", TABLE)
        self.assertEqual((plant["motors"], plant["max_torque"]), ([], [0.3, 0.2]))
        self.assertEqual(plant["camera_position"][:2], plant["camera_look_at"][:2])
        self.assertEqual(self.simulate("first_nm,second_nm", "0.3,0")[0][2:4], ["first_rad", "second_rad"])

    def test_an_effort_limit_of_zero_is_estimated_and_asked_for(self):
        plant, output = self.make("swing.urdf", swing(0.0))
        self.assertGreater(plant["max_torque"][0], 0.5 * 9.81 * 0.2)  # lifts the rod
        self.assertIn("plant/max_torque", output)
        with open(self.file("my_plant.yaml")) as stream:
            self.assertRegex(stream.read(), r"SET: [^\n]*(\n *#[^\n]*)*\n  max_torque: ")
        plant, output = self.make("swing.urdf", swing(0.0), "--max-torque", "0.7", "--force")
        self.assertEqual(plant["max_torque"], [0.7])

    def test_motors_that_the_file_does_not_say_have_to_be_named(self):
        self.write("arm.urdf", arm())
        self.assertRefused(1, ["--motors", "shoulder,elbow"], "arm.urdf", "--out", "my_plant.yaml")
        self.assertRefused(1, ["elbo", "elbow?"], "arm.urdf", "--out", "my_plant.yaml", "--motors", "elbo")
        plant, _ = self.make("arm.urdf", arm(), "--motors", "elbow", "--max-torque", "1.5")
        self.assertEqual((plant["motors"], plant["max_torque"]), (["elbow"], [1.5]))

    def test_nothing_is_replaced_unless_asked_for(self):
        self.make("swing.urdf", swing())
        os.remove(self.file("my_plant.yaml"))
        self.assertRefused(2, ["my_plant.png", "--force"], "swing.urdf", "--out", "my_plant.yaml")
        self.make("swing.urdf", swing(), "--force")

    def test_bad_options_and_models_are_refused_by_name(self):
        self.write("swing.urdf", swing())
        self.write("ball.xml", "<mujoco><worldbody><body><joint name='b' type='ball'/><geom size='.1'/></body>"
                               "</worldbody></mujoco>")
        self.write("bare.urdf", swing().replace(SHAPE, ""))
        out = ["--out", "my_plant.yaml"]
        for code, words, arguments in (
                (2, ["model file"], out), (2, ["--out"], ["swing.urdf"]), (2, ["plant.yml"], ["swing.urdf", "--out", "plant.yml"]),
                (2, ["--max-torque", "weak"], ["swing.urdf", "--max-torque", "weak"] + out),
                (2, ["nowhere"], ["swing.urdf", "--out", "nowhere/my_plant.yaml"]),
                (1, ["swong.urdf", "swing.urdf?"], ["swong.urdf"] + out), (1, ["ball"], ["ball.xml"] + out),
                (1, ["no shape", "visual"], ["bare.urdf"] + out),
                (1, ["max_torque", "2"], ["swing.urdf", "--max-torque", "1,2"] + out)):
            self.assertRefused(code, words, *arguments)
        code, output = self.newPlant("--help")
        self.assertEqual(code, 0, output)
        for word in ("--motors", "--max-torque", "--force", "--out"):
            self.assertIn(word, output)
