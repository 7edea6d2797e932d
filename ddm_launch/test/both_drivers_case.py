# Base of the tests that run one experiment by the nodes and by run_experiment: both leave the same files.
# SPDX-License-Identifier: BSD-3-Clause
import os

from processes import roslaunch, run_experiment
from run_files import differences, expected_files
from scratch_case import SharedScratchCase


class BothDriversCase(SharedScratchCase):
    """nodes, process: the folders of the experiment, as either driver leaves them."""

    @classmethod
    def runBothDrivers(cls, seed, trials, arguments, config=None):
        """Preset, plant or nuisance by name in `arguments`, and the text of a further file."""
        arguments = dict(arguments, seed=seed, trials=trials)
        if config:
            arguments["config"] = os.path.join(cls.class_scratch, "config.yaml")
            with open(arguments["config"], "w") as stream:
                stream.write(config)
        cls.trials = trials
        cls.nodes, cls.process = (os.path.join(cls.class_scratch, name) for name in ("nodes", "process"))
        _, cls.nodes_output = roslaunch(cls.class_scratch, "experiment.launch", "runs:=" + cls.nodes,
                                        *["%s:=%s" % item for item in arguments.items()])
        _, cls.process_output = run_experiment(
            "--out", cls.process, *[word for key, value in arguments.items() for word in ("--" + key, value)])

    def assertEqualFiles(self, names):
        """Both have finished, and these files of theirs are equal."""
        self.assertTrue(os.path.exists(os.path.join(self.nodes, "summary.yaml")), self.nodes_output)
        self.assertTrue(os.path.exists(os.path.join(self.process, "summary.yaml")), self.process_output)
        self.assertEqual(differences(self.nodes, self.process, names), [])

    def assertAllFilesAreEqual(self):
        """All but the bags, whose stamps are another simulated time."""
        names = [name for name in expected_files(self.trials) if not name.endswith(".bag")]
        self.assertGreater(len(names), 8)
        self.assertEqualFiles(names)
