# Settings in YAML files, and in what two of them differ.
# SPDX-License-Identifier: BSD-3-Clause
import yaml

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # the former is ten times as fast


def read_yaml(path):
    """The mapping in a YAML file; empty if the file is missing or holds something else."""
    try:
        with open(path) as stream:
            tree = yaml.load(stream, Loader=LOADER)
    except (OSError, UnicodeDecodeError, yaml.YAMLError):
        return {}
    return tree if isinstance(tree, dict) else {}


def flat(tree, prefix=""):
    """{"block/key": value} of nested mappings."""
    entries = {}
    for key, value in tree.items():
        entries.update(flat(value, "%s%s/" % (prefix, key)) if isinstance(value, dict) else {prefix + str(key): value})
    return entries


def differences(there, here, may_differ=()):
    """Lines that name each key whose value is not the same."""
    there, here = flat(there), flat(here)
    return ["%s: %s there, %s here" % (key, there.get(key, "nothing"), here.get(key, "nothing"))
            for key in sorted(set(there) | set(here)) if key not in may_differ and there.get(key) != here.get(key)]
