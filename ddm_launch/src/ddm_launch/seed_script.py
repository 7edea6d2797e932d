# What a sweep runs for each seed: the program with its options, as a script that any engine can start.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shlex
import subprocess

from ddm_launch.command import Failure, find_program

# Whoever starts a process may be killed without a chance to end it: then the kernel does. With this each link of the
# chain sweep - parallel - (ssh -) script - program falls with the one before it.
DIE_WITH_PARENT = ["setpriv", "--pdeathsig", "KILL"]

# The programs that a sweep can run, and the table that each writes into its folder.
TABLES = {"run_experiment": "trials.csv", "prediction_experiment": "predictions.csv"}

SCRIPT = """\
#!/bin/bash
# One seed of this sweep, by hand: bash run_seed.sh SEED. As a task of a Slurm job array the seed is its index.
seed=${{1:-${{SLURM_ARRAY_TASK_ID:?}}}}
name=$(printf seed_%04d "$seed")
exec >>{folder}/logs/"$name".log 2>&1
echo "seed $seed on $(uname -n)${{SLURM_JOB_ID:+, task ${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}} of Slurm}}"
. {setup} || exit
cd {working_folder} || exit
export OMP_NUM_THREADS=1  # a core for each seed
{command} --seed "$seed" --out {folder}/"$name"
code=$?
((code <= 128)) || echo "ended by signal $(kill -l "$code")"
exit "$code"
"""


class BadOptions(Failure):
    """The program refuses the options that it is given."""

    exit_code = 2


class SeedProgram:
    """A program of ddm_launch with all of its options but seed and folder."""

    def __init__(self, name, trials, options):
        """trials: None for a program that has none. options: all others, handed on as they are.

        Raises Failure if the program or the setup.bash of its workspace is not there.
        """
        self.name, self.trials, self.options = name, trials, list(options)
        self.path = find_program(name)
        self.setup = find_setup(self.path)

    @property
    def table(self):
        return TABLES[self.name]

    def command(self):
        """The words of the command line, without seed and folder."""
        trials = [] if self.trials is None else ["--trials", str(self.trials)]
        return [self.path] + trials + self.options

    def script(self, folder):
        """Text of the bash script that runs one seed of the sweep in this (absolute) folder."""
        return SCRIPT.format(folder=shlex.quote(folder), setup=shlex.quote(self.setup),
                             working_folder=shlex.quote(os.getcwd()),
                             command=" ".join(shlex.quote(word) for word in DIE_WITH_PARENT + self.command()))

    def check(self, seed):
        """Raises BadOptions with the program's own words if it refuses its options.

        It is sent to a folder that cannot be: it then ends with code 2 if the options are at fault, and with code
        1 before it has computed anything if they are not.
        """
        done = subprocess.run(self.command() + ["--seed", str(seed), "--out", os.devnull], stdin=subprocess.DEVNULL,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, universal_newlines=True)
        if done.returncode == 2:
            raise BadOptions(done.stderr.strip())


def find_setup(program):
    """The setup.bash that each seed sources first, on other hosts too.

    That of the topmost workspace that is sourced here: it may hold plants that the workspace of the program does not
    know. Where none is, that of the program.
    """
    prefix = os.path.dirname(os.path.dirname(os.path.dirname(program)))  # PREFIX/lib/ddm_launch/PROGRAM
    for folder in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep) + [prefix]:
        path = os.path.join(folder, "setup.bash")
        if folder and os.path.isfile(path):
            return path
    raise Failure("there is no setup.bash in %s, where %s comes from, nor in CMAKE_PREFIX_PATH: source the "
                  "workspace's devel/setup.bash" % (prefix, program))
