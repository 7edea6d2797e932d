# From bags to arrays, to a model, and to a report of the model on a bag that it has not learned from.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import os

import numpy as np
import yaml

import ddm_model
from ddm_model import inspection
from ddm_model.model_data import read_bags

IMAGE_SIZE = 51  # [pixels]


def episodes_in(path, data_set):
    """Pairs (images [T, H, W], torques [T, m]) without gaps."""
    bag = read_bags([path], IMAGE_SIZE, data_set=data_set)[0]
    ends = np.cumsum(bag["segment_sizes"])[:-1]
    return list(zip(np.split(bag["images"], ends), np.split(bag["torques"], ends)))


def main():
    parser = argparse.ArgumentParser(description="Trains on all bags but the last, and reports how the model predicts that bag.")
    parser.add_argument("bags", nargs="+", metavar="BAG")
    parser.add_argument("--preset", default="efficient")
    parser.add_argument("--max-torque", type=float, nargs="+", required=True, help="limit of each motor [N m]")
    parser.add_argument("--config", type=argparse.FileType(), help="YAML file whose block data_set says how to read the bags")
    parser.add_argument("--out", default="report", help="folder of model and report")
    args = parser.parse_args()
    if len(args.bags) < 2:
        parser.error("give at least two bags, got %s: the last one is not learned from" % args.bags[0])
    data_set = (yaml.safe_load(args.config) or {}).get("data_set", {}) if args.config else {}
    episodes = [episode for path in args.bags[:-1] for episode in episodes_in(path, data_set)]
    print("%d episodes with %d images" % (len(episodes), sum(len(images) for images, _ in episodes)))
    model = ddm_model.train(episodes, goal=None, preset=args.preset, max_torque=args.max_torque, data_set=data_set)
    os.makedirs(args.out, exist_ok=True)
    path = os.path.join(args.out, "model.ddm")
    model.save(path)
    return inspection.main(["--model", path, "--out", args.out, args.bags[-1]])


if __name__ == "__main__":
    raise SystemExit(main())
