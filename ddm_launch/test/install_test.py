# The install space has everything and needs nothing else: it runs where sources, build and devel space are gone.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re
import unittest
from concurrent.futures import ThreadPoolExecutor

from namespaces import hiding, why_not
from processes import call, free_port, has_mujoco
from run_files import differences, expected_files, files_in, torque_files
from scratch_case import SharedScratchCase

PACKAGES = ["ddm_launch", "ddm_model", "ddm_mpc", "ddm_msgs", "ddm_sim"]
CHECKOUT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
BUILD = os.environ["DDM_BUILD"]
SHARED_FOLDERS = ["config", "launch", "rviz"]  # those in a package's share folder
TRIALS = 1


def cached(name):
    """A value of the build's CMakeCache.txt; empty if it has none."""
    with open(os.path.join(BUILD, "CMakeCache.txt")) as stream:
        found = re.search(r"^%s:\w+=(.*)$" % name, stream.read(), re.MULTILINE)
    return found.group(1) if found else ""


ALONE = "" if cached("ddm_msgs_BINARY_DIR") else "each package has a build folder of its own"
HINDRANCE = ALONE or why_not("mount")


def programs_in(folder):
    """Names of the programs in lib/PACKAGE of a space, but for tests."""
    names = os.listdir(folder) if os.path.isdir(folder) else []
    return sorted(name for name in names if os.access(os.path.join(folder, name), os.X_OK)
                  and not re.search("_test$|_test_", name))


