#!/usr/bin/python3
# Numbers on pages are those of the committed tables: each claim below is worded as on the page and filled from a CSV.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import sys
import unittest

import pandas
import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import pages  # noqa: E402

RESULTS = "ddm_launch/results/"
ROBOT = "doc/your_robot.md"
SPEED = RESULTS + "speed/README.md"
EFFICIENT = RESULTS + "efficient/README.md"
CHECKED = (EFFICIENT, SPEED)  # pages on which each number in a table belongs to a claim
NO_NUMBER = "not learned"  # what a row says whose other numbers are the task's own


def table(name):
    """A CSV of results/."""
    return pandas.read_csv(os.path.join(pages.CHECKOUT, RESULTS, name))


def models(name, first, last=None, **where):
    """(successful models, all models) of a trials.csv or a table of success rates, learned from `first` to `last` images."""
    rows = table(name)
    for column, value in where.items():
        rows = rows[rows[column] == value]
    rows = rows[(rows.frames >= first) & (rows.frames <= (last or first))]
    runs = rows.runs if "runs" in rows else 1.0 + 0.0 * rows.success
    return round((rows.success * runs).sum()), round(runs.sum())


def nuisances(first, last=None):
    good, count = zip(*(models("efficient/nuisances.csv", first, last, nuisance=name)
                        for name in table("efficient/nuisances.csv").nuisance.unique() if name != "none"))
    return sum(good), sum(count)


def lowest_and_highest(nuisance):
    """Successful models after 200 to 500 images."""
    counts = by_images("efficient/nuisances.csv", range(200, 600, 100), nuisance=nuisance)
    return min(counts), max(counts)


def seeds_of(task, least_return):
    """(seeds whose last model has this mean return, all seeds)"""
    returns = table("efficient/tasks/%s/last_models.csv" % task).mean_return
    return (returns >= least_return).sum(), len(returns)


def cells(head, values):
    """A row of a table."""
    return "| %s | %s |" % (head, " | ".join(map(str, values)))


def by_images(name, images, **where):
    return [models(name, count, **where)[0] for count in images]


def claims():
    """(page, text that must be on it)"""
    first, later = models("efficient/success_rate.csv", 100), models("efficient/success_rate.csv", 200, 1600)
    gravity = "efficient/gravity.csv"
    balance, hold = models(gravity, 1000, method="ddm"), models(gravity, 1500, 2000, method="ddm")
    links, late_links = (models("efficient/tasks.csv", *frames, task="two_link") for frames in ((1000, 2000), (1500, 2000)))
    swing, reach = seeds_of("suite_pendulum", 700.0), seeds_of("suite_reacher", 800.0)
    returns = table("efficient/tasks/suite_pendulum/last_models.csv").mean_return
    yield "README.md", "**After 100 images (20 s) it swings up the paper's pendulum on [%d of %d seeds]" % first
    yield "README.md", "| the paper's pendulum | 100 | 20 s | %d of %d seeds |" % first
    yield "README.md", "| the same with gravity | from 1,500 | 300 s | %d of %d models |" % hold
    yield "README.md", "| two links, two motors | from 1,500 | 300 s | %d of %d models |" % late_links
    yield "README.md", "| suite's pendulum swing-up, return 700 | 4,000 | 400 s | %d of %d |" % swing
    yield "README.md", "| suite's reacher easy, return 800 | 4,000 | 400 s | %d of %d |" % reach
    yield ROBOT, "[%d of %d after 500 images, %d after 600]" % (
        models(gravity, 500, method="ddm") + models(gravity, 600, method="ddm")[:1])
    yield ROBOT, "%s [%d or %d of %d]" % (("Still: yes,",) + lowest_and_highest("clutter") + (20,))
    yield ROBOT, "%d of %d after 1,000 images, all from 1,500 on" % models("efficient/tasks.csv", 1000, task="two_link")
    yield EFFICIENT, "| the paper's pendulum | 100 | 20 s | %d of %d models | 0.86 |" % first
    yield EFFICIENT, "| | 200 to 1,600 | 40 to 320 s | %d of %d | 0.99 |" % later
    yield EFFICIENT, "| six nuisances of the camera | 100 | 20 s | %d of %d | 0.85 |" % nuisances(100)
    yield EFFICIENT, "| | 200 to 500 | 40 to 100 s | %d of %d | 0.97 |" % nuisances(200, 500)
    yield EFFICIENT, "| pendulum with gravity | 1,000 | 200 s | %d of %d | 0.85 |" % balance
    yield EFFICIENT, "| | 1,500 to 2,000 | 300 to 400 s | %d of %d | 0.97 |" % hold
    yield EFFICIENT, "| two links, two motors | 1,000 to 2,000 | 200 to 400 s | %d of %d | 0.85 |" % links
    yield EFFICIENT, "| suite's pendulum, mean return 700 | 4,000 | 400 s | %d of %d seeds | 16 |" % swing
    yield EFFICIENT, "| suite's reacher easy, mean return 800 (version d90468f) | 4,000 | 400 s | %d of %d seeds | 16 of 20 |" % reach
    for name in table("efficient/nuisances.csv").nuisance.unique():
        counts = by_images("efficient/nuisances.csv", range(100, 600, 100), nuisance=name)
        yield EFFICIENT, cells(name.replace("_", " "), counts)
    images = (200, 300, 400, 500, 600, 700, 800, 900, 1000, 1500, 2000)
    yield EFFICIENT, cells("successful, of 20", by_images(gravity, images, method="ddm"))
    yield EFFICIENT, cells("both links upright, of 20", by_images("efficient/tasks.csv", images, task="two_link"))
    yield EFFICIENT, "The median over the seeds is %.0f" % returns.median()
    for text in speed_claims():
        yield SPEED, text


