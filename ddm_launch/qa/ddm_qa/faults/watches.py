# What motors do after a fault, and what is learned of it, judged by the torques that were sent and those that acted.
# SPDX-License-Identifier: BSD-3-Clause
import bisect
import time

import rosbag

PERIODS_HELD = 2      # for which a plant holds a torque
FEWEST_FRAMES = 3     # that tell anything
FEWEST_PAIRS = 5      # of image and torque in a bag
FEWEST_EFFORTS = 20   # of a robot, at 100 Hz


class MotorWatch:
    """In real time nothing may act, two periods after the last torque that was meant for the motor."""

    def __init__(self, stays_off):
        """stays_off: a torque that was refused must switch the motor off whatever comes after it."""
        self._stays_off, self._acted, self._passed, self._fault = stays_off, [], [], None

    def torque_has_acted(self, end, torque):
        """end: of the period in which it did."""
        self._acted.append((end, torque))

    def torque_passes(self, now, stamp):
        """stamp: of the image that it answers."""
        self._passed.append((now, stamp))

    def fault_begins(self, now, stamp):
        """stamp: of the image on show."""
        self._fault = now, stamp

    def verdict(self):
        """`zero`, or what was seen instead."""
        if self._fault is None:
            return "no fault"
        since, until = self._quiet_time()
        after = [torque for end, torque in self._acted if since < end < until][PERIODS_HELD:]
        if not any(torque for end, torque in self._acted if end <= since):
            return "no torque had acted before"
        if any(after):
            return "driven: " + " ".join("%g" % torque for torque in after)
        return "zero" if len(after) >= FEWEST_FRAMES else "only %d frames seen" % len(after)

    def _quiet_time(self):
        """From the last torque that answers an image before the fault to the first one that answers a later one."""
        begin, stamp = self._fault
        since = max([begin] + [now for now, answered in self._passed if answered < stamp])
        later = [now for now, answered in self._passed if answered >= stamp and now > begin]
        return since, min(later) if later and not self._stays_off else float("inf")


class Effort:
    """What a robot's motor gets, and when."""

    def __init__(self):
        self._efforts, self._fault, self._until = [], None, None

    def acts(self):
        return bool(self._efforts) and self._efforts[-1][1] != 0.0

    def take(self, effort):
        self._efforts.append((time.monotonic(), effort.data))

    def fault_begins(self, lasts=float("inf")):
        self._fault = time.monotonic()
        self._until = self._fault + lasts

    def verdict(self, limit):
        """`zero`, or what was seen instead. limit: after which there may be no torque [s]."""
        after = [effort for now, effort in self._efforts if self._fault + limit < now < self._until]
        if any(after):
            return "driven: " + " ".join("%g" % effort for effort in after if effort)[:60]
        return "zero" if len(after) >= FEWEST_EFFORTS else "only %d torques seen" % len(after)


def learned(bag_path, acted):
    """`learned what acted`, or what was seen instead. acted: (stamp of an image [ns], torque that acted before it) of all
    frames, in order."""
    stamps = [stamp for stamp, _ in acted]
    images, torques = set(), {}
    with rosbag.Bag(bag_path) as bag:
        for topic, message, _ in bag.read_messages(["camera/image_raw", "torque"]):
            if topic == "torque":
                torques[message.header.stamp.to_nsec()] = message.torque[0]
            else:
                images.add(message.header.stamp.to_nsec())
    pairs = images & set(torques)
    wrong = []
    for stamp in sorted(pairs):
        after = bisect.bisect_right(stamps, stamp)
        if after == len(stamps) or acted[after][1] != torques[stamp]:
            wrong.append(stamp)
    if wrong:
        return "%d of %d pairs have a torque that did not act" % (len(wrong), len(pairs))
    if len(pairs) < FEWEST_PAIRS:
        return "only %d pairs" % len(pairs)
    return "learned what acted" if pairs != images else "no image is without a torque"
