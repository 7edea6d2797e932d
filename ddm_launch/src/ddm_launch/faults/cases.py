# What can happen to an experiment, and what must come of it.
# SPDX-License-Identifier: BSD-3-Clause
import collections

# Outcomes. finished: summary.yaml says so. ended: the launch ended by itself, without a verdict. named: the output has
# the case's words. undamaged: what was finished before is there, byte by byte, after the fault and after resuming.
# resumes: the same command finishes the experiment. equal: then all files but bags are those of the undisturbed
# experiment, apart from times. zero: in real time, from the third period after the last torque on, none acts.
RECOVERS = "finished, equal"
NOTICED = "finished, named, equal"
ENDS = "ended, named, undamaged, resumes, equal"
REFUSED = "ended, named"
GOES_ON_AFTER_ZERO = "finished, zero"
ENDS_WITH_ZERO = "ended, named, zero, undamaged, resumes"

# name: unique. phase, fault: words for fault_injector, or for damage.py where phase is `at rest`. words: what the
# output must have. quick: also in the small subset. root: needs root, to mount a small or a read-only file system.
Case = collections.namedtuple("Case", "name phase fault expected words quick root")

NODES = ("sim_node", "mpc_node", "trial_recorder", "model_node", "experiment_node", "master")
PHASES = ("random trial", "recording", "training", "evaluation")
RUNS = ("exploring trial", "evaluation")
QUICK = set("""
kill sim_node in random trial|kill trial_recorder in recording|kill model_node in training|kill mpc_node in evaluation
pause mpc_node in random trial|pause experiment_node in training|kill master in evaluation
hold trial_recorder in exploring trial
drop image in exploring trial|double torque in exploring trial|reorder image in evaluation
publish torque in exploring trial|publish image in evaluation|publish model in evaluation|publish clock in evaluation
alter torque nan in exploring trial|alter image size in evaluation
cut chunk of trial.bag at rest|flip model.ddm at rest|flip end of trials.csv at rest|fill disk in random trial
begin experiment in exploring trial
hold mpc_node in evaluation in real time|alter torque nan in exploring trial in real time
mute image in exploring trial in real time
""".replace("\n", "|").split("|")) - {""}


def case(fault, phase, expected, *words, root=False):
    name = "%s %s" % (fault, phase if phase == "at rest" else "in " + phase)
    return Case(name, phase, fault, expected, words, name in QUICK, root)


def processes():
    for node in NODES:
        for phase in PHASES:
            yield case("kill " + node, phase, ENDS, "[%s" % node, "has died")
            yield case("pause " + node, phase, RECOVERS)


def held():
    """A node that stops for good: whoever waits for it says so."""
    for phase in RUNS:
        yield case("hold sim_node", phase, ENDS, "no image after step")
        yield case("hold mpc_node", phase, ENDS, "no torque for frame", "action /run_trial shows no sign of life")
    yield case("hold trial_recorder", "exploring trial", ENDS, "service /stop_recording does not answer")
    yield case("hold model_node", "training", ENDS, "action /train shows no sign of life")
    # Nodes that know each other need no master: the experiment takes longer, since each of its questions has a limit.
    for phase in RUNS + ("training",):
        yield case("hold master", phase, NOTICED, "the ROS master does not answer")


def transport():
    for phase in RUNS:
        yield case("drop image", phase, ENDS, "no torque for frame 7 ", "/fault_injector")
        yield case("drop torque", phase, ENDS, "no torque for frame 7 ", "/fault_injector")
        for verb in ("double", "late", "reorder"):
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
    """The plant does not wait: whatever happens, the motor must stop by itself."""
    for phase in [run + " in real time" for run in RUNS]:
        # As good as dead, to the plant; when it is killed roslaunch ends the plant, too, and there is nothing to see.
        yield case("hold mpc_node", phase, ENDS_WITH_ZERO, "action /run_trial shows no sign of life")
        yield case("pause mpc_node", phase, GOES_ON_AFTER_ZERO)
        yield case("mute image", phase, ENDS_WITH_ZERO, "no image after step", "/fault_injector")
        yield case("mute torque", phase, GOES_ON_AFTER_ZERO)  # a motor that hears nothing does not tell
        for what in ("image", "torque"):
            yield case("late " + what, phase, GOES_ON_AFTER_ZERO)
        for how in ("nan", "inf", "none", "twice", "1e300"):
            yield case("alter torque " + how, phase, ENDS_WITH_ZERO, "torque refused", "/fault_injector")
        yield case("publish torque", phase, ENDS_WITH_ZERO, "torque refused", "/intruder")


def values():
    for phase in RUNS:
        for how in ("nan", "inf", "none", "twice", "1e300"):
            yield case("alter torque " + how, phase, ENDS, "torque refused", "/fault_injector")
        yield case("alter image size", phase, ENDS, "the images change from 51x51 mono8 to 25x25 mono8")
        yield case("alter image encoding", phase, ENDS, "the images change from 51x51 mono8 to 51x51 rgb8")
    yield case("alter image unknown", "exploring trial", ENDS, "the images change from 51x51 mono8 to 51x51 smell")
    yield case("alter image cut", "exploring trial", ENDS, "image refused", "data must hold")
    yield case("alter image unstamped", "exploring trial", ENDS, "image refused", "it has no stamp")


def files():
    for record in ("version", "header", "chunk", "index", "connection", "chunk_info"):
        yield case("cut %s of trial.bag" % record, "at rest", ENDS, "trial_000/trial.bag")
    yield case("flip chunk of trial.bag", "at rest", ENDS, "trial_000/trial.bag")
    yield case("remove trial.bag", "at rest", ENDS, "trial_000/trial.bag is missing", "put it back")
    yield case("flip end of trials.csv", "at rest", ENDS, "trials.csv, line 2")
    yield case("flip head of trials.csv", "at rest", ENDS, "trials.csv, line 1")
    yield case("flip digit of trials.csv", "at rest", ENDS, "trials.csv is not as it was written")
    yield case("flip config.yaml", "at rest", ENDS, "use another folder")
    yield case("flip model.ddm", "at rest", REFUSED, "model.ddm", "is damaged (wrong checksum)")
    yield case("flip head of model.ddm", "at rest", REFUSED, "model.ddm")
    yield case("cut model.ddm", "at rest", REFUSED, "model.ddm")
    yield case("read-only folder", "at rest", ENDS, "cannot write into the folder", root=True)
    for phase in ("random trial", "recording", "training", "evaluation"):
        yield case("fill disk", phase, ENDS, "cannot", "No space left on device", root=True)


def folders():
    yield case("begin experiment", "exploring trial", NOTICED, "another experiment is running in the folder")
    yield case("begin experiment", "random trial", NOTICED, "another experiment is running in the folder")


CASES = [each for group in (processes, held, transport, intruders, clocks, real_time, values, files,
                                        folders) for each in group()]
