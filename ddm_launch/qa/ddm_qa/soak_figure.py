# The figure of a soak: memory and open files of each node over the trials.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_launch.figure_style import (BLACK, BLUE, GREEN, GREY, ORANGE, PAGE_WIDTH, PURPLE, SKY, VERMILLION, new_figure,
                                     save)
from ddm_qa.soak_bars import GROWTH, after, by_node, reference_trial

LINES = [(BLUE, "-"), (VERMILLION, "--"), (GREEN, "-."), (ORANGE, "-"), (PURPLE, "--"), (SKY, "-."), (BLACK, ":")]
TITLES = {"lockstep": "lock-step", "real_time": "real time"}


def draw_run(samples, memory, files):
    """Both panels of a run; samples: of this run."""
    last = max(sample.trial for sample in samples)
    reference = reference_trial(last)
    for number, (node, of_node) in enumerate(sorted(by_node(samples).items())):
        color, dashes = LINES[number % len(LINES)]
        trials = [sample.trial for sample in of_node]
        base = after(of_node, reference).rss_kb
        memory.plot(trials, [100.0 * (sample.rss_kb / base - 1.0) for sample in of_node], dashes, color=color)
        files.plot(trials, [sample.open_files for sample in of_node], dashes, color=color,
                   label="%s, %.0f MB" % (node, base / 1024.0))
    memory.axhline(100.0 * GROWTH, color=GREY, linewidth=0.8)
    memory.text(0.01, 100.0 * GROWTH - 0.1, "at most after the last trial", transform=memory.get_yaxis_transform(),
                verticalalignment="top", color=GREY, fontsize=7)
    memory.axvline(reference, color=GREY, linewidth=0.8, linestyle=":")
    minutes = max(sample.time_s for sample in samples) / 60.0
    memory.set_title("%s: %d trials in %.1f min" % (TITLES[samples[0].run], last, minutes))
    memory.set_ylabel("resident memory,\nchange since trial %d [%%]" % reference)
    files.set_ylabel("open files [-]")
    files.set_ylim(0.0, None)
    files.set_xlabel("trial [-]")
    files.legend(loc="upper center", bbox_to_anchor=(0.5, -0.35), ncol=2, handlelength=2.4, frameon=False,
                 title="node, memory after trial %d" % reference, title_fontsize=7)
    for axes in (memory, files):
        axes.grid(True)


def draw(samples, out):
    """Raises Failure if `out` is not a .png."""
    runs = sorted({sample.run for sample in samples})
    with new_figure(PAGE_WIDTH, 4.4) as figure:
        panels = figure.subplots(2, len(runs), sharex="col", sharey="row", squeeze=False, gridspec_kw={"height_ratios": [2, 1]})
        for run, memory, files in zip(runs, *panels):
            draw_run([sample for sample in samples if sample.run == run], memory, files)
        save(figure, out)
