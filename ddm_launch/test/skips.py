# Import this where cases may be skipped: rosunit alone reports them as passed, and a class of them as no case at all.
# SPDX-License-Identifier: BSD-3-Clause
from xml.etree import ElementTree

from rosunit import xmlrunner

xml_of_rosunit = xmlrunner._XMLTestResult.xml


def xml(result, *arguments):
    """The report of rosunit, in which each skipped case has the reason."""
    tree = xml_of_rosunit(result, *arguments)
    cases = {(case.get("classname"), case.get("name")): case for case in tree.getroot().iter("testcase")}
    for test, reason in result.skipped:
        class_name, _, name = test.id().rpartition(".")
        case = cases.get((class_name, name))
        if case is None:
            case = ElementTree.SubElement(tree.getroot(), "testcase", classname=class_name, name=name)
        ElementTree.SubElement(case, "skipped", message=reason)
    return tree


xmlrunner._XMLTestResult.xml = xml
