# What can happen to an experiment, and what must come of it.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import itertools

# Outcomes. finished: summary.yaml says so. ended: the launch ended by itself, without a verdict. named: the output has
# the case's words. undamaged: what was finished before the fault, at least one trial, is there, byte by byte, after the
# fault and after resuming. resumes: the same command finishes the experiment. equal: then all files but bags are those of
# the undisturbed experiment, apart from times. zero: in real time, from the third period after the last torque on, none
# acts. learned what acted: in the bag of the trial, an image has the torque that acted after it or none, and some have none. unchanged: the command
# left every byte of the run folder. refused: the launch left no bag. acts when restored: with the fault taken away, the
# same launch leaves one. kept: a bag that was not completed is still there, byte by byte.
RECOVERS = "finished, equal"
NOTICED = "finished, named, equal"
ENDS = "ended, named, undamaged, resumes, equal"
ENDS_IN_FIRST_TRIAL = "ended, named, resumes, equal"
KILLED = "ended, undamaged, resumes, equal"  # roslaunch names the node, and ends the others at once
KILLED_IN_FIRST_TRIAL = "ended, resumes, equal"
STAYS = "ended, named, unchanged, undamaged, resumes, equal"
REFUSED = "refused, named, acts when restored"
REFUSED_AND_KEPT = "refused, named, kept, acts when restored"
GOES_ON_AFTER_ZERO = "finished, zero"
GOES_ON_NAMED_AFTER_ZERO = "finished, named, zero"
ENDS_WITH_ZERO = "ended, named, zero, undamaged, resumes"

# name: unique. phase, fault: words for fault_injector, or for damage.py where phase is `at rest`. words: what the
# output must have. quick: also in the small subset. root: needs root, to mount a small or a read-only file system.
Case = collections.namedtuple("Case", "name phase fault expected words quick root")
FAULTS_OF_ROOT = ("read-only folder", "fill disk")

NODES = ("sim_node", "mpc_node", "trial_recorder", "model_node", "experiment_node", "master")
AT_REST, REAL_TIME, ON_A_ROBOT = "at rest", " in real time", " on a robot"  # the latter two: ends of names
FIRST, EXPLORING, RECORDING, TRAINING, EVALUATION = PHASES = (
    "random trial", "exploring trial", "recording", "training", "evaluation")
RUNS = (EXPLORING, EVALUATION)
NO_TORQUES = "nan|inf|none|twice|1e300"
QUICK = set("""
kill mpc_node in evaluation|pause mpc_node in exploring trial|lose sim_node in exploring trial
drop image in exploring trial|publish torque in exploring trial|alter torque nan in exploring trial
cut chunk of trial.bag at rest|flip model.ddm at rest|fill disk in random trial|begin experiment in exploring trial
mute image in exploring trial in real time|future image in exploring trial on a robot
""".replace("\n", "|").split("|")) - {""}


def cases(phases, *rows):
    """A case for each phase and row (fault, expected, words of the output); the fault `a|b c` stands for `a c` and `b c`."""
    for phase in phases:
        for alternatives, expected, *words in rows:
            for parts in itertools.product(*(part.split("|") for part in alternatives.split())):
                fault = " ".join(parts)
                name = "%s %s" % (fault, phase if phase == AT_REST else "in " + phase)
                yield Case(name, phase, fault, expected, tuple(words), name in QUICK, fault in FAULTS_OF_ROOT)


def processes():
    for node in NODES:
        yield from cases([FIRST], ("kill " + node, KILLED_IN_FIRST_TRIAL))
        yield from cases(PHASES[1:], ("kill " + node, KILLED), ("pause " + node, RECOVERS))


def missed():
    """A node that dies out of roslaunch's sight, is stopped for longer than anybody waits, or for good: those who wait
    for it say so."""
    for verb in ("lose", "oversleep", "hold"):
        yield from cases(RUNS, (verb + " sim_node", ENDS, "no image after step", "action /run_trial"),
                         (verb + " mpc_node", ENDS, "no torque for frame", "action /run_trial"))
        yield from cases([EXPLORING], (verb + " trial_recorder", ENDS, "service /stop_recording does not answer"))
        yield from cases([TRAINING], (verb + " model_node", ENDS, "action /train shows no sign of life"))
    # nobody says whether the last torque acted
    yield from cases([RECORDING], ("lose sim_node", ENDS, "service /stop_recording"))
    yield from cases([TRAINING], ("lose sim_node", ENDS, "service /reset does not answer"))
    yield from cases([RECORDING, TRAINING], ("lose mpc_node", ENDS, "action /run_trial shows no sign of life"))
    # A node that knows others needs no master: the experiment takes longer, since each of its questions has a limit.
    yield from cases(RUNS + (TRAINING,), ("hold master", NOTICED, "the ROS master does not answer"))


