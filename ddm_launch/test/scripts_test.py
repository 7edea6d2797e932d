# demo.sh, test.sh, what they share, and fresh_root.sh: what they refuse, with which words, and that they do nothing twice.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import shlex
import socket
import subprocess

from scratch_case import ScratchCase

SCRIPTS = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scripts"))
CHECKOUT = os.path.dirname(os.path.dirname(SCRIPTS))
FRESH_ROOT = os.path.join(CHECKOUT, "ddm_launch", "qa", "fresh_root.sh")


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
        for text in ('ID=debian\nVERSION_ID="10"\nPRETTY_NAME="It"\n', "ID=debian\nPRETTY_NAME=It\n",
                     'ID=debian\nVERSION_ID="130"\nPRETTY_NAME="It"\n', 'ID=ubuntu\nVERSION_ID="12"\nPRETTY_NAME="It"\n',
                     'ID=ubuntu\nVERSION_ID="20.04"\nPRETTY_NAME="It"\n'):
            code, output = self.callFunction("check_system " + self.release(text))
            self.assertEqual(code, 0)
            for words in ("WARNING: this is It", "not here", "Debian 11, 12 and 13", "doc/install.md", "docker run"):
                self.assertIn(words, output)
        self.assertIn("an unknown system", self.callFunction("check_system /no/such/file")[1])

    def test_debian_with_a_ros_of_opt_ros_is_warned_and_told_which(self):
        release = self.release('ID=debian\nVERSION_ID="12"\nPRETTY_NAME="It"\n')
        code, output = self.callFunction("%s; check_system %s" % (self.noetic(), release))
        self.assertEqual(code, 0)
        self.assertIn("this is It with %s/noetic/setup.bash" % self.file("opt"), output)

    def test_a_ros_of_opt_ros_is_sourced_instead_of_the_environment_of_the_caller(self):
        code, output = self.callFunction("export ROS_DISTRO=mine PYTHONPATH=/mine; %s; use_system_environment with words; "
                                         "echo $ROS_DISTRO $PYTHONPATH $ARGUMENTS" % self.noetic())
        self.assertEqual((code, output), (0, "noetic /opt/ros/noetic/lib 0\n"))
        code, output = self.callFunction("export ROS_DISTRO=mine; opt_ros=/nonexistent; use_system_environment; "
                                         "echo ${ROS_DISTRO-none}")
        self.assertEqual((code, output), (0, "none\n"))

    def test_packages_of_ros_are_those_of_debian_only_where_ros_is(self):
        listed = "%%s; . %s/workspace.sh; printf '%%%%s\\n' \"${packages_to_run[@]}\"" % shlex.quote(SCRIPTS)
        self.assertIn("libroscpp-dev", self.callFunction(listed % "opt_ros=/nonexistent")[1].splitlines())
        code, output = self.callFunction(listed % self.noetic())
        self.assertEqual(code, 0, output)
        self.assertIn("libceres-dev", output.splitlines())
        self.assertEqual([name for name in output.splitlines() if "ros" in name or name == "catkin"], [])

    def test_rosdep_installs_what_package_xml_lists_where_ros_is_not_debians(self):
        rosdep = "rosdep() { echo rosdep \"$@\"; %s; }; %s; use_system_environment; install_by_rosdep"
        code, output = self.callFunction(rosdep % ("true", self.noetic()))
        self.assertEqual(code, 0)
        self.assertIn("rosdep install --from-paths %s --ignore-src --rosdistro noetic" % CHECKOUT, output)
        self.assertNotIn("WARNING", output)
        self.assertEqual(self.callFunction(rosdep % ("true", "opt_ros=/nonexistent")), (0, ""))

    def test_the_scripts_go_on_without_rosdep_and_when_it_fails(self):
        for rosdep in ("rosdep() { false; }", "command() { false; }"):
            code, output = self.callFunction("%s; %s; use_system_environment; install_by_rosdep" % (rosdep, self.noetic()))
            self.assertEqual(code, 0)
            self.assertIn("WARNING: rosdep", output)

    def test_a_system_without_apt_is_told_what_the_build_needs(self):
        code, output = self.callFunction("missing_packages() { echo cmake; }; command() { [[ $2 != apt-get ]]; }; "
                                         "install_packages cmake")
        self.assertEqual(code, 0)
        self.assertIn("WARNING", output)
        self.assertIn("cmake", output)

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

    def test_only_packages_that_are_not_installed_are_missing(self):
        self.assertEqual(self.callFunction("missing_packages bash no-such-package coreutils"),
                         (0, "no-such-package\n"))

    def test_nothing_is_installed_when_nothing_is_missing(self):
        code, output = self.callFunction("as_root() { echo CALLED; }; install_packages bash coreutils")
        self.assertEqual((code, output), (0, "Packages: all 2 installed\n"))

    def test_missing_packages_without_root_or_sudo_are_named(self):
        code, output = self.callFunction("id() { echo 1000; }; missing_packages() { echo cmake; }; command() { [[ $2 == apt-get ]]; }; "
                                         "install_packages cmake")
        self.assertEqual(code, 1)
        self.assertIn("sudo", output)
        self.assertIn("install -y --no-install-recommends cmake", output)

    def test_packages_with_services_are_installed_without_starting_or_enabling_them(self):
        printed = 'missing_packages() { echo cmake munge; }; as_root() { printf "%s|" "$@"; }; install_packages cmake munge'
        code, output = self.callFunction(". %s; %s" % (os.path.join(SCRIPTS, "..", "qa", "packages.sh"), printed))
        self.assertEqual(code, 0)
        self.assertIn("policy-rc.d", output)
        self.assertIn("systemctl disable", output)
        self.assertIn("install -y --no-install-recommends cmake munge", output)
        code, output = self.callFunction(printed)
        self.assertNotIn("policy-rc.d", output)  # demo.sh installs no services

    def test_the_guard_against_services_passes_on_the_verdict(self):
        policy = self.file("policy-rc.d")
        packages = os.path.join("..", "qa", "packages.sh")
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

    def test_a_system_that_knows_localhost_is_left_alone(self):
        self.assertEqual(self.callFunction("as_root() { echo CALLED; }; getent() { true; }; ensure_localhost_resolves"),
                         (0, ""))

    def test_a_system_that_does_not_know_localhost_is_taught(self):
        code, output = self.callFunction("as_root() { echo CALLED \"$@\"; }; getent() { false; }; "
                                         "ensure_localhost_resolves")
        self.assertEqual(code, 0)
        self.assertIn("/etc/hosts", output.split("CALLED")[1])

    def test_the_workspace_links_this_checkout_and_may_exist(self):
        for _ in range(2):
            self.assertEqual(self.callFunction("make_workspace"), (0, ""))
            self.assertEqual(os.path.realpath(os.path.join(self.workspace, "src", "ddm")), CHECKOUT)

    def test_another_folder_in_the_place_of_the_link_is_refused(self):
        os.makedirs(os.path.join(self.workspace, "src", "ddm"))
        code, output = self.callFunction("make_workspace")
        self.assertEqual(code, 1)
        self.assertIn(os.path.join(self.workspace, "src", "ddm"), output)

    def test_a_link_to_another_checkout_is_refused(self):
        os.makedirs(os.path.join(self.workspace, "src"))
        os.symlink("/no/other/checkout", os.path.join(self.workspace, "src", "ddm"))
        code, output = self.callFunction("make_workspace")
        self.assertEqual(code, 1)
        self.assertIn("/no/other/checkout", output)

    def test_a_checkout_inside_the_source_space_is_not_linked_again(self):
        checkout = os.path.join(self.workspace, "src", "cloned_here")
        os.makedirs(checkout)
        self.assertEqual(self.callFunction("checkout=%s; make_workspace" % checkout), (0, ""))
        self.assertEqual(os.listdir(os.path.join(self.workspace, "src")), ["cloned_here"])

    def test_a_workspace_inside_the_checkout_is_refused(self):
        code, output = self.callFunction("DDM_WS=$checkout/ws; make_workspace")
        self.assertEqual(code, 1)
        self.assertIn(CHECKOUT, output)

    def test_a_workspace_with_a_space_in_its_path_is_refused(self):
        code, output = self.callFunction("DDM_WS='/tmp/my ws'; make_workspace")
        self.assertEqual(code, 1)
        self.assertIn("/tmp/my ws", output)

    def test_unknown_arguments_are_refused_before_anything_is_done(self):
        for script in ("demo.sh", "test.sh"):
            code, output = self.call("/bin/bash", os.path.join(SCRIPTS, script), "--nonsense")
            self.assertEqual(code, 2)
            self.assertIn("--nonsense", output)
            self.assertFalse(os.path.exists(self.workspace))

    def test_help_is_printed_and_nothing_is_done(self):
        for script in ("demo.sh", "test.sh"):
            code, output = self.call("/bin/bash", os.path.join(SCRIPTS, script), "--help")
            self.assertEqual(code, 0)
            self.assertTrue(output.startswith("usage: bash " + script))
            self.assertFalse(os.path.exists(self.workspace))

    def test_a_number_of_trials_that_is_none_is_refused(self):
        for value in ("0", "-3", "many", ""):
            code, output = self.call("/bin/bash", os.path.join(SCRIPTS, "demo.sh"), "--trials", value)
            self.assertEqual(code, 2)
            self.assertIn("--trials", output)

    def test_rviz_without_a_screen_is_refused_before_anything_is_done(self):
        code, output = self.call("/usr/bin/env", "-u", "DISPLAY", "/bin/bash", os.path.join(SCRIPTS, "demo.sh"), "--rviz")
        self.assertEqual(code, 2)
        self.assertIn("DISPLAY", output)
        self.assertFalse(os.path.exists(self.workspace))

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

    def callFreshRoot(self, *arguments, **environment):
        folder = self.file("roots")
        os.makedirs(folder, exist_ok=True)
        set_variables = ["%s=%s" % variable for variable in dict(environment, TMPDIR=folder).items()]
        done = self.call("/usr/bin/env", *set_variables, "/bin/bash", FRESH_ROOT, *arguments)
        self.assertEqual(os.listdir(folder), [])  # nothing was made
        return done

    def test_an_empty_system_other_than_debian_11_12_or_13_is_refused(self):
        for arguments in ((), ("sid",), ("demo",), ("bookworm", "trixie"), ("trixie", "demo", "--nonsense")):
            code, output = self.callFreshRoot(*arguments)
            self.assertEqual(code, 2)
            self.assertIn("usage: bash fresh_root.sh bullseye|bookworm|trixie", output)
            self.assertIn("'%s'" % (arguments or ("",))[-1], output)
        self.assertEqual(self.callFreshRoot("trixie", "--help")[0], 0)

    def test_an_empty_system_needs_a_tool_that_makes_it(self):
        os.makedirs(self.file("tools"))
        os.symlink("/usr/bin/dirname", self.file("tools", "dirname"))
        code, output = self.callFreshRoot("trixie", PATH=self.file("tools"))
        self.assertEqual(code, 1)
        self.assertIn("debootstrap is not installed", output)

    def checkSummary(self, text):
        if text is not None:
            self.write("summary.yaml", text)
        return self.callFunction("check_summary %s 15 ''" % self.scratch, "demo.sh")

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

    def test_a_call_that_finds_everything_finished_is_a_success(self):
        summary = self.write("summary.yaml", "finished: true\ntrials: 15\n")
        for launch in ("touch %s" % summary, "cp {0} {0}.new && mv {0}.new {0}".format(summary)):
            code, output = self.runExperiment(launch)
            self.assertEqual(code, 0, output)

    def test_a_finished_experiment_is_a_success(self):
        for trials in (15, 20):
            self.assertEqual(self.checkSummary("finished: true\ntrials: %d\nsuccess: [0, 1]\n" % trials), (0, ""))

    def test_an_experiment_that_did_not_finish_is_a_failure(self):
        for text in ("finished: false\ntrials: 15\n", "trials: 15\n", "no map", ""):
            code, output = self.checkSummary(text)
            self.assertEqual(code, 1)
            self.assertIn("summary.yaml", output)
            self.assertIn("15 trials", output)

    def test_an_experiment_without_summary_is_a_failure(self):
        code, output = self.checkSummary(None)
        self.assertEqual(code, 1)
        self.assertIn("wrote no", output)

    def test_the_summary_of_fewer_trials_is_no_success(self):
        for text in ("finished: true\ntrials: 14\n", "finished: true\n"):
            code, output = self.checkSummary(text)
            self.assertEqual(code, 1)
            self.assertIn("15 trials", output)
