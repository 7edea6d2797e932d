# Ctrl-C and its like as an exception, so that a sweep ends what it has started.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import signal

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interrupted(BaseException):
    """A signal asks to end. Not an Exception: nothing but the program itself may handle it."""

    def __init__(self, number):
        super().__init__("interrupted by %s" % signal.Signals(number).name)
        self.number = number


@contextlib.contextmanager
def raised_as_exception():
    """Within, the first signal raises Interrupted in the main thread; those after it are ignored, so that the ending
    that it begins comes to its end."""
    def on_signal(number, _):
        for each in SIGNALS:
            signal.signal(each, signal.SIG_IGN)
        raise Interrupted(number)

    before = {number: signal.getsignal(number) for number in SIGNALS}
    for number in SIGNALS:
        if number != signal.SIGHUP or before[number] != signal.SIG_IGN:  # under nohup a lost terminal is not a reason
            signal.signal(number, on_signal)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextlib.contextmanager
def held_back():
    """Within, signals wait: for what must not be cut in two."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
