# What motors do after a fault, judged by the torques that they were sent and those that acted. Times in seconds.
# SPDX-License-Identifier: BSD-3-Clause
import time

PERIODS_HELD = 2      # for which a plant holds a torque
PERIODS_SWAPPED = 4   # after a swap, in which the older torque would act
FEWEST_FRAMES = 3     # that tell anything
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


class OrderWatch:
    """Of two messages that arrive in the wrong order the older one must come to nothing."""

    def __init__(self):
        self._swapped, self._answers, self._acted = None, [], []

    def swap(self, stamp, torque):
        """stamp, torque: of the older message, whose torque is None if it is an image."""
        self._swapped = stamp, torque

    def torque_has_acted(self, _, torque):
        if self._swapped:
            self._acted.append(torque)

    def torque_passes(self, _, stamp):
        if self._swapped:
            self._answers.append(stamp)

    def verdict(self):
        """`in order`, or what was seen instead."""
        if self._swapped is None:
            return "no fault"
        _, torque = self._swapped
        if len(self._acted) < FEWEST_FRAMES:
            return "only %d frames seen" % len(self._acted)
        if torque is None:  # the newer image may be lost: only the newest one in the queue is answered
            return "in order" if self._answers == sorted(self._answers) else "the older image was answered late"
        return "the older torque acted" if torque in self._acted[:PERIODS_SWAPPED] else "in order"


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
