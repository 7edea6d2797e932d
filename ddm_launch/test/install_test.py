# The install space is complete: it works after sources, build space and devel space have been hidden.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re

import pytest

from namespaces import hiding, why_not
from processes import free_port, has_mujoco, output_of
from rooms import CHECKOUT
from run_files import differences, expected_files, files_in, torque_files

PACKAGES = ["ddm_launch", "ddm_model", "ddm_mpc", "ddm_msgs", "ddm_sim"]
BUILD = os.environ["DDM_BUILD"]
TRIALS = 1
LEFT_OUT = ["benchmark_kernels"]  # a program of qa


def cached(name):
    """A value of the build's CMakeCache.txt; empty if the file has no such value."""
    with open(os.path.join(BUILD, "CMakeCache.txt")) as stream:
        found = re.search(r"^%s:\w+=(.*)$" % name, stream.read(), re.MULTILINE)
    return found.group(1) if found else ""


HINDRANCE = why_not("mount") if cached("ddm_msgs_BINARY_DIR") else "each package has a build folder of its own"
DEVEL = cached("CATKIN_DEVEL_PREFIX")
GONE = sorted({CHECKOUT, os.path.realpath(cached("CMAKE_HOME_DIRECTORY")), BUILD, DEVEL})
pytestmark = pytest.mark.skipif(bool(HINDRANCE), reason="THE INSTALL SPACE IS NOT TESTED: %s" % HINDRANCE)


def programs_in(folder):
    """Names of the programs in lib/PACKAGE of a space, without tests."""
    names = os.listdir(folder) if os.path.isdir(folder) else []
    return sorted(name for name in names if os.access(os.path.join(folder, name), os.X_OK)
                  and not re.search("_test$|_test_", name))


@pytest.fixture(name="prefix", scope="module")
def install(tmp_path_factory):
    scratch = str(tmp_path_factory.mktemp("installed"))
    output_of(["cmake", "--install", BUILD], environment=dict(os.environ, DESTDIR=scratch))
    return os.path.join(scratch, cached("CMAKE_INSTALL_PREFIX").lstrip("/"))


def run_installed(prefix, folder, *command):
    """Returns the output of a command after sourcing install/setup.bash in a new terminal."""
    terminal = {"PATH": "/usr/bin:/bin:/usr/sbin:/sbin", "HOME": folder, "ROS_HOME": folder + "/ros", "ROS_HOSTNAME": "localhost",
                "PYTHONUNBUFFERED": "1"}
    # A function without arguments sources setup.bash, which would otherwise parse the words of the command.
    source = "open_terminal() { . %s/setup.bash; }; open_terminal && exec \"$@\"" % prefix
    output = output_of(hiding(GONE) + ["bash", "-c", source, "bash"] + [str(word) for word in command],
                       environment=terminal, folder=folder)
    return output


def test_everything_but_qa_and_study_is_installed_and_names_no_other_folder(prefix):
    for package in PACKAGES:
        built = programs_in(os.path.join(DEVEL, "lib", package))
        installed = programs_in(os.path.join(prefix, "lib", package))
        assert installed == [name for name in built if name not in LEFT_OUT], package
        for path in files_in(os.path.join(CHECKOUT, package)):
            header = re.match(r"(?:\w+/)?include/(.*\.h)$", path)
            if header and "/testing/" not in path and (has_mujoco() or not path.startswith("mujoco/")):
                assert os.path.isfile(os.path.join(prefix, "include", header.group(1))), path
            if re.match(r"(config|launch|rviz)/.*\.(launch|yaml|rviz)$", path):
                assert os.path.isfile(os.path.join(prefix, "share", package, path)), path
    assert not {"qa", "fault_table", "study", "prediction_experiment"} & set(programs_in(os.path.join(prefix, "lib", "ddm_launch")))
    for path in files_in(prefix):
        if path.endswith(("Config.cmake", "_setup_util.py")):
            continue  # files of catkin, which name all workspaces that were sourced at configuration
        with open(os.path.join(prefix, path), "rb") as stream:
            content = stream.read()
        if b"\0" not in content[:4096]:  # messages in a program may contain the path of its source
            for folder in GONE:
                assert not re.search(re.escape(folder).encode() + rb"(?![\w.-])", content), (path, folder)


def test_an_experiment_runs_in_one_process_and_with_the_nodes(prefix, tmp_path):
    process, nodes, scratch = str(tmp_path / "process"), str(tmp_path / "nodes"), str(tmp_path)
    for folder in GONE:
        assert os.listdir(folder) and run_installed(prefix, scratch, "ls", "-A", folder) == ""
    run_installed(prefix, scratch, "rosrun", "ddm_launch", "run_experiment", "--preset", "debug", "--seed", 1, "--trials", TRIALS,
                  "--out", process)
    output = run_installed(prefix, scratch, "roslaunch", "-p", free_port(), "ddm_launch", "experiment.launch", "preset:=debug",
                           "seed:=1", "trials:=%d" % TRIALS, "runs:=" + nodes)
    for folder in (process, nodes):
        assert files_in(folder) == expected_files(TRIALS), output
    assert differences(process, nodes, torque_files(TRIALS)) == []


@pytest.mark.skipif(not glob.glob(os.path.join(DEVEL, "lib", "python3*", "*-packages", "ddm_model", "_core*.so")),
                    reason="the build is without Python bindings")
def test_python_trains_and_acts(prefix, tmp_path):
    script = ("import ddm_model, ddm_mpc, ddm_sim, numpy\n"
              "env = ddm_sim.make('pendulum')\n"
              "images, torques = numpy.array([env.reset()[0]] + [env.step([k % 5 - 2.0])[0] for k in range(29)]), numpy.ones((30, 1))\n"
              "model = ddm_model.train([(images, torques)], images[0], preset='debug', plant=env)\n"
              "print('torque', ddm_mpc.Controller(model, preset='debug', plant='pendulum').act(images[1]))")
    assert "torque [" in run_installed(prefix, str(tmp_path), "/usr/bin/python3", "-c", script)
    folder, = glob.glob(os.path.join(prefix, "lib", "python3*", "*-packages"))
    assert all(os.path.isfile(os.path.join(folder, package, "__init__.pyi")) for package in ("ddm_model", "ddm_mpc", "ddm_sim"))


def test_every_tool_shows_its_help(prefix, tmp_path):
    nodes = set()  # these programs are started only by launch files
    for path in glob.glob(os.path.join(CHECKOUT, "ddm_launch", "**", "*.launch"), recursive=True):
        with open(path) as stream:
            nodes.update(re.findall(r'type="(\w+)"', stream.read()))
    tools = [os.path.join(prefix, "lib", package, name) for package in PACKAGES
             for name in programs_in(os.path.join(prefix, "lib", package)) if name not in nodes]
    assert len(tools) > 8
    script = 'for tool; do "$tool" --help | grep -q "^usage: " || { echo "$tool"; exit 1; }; done'
    run_installed(prefix, str(tmp_path), "bash", "-c", script, "bash", *tools)
