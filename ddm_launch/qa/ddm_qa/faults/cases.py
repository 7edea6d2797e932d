# What can happen to an experiment, and what must come of it.
# SPDX-License-Identifier: BSD-3-Clause
import collections

# Outcomes. finished: summary.yaml says so. ended: the launch ended by itself, without a verdict. named: the output has
# the case's words. undamaged: what was finished before the fault, at least one trial, is there, byte by byte, after the
# fault and after resuming. resumes: the same command finishes the experiment. equal: then all files but bags are those of
# the undisturbed experiment, apart from times. zero: in real time, from the third period after the last torque on, none
# acts. in order: in real time, of two messages in the wrong order the older one has no effect. learned what acted: in the
# bag of the trial, an image has the torque that acted after it or none, and some have none. unchanged: the command
# left every byte of the run folder. refused: the launch left no bag. acts when restored: with the fault taken away, the
# same launch leaves one. kept: a bag that was not completed is still there, byte by byte. one is whole: of two files
# written at once under one name.
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
GOES_ON_IN_ORDER = "finished, in order"
ENDS_WITH_ZERO = "ended, named, zero, undamaged, resumes"

# name: unique. phase, fault: words for fault_injector, or for damage.py where phase is `at rest`. words: what the
# output must have. quick: also in the small subset. root: needs root, to mount a small or a read-only file system.
Case = collections.namedtuple("Case", "name phase fault expected words quick root")

NODES = ("sim_node", "mpc_node", "trial_recorder", "model_node", "experiment_node", "master")
AT_REST, REAL_TIME, ON_A_ROBOT = "at rest", " in real time", " on a robot"  # the latter two: ends of names
FIRST, EXPLORING, RECORDING, TRAINING, EVALUATION = PHASES = (
    "random trial", "exploring trial", "recording", "training", "evaluation")
RUNS = (EXPLORING, EVALUATION)
QUICK = set("""
kill sim_node in random trial|kill trial_recorder in recording|kill mpc_node in evaluation
pause mpc_node in exploring trial|kill master in evaluation
lose sim_node in exploring trial|oversleep mpc_node in evaluation
drop image in exploring trial|double torque in exploring trial|repeat image in evaluation
publish torque in exploring trial|publish image in evaluation|publish clock in evaluation
alter torque nan in exploring trial|alter image size in evaluation
cut chunk of trial.bag at rest|flip model.ddm at rest|flip end of trials.csv at rest|unfinished bag at rest|other seed at rest|fill disk in random trial
begin experiment in exploring trial
hold mpc_node in evaluation in real time|alter torque nan in exploring trial in real time
mute image in exploring trial in real time|swap torque in exploring trial in real time
future image in exploring trial on a robot
""".replace("\n", "|").split("|")) - {""}


def case(fault, phase, expected, *words, root=False):
    name = "%s %s" % (fault, phase if phase == AT_REST else "in " + phase)
    return Case(name, phase, fault, expected, words, name in QUICK, root)


def processes():
    for node in NODES:
        for phase in PHASES:
            yield case("kill " + node, phase, KILLED_IN_FIRST_TRIAL if phase == FIRST else KILLED)
            if phase != FIRST:
                yield case("pause " + node, phase, RECOVERS)


def missed():
    """A node that dies out of roslaunch's sight, is stopped for longer than anybody waits, or for good: those who wait
    for it say so."""
    for verb in ("lose", "oversleep", "hold"):
        for phase in RUNS:
            yield case(verb + " sim_node", phase, ENDS, "no image after step", "action /run_trial")
            yield case(verb + " mpc_node", phase, ENDS, "no torque for frame", "action /run_trial")
        yield case(verb + " trial_recorder", EXPLORING, ENDS, "service /stop_recording does not answer")
        yield case(verb + " model_node", TRAINING, ENDS, "action /train shows no sign of life")
    yield case("lose sim_node", RECORDING, ENDS, "service /stop_recording")  # nobody says whether the last torque acted
    yield case("lose sim_node", TRAINING, ENDS, "service /reset does not answer")
    for phase in (RECORDING, TRAINING):
        yield case("lose mpc_node", phase, ENDS, "action /run_trial shows no sign of life")
    # A node that knows others needs no master: the experiment takes longer, since each of its questions has a limit.
    for phase in RUNS + (TRAINING,):
        yield case("hold master", phase, NOTICED, "the ROS master does not answer")


def transport():
    for phase in RUNS:
        yield case("drop image", phase, ENDS, "no torque for frame 7 ", "/fault_injector")
        yield case("drop torque", phase, ENDS, "no torque for frame 7 ", "/fault_injector")
        for verb in ("double", "late", "repeat"):
            for what in ("image", "torque"):
                yield case("%s %s" % (verb, what), phase, RECOVERS)


def intruders():
    for phase in RUNS:
        yield case("publish torque", phase, ENDS, "/intruder")
        yield case("publish image", phase, ENDS, "/intruder")
        yield case("publish model", phase, ENDS, "/intruder")
        yield case("publish clock", phase, ENDS, "/intruder")


