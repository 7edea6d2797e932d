# demo.sh, test.sh, what they share, and fresh_root.sh: what they refuse, with which words, and that they do nothing twice.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import shlex
import shutil
import socket
import subprocess

from scratch_case import ScratchCase

SCRIPTS = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scripts"))
CHECKOUT = os.path.dirname(os.path.dirname(SCRIPTS))


class ScriptsTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.workspace = self.file("ws")

    def call(self, *command):
        """Returns (exit code, stdout and stderr)."""
        environment = dict(os.environ, DDM_WS=self.workspace)
        done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True)
        return done.returncode, done.stdout

    def callFunction(self, code, script="workspace.sh"):
        """Runs bash code after sourcing a script, as strictly as the scripts run themselves."""
        path = shlex.quote(os.path.join(SCRIPTS, script))
        return self.call("/bin/bash", "-c", "set -euo pipefail; . %s; %s" % (path, code))

    def release(self, text):
        return self.write("os-release", text)

    def noetic(self):
        """A folder like /opt/ros where Noetic is, as a word of bash that says so to the scripts."""
        self.write("opt/noetic/setup.bash", "export ROS_DISTRO=noetic PYTHONPATH=/opt/ros/noetic/lib ARGUMENTS=$#$UNSET\n")
        return "opt_ros=" + self.file("opt")

    def test_debian_11_12_and_13_are_tested_systems(self):
        for version in ("11", "12", "13"):
            release = self.release('ID=debian\nVERSION_ID="%s"\nPRETTY_NAME="Debian %s"\n' % (version, version))
            self.assertEqual(self.callFunction("check_system " + release), (0, "System: Debian %s\n" % version))

    def test_another_system_is_warned_and_goes_on(self):
        for text in ("ID=debian\nPRETTY_NAME=It\n", 'ID=debian\nVERSION_ID="130"\nPRETTY_NAME="It"\n',
                     'ID=ubuntu\nVERSION_ID="12"\nPRETTY_NAME="It"\n'):
            code, output = self.callFunction("check_system " + self.release(text))
            self.assertEqual(code, 0)
            for words in ("WARNING: this is It", "not here", "Debian 11, 12 and 13", "doc/install.md", "docker run"):
                self.assertIn(words, output)
        self.assertIn("an unknown system", self.callFunction("check_system /no/such/file")[1])

    def test_a_ros_of_opt_ros_is_sourced_instead_of_the_environment_of_the_caller(self):
        code, output = self.callFunction("export ROS_DISTRO=mine PYTHONPATH=/mine; %s; use_system_environment with words; "
                                         "echo $ROS_DISTRO $PYTHONPATH $ARGUMENTS" % self.noetic())
        self.assertEqual((code, output), (0, "noetic /opt/ros/noetic/lib 0\n"))
        code, output = self.callFunction("export ROS_DISTRO=mine; opt_ros=/nonexistent; use_system_environment; "
                                         "echo ${ROS_DISTRO-none}")
        self.assertEqual((code, output), (0, "none\n"))

    def test_rosdep_installs_what_package_xml_lists_where_ros_is_not_debians(self):
        rosdep = "rosdep() { echo rosdep \"$@\"; %s; }; %s; use_system_environment; install_by_rosdep"
        code, output = self.callFunction(rosdep % ("true", self.noetic()))
        self.assertEqual(code, 0)
        self.assertIn("rosdep install --from-paths %s --ignore-src --rosdistro noetic" % CHECKOUT, output)
        self.assertNotIn("WARNING", output)
        self.assertEqual(self.callFunction(rosdep % ("true", "opt_ros=/nonexistent")), (0, ""))

    def test_optional_packages_that_the_system_does_not_have_are_named_and_left_out(self):
        stubs = ("missing_packages() { printf '%%s\\n' \"$@\"; }; as_root() { echo \"CALLED $*\"; }; "
                 "optional_packages=(libmujoco-dev xvfb); apt-cache() { [[ $2 == %s ]]; }; ")
        code, output = self.callFunction(stubs % "xvfb" + "install_packages cmake libmujoco-dev xvfb")
        self.assertEqual(code, 0)
        called = [line.partition("apt-get")[2] for line in output.splitlines() if line.startswith("CALLED")]
        self.assertEqual(len(called), 2)
        self.assertRegex(called[0], "update.*install .* cmake$")
        self.assertRegex(called[1], "^((?!update).)*install .* xvfb$")
        self.assertIn("left out: libmujoco-dev", output)
        # nothing but those is missing: neither root nor network is asked for
        code, output = self.callFunction(stubs % "none" + "install_packages libmujoco-dev")
        self.assertEqual(code, 0)
        self.assertNotIn("CALLED", output)

    def test_tests_have_the_environment_of_the_workspace_from_the_first_configuration_on(self):
        code, output = self.callFunction("use_system_environment; make_workspace; rm $DDM_WS/src/ddm; build_release help")
        self.assertEqual(code, 0, output)
        self.assertEqual(output.count("Running command: \"cmake "), 1)
        with open(os.path.join(self.workspace, "build", "catkin_generated", "setup_cached.sh")) as stream:
            environment = stream.read()
        for name, folder in (("PYTHONPATH", "lib/python3/dist-packages"), ("LD_LIBRARY_PATH", "lib")):
            self.assertRegex(environment, "export %s='[^']*%s" % (name, os.path.join(self.workspace, "devel", folder)))

    def test_only_packages_that_are_not_installed_are_installed(self):
        stubs = "as_root() { echo CALLED \"$@\"; }; "
        code, output = self.callFunction(stubs + "install_packages bash coreutils")
        self.assertEqual((code, output), (0, "Packages: all 2 installed\n"))
        code, output = self.callFunction(stubs + "install_packages bash no-such-package coreutils")
        self.assertIn("install -y --no-install-recommends no-such-package\n", output)

    def test_missing_packages_without_root_or_sudo_are_named(self):
        code, output = self.callFunction("id() { echo 1000; }; missing_packages() { echo cmake; }; command() { [[ $2 == apt-get ]]; }; "
                                         "install_packages cmake")
        self.assertEqual(code, 1)
        self.assertIn("sudo", output)
        self.assertIn("install -y --no-install-recommends cmake", output)

    def test_the_guard_against_services_passes_on_the_verdict(self):
        policy = self.file("policy-rc.d")
        packages = "test.sh"
        guarded = "export POLICY_RC_D=%s; \"${around_apt[@]}\" " % policy
        self.assertEqual(self.callFunction(guarded + 'sh -c "$POLICY_RC_D; exit 3"', packages)[0], 3)
        self.assertEqual(self.callFunction(guarded + 'sh -c "$POLICY_RC_D; echo policy says \\$?"', packages),
                         (0, "policy says 101\n"))
        self.assertFalse(os.path.exists(policy))

    def test_nodes_keep_to_this_machine_unless_the_caller_names_an_address(self):
        for told, address in (("ROS_IP= ROS_HOSTNAME=", "127.0.0.1"), ("ROS_IP=10.0.0.2 ROS_HOSTNAME=", "10.0.0.2"),
                              ("ROS_IP= ROS_HOSTNAME=robot", "")):
            self.assertEqual(self.callFunction("export %s; use_system_environment; printf %%s \"$ROS_IP\"" % told),
                             (0, address))

    def test_the_image_keeps_nodes_to_itself_unless_the_caller_names_a_master_or_an_address(self):
        with open(os.path.join(CHECKOUT, "Dockerfile")) as stream:
            dockerfile = stream.read()
        self.assertNotIn("ROS_IP", dockerfile)
        entry = re.search(r'ENTRYPOINT \["bash", "/ddm/(.*)"\]', dockerfile).group(1)
        os.chmod(self.write("ws/devel/env.sh", '#!/bin/sh\necho "${ROS_MASTER_URI-}" "${ROS_IP-}" "${ROS_HOSTNAME-}" "$@"\n'), 0o755)
        clean = ["/usr/bin/env", "-u", "ROS_MASTER_URI", "-u", "ROS_IP", "-u", "ROS_HOSTNAME"]
        robot = "http://10.0.0.1:11311"
        for given, printed in (([], " 127.0.0.1  a 'b c'"), (["ROS_IP=10.0.0.2"], " 10.0.0.2  a 'b c'"),
                               (["ROS_HOSTNAME=pc"], "  pc a 'b c'"), (["ROS_MASTER_URI=" + robot], robot + "   a 'b c'"),
                               (["ROS_MASTER_URI=" + robot, "ROS_IP=10.0.0.2"], robot + " 10.0.0.2  a 'b c'")):
            command = clean + given + ["/bin/bash", os.path.join(CHECKOUT, entry), "a", "'b c'"]
            self.assertEqual(self.call(*command), (0, printed + "\n"))

    def test_a_name_for_localhost_is_added_only_where_there_is_none(self):
        for known, added in (("true", False), ("false", True)):
            code, output = self.callFunction("as_root() { echo CALLED \"$@\"; }; getent() { %s; }; ensure_localhost_resolves"
                                             % known)
            self.assertEqual((code, "/etc/hosts" in output), (0, added))

    def test_the_workspace_links_this_checkout_and_may_exist(self):
        for _ in range(2):
            self.assertEqual(self.callFunction("make_workspace"), (0, ""))
            self.assertEqual(os.path.realpath(os.path.join(self.workspace, "src", "ddm")), CHECKOUT)

    def test_another_checkout_or_folder_in_the_place_of_the_link_is_refused(self):
        os.makedirs(os.path.join(self.workspace, "src"))
        link = os.path.join(self.workspace, "src", "ddm")
        os.symlink("/no/other/checkout", link)
        for code, words in (("make_workspace", "/no/other/checkout"), ("rm $DDM_WS/src/ddm; mkdir $DDM_WS/src/ddm; make_workspace", link)):
            code, output = self.callFunction(code)
            self.assertEqual(code, 1)
            self.assertIn(words, output)

    def test_a_workspace_inside_the_checkout_or_with_a_space_in_its_path_is_refused(self):
        for place, words in (("$checkout/ws", CHECKOUT), ("'/tmp/my ws'", "/tmp/my ws")):
            code, output = self.callFunction("DDM_WS=%s; make_workspace" % place)
            self.assertEqual(code, 1)
            self.assertIn(words, output)

    def test_bad_arguments_are_refused_and_help_is_printed_before_anything_is_done(self):
        demo, test = (os.path.join(SCRIPTS, name) for name in ("demo.sh", "test.sh"))
        fresh_root = os.path.join(CHECKOUT, "ddm_launch", "qa", "fresh_root.sh")
        for script, code, words, arguments in (
                (demo, 2, "--nonsense", ["--nonsense"]), (test, 2, "--nonsense", ["--nonsense"]),
                (demo, 2, "--trials", ["--trials", "0"]), (demo, 2, "DISPLAY", ["--rviz"]),
                (fresh_root, 2, "'sid'", ["sid"]), (fresh_root, 2, "'--nonsense'", ["trixie", "demo", "--nonsense"]),
                (demo, 0, "usage: bash demo.sh", ["--help"]), (test, 0, "usage: bash test.sh", ["--help"]),
                (fresh_root, 0, "usage: bash fresh_root.sh", ["--help"])):
            actual, output = self.call("/usr/bin/env", "-u", "DISPLAY", "TMPDIR=" + self.scratch, "/bin/bash", script, *arguments)
            self.assertEqual(actual, code, output)
            self.assertIn(words, output)
            self.assertEqual(os.listdir(self.scratch), [])

    def test_another_port_is_taken_when_the_masters_port_is_in_use(self):
        with socket.socket() as holder:
            try:
                holder.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # a master that has ended leaves it waiting
                holder.bind(("", 11311))
                holder.listen(1)
            except OSError:
                pass  # somebody's master has it: just as good
            code, output = self.callFunction("free_master_port", "demo.sh")
        self.assertEqual(code, 0)
        self.assertNotEqual(int(output), 11311)
        with socket.socket() as probe:
            probe.bind(("", int(output)))

    def test_the_build_uses_avx2_unless_told_otherwise(self):
        printed = "; DDM_WS=%s; catkin_make() { printf '%%s\\n' \"$@\"; }; grep() { true; }; build_release" % self.workspace
        for told, flag in (("unset DDM_AVX2", "-DDDM_AVX2=ON"), ("DDM_AVX2=OFF", "-DDDM_AVX2=OFF")):
            code, output = self.callFunction(told + printed)
            self.assertEqual(code, 0)
            self.assertIn(flag, output.splitlines())

    def runExperiment(self, launch):
        """Runs the experiment of demo.sh with bash code instead of roslaunch."""
        return self.callFunction("roslaunch() { %s; }; runs=%s trials=15 rviz=false; run_experiment"
                                 % (launch, shlex.quote(self.scratch)), "demo.sh")

    def test_the_summary_of_an_earlier_call_is_no_success(self):
        summary = self.write("summary.yaml", "finished: true\ntrials: 15\n")
        for launch in ("echo refused", "rm %s" % summary):
            code, output = self.runExperiment(launch)
            self.assertEqual(code, 1, output)
            self.assertIn("summary.yaml", output)

    def test_the_summary_tells_whether_enough_trials_are_finished(self):
        for text, code in (("finished: true\ntrials: 15\nsuccess: [0, 1]\n", 0), ("finished: true\ntrials: 20\n", 0),
                           ("finished: true\ntrials: 14\n", 1), ("finished: true\n", 1), ("finished: false\ntrials: 15\n", 1),
                           ("no map", 1), (None, 1)):
            shutil.rmtree(self.file("run"), ignore_errors=True)
            if text is not None:
                self.write("run/summary.yaml", text)
            actual, output = self.callFunction("check_summary %s 15 ''" % self.file("run"), "demo.sh")
            self.assertEqual(actual, code, output)
            self.assertEqual("summary.yaml" in output, code == 1)

    def test_a_call_that_finds_everything_finished_is_a_success(self):
        summary = self.write("summary.yaml", "finished: true\ntrials: 15\n")
        for launch in ("touch %s" % summary, "cp {0} {0}.new && mv {0}.new {0}".format(summary)):
            code, output = self.runExperiment(launch)
            self.assertEqual(code, 0, output)