def messages():
    yield from cases(RUNS, ("drop image|torque", ENDS, "no torque for frame 7 ", "/fault_injector"),
                     ("double|late|repeat image|torque", RECOVERS))
    yield from cases(RUNS, ("publish torque|image|model|clock", ENDS, "/intruder"))
    yield from cases(RUNS, ("mute clock", RECOVERS))  # no node waits for time to pass


def real_time():
    """The plant does not wait: whatever happens, the motor must stop by itself, and no torque that came too late or
    never reached it may be learned from."""
    for run in RUNS:
        learns = ", learned what acted" if run == EXPLORING else ""
        yield from cases(
            [run + REAL_TIME],
            # For the plant it is as good as dead. If it were killed, roslaunch would end the plant as well.
            ("hold mpc_node", ENDS_WITH_ZERO, "action /run_trial shows no sign of life"),
            ("pause mpc_node", GOES_ON_AFTER_ZERO + learns),
            ("mute image", ENDS_WITH_ZERO, "no image after step", "/fault_injector"),
            ("mute torque", GOES_ON_AFTER_ZERO + learns),  # a motor that hears nothing says nothing
            ("late image|torque", GOES_ON_AFTER_ZERO + learns),
            ("alter torque " + NO_TORQUES, ENDS_WITH_ZERO, "torque refused", "/fault_injector"),
            ("publish torque", ENDS_WITH_ZERO, "torque refused", "/intruder"))
    yield from cases(["every run" + REAL_TIME],  # plans that would go on for minutes
                     ("long plans", "ended, named", "no plan for step 1", "mpc/time_budget"),
                     ("long plans with a budget", "finished, in time"))


def robot():
    """A wrong clock, old joint states, another camera, a dead controller or a joint beyond its limits must bring zero torque
    within two dt and 50 ms."""
    return cases([run + ON_A_ROBOT for run in RUNS],
                 ("future image", ENDS_WITH_ZERO, "no image after step"),  # and then silence
                 ("set clock forward", GOES_ON_NAMED_AFTER_ZERO, "the camera's clock has jumped forward"),
                 ("set clock back", GOES_ON_NAMED_AFTER_ZERO, "before the one that came before it"),
                 ("age joints", GOES_ON_NAMED_AFTER_ZERO, "joint_states does not report"),
                 ("resize image", ENDS_WITH_ZERO, "the images have changed from", "no image after step"),
                 ("lose mpc_node", ENDS_WITH_ZERO, "no node publishes torques", "action /run_trial shows no sign of life"),
                 ("exceed position", ENDS_WITH_ZERO, "robot/position_limits", "was cancelled"),
                 ("exceed speed", ENDS_WITH_ZERO, "robot/speed_limit", "was cancelled"))


def values():
    change = "the images change from 51x51 mono8 to "
    yield from cases(RUNS, ("alter torque " + NO_TORQUES, ENDS, "torque refused", "/fault_injector"),
                     ("alter image size", ENDS, change + "25x25 mono8"),
                     ("alter image encoding", ENDS, change + "51x51 rgb8"))
    yield from cases([EXPLORING], ("alter image unknown", ENDS, change + "51x51 smell"),
                     ("alter image cut", ENDS, "image refused", "data must hold"),
                     ("alter image unstamped", ENDS, "image refused", "it has no stamp"))


def files():
    yield from cases([AT_REST],
                     ("cut version|header|chunk|index|connection|chunk_info of trial.bag", STAYS, "trial_000/trial.bag"),
                     ("flip chunk of trial.bag", STAYS, "trial_000/trial.bag"),
                     ("remove trial.bag", STAYS, "trial_000/trial.bag is missing", "put it back"),
                     ("flip end of trials.csv", STAYS, "trials.csv is not as it was written"),
                     ("flip head of trials.csv", STAYS, "trials.csv, line 1"),
                     ("flip digit of trials.csv", STAYS, "trials.csv is not as it was written"),
                     ("flip config.yaml", STAYS, "use another folder"),
                     ("flip model.ddm", REFUSED, "model.ddm", "is damaged (wrong checksum)"),
                     ("flip head of model.ddm", REFUSED, "model.ddm"),
                     ("cut model.ddm", REFUSED, "model.ddm"),
                     ("read-only folder", STAYS, "config.yaml: Read-only file system"))
    full = ("cannot", "No space left on device")
    yield from cases([FIRST], ("fill disk", ENDS_IN_FIRST_TRIAL, *full))
    yield from cases(PHASES[1:], ("fill disk", ENDS, *full))
    yield from cases([AT_REST], ("other seed", STAYS, "holds another experiment", "experiment/seed"),
                     ("unfinished bag", REFUSED_AND_KEPT, "new.bag.active", "rosbag reindex"),
                     ("unfinished trial", "finished, kept, equal"))
    yield from cases([EXPLORING, FIRST], ("begin experiment", NOTICED, "another process is running in the folder"))


CASES = [case for group in (processes, missed, messages, real_time, robot, values, files) for case in group()]
