# Numbers on pages are those of the committed tables: page_numbers.yaml says which number comes from where.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re
import tempfile
import unittest

import pages
from page_numbers import RESULTS, Page, agree, checked_pages, read_rows


class PageNumbersTest(unittest.TestCase):
    maxDiff = None
    PAGE = "# A\n\n| runs | 100 images | 1,500 |\n| --- | --- | --- |\n| ours | 2 | 3 |\n\nAbout 1.67 of\n3.\n"
    TABLE = {"table": "| runs", "keys": ["name"], "words": {"ours": "a", "100 images": "100"}, "across": "frames",
             "cells": "{good}"}

    def problems(self, *claims, **without_csv):
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as csv:
            csv.write("name,frames,good\na,100,2\na,1500,3\nb,100,0\n")
            csv.flush()
            page = Page("p.md", self.PAGE, {csv.name: claims, "without_csv": without_csv})
        return "; ".join(page.problems + page.uncovered())

    def test_numbers_on_pages_are_those_of_the_tables(self):
        checked = checked_pages()
        self.assertEqual([problem for page in checked for problem in page.problems], [])
        for page in checked:
            print("%s: %d numbers are those of their CSV" % (page.name, page.compared))

    def test_each_number_in_a_table_of_results_belongs_to_a_claim(self):
        checked = [page for page in checked_pages() if page.name == "README.md" or page.name.startswith(RESULTS)]
        self.assertEqual([problem for page in checked for problem in page.uncovered()], [])
        there = glob.glob(os.path.join(pages.CHECKOUT, RESULTS, "**/README.md"), recursive=True)
        self.assertEqual({os.path.relpath(path, pages.CHECKOUT) for path in there} - {page.name for page in checked}, set())

    def test_the_first_run_prints_what_its_page_shows(self):
        rows = read_rows("first_run/trials.csv").set_index("trial")
        lines = re.findall(r"^trial  (\d)/3 +(\d+) frames  V_R +(\S+)  V_P +(\S+)  error +(\S+) deg  success$",
                           pages.read("doc/first_run.md"), re.MULTILINE)
        self.assertEqual([trial for trial, *_ in lines], ["0", "3"])
        for trial, frames, *numbers in lines:
            row = rows.loc[int(trial)]
            self.assertEqual((int(frames), numbers), (row.frames, ["%.3g" % row[name] for name in ("v_r", "v_p", "final_error")]))

    def test_rates_are_those_of_the_single_runs(self):
        for folder in ("efficient/", "paper/"):
            runs, rates = read_rows(folder + "trials.csv"), read_rows(folder + "success_rate.csv").set_index("frames").success
            expected = runs.groupby("frames").success.mean()
            self.assertLess(abs(expected[rates.index] - rates).max(), 1e-6, folder)

    def test_right_numbers_pass(self):
        self.assertEqual(self.problems(self.TABLE, "{mean(good)} of {count(name)}."), "")
        self.assertEqual(self.problems(dict(self.TABLE, cells=["{good} ± {std_error(good)}", "{good}"])), "")
        self.assertEqual(self.problems({"text": "of {good}.", "where": "frames == 1500"}, A="other numbers"), "")
        self.assertEqual(self.problems(**{"| ours | 2": "not ours"}), "")
        self.assertTrue(agree("−0.54", -0.5366) and agree("12,040", 12040.0) and agree("+0.0", 0.04))
        self.assertFalse(agree("0.54", -0.54) or agree("0.53", 0.5366) or agree("0.5", float("nan")))

    def test_what_is_wrong_is_named(self):
        for claim, problem in (
                ("of {sum(good)}.", "p.md: claim 'of {sum(good)}.': the page prints 3, sum(good) is 5"),
                (dict(self.TABLE, words={"ours": "b", "1,500": "100", "100 images": "100"}), "claim '| runs': '| ours | 2 | 3 |' prints 2, good is 0"),
                ("of {sum(good)} runs", "is on the page 0 times"), ("{good}", "is on the page 6 times"),
                ("of {bad}.", "name 'bad' is not defined"), ("of {good}.", "3 rows instead of one"),
                ({"text": "of {good}.", "where": "bad == 1"}, "'bad' is not defined"),
                (dict(self.TABLE, table="| years"), "is not the heading or first row of one table"),
                (dict(self.TABLE, words={"ours": "c"}), "no row has 'c' in column name"),
                (dict(self.TABLE, cells="{good} of 20"), "a cell is '2' instead of '{good} of 20'"),
                (dict(self.TABLE, cells=["{good}"]), "3 cells in a row instead of 2")):
            self.assertIn(problem, self.problems(claim))
        self.assertIn("p.md: no claim has all numbers of '| ours | 2 | 3 |'", self.problems())
        self.assertIn("p.md: without_csv: 'B' is not on the page", self.problems(B="gone"))
        self.assertIn("No such file", "".join(Page("p.md", self.PAGE, {"no.csv": ["of {count(a)}."]}).problems))
