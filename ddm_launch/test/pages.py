# Reads the pages of this repository: headings, links and commands.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re

CHECKOUT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def page_paths():
    """All pages, relative to the checkout."""
    return sorted(os.path.relpath(path, CHECKOUT) for path in glob.glob(os.path.join(CHECKOUT, "**", "*.md"), recursive=True))


def read(path):
    with open(os.path.join(CHECKOUT, path), encoding="utf-8") as stream:
        return stream.read()


def blocks(text, language):
    """Contents of the fenced blocks of a language."""
    return [content for name, content in BLOCK.findall(text) if name == language]


def anchors(text):
    """Anchors of all headings of a page, as repository hosts compute them."""
    found = []
    for heading in re.findall(r"^#+ (.*)$", BLOCK.sub("", text), re.MULTILINE):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
        slug = re.sub(r"[^\w\- ]", "", plain.strip().lower()).replace(" ", "-")
        found.append(slug if slug not in found else "%s-%d" % (slug, found.count(slug)))
    return found


def links(page):
    """(path relative to the checkout, anchor or "") of each link to a file or heading of this repository."""
    found = []
    for link in re.findall(r"\]\(([^()\s]+)\)", BLOCK.sub("", read(page))):
        path, _, anchor = link.partition("#")
        if not re.match("https?:", link):
            found.append((os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page, anchor))
    return found
