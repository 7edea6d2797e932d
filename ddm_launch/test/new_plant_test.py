# new_plant: its plant file works in every program and from every folder, and unsuitable model files are refused.
# SPDX-License-Identifier: BSD-3-Clause
import os
import struct
import subprocess

import pytest
import yaml

from processes import find_program, has_mujoco, output_of
from run_files import read_rows, read_yaml

pytestmark = pytest.mark.skipif(not has_mujoco(), reason="ddm_sim was built without MuJoCo")

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


class Maker:
    """Calls new_plant in a folder."""

    def __init__(self, folder):
        self.folder, self.elsewhere, self.plant = folder, folder / "elsewhere", folder / "my_plant.yaml"
        self.elsewhere.mkdir()

    def call(self, *arguments, **expected):
        return output_of([find_program("new_plant", "ddm_sim"), *arguments], folder=str(self.folder), **expected)

    def make(self, model, text, *options):
        """Returns (block `plant` of the plant file, output)."""
        (self.folder / model).write_text(text)
        output = self.call(model, "--out", "my_plant.yaml", *options)
        return read_yaml(self.plant)["plant"], output

    def simulate(self, header, row):
        """Returns the rows of a trajectory that is simulated in another folder."""
        (self.folder / "torques.csv").write_text("%s\n%s\n%s\n" % (header, row, row))
        with open(self.folder / "torques.csv") as torques:
            text = subprocess.check_output([find_program("simulate", "ddm_sim"), "--plant", "../my_plant.yaml"],
                                           stdin=torques, cwd=self.elsewhere, universal_newlines=True)
        return [line.split(",") for line in text.splitlines()]

    def assert_refused(self, code, words, *arguments):
        self.call(*arguments, code=code, words=words)
        assert not self.plant.exists() and not [name for name in os.listdir(self.folder) if "unfinished" in name]


@pytest.fixture(name="maker")
def make_maker(tmp_path):
    return Maker(tmp_path)


def test_a_urdf_with_one_motor_becomes_a_plant_that_learns_from_any_folder(maker):
    plant, output = maker.make("swing.urdf", swing())
    assert (plant["model"], plant["motors"], plant["max_torque"]) == ("swing.urdf", ["pivot"], [2])
    for word in ("pivot", "hinge", "effort limit 2 N m", "plant/goal", "plant/tolerance", "run_experiment", "my_plant.png",
                 "stable"):
        assert word in output
    assert maker.plant.read_text().count("SET: ") == 2
    assert min(struct.unpack(">II", (maker.folder / "my_plant.png").read_bytes()[16:24])) > 800
    assert maker.simulate("pivot_nm", "2")[0] == ["step", "time_s", "pivot_rad", "pivot_rad_per_s"]

    debug, folder = ["--preset", "debug", "--plant", "../my_plant.yaml"], str(maker.elsewhere)
    for command in (["run_experiment", "--trials", 0, "--out", "run", *debug],
                    ["run_experiment", "--config", "run/config.yaml", "--out", "again"],
                    ["evaluate", "--model", "run/trial_000/model.ddm", "--seeds", "0:1", *debug],
                    ["sweep", "--seeds", "0:1", "--trials", 0, "--out", "sweep", *debug]):
        output_of([find_program(command[0]), *command[1:]], folder=folder)
    saved = read_yaml(folder, "run", "config.yaml")
    model = str(maker.folder / "swing.urdf")
    assert (saved["plant"]["model"], saved["experiment"]["plant"]) == (model, str(maker.plant))
    assert read_rows(folder, "again", "trial_000", "torques.csv") == read_rows(folder, "run", "trial_000", "torques.csv")
    parameters = subprocess.check_output(["roslaunch", "--dump-params", "ddm_launch", "experiment.launch",
                                          "plant:=../my_plant.yaml", "runs:=run"], cwd=folder, stderr=subprocess.DEVNULL)
    assert yaml.safe_load(yaml.safe_load(parameters)["/configuration"])["plant"]["model"] == model


def test_an_mjcf_file_with_two_motors_is_seen_from_above(maker):
    plant, _ = maker.make("table.xml", TABLE)
    assert (plant["motors"], plant["max_torque"]) == ([], [0.3, 0.2])
    assert plant["camera_position"][:2] == plant["camera_look_at"][:2]
    assert maker.simulate("first_nm,second_nm", "0.3,0")[0][2:4] == ["first_rad", "second_rad"]


def test_effort_limits_and_motors_that_the_file_does_not_give_are_estimated_or_asked_for(maker):
    plant, output = maker.make("swing.urdf", swing(0.0))
    assert plant["max_torque"][0] > 0.5 * 9.81 * 0.2  # enough to lift the rod
    assert "plant/max_torque" in output and "SET: " in maker.plant.read_text().partition("max_torque: ")[0]
    plant, output = maker.make("swing.urdf", swing(0.0), "--max-torque", "0.7", "--force")
    assert plant["max_torque"] == [0.7]
    plant, _ = maker.make("swing.urdf", swing().replace('effort="2"', 'effort="1.23456789"'), "--force")
    assert plant["max_torque"] == [1.234568]  # slightly above the file's limit
    os.remove(maker.plant)
    # existing files are not replaced
    maker.assert_refused(2, ["my_plant.png", "--force"], "swing.urdf", "--out", "my_plant.yaml")
    (maker.folder / "arm.urdf").write_text(arm())
    maker.assert_refused(1, ["--motors", "shoulder,elbow"], "arm.urdf", "--out", "my_plant.yaml", "--force")
    maker.assert_refused(1, ["elbo", "elbow?"], "arm.urdf", "--out", "my_plant.yaml", "--motors", "elbo", "--force")
    plant, _ = maker.make("arm.urdf", arm(), "--motors", "elbow", "--max-torque", "1.5", "--force")
    assert (plant["motors"], plant["max_torque"]) == (["elbow"], [1.5])


def test_bad_options_and_models_are_refused_by_name(maker):
    (maker.folder / "swing.urdf").write_text(swing())
    (maker.folder / "ball.xml").write_text("<mujoco><worldbody><body><joint name='b' type='ball'/><geom size='.1'/></body>"
                                           "</worldbody></mujoco>")
    (maker.folder / "bare.urdf").write_text(swing().replace(SHAPE, ""))
    out = ["--out", "my_plant.yaml"]
    for code, words, arguments in (
            (2, ["model file"], out), (2, ["--out"], ["swing.urdf"]), (2, ["plant.yml"], ["swing.urdf", "--out", "plant.yml"]),
            (2, ["--max-torque", "weak"], ["swing.urdf", "--max-torque", "weak"] + out),
            (2, ["nowhere"], ["swing.urdf", "--out", "nowhere/my_plant.yaml"]),
            (1, ["swong.urdf", "swing.urdf?"], ["swong.urdf"] + out), (1, ["ball"], ["ball.xml"] + out),
            (1, ["no shape", "visual"], ["bare.urdf"] + out),
            (1, ["max_torque", "2"], ["swing.urdf", "--max-torque", "1,2"] + out)):
        maker.assert_refused(code, words, *arguments)
