# Writes files that appear, or change, only when they are complete.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import os
import re
import secrets


def write_file(path, content):
    """Writes text (as UTF-8) or bytes. If several processes write at once, one of their files survives, whole. A failure,
    for example a full disk, leaves the file as it was and nothing next to it.

    Raises OSError, whose text names the file and the reason, if it cannot be written or is not a regular file: a device
    or a pipe would be replaced. A symbolic link stays one.
    """
    if os.path.exists(path) and not os.path.isfile(path):
        raise OSError("cannot write %s: it is not a regular file" % path)
    data = content.encode("utf-8") if isinstance(content, str) else content
    target = os.path.realpath(path)
    unfinished = "%s.unfinished.%s" % (target, secrets.token_hex(8))
    try:
        with open(unfinished, "xb") as stream:  # with the permissions that the umask gives
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(unfinished, target)
    except OSError as error:
        raise OSError("cannot write %s: %s" % (path, error.strerror)) from error
    finally:
        with contextlib.suppress(OSError):
            os.remove(unfinished)  # already renamed if all went well


def remove_unfinished(folder):
    """Removes what write_file() left behind in a folder when its process was killed. Only for a folder in which nobody else
    writes."""
    for name in os.listdir(folder):
        if re.search(r"\.unfinished\.[0-9a-f]+$", name):
            with contextlib.suppress(OSError):
                os.remove(os.path.join(folder, name))
