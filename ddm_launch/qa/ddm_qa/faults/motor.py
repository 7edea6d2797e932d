# What a motor does in real time after a fault: nothing, two periods after the last torque that was meant for it.
# SPDX-License-Identifier: BSD-3-Clause
import threading

PERIODS_HELD = 2  # for which a plant holds a torque
FEWEST = 3        # frames without torque, after those, that tell anything


class MotorWatch:
    """Told of each torque on its way to the plant, and of each torque that has acted. Times in seconds."""

    def __init__(self, stays_off):
        """stays_off: a torque that was refused must switch the motor off whatever comes after it."""
        self._stays_off, self._lock = stays_off, threading.Lock()
        self._acted, self._passed, self._fault = [], [], None

    def torque_has_acted(self, end, torque):
        """end: of the period in which it did."""
        with self._lock:
            self._acted.append((end, torque))

    def torque_passes(self, now, stamp):
        """stamp: of the image that it answers."""
        with self._lock:
            self._passed.append((now, stamp))

    def fault_begins(self, now, stamp):
        """stamp: of the image on show."""
        with self._lock:
            self._fault = now, stamp

    def verdict(self):
        """`zero`, or what was seen instead."""
        with self._lock:
            if self._fault is None:
                return "no fault"
            since, until = self._quiet_time()
            before = [torque for end, torque in self._acted if end <= since]
            after = [torque for end, torque in self._acted if since < end < until][PERIODS_HELD:]
        if not any(before):
            return "no torque had acted before"
        if any(after):
            return "driven: " + " ".join("%g" % torque for torque in after)
        return "zero" if len(after) >= FEWEST else "only %d frames seen" % len(after)

    def _quiet_time(self):
        """From the last torque that answers an image before the fault to the first one that answers a later one."""
        begin, stamp = self._fault
        since = max([begin] + [now for now, answered in self._passed if answered < stamp])
        later = [now for now, answered in self._passed if answered >= stamp and now > begin]
        return since, min(later) if later and not self._stays_off else float("inf")
