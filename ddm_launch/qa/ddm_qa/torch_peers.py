# What training and planning take in PyTorch: the same mathematics, shapes and data, with its own L-BFGS.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs as a process of its own, so that PyTorch's threads and memory are its own.
Samples are rows here, as PyTorch wants them."""
import argparse
import json
import math
import os
import time

import numpy
import rosbag
import torch
import yaml

LAYER_STD = 0.3
OVERSAMPLING = 10  # dimensions of the PCA's subspace beyond those wanted, as ours


def read_trials(run):
    """Lists (images [N x D] in [0, 1], torques [N x m]) of the bags of a run folder, and the goal image [D]."""
    trials, goal = [], None
    for name in sorted(os.listdir(run)):
        path = os.path.join(run, name, "trial.bag")
        if not os.path.exists(path):
            continue
        images, torques = {}, {}
        with rosbag.Bag(path) as bag:
            for topic, message, _ in bag.read_messages():
                if topic.endswith("goal_image"):
                    goal = pixels(message)
                elif topic.endswith("image_raw"):
                    images[message.header.stamp] = pixels(message)
                elif topic.endswith("torque"):
                    torques[message.header.stamp] = message.torque
        stamps = sorted(set(images) & set(torques))
        trials.append((numpy.stack([images[stamp] for stamp in stamps]),
                       numpy.array([torques[stamp] for stamp in stamps], dtype=numpy.float32)))
    return trials, goal


def pixels(message):
    return numpy.frombuffer(message.data, dtype=numpy.uint8).astype(numpy.float32) / 255.0


def network(widths, linear_output, generator):
    """Weights and biases of a fully connected network, to be optimised."""
    layers = []
    for inputs, outputs in zip(widths, widths[1:]):
        weights = torch.randn(outputs, inputs, generator=generator) * LAYER_STD / math.sqrt(inputs)
        layers.append((weights.requires_grad_(), torch.zeros(outputs, requires_grad=True)))
    return layers, linear_output


def forward(net, samples):
    layers, linear_output = net
    for number, (weights, biases) in enumerate(layers):
        samples = torch.nn.functional.linear(samples, weights, biases)
        if not (linear_output and number == len(layers) - 1):
            samples = torch.atan(samples)
    return samples


class Peer:
    """The deep dynamical model of a configuration."""

    def __init__(self, config, trials, goal):
        model, mpc = config["model"], config["mpc"]
        self.order, self.feature_dim, self.pca_dim = model["order"], model["feature_dim"], model["pca_dim"]
        self.horizon, self.control_weight = mpc["horizon"], mpc["control_weight"]
        self.max_torque = mpc["max_torque"]
        self.images = torch.from_numpy(numpy.concatenate([images for images, _ in trials] + [goal[None]]))
        self.torques = torch.from_numpy(numpy.concatenate([torques for _, torques in trials])) / model["max_torque"]
        begins = numpy.cumsum([0] + [len(images) for images, _ in trials])
        self.targets = torch.from_numpy(numpy.concatenate(
            [numpy.arange(begin + self.order, end) for begin, end in zip(begins, begins[1:])]))
        generator = torch.Generator().manual_seed(0)
        regressors = self.order * (self.feature_dim + self.torques.shape[1])
        self.encoder = network([self.pca_dim] + model["encoder_widths"] + [self.feature_dim], False, generator)
        self.decoder = network([self.feature_dim] + model["decoder_widths"] + [self.pca_dim], True, generator)
        self.f = network([regressors] + model["predictor_widths"] + [self.feature_dim], True, generator)
        self.fit_pca()

    def parameters(self):
        return [each for net in (self.encoder, self.decoder, self.f) for layer in net[0] for each in layer]

    def fit_pca(self):
        self.mean = self.images.mean(0)
        centred = self.images - self.mean
        _, _, basis = torch.pca_lowrank(centred, q=self.pca_dim + OVERSAMPLING, center=False, niter=2)
        self.basis = basis[:, :self.pca_dim].contiguous()
        scores = centred @ self.basis
        self.scale = 1.0 / scores[:, 0].std()
        self.scores = scores * self.scale
        self.weight = 1.0 / self.scores.square().sum()

    def encode(self, image):
        return forward(self.encoder, (image - self.mean) @ self.basis * self.scale)

    def regressors(self, features):
        """h of all targets."""
        columns = []
        for lag in range(1, self.order + 1):
            columns += [features[self.targets - lag], self.torques[self.targets - lag]]
        return torch.cat(columns, 1)

    def objective(self):
        """w (V_R + V_P)"""
        features = forward(self.encoder, self.scores)
        predicted = forward(self.f, self.regressors(features))
        decoded = forward(self.decoder, torch.cat([features, predicted]))
        wanted = torch.cat([self.scores, self.scores[self.targets]])
        return self.weight * (decoded - wanted).square().sum()

    def objective_gradient(self):
        for parameter in self.parameters():
            parameter.grad = None
        value = self.objective()
        value.backward()
        return value

    def retrain(self, iterations, rank):
        self.fit_pca()
        minimise(self.parameters(), self.objective, iterations, rank)

    def plan_cost(self, v, features, torques):
        """J of the torques u = max_torque tanh(v), from the last features and torques, the newest first."""
        u = torch.tanh(v)
        features, torques = list(features), list(torques)
        cost = self.control_weight * (self.max_torque * u).square().sum()
        for step in range(self.horizon):
            torques.insert(0, u[step])
            parts = [part for pair in zip(features[:self.order], torques[:self.order]) for part in pair]
            features.insert(0, forward(self.f, torch.cat(parts)))
            cost = cost + (features[0] - self.goal_feature).square().sum()
        return cost

    def plan(self, number, last_v, iterations_per_start):
        """The best of three starts from the frame of target `number`: the last plan moved on by one step, no torque, a
        constant one."""
        with torch.no_grad():
            self.goal_feature = forward(self.encoder, self.scores[-1:])[0]
            past = forward(self.encoder, self.scores[self.targets[number] - torch.arange(self.order)])
            torques = self.torques[self.targets[number] - torch.arange(1, self.order)]
        starts = [torch.cat([last_v[1:], last_v[-1:]]), torch.zeros_like(last_v), torch.full_like(last_v, 0.5)]
        best = None
        for v in starts:
            v = v.clone().requires_grad_()
            minimise([v], lambda: self.plan_cost(v, past, torques), iterations_per_start, iterations_per_start)
            with torch.no_grad():
                cost = float(self.plan_cost(v, past, torques))
            if best is None or cost < best[0]:
                best = cost, v.detach()
        return best[1]


def minimise(parameters, function, iterations, rank):
    """So many iterations of PyTorch's L-BFGS, unless it cannot go on."""
    solver = torch.optim.LBFGS(parameters, max_iter=iterations, max_eval=10 * iterations, history_size=max(1, rank),
                               tolerance_grad=0.0, tolerance_change=0.0, line_search_fn="strong_wolfe")

    def closure():
        solver.zero_grad()
        value = function()
        value.backward()
        return value

    solver.step(closure)