@unittest.skipIf(HINDRANCE, "THE INSTALL SPACE IS NOT TESTED: %s" % HINDRANCE)
class InstallTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.devel = cached("CATKIN_DEVEL_PREFIX")
        cls.gone = sorted({CHECKOUT, os.path.realpath(cached("CMAKE_HOME_DIRECTORY")), BUILD, cls.devel})
        cls.prefix = os.path.join(cls.class_scratch, cached("CMAKE_INSTALL_PREFIX").lstrip("/"))
        code, output = call(["cmake", "--install", BUILD], environment=dict(os.environ, DESTDIR=cls.class_scratch))
        if code != 0:
            raise AssertionError(output)
        cls.run_folder = os.path.join(cls.class_scratch, "process")
        cls.code, cls.output = cls.runInstalled("rosrun", "ddm_launch", "run_experiment", "--preset", "debug",
                                                "--seed", 1, "--trials", TRIALS, "--out", cls.run_folder)

    @classmethod
    def runInstalled(cls, *command):
        """A command after sourcing install/setup.bash in a new terminal. Returns (exit code, output)."""
        terminal = {"PATH": "/usr/bin:/bin:/usr/sbin:/sbin", "HOME": cls.class_scratch,
                    "ROS_HOME": cls.class_scratch + "/ros", "ROS_HOSTNAME": "localhost", "PYTHONUNBUFFERED": "1"}
        # a function, or setup.bash would take the command's words for its own
        source = "open_terminal() { . %s/setup.bash; }; open_terminal && exec \"$@\"" % cls.prefix
        return call(hiding(cls.gone) + ["bash", "-c", source, "bash"] + [str(word) for word in command],
                    environment=terminal, folder=cls.class_scratch)

    def assertRuns(self, *command):
        code, output = self.runInstalled(*command)
        self.assertEqual(code, 0, "%s\n%s" % (command, output))
        return output

    def test_sources_build_and_devel_space_are_gone(self):
        for folder in self.gone:
            self.assertGreater(len(os.listdir(folder)), 0)
            self.assertEqual(self.assertRuns("ls", "-A", folder), "", folder)

    def test_nothing_that_is_installed_names_sources_build_or_devel_space(self):
        for path in files_in(self.prefix):
            if path.endswith(("Config.cmake", "_setup_util.py")):
                continue  # catkin's own: they name all workspaces that were sourced when this one was configured
            with open(os.path.join(self.prefix, path), "rb") as stream:
                content = stream.read()
            if b"\0" in content[:4096]:
                continue  # a program may tell where its sources were, in a message
            for folder in self.gone:
                self.assertIsNone(re.search(re.escape(folder).encode() + rb"(?![\w.-])", content), (path, folder))

    def test_all_programs_but_those_of_qa_and_study_are_installed(self):
        left_out = []
        for room in ("qa/benchmark", "study/prediction"):
            with open(os.path.join(CHECKOUT, "ddm_launch", room, "CMakeLists.txt")) as stream:
                left_out += re.findall(r"add_executable\((\w+)", stream.read())
        self.assertIn("benchmark_kernels", left_out)
        self.assertIn("prediction_experiment", left_out)
        for package in PACKAGES:
            built = programs_in(os.path.join(self.devel, "lib", package))
            self.assertEqual(programs_in(os.path.join(self.prefix, "lib", package)),
                             [name for name in built if name not in left_out], package)
        installed = programs_in(os.path.join(self.prefix, "lib", "ddm_launch"))
        self.assertLessEqual({"sweep", "robot_check"}, set(installed))
        self.assertEqual({"qa", "fault_table", "study"} & set(installed), set())

    def test_all_configurations_launch_files_and_headers_are_installed(self):
        for package in PACKAGES:
            share = os.path.join(self.prefix, "share", package)
            for name in SHARED_FOLDERS:
                kinds = (".launch", ".yaml", ".rviz")
                wanted = [path for path in files_in(os.path.join(CHECKOUT, package, name)) if path.endswith(kinds)]
                self.assertEqual([path for path in files_in(os.path.join(share, name)) if path.endswith(kinds)], wanted,
                                 (package, name))
            for path in files_in(os.path.join(CHECKOUT, package)):
                header = re.match(r"(?:\w+/)?include/(.*\.h)$", path)
                if header and "/testing/" not in path and (has_mujoco() or not path.startswith("mujoco/")):
                    self.assertTrue(os.path.isfile(os.path.join(self.prefix, "include", header.group(1))), path)

    def test_an_experiment_runs_in_one_process_and_with_the_nodes(self):
        output = self.assertRuns("roslaunch", "-p", free_port(), "ddm_launch", "experiment.launch", "preset:=debug",
                                 "seed:=1", "trials:=%d" % TRIALS, "runs:=" + self.out)
        self.assertEqual(self.code, 0, self.output)
        for folder in (self.run_folder, self.out):
            self.assertEqual(files_in(folder), expected_files(TRIALS), output)
        self.assertEqual(differences(self.out, self.run_folder, torque_files(TRIALS)), [])

    def test_launch_files_find_what_they_name(self):
        for words in (["experiment.launch", "runs:=/nowhere", "rviz:=true", "nuisance:=drops"],
                      ["part.launch", "simulator:=true", "plant:=moving_tile"]):
            output = self.assertRuns("roslaunch", "--files", "ddm_launch", *words)
            self.assertIn(self.prefix, output)
        output = self.assertRuns("roslaunch", "--args", "rviz", "ddm_launch", "experiment.launch", "runs:=/nowhere",
                                 "rviz:=true")
        config = re.search(r"-d (\S+)", output).group(1)
        self.assertTrue(config.startswith(self.prefix) and os.path.isfile(config), config)

    def test_every_tool_shows_its_help(self):
        nodes = set()  # launch files start these, nobody else does
        for path in glob.glob(os.path.join(CHECKOUT, "ddm_launch", "**", "*.launch"), recursive=True):
            with open(path) as stream:
                nodes.update(re.findall(r'type="(\w+)"', stream.read()))
        tools = [(package, name) for package in PACKAGES
                 for name in programs_in(os.path.join(self.prefix, "lib", package)) if name not in nodes]
        self.assertGreater(len(tools), 8)
        with ThreadPoolExecutor(2) as pool:
            done = list(pool.map(lambda tool: self.runInstalled(os.path.join(self.prefix, "lib", *tool), "--help"), tools))
        usage = re.compile(r"^(usage: |benchmark \[)", re.MULTILINE)  # the latter: Google Benchmark's own
        self.assertEqual([(tool, output) for tool, (code, output) in zip(tools, done)
                          if code != 0 or not usage.search(output)], [])

