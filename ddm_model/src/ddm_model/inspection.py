# inspect: reports the quality of a model, alone and on bags, with a remedy for each problem.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import os
import sys

import pandas
import yaml

from ddm_model import report, report_figures
from ddm_model.model import load
from ddm_model.model_data import ModelData, ModelDataError
from ddm_model.plain_file import write_file
from ddm_model.verdict import summary, verdict

# Options that are passed on to the program read_bags, which explains them: name and form of the value.
READ_BAGS_OPTIONS = {"config": "FILE", "image-topic": "TOPIC", "torque-topic": "TOPIC", "dt": "S", "motors": "A,B,...",
                     "crop": "X,Y,W,H"}


def say(text):
    print(text, file=sys.stderr, flush=True)


def facts_of(model):
    """Facts that the model file itself contains."""
    max_torque = model.options["max_torque"].tolist()
    facts = {**model.info, "image_size": model.image_size, "torque_dim": model.torque_dim,
             "goal": model.goal_feature is not None,
             "options": {**model.options, "max_torque": max_torque if len(max_torque) > 1 else max_torque[0]}}
    facts["config"] = facts.pop("config")  # the longest value comes last
    return facts


def facts_table(data, path):
    """HTML table with the facts of a model and the units of its errors."""
    facts = {"file": path, **facts_of(data.model)}
    facts.update(facts.pop("options"))
    del facts["config"]  # the configuration has its own section
    values = max(facts["frames"], 1) * facts["image_size"] ** 2
    for name in ("v_r", "v_p"):
        facts[name] = "%.4g grey²: %.3g grey a pixel, within the principal components" % (
            facts[name], (facts[name] / values) ** 0.5)
    return report.table(["the model", ""], facts.items())


def bags_table(data):
    names = ["camera", "frames", "segments", "images_without_torque", "torques_without_image", "interval_s", "bag"]
    columns = [data.bags[name] for name in names]
    rows = [[cell if isinstance(cell, str) else "%g" % cell for cell in row] for row in zip(*columns)]
    return report.table([name.replace("_s", " [s]").replace("_", " ") for name in names], rows)


def figures_of(data):
    """Yields (title, figure, caption) in the order of the report."""
    yield ("Principal components", report_figures.draw_spectrum(data),
           "How much each component matters. A curve that has not come down at its right end asks for more of them.")
    if data.bags is not None:
        yield ("Pairs of image and torque", report_figures.draw_pairing(data),
               "When there are frames, and when images and torques that have no partner. A frame that is missing splits its "
               "bag, and nothing is predicted across it.")
        yield ("Reconstructions", report_figures.draw_reconstructions(data),
               "Images, what the principal components keep of them after model/blur, and what the features keep.")
        for kind, prediction in data.predictions.items():
            yield ("A prediction: %s" % kind, report_figures.draw_prediction(data, prediction),
                   "Steps ahead above each image. By error, this prediction is %s of all; only the first image was seen, "
                   "and the torques." % {"typical": "the median", "worst": "the worst"}[kind])
        if len(data.errors["steps"]) > 0:
            yield ("Error by step", report_figures.draw_errors(data),
                   "Over %d predictions of each length. Predictions must stay below the grey curve to be of use."
                   % data.errors["num_predictions"][0])
    if data.model.options["feature_dim"] >= 2:
        yield ("Feature plane", report_figures.draw_plane(data),
               "Images that the model decodes at 9 x 9 features, and where the frames lie. Neighbouring images must look "
               "alike, and motions be paths without jumps.")
    if data.bags is not None:
        yield ("Coverage", report_figures.draw_coverage(data),
               "How often each feature and torque occurs; dashed: model/max_torque.")


def build_page(data, path, checks):
    """HTML page of the report."""
    sections = ["<h2>Verdict</h2>", report.verdict_table(checks)]
    if data.bags is None:
        sections.append("<p>No bag was given: give some that the model has not learned from to have its predictions "
                        "judged.</p>")
    else:
        sections.append("<p>If the model was trained on these bags, its errors flatter: judge by others.</p>")
    sections += ["<h2>Facts</h2>", facts_table(data, path)]
    if data.bags is not None:
        sections += ["<p></p>", bags_table(data)]
    if data.notes:
        sections += ["<p></p>", report.table(["bag", "what to know about it"], data.notes)]
    say("drawing")
    sections += [report.figure(title, report_figures.as_data_uri(figure), caption)
                 for title, figure, caption in figures_of(data)]
    sections += ["<h2>Configuration that it was trained with</h2>",
                 "<pre>%s</pre>" % report.escaped(data.model.info["config"])]
    failed = any(check.ok is False for check in checks)
    return report.page("Model %s" % data.model.info["id"], summary(checks), failed, sections)


def inspect(path, bags, out, steps, options):
    """Writes the report of a model and its tables into a folder. Returns the checks.

    Raises ModelDataError if a bag cannot be read, OSError if a file cannot be read or written.
    """
    data = ModelData(load(path), bags, steps, options, say)
    checks = verdict(data)
    page = build_page(data, path, checks)
    os.makedirs(out, exist_ok=True)
    write_file(os.path.join(out, "model.yaml"), yaml.safe_dump(facts_of(data.model), sort_keys=False,
                                                               default_flow_style=None))
    for name, columns in data.tables.items():
        write_file(os.path.join(out, name), pandas.DataFrame(columns).to_csv(index=False))
    write_file(os.path.join(out, "verdict.yaml"),
               yaml.safe_dump([dict(check._asdict()) for check in checks], sort_keys=False))
    write_file(os.path.join(out, "report.html"), page)
    return checks


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="inspect",
        description="Tells what a model is and, given bags, how well it describes and predicts them. DIR/report.html is "
        "a self-contained file; the numbers behind it are CSV and YAML files. The verdict names each check that "
        "fails, what was measured, the rule and what to do.")
    path = os.path.expanduser  # a shell does not expand --out=~/x
    parser.add_argument("--model", metavar="FILE", type=path, required=True, help="model file")
    parser.add_argument("--out", metavar="DIR", type=path, required=True, help="folder of the report; made if need be")
    parser.add_argument("--steps", type=int, default=15, help="longest prediction (%(default)s, as plans are)")
    for name, form in READ_BAGS_OPTIONS.items():
        parser.add_argument("--" + name, metavar=form, action="append", default=[],
                            help="as for read_bags; default: as the model's own bags were read")
    parser.add_argument("bags", metavar="BAG", nargs="*", type=path, help="bags with images and torques, best such that "
                        "the model has not learned from. Images are brought to the model's size")
    options = parser.parse_args(arguments)
    if not 1 <= options.steps <= 1000:
        parser.error("--steps must lie in [1, 1000], got %d" % options.steps)
    bag_options = ["--%s=%s" % (name, value) for name in READ_BAGS_OPTIONS
                   for value in getattr(options, name.replace("-", "_"))]
    try:
        checks = inspect(options.model, options.bags, options.out, options.steps, bag_options)
    except (ModelDataError, OSError) as error:
        print("inspect: %s" % error, file=sys.stderr)
        return 1
    for check in checks:
        print("%-9s  %s: %s" % (report.MARKS[check.ok], check.name, check.figure))
    print("\n%s\nwrote %s" % (summary(checks), os.path.join(options.out, "report.html")))
    return 0