def speed_claims():
    rows = table("speed/speed.csv").set_index("name")
    us, peers = rows.median_us, rows.peer_median_us / rows.median_us
    biggest = table("speed/retrain.csv").set_index("frames").loc[20000]
    yield "| 15 trials of `efficient`, pendulum, one core | %.1f s | 40 s |" % (us.efficient_experiment / 1e6)
    yield "| the same on two cores | %.1f s | 25 s |" % (us.efficient_experiment_all_cores / 1e6)
    for preset, prefix in (("efficient", "efficient_"), ("paper", "")):
        objective, products = us[prefix + "objective_gradient"] / 1e3, us[prefix + "matrix_products"] / 1e3
        yield "| objective and gradient of `%s`, over the matrix products in it | %.2f ms, %.2f ms: %.2f | 1.6 |" % (
            preset, objective, products, objective / products)
    yield "| retraining `efficient` on 20,000 images | %.1f s, %.0f MB | 60 s, 1 GB |" % tuple(biggest)
    yield "| PyTorch's time for this objective, over ours | %.1f | 3 |" % peers.objective_gradient
    yield "| PyTorch's time for a retraining of 200 iterations, over ours | %.1f | 3 |" % peers.retrain
    yield "| PyTorch's time for a plan, over ours | %.0f | 20 |" % peers.plan
    yield "over that of two nodes that only send the messages | %.2f | 0.60 |" % (us.bare_round_trip / us.lockstep_round_trip)
    yield "%.0f µs a frame against %.0f µs" % (us.lockstep_round_trip, us.bare_round_trip)
    for row in table("speed/planning_budget.csv").itertuples():
        yield "| %s | %s | %.1f | %.1f | %.1f |" % (row.preset, {"busy": "both cores busy"}.get(row.load, row.load),
                                                  row.median_ms, row.p99_ms, row.max_ms)
    yield "%.2f after 100 images (target 0.86), and %.3f over 200 to 1,600" % tuple(
        good / count for good, count in (models("speed/success/success_rate.csv", *frames) for frames in ((100,), (200, 1600))))


def table_numbers(text):
    """Rows of tables that have a number in a cell, without the heads."""
    return [row for rows in pages.tables(text) for row in rows[1:] if re.search(r"\d", " ".join(row))]


class PageNumbersTest(unittest.TestCase):
    maxDiff = None

    def test_numbers_on_pages_are_those_of_the_tables(self):
        texts = {}
        missing = [(page, text) for page, text in claims()
                   if text not in texts.setdefault(page, " ".join(pages.read(page).split()))]
        self.assertEqual(missing, [])

    def test_each_number_in_a_table_of_a_checked_page_belongs_to_a_claim(self):
        for page in CHECKED:
            text = pages.read(page)
            for _, claim in (each for each in claims() if each[0] == page):
                text = text.replace(claim, "| covered |")  # still a row of its table
            self.assertEqual([row for row in table_numbers(text) if NO_NUMBER not in row], [], page)

    def test_rates_and_counts_are_those_of_the_rows(self):
        good, count = models("efficient/success_rate.csv", 100)
        rows = table("efficient/trials.csv")
        self.assertEqual((good, count), (rows[rows.frames == 100].success.sum(), (rows.frames == 100).sum()))

    def test_a_wrong_number_is_noticed(self):
        page, text = next(claims())
        wrong = re.sub(r"\d+ of", lambda found: "%d of" % (int(found.group().split()[0]) - 1), text)
        self.assertNotEqual(wrong, text)
        self.assertNotIn(wrong, pages.read(page))


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "page_numbers_test", PageNumbersTest)
