# demo.sh, test.sh and workspace.sh: their error messages, and that they repeat no work.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import shlex
import socket
import subprocess

import pytest

from rooms import CHECKOUT

SCRIPTS = os.path.join(CHECKOUT, "ddm_launch", "scripts")


class Shell:
    """Calls scripts with a new folder as the workspace."""

    def __init__(self, folder):
        self.folder, self.workspace = folder, str(folder / "ws")

    def call(self, *command):
        """Returns (exit code, stdout and stderr)."""
        done = subprocess.run(command, env=dict(os.environ, DDM_WS=self.workspace), stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        return done.returncode, done.stdout

    def run(self, code, script="workspace.sh"):
        """Sources a script and runs bash code with the strict options of the scripts."""
        path = shlex.quote(os.path.join(SCRIPTS, script))
        return self.call("/bin/bash", "-c", "set -euo pipefail; . %s; %s" % (path, code))

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return str(path)


@pytest.fixture(name="shell")
def make(tmp_path):
    return Shell(tmp_path)


def test_debian_11_12_and_13_are_tested_systems_and_others_are_warned(shell):
    for version in ("11", "12", "13"):
        release = shell.write("os-release", 'ID=debian\nVERSION_ID="%s"\nPRETTY_NAME="Debian %s"\n' % (version, version))
        assert shell.run("check_system " + release) == (0, "System: Debian %s\n" % version)
    for text in ("ID=debian\nPRETTY_NAME=It\n", 'ID=debian\nVERSION_ID="130"\nPRETTY_NAME="It"\n',
                 'ID=ubuntu\nVERSION_ID="12"\nPRETTY_NAME="It"\n'):
        code, output = shell.run("check_system " + shell.write("os-release", text))
        assert code == 0 and all(words in output for words in ("WARNING: this is It", "Debian 11, 12 and 13", "docker run"))
    assert "an unknown system" in shell.run("check_system /no/such/file")[1]


def test_a_ros_of_opt_ros_is_sourced_and_its_packages_come_by_rosdep(shell):
    shell.write("opt/noetic/setup.bash", "export ROS_DISTRO=noetic PYTHONPATH=/opt/ros/noetic/lib ARGUMENTS=$#$UNSET\n")
    noetic, none = "opt_ros=" + str(shell.folder / "opt"), "opt_ros=/nonexistent"
    assert shell.run("export ROS_DISTRO=mine PYTHONPATH=/mine; %s; use_system_environment with words; "
                     "echo $ROS_DISTRO $PYTHONPATH $ARGUMENTS" % noetic) == (0, "noetic /opt/ros/noetic/lib 0\n")
    assert shell.run("export ROS_DISTRO=mine; %s; use_system_environment; echo ${ROS_DISTRO-none}" % none) == (0, "none\n")
    rosdep = "rosdep() { echo rosdep \"$@\"; }; %s; use_system_environment; install_by_rosdep"
    code, output = shell.run(rosdep % noetic)
    assert code == 0 and "WARNING" not in output
    assert "rosdep install --from-paths %s --ignore-src --rosdistro noetic" % CHECKOUT in output
    assert shell.run(rosdep % none) == (0, "")


def test_packages_that_are_missing_are_installed_and_optional_ones_that_do_not_exist_are_left_out(shell):
    called = "as_root() { echo CALLED \"$@\"; }; "
    assert shell.run(called + "install_packages bash coreutils") == (0, "Packages: all 2 installed\n")
    code, output = shell.run(called + "install_packages bash no-such-package coreutils")
    assert "install -y --no-install-recommends no-such-package\n" in output
    stubs = ("missing_packages() { printf '%%s\\n' \"$@\"; }; as_root() { echo \"CALLED $*\"; }; "
             "optional_packages=(libmujoco-dev xvfb); apt-cache() { [[ $2 == %s ]]; }; ")
    code, output = shell.run(stubs % "xvfb" + "install_packages cmake libmujoco-dev xvfb")
    first, second = [line.partition("apt-get")[2] for line in output.splitlines() if line.startswith("CALLED")]
    assert code == 0 and "left out: libmujoco-dev" in output
    assert re.search("update.*install .* cmake$", first) and re.search("^((?!update).)*install .* xvfb$", second)
    code, output = shell.run("id() { echo 1000; }; missing_packages() { echo cmake; }; "
                             "command() { [[ $2 == apt-get ]]; }; install_packages cmake")
    assert code == 1 and "sudo" in output and "install -y --no-install-recommends cmake" in output


def test_nodes_keep_to_this_machine_or_image_unless_the_caller_names_a_master_or_an_address(shell):
    for told, address in (("ROS_IP= ROS_HOSTNAME=", "127.0.0.1"), ("ROS_IP=10.0.0.2 ROS_HOSTNAME=", "10.0.0.2"),
                          ("ROS_IP= ROS_HOSTNAME=robot", "")):
        assert shell.run("export %s; use_system_environment; printf %%s \"$ROS_IP\"" % told) == (0, address)
    with open(os.path.join(CHECKOUT, "Dockerfile")) as stream:
        entry = re.search(r'ENTRYPOINT \["bash", "/ddm/(.*)"\]', stream.read()).group(1)
    os.chmod(shell.write("ws/devel/env.sh", '#!/bin/sh\necho "${ROS_MASTER_URI-}" "${ROS_IP-}" "${ROS_HOSTNAME-}" "$@"\n'), 0o755)
    robot = "http://10.0.0.1:11311"
    for given, printed in (([], " 127.0.0.1  a 'b c'"), (["ROS_IP=10.0.0.2"], " 10.0.0.2  a 'b c'"),
                           (["ROS_HOSTNAME=pc"], "  pc a 'b c'"), (["ROS_MASTER_URI=" + robot], robot + "   a 'b c'")):
        command = ["/usr/bin/env", "-u", "ROS_MASTER_URI", "-u", "ROS_IP", "-u", "ROS_HOSTNAME", *given, "/bin/bash",
                   os.path.join(CHECKOUT, entry), "a", "'b c'"]
        assert shell.call(*command) == (0, printed + "\n")


def test_the_workspace_links_this_checkout_and_nothing_else_may_be_in_its_place(shell):
    link = os.path.join(shell.workspace, "src", "ddm")
    for _ in range(2):
        assert shell.run("make_workspace") == (0, "")
        assert os.path.realpath(link) == CHECKOUT
    for code, words in (("ln -sfn /no/other/checkout $DDM_WS/src/ddm", "/no/other/checkout"),
                        ("rm $DDM_WS/src/ddm; mkdir $DDM_WS/src/ddm", link), ("DDM_WS=$checkout/ws", CHECKOUT),
                        ("DDM_WS='/tmp/my ws'", "/tmp/my ws")):
        code, output = shell.run(code + "; make_workspace")
        assert code == 1 and words in output


def test_bad_arguments_are_refused_and_help_is_printed_before_anything_is_done(shell):
    demo, test = (os.path.join(SCRIPTS, name) for name in ("demo.sh", "test.sh"))
    for script, code, words, arguments in (
            (demo, 2, "--nonsense", ["--nonsense"]), (test, 2, "--nonsense", ["--nonsense"]),
            (demo, 2, "--trials", ["--trials", "0"]), (demo, 2, "DISPLAY", ["--rviz"]), (test, 2, "--fuzz", ["--fuzz"]),
            (demo, 0, "usage: bash demo.sh", ["--help"]), (test, 0, "usage: bash test.sh", ["--help"])):
        actual, output = shell.call("/usr/bin/env", "-u", "DISPLAY", "/bin/bash", script, *arguments)
        assert actual == code and words in output, output
        assert not os.path.exists(shell.workspace)


def test_another_port_is_taken_when_the_masters_port_is_in_use(shell):
    with socket.socket() as holder:
        try:
            # the port of a finished master may still be in TIME_WAIT
            holder.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            holder.bind(("", 11311))
            holder.listen(1)
        except OSError:
            pass  # another master uses the port, which serves as well
        code, output = shell.run("free_master_port")
    assert code == 0 and int(output) != 11311


def test_only_the_summary_of_this_call_tells_whether_enough_trials_are_finished(shell):
    for text, code in (("finished: true\ntrials: 15\nsuccess: [0, 1]\n", 0), ("finished: true\ntrials: 14\n", 1),
                       ("finished: true\n", 1), ("finished: false\ntrials: 15\n", 1), ("no map", 1)):
        folder = os.path.dirname(shell.write("run/summary.yaml", text))
        actual, output = shell.run("check_summary %s 15 ''" % folder, "demo.sh")
        assert actual == code and ("summary.yaml" in output) == (code == 1), output
    summary = shell.write("run/summary.yaml", "finished: true\ntrials: 15\n")
    for launch, code in (("echo refused", 1), ("rm %s" % summary, 1), ("echo 'finished: true\ntrials: 15' > %s" % summary, 0),
                         ("touch %s" % summary, 0)):
        actual, output = shell.run("roslaunch() { %s; }; runs=%s trials=15 rviz=false; run_experiment" % (launch, folder), "demo.sh")
        assert actual == code, (launch, output)
