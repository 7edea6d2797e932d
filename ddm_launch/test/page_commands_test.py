# Every command in every page works: it is run here, or by the test that page_commands.py names.
# SPDX-License-Identifier: BSD-3-Clause
from concurrent.futures import ThreadPoolExecutor
import glob
import os
import re
import shutil
import tempfile
import unittest.mock
import xml.etree.ElementTree

import page_commands
import pages
from processes import call, find_program, free_port, needs_mujoco, line_by_line, run_experiment
from scratch_case import SharedScratchCase

LIMIT_S = 300.0  # for the commands of a page
# What a reader has before: files that a page begins with.
GIVEN = {"doc/reference/launch_files.md": ["monday.ddm", "monday/a.bag", "a.bag", "b.bag"],
         "doc/reference/programs.md": ["robot.model", "monday.bag", "my_robot.yaml", "upright.png", "trial_000.bag",
                                       "trial_001.bag"],
         "ddm_launch/results/published/README.md": ["trials.csv", "success_rate.csv"]}
NEED_MUJOCO = ["ddm_launch/results/README.md", "ddm_launch/results/tasks/README.md", "doc/your_plant.md"]


def setup_file():
    """setup.bash of the workspace that this test runs in."""
    for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(":"):
        if os.path.isfile(os.path.join(prefix, "setup.bash")):
            return os.path.join(prefix, "setup.bash")
    raise AssertionError("no workspace is sourced")


def arguments_of(launch_file):
    package = os.path.join(pages.CHECKOUT, "ddm_launch")
    path, = glob.glob(os.path.join(package, "**", "launch", launch_file), recursive=True)
    return {argument.get("name") for argument in xml.etree.ElementTree.parse(path).getroot().findall("arg")
            if argument.get("value") is None}


class PageCommandsTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.given = os.path.join(cls.class_scratch, "given")
        code, output = run_experiment("--preset", "debug", "--seed", 7, "--trials", 1, "--out", cls.given)
        assert code == 0, output

    def give(self, folder, name):
        path = os.path.join(folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        if name.endswith(".yaml"):
            with open(path, "w") as stream:
                stream.write("model: {pca_dim: 10}\n")
        elif name.endswith(".png"):
            shutil.copy(os.path.join(pages.CHECKOUT, "ddm_launch/results/rviz/rviz.png"), path)
        elif name == "success_rate.csv":
            shutil.copy(os.path.join(pages.CHECKOUT, "ddm_launch/results/published", name), path)
        elif name == "trials.csv":
            shutil.copy(os.path.join(self.given, name), path)
        else:
            trial = os.path.join(self.given, "trial_001" if re.search("b|1", os.path.splitext(name)[0][-1]) else
                                 "trial_000")
            shutil.copy(os.path.join(trial, "trial.bag" if name.endswith(".bag") else "model.ddm"), path)

    def runPage(self, page):
        """(page, exit code, output) of all its commands, in a home and a folder of its own."""
        home = tempfile.mkdtemp(dir=self.scratch)
        folder = os.path.join(home, "here")
        os.makedirs(folder)
        os.makedirs(os.path.join(home, "ddm_ws", "devel"))
        with open(os.path.join(home, "ddm_ws", "devel", "setup.bash"), "w") as stream:
            stream.write(". %s\n" % setup_file())
        for name in GIVEN.get(page, []):
            self.give(folder, name)
        script = os.path.join(home, "page.sh")
        with open(script, "w") as stream:
            stream.write(page_commands.script_of(pages.read(page)))
        environment = dict(line_by_line(), HOME=home, ROS_HOME=os.path.join(home, "ros"), ROS_HOSTNAME="localhost",
                           ROS_MASTER_URI="http://localhost:%d" % free_port())
        environment.pop("DDM_WS", None)
        try:
            return (page,) + call(["bash", script], LIMIT_S, environment=environment, folder=folder)
        except TimeoutError as error:
            return page, None, str(error)

    def test_the_commands_of_all_pages_run_in_their_order(self):
        with_commands = [page for page in pages.page_paths() if page_commands.block_commands(pages.read(page))]
        self.assertGreater(len(with_commands), 10)
        self.assertLessEqual(set(NEED_MUJOCO), set(with_commands))
        self.assertPagesRun(page for page in with_commands if page not in NEED_MUJOCO)

    @needs_mujoco
    def test_the_commands_of_pages_on_model_files_run_in_their_order(self):
        self.assertPagesRun(NEED_MUJOCO)

    def assertPagesRun(self, names):
        with ThreadPoolExecutor(2) as pool:
            done = list(pool.map(self.runPage, names))
        failed = [(page, output[-3000:]) for page, code, output in done if code != 0]
        for page, output in failed:
            print("== %s\n%s" % (page, output))
        self.assertEqual([page for page, _ in failed], [])

    def test_every_program_in_a_page_is_known_to_be_run_by_a_test(self):
        unknown = []
        for page in pages.page_paths():
            text = pages.read(page)
            for command in page_commands.block_commands(text) + page_commands.usage_commands(text):
                program = page_commands.program_of(command)
                if program and program not in page_commands.RUN_HERE and not page_commands.is_run_by_nobody(command) \
                        and not page_commands.test_elsewhere(command):
                    unknown.append((page, command))
        self.assertEqual(unknown, [], "add them to page_commands.py: RUN_HERE or ELSEWHERE")

    def test_the_tests_that_run_the_others_are_there_and_name_them(self):
        rows = [(test, program) for program, test in page_commands.ELSEWHERE.items()]
        for test, word in rows + [(test, word) for _, test, word in page_commands.COMMANDS_ELSEWHERE]:
            with open(page_commands.test_path(test)) as stream:
                self.assertIn(word, stream.read(), test)

    def test_options_and_arguments_of_all_commands_exist(self):
        known, wrong = {}, []
        for page in pages.page_paths():
            text = pages.read(page)
            for command in page_commands.block_commands(text) + page_commands.usage_commands(text):
                program = page_commands.program_of(command)
                if program is None or page_commands.is_run_by_nobody(command):
                    continue
                if program not in known:
                    known[program] = self.optionsOf(command, program)
                own = command.split(" -- ")[0]
                used = (re.findall(r"(?<=\s)(\w+):=", command) if program.endswith(".launch")
                        else re.findall(r"(?<=[\s\[])(--\w[\w-]*)", own))
                wrong += [(page, command, name) for name in used if name not in known[program]]
        self.assertEqual(wrong, [])
        self.assertGreater(len(known), 20)

    @staticmethod
    def optionsOf(command, program):
        if program.endswith(".launch"):
            return arguments_of(program)
        package = re.search(r"(?:rosrun|--libexec) (\w+)", command)
        if program in ("sim_node", "mpc_node", "speed_kernels"):
            return {"--benchmark_filter"}
        name, *words = program.split()
        path = (find_program(name, package.group(1)) if package
                else os.path.join(pages.CHECKOUT, "ddm_launch", "qa" if name == "fuzz.sh" else "scripts", name))
        code, output = call((["bash"] if name.endswith(".sh") else []) + [path] + words + ["--help"])
        assert code == 0, output
        return set(re.findall(r"--\w[\w-]*", output))

    def test_the_table_of_features_names_tests_that_run_its_commands(self):
        rows = pages.tables(pages.section(pages.read("doc/develop/testing.md"), "Features and their tests"))[0][1:]
        self.assertGreater(len(rows), 12)
        for row in rows:
            programs = [page_commands.program_of(command) for command in pages.code_spans(row[1])]
            text = "".join(self.sourcesOf(test) for test in re.findall(r"\w+(?:\.test|_test\.py)", row[2]))
            for program in filter(None, programs):
                self.assertRegex(text, r"\b%s\b" % re.escape(program.replace(".launch", "")), row)

    @staticmethod
    def sourcesOf(test):
        """A test and all sources beside it that its programs may be made of."""
        for package in pages.PACKAGES:
            folder = os.path.join(pages.CHECKOUT, package, "test")
            if os.path.exists(os.path.join(folder, test)):
                text = pages.read(os.path.join(folder, test))
                for name in re.findall(r'type="(\w+)\.py"', text):
                    text += pages.read(os.path.join(folder, name + ".py"))
                for helper in re.findall(r"^from (both_drivers_case|processes|robot_stand_in|toy_robot) import", text,
                                         re.MULTILINE):
                    text += pages.read(os.path.join(folder, helper + ".py"))
                return text
        raise AssertionError("no such test: " + test)

    def test_a_command_that_fails_is_noticed_even_by_roslaunch(self):
        for commands, code in (("true\nfalse\ntrue", 1), ("roscore &\nrosparam get /rosversion", 0),
                               ("roslaunch ddm_launch control.launch model:=no.ddm\ntrue", 1)):
            with unittest.mock.patch.object(pages, "read", return_value="```bash\n%s\n```\n" % commands):
                _, actual, output = self.runPage("a page")
            self.assertEqual(actual, code, output)

    def test_commands_become_cheap_and_keep_what_they_show(self):
        self.assertEqual(page_commands.cheaper("rosrun ddm_launch run_experiment --seed 1 --out a"),
                         "rosrun ddm_launch run_experiment --trials 1 --preset debug --seed 1 --out a")
        self.assertEqual(page_commands.cheaper("roslaunch ddm_launch control.launch model:=m"),
                         "roslaunch ddm_launch control.launch preset:=debug model:=m")
