# What comes of two messages that arrive in the wrong order: of the older one, nothing.
# SPDX-License-Identifier: BSD-3-Clause
import threading

PERIODS = 4   # after the swap in which the older torque would act
FEWEST = 3    # of them that must have been seen


class OrderWatch:
    """Takes the same calls as MotorWatch, apart from the fault's."""

    def __init__(self):
        self._lock, self._swapped = threading.Lock(), None
        self._answers, self._acted = [], []  # since the swap

    def swap(self, stamp, torque):
        """stamp, torque: of the older message, whose torque is None if it is an image."""
        with self._lock:
            self._swapped = stamp, torque

    def torque_has_acted(self, _, torque):
        with self._lock:
            if self._swapped:
                self._acted.append(torque)

    def torque_passes(self, _, stamp):
        """stamp: of the image that it answers."""
        with self._lock:
            if self._swapped:
                self._answers.append(stamp)

    def verdict(self):
        """`in order`, or what was seen instead."""
        with self._lock:
            if self._swapped is None:
                return "no fault"
            stamp, torque = self._swapped
            if len(self._acted) < FEWEST:
                return "only %d frames seen" % len(self._acted)
            if torque is None:  # the newer image may be lost: only the newest one in the queue is answered
                return "in order" if self._answers == sorted(self._answers) else "the older image was answered late"
            return "the older torque acted" if torque in self._acted[:PERIODS] else "in order"