def clocks():
    """No node waits for time to pass."""
    for phase in RUNS:
        yield case("mute clock", phase, RECOVERS)


def real_time():
    """The plant does not wait: whatever happens, the motor must stop by itself, and no torque that came too late or
    never reached it may be learned from."""
    for run in RUNS:
        phase, learns = run + REAL_TIME, ", learned what acted" if run == EXPLORING else ""
        # As good as dead, to the plant; when it is killed roslaunch ends the plant, too, and there is nothing to see.
        yield case("hold mpc_node", phase, ENDS_WITH_ZERO, "action /run_trial shows no sign of life")
        yield case("pause mpc_node", phase, GOES_ON_AFTER_ZERO + learns)
        yield case("mute image", phase, ENDS_WITH_ZERO, "no image after step", "/fault_injector")
        yield case("mute torque", phase, GOES_ON_AFTER_ZERO + learns)  # a motor that hears nothing says nothing
        for what in ("image", "torque"):
            yield case("late " + what, phase, GOES_ON_AFTER_ZERO + learns)
            yield case("swap " + what, phase, GOES_ON_IN_ORDER + learns)
        for how in ("nan", "inf", "none", "twice", "1e300"):
            yield case("alter torque " + how, phase, ENDS_WITH_ZERO, "torque refused", "/fault_injector")
        yield case("publish torque", phase, ENDS_WITH_ZERO, "torque refused", "/intruder")


def planning():
    """Plans that would go on for minutes."""
    phase = "every run" + REAL_TIME
    yield case("long plans", phase, "ended, named", "no plan for step 1", "mpc/time_budget")
    yield case("long plans with a budget", phase, "finished, in time")


def robot():
    """A wrong clock, or a joint beyond its limits, must bring zero torque within two dt and 50 ms."""
    for phase in [run + ON_A_ROBOT for run in RUNS]:
        yield case("future image", phase, ENDS_WITH_ZERO, "no image after step")  # and then silence
        yield case("set clock forward", phase, GOES_ON_NAMED_AFTER_ZERO, "the camera's clock has jumped forward")
        yield case("set clock back", phase, GOES_ON_NAMED_AFTER_ZERO, "before the one that came before it")
        yield case("exceed position", phase, ENDS_WITH_ZERO, "robot/position_limits", "was cancelled")
        yield case("exceed speed", phase, ENDS_WITH_ZERO, "robot/speed_limit", "was cancelled")


def values():
    for phase in RUNS:
        for how in ("nan", "inf", "none", "twice", "1e300"):
            yield case("alter torque " + how, phase, ENDS, "torque refused", "/fault_injector")
        yield case("alter image size", phase, ENDS, "the images change from 51x51 mono8 to 25x25 mono8")
        yield case("alter image encoding", phase, ENDS, "the images change from 51x51 mono8 to 51x51 rgb8")
    yield case("alter image unknown", EXPLORING, ENDS, "the images change from 51x51 mono8 to 51x51 smell")
    yield case("alter image cut", EXPLORING, ENDS, "image refused", "data must hold")
    yield case("alter image unstamped", EXPLORING, ENDS, "image refused", "it has no stamp")


def files():
    for record in ("version", "header", "chunk", "index", "connection", "chunk_info"):
        yield case("cut %s of trial.bag" % record, AT_REST, STAYS, "trial_000/trial.bag")
    yield case("flip chunk of trial.bag", AT_REST, STAYS, "trial_000/trial.bag")
    yield case("remove trial.bag", AT_REST, STAYS, "trial_000/trial.bag is missing", "put it back")
    yield case("flip end of trials.csv", AT_REST, STAYS, "trials.csv is not as it was written")
    yield case("flip head of trials.csv", AT_REST, STAYS, "trials.csv, line 1")
    yield case("flip digit of trials.csv", AT_REST, STAYS, "trials.csv is not as it was written")
    yield case("flip config.yaml", AT_REST, STAYS, "use another folder")
    yield case("flip model.ddm", AT_REST, REFUSED, "model.ddm", "is damaged (wrong checksum)")
    yield case("flip head of model.ddm", AT_REST, REFUSED, "model.ddm")
    yield case("cut model.ddm", AT_REST, REFUSED, "model.ddm")
    yield case("read-only folder", AT_REST, STAYS, "cannot write into the folder", root=True)
    for phase in PHASES:
        yield case("fill disk", phase, ENDS_IN_FIRST_TRIAL if phase == FIRST else ENDS, "cannot",
                   "No space left on device", root=True)


def folders():
    yield case("other seed", AT_REST, STAYS, "holds another experiment", "experiment/seed")
    yield case("unfinished bag", AT_REST, REFUSED_AND_KEPT, "new.bag.active", "rosbag reindex")
    yield case("unfinished trial", AT_REST, "finished, kept, equal")
    yield case("two writers", AT_REST, "one is whole")
    yield case("begin experiment", "exploring trial", NOTICED, "another experiment is running in the folder")
    yield case("begin experiment", "random trial", NOTICED, "another experiment is running in the folder")


CASES = [each for group in (processes, missed, transport, intruders, clocks, real_time, planning, robot, values, files,
                                        folders) for each in group()]
