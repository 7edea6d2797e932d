# Reads settings from YAML files, and compares settings.
# SPDX-License-Identifier: BSD-3-Clause
import yaml

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # CSafeLoader is ten times as fast


def read_yaml(path):
    """Reads the mapping in a YAML file. Returns an empty mapping if the file is missing or has other content."""
    try:
        with open(path) as stream:
            tree = yaml.load(stream, Loader=LOADER)
    except (OSError, UnicodeDecodeError, yaml.YAMLError):
        return {}
    return tree if isinstance(tree, dict) else {}


def flat(tree, prefix=""):
    """Flattens nested mappings to {"block/key": value}."""
    entries = {}
    for key, value in tree.items():
        entries.update(flat(value, "%s%s/" % (prefix, key)) if isinstance(value, dict) else {prefix + str(key): value})
    return entries


def differences(there, here, may_differ=()):
    """Returns one line of text for each key whose values differ. may_differ: keys that are not compared."""
    there, here = flat(there), flat(here)
    return ["%s: %s there, %s here" % (key, there.get(key, "nothing"), here.get(key, "nothing"))
            for key in sorted(set(there) | set(here)) if key not in may_differ and there.get(key) != here.get(key)]
