# Writes files that appear, or change, only when they are complete.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import os


def write_file(path, content):
    """Writes text (as UTF-8) or bytes. What fails, a full disk too, leaves the file as it was and nothing beside it.

    Raises OSError, whose text names the file and the reason, if it cannot be written or is no plain file: a device or a
    pipe would be replaced. A symbolic link stays one.
    """
    if os.path.exists(path) and not os.path.isfile(path):
        raise OSError("cannot write %s: it is no plain file" % path)
    target = os.path.realpath(path)
    unfinished = target + ".unfinished"
    try:
        with open(unfinished, "wb") as stream:
            stream.write(content.encode("utf-8") if isinstance(content, str) else content)
        os.replace(unfinished, target)
    except OSError as error:
        raise OSError("cannot write %s: %s" % (path, error.strerror)) from error
    finally:
        with contextlib.suppress(OSError):
            os.remove(unfinished)  # not there any more if all went well