def times_us(call, num_calls):
    """(median, 99 % quantile) of single calls, after one that does not count [us]."""
    call()
    times = []
    for _ in range(num_calls):
        start = time.perf_counter()
        call()
        times.append(1e6 * (time.perf_counter() - start))
    return float(numpy.median(times)), float(numpy.quantile(times, 0.99))


def measure(run, iterations, plan_iterations):
    with open(os.path.join(run, "config.yaml")) as stream:
        config = yaml.safe_load(stream)
    peer = Peer(config, *read_trials(run))
    starts = config["mpc"]["num_starts"]
    image = peer.images[0]
    results = {"objective_gradient": times_us(peer.objective_gradient, 100), "pca": times_us(peer.fit_pca, 5)}
    with torch.no_grad():
        results["encode"] = times_us(lambda: peer.encode(image), 1000)
    results["retrain"] = times_us(lambda: peer.retrain(iterations, config["training"]["lbfgs_rank"]), 3)
    state = {"v": torch.zeros(peer.horizon, peer.torques.shape[1]), "number": 0}

    def plan():
        state["v"] = peer.plan(state["number"], state["v"], max(1, round(plan_iterations / starts)))
        state["number"] += 1

    results["plan"] = times_us(plan, 20)
    return {name: {"median_us": median, "p99_us": p99} for name, (median, p99) in results.items()}


def main():
    parser = argparse.ArgumentParser(prog="torch_peers", description="Times training and planning in PyTorch, on the "
                                     "bags of a finished experiment; prints JSON.")
    parser.add_argument("run", metavar="RUN_FOLDER")
    parser.add_argument("--iterations", type=int, default=200, help="of a retraining, default 200")
    parser.add_argument("--plan-iterations", type=float, default=60.0, help="of a plan, over its three starts, default 60")
    options = parser.parse_args()
    torch.set_num_threads(1)
    print(json.dumps(measure(options.run, options.iterations, options.plan_iterations)))


if __name__ == "__main__":
    main()
