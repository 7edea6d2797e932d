# The pages of this repository as a reader meets them: headings, links, tables, messages and commands.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re

CHECKOUT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
PACKAGES = ["ddm_launch", "ddm_model", "ddm_mpc", "ddm_msgs", "ddm_sim"]
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def page_paths():
    """All pages, relative to the checkout."""
    patterns = ["README.md", "CONTRIBUTING.md", "doc/**/*.md", "examples/**/*.md"] + [package + "/**/*.md" for package in PACKAGES]
    return sorted({os.path.relpath(path, CHECKOUT) for pattern in patterns
                   for path in glob.glob(os.path.join(CHECKOUT, pattern), recursive=True)})


def read(path):
    with open(os.path.join(CHECKOUT, path), encoding="utf-8") as stream:
        return stream.read()


def blocks(text, language=None):
    """Contents of the fenced blocks, of one language if given."""
    return [content for name, content in BLOCK.findall(text) if language is None or name == language]


def without_blocks(text):
    return BLOCK.sub("", text)


def anchors(text):
    """What a link to a heading of this page may be, as hosts of repositories make it of the heading."""
    found = []
    for heading in re.findall(r"^#+ (.*)$", without_blocks(text), re.MULTILINE):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
        slug = re.sub(r"[^\w\- ]", "", plain.strip().lower()).replace(" ", "-")
        found.append(slug if slug not in found else "%s-%d" % (slug, found.count(slug)))
    return found


def links(text):
    """Targets of links and pictures."""
    return re.findall(r"\]\(([^()\s]+)\)", without_blocks(text))


def tables(text):
    """Each table as a list of rows of cells; the head is the first row. A | in `code` parts no cells."""
    out = [[]]
    for line in without_blocks(text).splitlines() + [""]:
        if line.startswith("|"):
            if not re.match(r"^\|[\s:|-]+\|$", line) or not out[-1]:
                masked = re.sub(r"`[^`]*`", lambda code: code.group(0).replace("|", "\0"), line.strip().strip("|"))
                out[-1].append([cell.strip().replace("\0", "|") for cell in masked.split("|")])
        elif out[-1]:
            out.append([])
    return out[:-1]


def code_spans(text):
    return re.findall(r"`([^`]+)`", text)


def section(text, heading):
    """What stands below a heading, down to the next one of its level or above."""
    start = re.search(r"^(#+) %s$" % re.escape(heading), text, re.MULTILINE)
    if not start:
        raise AssertionError("no heading '%s'" % heading)
    rest = text[start.end():]
    end = re.search(r"^#{1,%d} " % len(start.group(1)), BLOCK.sub(lambda block: "." * len(block.group(0)), rest),
                    re.MULTILINE)
    return rest[:end.start()] if end else rest
