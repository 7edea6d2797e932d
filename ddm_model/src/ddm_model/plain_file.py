# Writes files that appear or change only when they are complete.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import os
import re
import secrets


def write_file(path, content):
    """Writes text (as UTF-8) or bytes. If several processes write at once, the file has the complete content of one of
    them. A failure, for example a full disk, leaves the old file unchanged and no other file next to it.

    A symbolic link stays a link. Raises OSError with file name and reason if the file cannot be written, or if it is
    not a regular file, because the write would replace a device or a pipe.
    """
    if os.path.exists(path) and not os.path.isfile(path):
        raise OSError("cannot write %s: it is not a regular file" % path)
    data = content.encode("utf-8") if isinstance(content, str) else content
    target = os.path.realpath(path)
    unfinished = "%s.unfinished.%s" % (target, secrets.token_hex(8))
    try:
        with open(unfinished, "xb") as stream:  # "xb" applies the permissions of the umask
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(unfinished, target)
    except OSError as error:
        raise OSError("cannot write %s: %s" % (path, error.strerror)) from error
    finally:
        with contextlib.suppress(OSError):
            os.remove(unfinished)  # the file no longer exists if it was renamed


def remove_unfinished(folder):
    """Removes unfinished files that a killed process of write_file() has left in a folder. No other process may write
    into the folder at the same time."""
    for name in os.listdir(folder):
        if re.search(r"\.unfinished\.[0-9a-f]+$", name):
            with contextlib.suppress(OSError):
                os.remove(os.path.join(folder, name))
