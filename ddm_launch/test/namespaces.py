# Hides folders and simulates machines by Linux namespaces, which end with the program.
# SPDX-License-Identifier: BSD-3-Clause
import shutil
import subprocess

import pages

HIDE = 'while [ "$1" != -- ]; do mount -t tmpfs none "$1" || exit; shift; done; shift; exec "$@"'


def hiding(folders):
    """Words to put before a command, which then sees these folders as empty."""
    return ["unshare", "--mount", "sh", "-c", HIDE, "sh"] + list(folders) + ["--"]


def why_not(*kinds):
    """The reason why this process cannot make namespaces of these kinds (mount, net); empty if it can."""
    done = subprocess.run(["unshare"] + ["--" + kind for kind in kinds] + ["ip", "link"],
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, universal_newlines=True)
    return "" if done.returncode == 0 else "no namespaces (%s): run it as root" % done.stderr.strip()


def why_no_nft():
    """The reason why this process cannot filter packets in its namespaces; empty if it can."""
    return why_not("net", "mount") or ("" if shutil.which("nft") else "no program nft: install nftables")


def nft_rule(peers=False):
    """The nftables rule of doc/reference/network.md. peers: include the line for several machines."""
    rule, = pages.blocks(pages.read("doc/reference/network.md"), "nft")
    return rule.replace("# ip saddr", "ip saddr") if peers else rule


class Network:
    """A context manager that simulates machines on one wire. Each machine has an address and some folders of its
    own."""

    def __init__(self):
        self._holders = []
        self._hub = self._hold(["unshare", "--net"])
        self._run(self._hub, "ip", "link", "add", "wire", "type", "bridge")
        self._run(self._hub, "ip", "link", "set", "wire", "up")

    def addMachine(self, own_folders):
        """Returns (address of the new machine, words to put before a command that runs there)."""
        holder = self._hold(["unshare", "--net"] + hiding(own_folders))
        number = len(self._holders) - 1  # the hub is not counted
        address, plug = "10.0.0.%d" % number, "plug%d" % number
        self._run(self._hub, "ip", "link", "add", plug, "type", "veth", "peer", "name", "eth0", "netns",
                  str(holder.pid))
        self._run(self._hub, "ip", "link", "set", plug, "master", "wire", "up")
        self._run(holder, "ip", "address", "add", address + "/24", "dev", "eth0")
        for link in ("lo", "eth0"):
            self._run(holder, "ip", "link", "set", link, "up")
        return address, self._enter(holder)

    def load(self, enter, rules):
        """Loads rules into nftables. enter: words to put before a command on that machine. rules: text for nft."""
        subprocess.run(enter + ["nft", "-f", "-"], input=rules, universal_newlines=True, check=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for holder in self._holders:
            holder.stdin.close()
            holder.wait()
            holder.stdout.close()

    def _hold(self, words):
        """Starts a process that keeps its namespaces alive. The process ends with this one."""
        holder = subprocess.Popen(words + ["sh", "-c", "echo ready; exec cat"], stdin=subprocess.PIPE,
                                  stdout=subprocess.PIPE)
        self._holders.append(holder)
        if holder.stdout.readline() != b"ready\n":
            raise RuntimeError("no namespaces by: %s" % " ".join(words))
        return holder

    @staticmethod
    def _enter(holder):
        return ["nsenter", "--net", "--mount", "--target", str(holder.pid)]

    def _run(self, holder, *command):
        subprocess.run(self._enter(holder) + list(command), check=True, stdin=subprocess.DEVNULL)
