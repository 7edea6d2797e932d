# The table of faults: each fault that the tests inject into an experiment, and the expected outcome.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import itertools

# Outcomes. fault_run.py has a method that checks each word.
RECOVERS = "finished, equal"
NOTICED = "finished, named, equal"
ENDS = "ended, named, undamaged, resumes, equal"
ENDS_IN_FIRST_TRIAL = "ended, named, resumes, equal"
KILLED = "ended, undamaged, resumes, equal"  # roslaunch reports the node and ends the others
KILLED_IN_FIRST_TRIAL = "ended, resumes, equal"
GOES_ON_AFTER_ZERO = "finished, zero"
GOES_ON_NAMED_AFTER_ZERO = "finished, named, zero"
ENDS_WITH_ZERO = "ended, named, zero, undamaged, resumes"

# name: unique name. phase, fault: time and kind of the fault, in the words of fault_injector and fault_run.py.
# expected: outcome. words: texts that the output must contain.
Case = collections.namedtuple("Case", "name phase fault expected words")
FAULT_OF_ROOT = "fill disk"  # mounts a small file system

NODES = "sim_node|mpc_node|trial_recorder|model_node|experiment_node|master"
# Suffixes of phases.
REAL_TIME, ON_A_ROBOT = " in real time", " on a robot"
FIRST, EXPLORING, RECORDING, TRAINING, EVALUATION = PHASES = (
    "random trial", "exploring trial", "recording", "training", "evaluation")
RUNS = (EXPLORING, EVALUATION)
NO_TORQUES = "nan|inf|none|twice|1e300"
CHANGE = "the images change from 51x51 mono8 to "
FULL = ("cannot", "No space left on device")
# A small subset with some cases of each class.
QUICK = (
    "kill mpc_node in evaluation", "lose sim_node in exploring trial", "drop image in exploring trial",
    "publish torque in exploring trial", "fill disk in random trial",
    "mute image in exploring trial in real time", "future image in exploring trial on a robot")


def cases(phases, *rows):
    """Yields a case for each phase and row (fault, expected, words of the output).

    The fault `a|b c` gives the cases `a c` and `b c`.
    """
    for phase in phases:
        for alternatives, expected, *words in rows:
            for parts in itertools.product(*(part.split("|") for part in alternatives.split())):
                fault = " ".join(parts)
                yield Case("%s in %s" % (fault, phase), phase, fault, expected, tuple(words))


def real_time(run):
    """Cases with a plant that does not wait for torques. After each fault the motor must stop by itself, and the model
    must not learn from torques that arrived too late or never reached the motor."""
    learns = ", learned what acted" if run == EXPLORING else ""
    return cases([run + REAL_TIME],
                 # A stopped node looks dead to the plant. A killed node would not do, because roslaunch would then end
                 # the plant, too.
                 ("hold mpc_node", ENDS_WITH_ZERO, "action /run_trial shows no sign of life"),
                 ("pause mpc_node", GOES_ON_AFTER_ZERO + learns),
                 ("mute image", ENDS_WITH_ZERO, "no image after step", "/fault_injector"),
                 ("mute torque", GOES_ON_AFTER_ZERO + learns),  # a motor that gets no torque reports nothing
                 ("late image|torque", GOES_ON_AFTER_ZERO + learns),
                 ("alter torque " + NO_TORQUES, ENDS_WITH_ZERO, "torque refused", "/fault_injector"),
                 ("publish torque", ENDS_WITH_ZERO, "torque refused", "/intruder"))


CASES = [
    # Processes that end or stop for a while.
    *cases([FIRST], ("kill " + NODES, KILLED_IN_FIRST_TRIAL)),
    *cases(PHASES[1:], ("kill " + NODES, KILLED), ("pause " + NODES, RECOVERS)),
    # A node that dies without roslaunch's notice, or is stopped for longer than other nodes wait, or for good. The
    # nodes that wait for this node must report it.
    *cases(RUNS, ("lose|oversleep|hold sim_node", ENDS, "no image after step", "action /run_trial"),
           ("lose|oversleep|hold mpc_node", ENDS, "no torque for frame", "action /run_trial")),
    *cases([EXPLORING], ("lose|oversleep|hold trial_recorder", ENDS, "service /stop_recording does not answer")),
    *cases([TRAINING], ("lose|oversleep|hold model_node", ENDS, "action /train shows no sign of life")),
    # No node confirms the last torque of a trial.
    *cases([RECORDING], ("lose sim_node", ENDS, "service /stop_recording")),
    *cases([TRAINING], ("lose sim_node", ENDS, "service /reset does not answer")),
    *cases([RECORDING, TRAINING], ("lose mpc_node", ENDS, "action /run_trial shows no sign of life")),
    # Connected nodes need no master. The experiment takes longer, because each request to the master runs into its time
    # limit.
    *cases(RUNS + (TRAINING,), ("hold master", NOTICED, "the ROS master does not answer")),

    # Messages that are lost, late, repeated or from another publisher.
    *cases(RUNS, ("drop image|torque", ENDS, "no torque for frame 7 ", "/fault_injector"),
           ("double|late|repeat image|torque", RECOVERS), ("publish torque|image|model|clock", ENDS, "/intruder"),
           ("mute clock", RECOVERS)),  # no node waits for simulated time to pass

    *real_time(EXPLORING), *real_time(EVALUATION),

    # A wrong clock, old joint states, another camera, a dead controller, or a joint beyond its limits must lead to zero
    # torque within two time steps and 50 ms.
    *cases([run + ON_A_ROBOT for run in RUNS],
           ("future image", ENDS_WITH_ZERO, "no image after step"),  # no further image follows
           ("set clock forward", GOES_ON_NAMED_AFTER_ZERO, "the camera's clock has jumped forward"),
           ("set clock back", GOES_ON_NAMED_AFTER_ZERO, "before the one that came before it"),
           ("age joints", GOES_ON_NAMED_AFTER_ZERO, "joint_states does not report"),
           ("resize image", ENDS_WITH_ZERO, "the images have changed from", "no image after step"),
           ("lose mpc_node", ENDS_WITH_ZERO, "no node publishes torques", "action /run_trial shows no sign of life"),
           ("exceed position", ENDS_WITH_ZERO, "robot/position_limits", "was cancelled"),
           ("exceed speed", ENDS_WITH_ZERO, "robot/speed_limit", "was cancelled")),

    # Messages with invalid values.
    *cases(RUNS, ("alter torque " + NO_TORQUES, ENDS, "torque refused", "/fault_injector"),
           ("alter image size", ENDS, CHANGE + "25x25 mono8"), ("alter image encoding", ENDS, CHANGE + "51x51 rgb8")),
    *cases([EXPLORING], ("alter image unknown", ENDS, CHANGE + "51x51 smell"),
           ("alter image cut", ENDS, "image refused", "data must hold"),
           ("alter image unstamped", ENDS, "image refused", "it has no stamp")),

    # A full disk, and a folder that is in use.
    *cases([FIRST], ("fill disk", ENDS_IN_FIRST_TRIAL, *FULL)),
    *cases(PHASES[1:], ("fill disk", ENDS, *FULL)),
    *cases([EXPLORING, FIRST], ("begin experiment", NOTICED, "another process is running in the folder"))]
