# Pages: links are valid, tables contain the numbers of the committed results, and the first commands work.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re

import roslib.packages

import pages
import rooms  # noqa: F401
from ddm_study.pages import BLOCK, Functions, filled
from processes import free_port, has_mujoco, line_by_line, output_of

LIMIT_S = 300.0  # time limit for the commands of a page


def test_links_lead_to_files_and_headings_that_are_there():
    dead = [(page, path, anchor) for page in pages.page_paths() for path, anchor in pages.links(page)
            if not os.path.exists(os.path.join(pages.CHECKOUT, path))
            or (anchor and anchor not in pages.anchors(pages.read(path)))]
    assert not dead


def test_programs_and_launch_files_that_pages_start_are_there():
    missing = set()
    for page in pages.page_paths():
        for package, name in re.findall(r"\bros(?:run|launch) (?:--wait )?(ddm_\w+) (\w[\w.]*)", pages.read(page)):
            find = roslib.packages.find_resource if name.endswith(".launch") else roslib.packages.find_node
            if package != "ddm_cart" and not find(package, name):  # the example is in another workspace
                missing.add(name)
    assert missing == (set() if has_mujoco() else {"new_plant"})


def test_marked_blocks_have_the_numbers_of_the_committed_tables():
    texts = {page: pages.read(page) for page in pages.page_paths()}
    marked = {page: text for page, text in texts.items() if BLOCK.search(text)}
    assert len(marked) >= 5
    functions = Functions(os.path.join(rooms.PACKAGE, "results"))
    assert not [page for page, text in marked.items() if filled(text, functions) != text], "run: rosrun ddm_launch study pages"


def test_a_block_is_filled_and_the_rest_of_the_page_stays(tmp_path):
    (tmp_path / "trials.csv").write_text("seed,trial,frames,success,final_error\n0,0,100,1,1\n1,0,100,0,9\n2,0,200,1,1\n")
    page = "Before\n\n<!-- fill\n| {of('trials.csv', 'frames == 100')} |\n-->\n\n| old |\n\n<!-- filled -->\nAfter\n"
    assert filled(page, Functions(str(tmp_path))) == page.replace("| old |", "| 1 of 2 |")


def test_the_commands_of_the_first_pages_run_as_they_are(tmp_path):
    prefix = next(path for path in os.environ["CMAKE_PREFIX_PATH"].split(":")
                  if os.path.isfile(os.path.join(path, "setup.bash")))
    for space in ("devel", "install"):
        (tmp_path / "ddm_ws" / space).mkdir(parents=True)
        (tmp_path / "ddm_ws" / space / "setup.bash").write_text(". %s/setup.bash\n" % prefix)
    for page in ("doc/install.md", "doc/first_run.md"):
        commands = "\n".join(pages.blocks(pages.read(page), "bash"))
        commands = commands.replace(" rviz:=true", "")  # the page describes this for machines without a screen
        environment = dict(line_by_line(), HOME=str(tmp_path), ROS_HOME=str(tmp_path / "ros"),
                           ROS_MASTER_URI="http://localhost:%d" % free_port())
        output_of(["bash", "-c", "set -e\n" + commands], LIMIT_S, environment=environment, folder=str(tmp_path))
    assert (tmp_path / "film.webp").exists()
