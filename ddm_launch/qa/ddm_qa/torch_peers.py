# What training and planning take in PyTorch: the same mathematics, shapes and data, with its own L-BFGS.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs as a process of its own, so that PyTorch's threads and memory are its own.
Samples are rows here, as PyTorch wants them. Functions of tensors alone are what TorchScript compiles."""
import argparse
import glob
import json
import os
import time
from typing import List

import numpy as np
import torch
import yaml

from ddm_model.model import load
from ddm_qa.recorded import read_trials

OVERSAMPLING = 10  # dimensions of the PCA's subspace beyond those wanted, as ours
LAYER_STD = 0.3  # of a random start
MOST_DIFFERENCE = 1e-5  # of a loss from ours, relative
WARM_UP = 10  # calls in which TorchScript specialises what it compiled


def forward(layers: List[torch.Tensor], linear_output: bool, samples: torch.Tensor) -> torch.Tensor:
    """layers: weights and biases in turn."""
    num_layers = len(layers) // 2
    for layer in range(num_layers):
        samples = torch.addmm(layers[2 * layer + 1], samples, layers[2 * layer].t())
        if layer + 1 < num_layers or not linear_output:
            samples = torch.atan(samples)
    return samples


def joint_objective(encoder: List[torch.Tensor], decoder: List[torch.Tensor], f: List[torch.Tensor],
                    scores: torch.Tensor, torques: torch.Tensor, targets: torch.Tensor, wanted: torch.Tensor,
                    order: int) -> torch.Tensor:
    """V_R + V_P, eq. (5a)."""
    features = forward(encoder, False, scores)
    columns: List[torch.Tensor] = []
    for lag in range(1, order + 1):
        columns.append(features[targets - lag])
        columns.append(torques[targets - lag])
    predicted = forward(f, True, torch.cat(columns, 1))
    decoded = forward(decoder, True, torch.cat([features, predicted]))
    return (decoded - wanted).square().sum()


def plan_costs(f: List[torch.Tensor], v: torch.Tensor, features: torch.Tensor, torques: torch.Tensor,
               goal: torch.Tensor, control_weight: float) -> torch.Tensor:
    """J of the torques u = max_torque tanh(v) of all starts at once, eq. (9)  [starts].

    v: [starts x K x motors]. features, torques: the last ones, the newest first  [n x feature_dim], [n - 1 x motors].
    control_weight: lambda max_torque^2
    """
    num_starts = v.size(0)
    u = torch.tanh(v)
    past = [features[lag].expand(num_starts, -1) for lag in range(features.size(0))]
    acted = [torques[lag].expand(num_starts, -1) for lag in range(torques.size(0))]
    cost = control_weight * u.square().sum(dim=[1, 2])
    for step in range(v.size(1)):
        acted.insert(0, u[:, step])
        parts: List[torch.Tensor] = []
        for lag in range(features.size(0)):
            parts.append(past[lag])
            parts.append(acted[lag])
        past.insert(0, forward(f, True, torch.cat(parts, 1)))
        cost = cost + (past[0] - goal).square().sum(1)
    return cost


class Peer:
    """The deep dynamical model of a finished run of preset paper."""

    def __init__(self, run, compiled):
        """compiled: by TorchScript, or eager."""
        with open(os.path.join(run, "config.yaml")) as stream:
            self.config = yaml.safe_load(stream)
        self.ours = load(sorted(glob.glob(os.path.join(run, "trial_*", "model.ddm")))[-1])
        options, trials = self.ours.options, read_trials(run, self.ours.arrays["goal"])
        if options["residual"] or options["increments"] or options["blur"] or options["delay"]:
            raise ValueError("%s: the peers compute what preset paper does, without residual, increments, blur and delay"
                             % run)
        wrap = torch.jit.script if compiled else lambda function: function
        self.forward, self.joint_objective, self.plan_costs = wrap(forward), wrap(joint_objective), wrap(plan_costs)
        self.order, self.horizon = options["order"], self.config["mpc"]["horizon"]
        self.max_torque = torch.tensor(options["max_torque"], dtype=torch.float32)
        self.control_weight = float(self.config["mpc"]["control_weight"] * options["max_torque"][0] ** 2)
        self.images = torch.from_numpy(trials.images)
        self.torques = torch.from_numpy(trials.torques) / self.max_torque
        self.targets = torch.from_numpy(trials.targets(self.order))
        self.encoder, self.decoder, self.f = (self.layers_of(name) for name in ("encoder", "decoder", "f"))
        self.ours_at = [parameter.detach().clone() for parameter in self.parameters()]
        self.generator = torch.Generator().manual_seed(0)
        self.mean = torch.tensor(self.ours.arrays["pca_mean"])
        self.basis = torch.tensor(np.ascontiguousarray(self.ours.arrays["pca_basis"]))
        self.scale = float(self.ours.arrays["pca_scale"])
        self.project()

    def layers_of(self, name):
        """Our weights and biases, to be optimised."""
        num_layers = sum(key.startswith(name + "_W") for key in self.ours.arrays)
        return [torch.tensor(np.ascontiguousarray(self.ours.arrays["%s_%s%d" % (name, kind, layer)]),
                             dtype=torch.float32).requires_grad_()
                for layer in range(1, num_layers + 1) for kind in "Wb"]

    def parameters(self):
        return self.encoder + self.decoder + self.f

    def project(self):
        self.scores = (self.images - self.mean) @ self.basis * self.scale
        self.wanted = torch.cat([self.scores, self.scores[self.targets]])
        self.weight = 1.0 / self.scores.square().sum()

    def fit_pca(self):
        self.mean = self.images.mean(0)
        _, _, basis = torch.pca_lowrank(self.images - self.mean, q=self.ours.options["pca_dim"] + OVERSAMPLING,
                                        center=False, niter=2)
        self.basis = basis[:, :self.ours.options["pca_dim"]].contiguous()
        self.scale = 1.0
        self.project()
        self.scale = float(1.0 / self.scores[:, 0].std())
        self.project()

    def encode(self, image):
        return self.forward(self.encoder, False, ((image - self.mean) @ self.basis * self.scale)[None])

    def loss(self):
        """V_R + V_P"""
        return self.joint_objective(self.encoder, self.decoder, self.f, self.scores, self.torques, self.targets, self.wanted,
                                    self.order)

    def objective(self):
        return self.weight * self.loss()

    def objective_gradient(self):
        return torch.autograd.grad(self.objective(), self.parameters())

    def set_parameters(self, values):
        with torch.no_grad():
            for parameter, value in zip(self.parameters(), values):
                parameter.copy_(value)

    def random_start(self):
        """Another one with each call."""
        return [torch.randn(each.shape, generator=self.generator) * LAYER_STD / each.shape[-1] ** 0.5 if each.dim() > 1
                else torch.zeros_like(each) for each in self.ours_at]

    def retrain(self, iterations, rank):
        """From another random start with each call. Returns whether its time counts: from some starts L-BFGS gets stuck."""
        self.set_parameters(self.random_start())
        self.fit_pca()
        return minimise(self.parameters(), self.objective, iterations, rank) == iterations

    def start_plan(self, number):
        """What plan_costs() wants to know of the frame of target `number`."""
        with torch.no_grad():
            goal = self.forward(self.encoder, False, self.scores[-1:])[0]
            now = self.targets[number] - 1
            past = self.forward(self.encoder, False, self.scores[now - torch.arange(self.order)])
        return past, self.torques[now - torch.arange(1, self.order)], goal

    def plan(self, number, last_v, iterations):
        """The best of three starts: the last plan moved on by one step, no torque, a constant one. They share a line search."""
        past, torques, goal = self.start_plan(number)
        v = torch.stack([torch.cat([last_v[1:], last_v[-1:]]), torch.zeros_like(last_v), torch.full_like(last_v, 0.5)])
        v.requires_grad_()

        def costs():
            return self.plan_costs(self.f, v, past, torques, goal, self.control_weight)

        minimise([v], lambda: costs().sum(), iterations, iterations)
        with torch.no_grad():
            return v[torch.argmin(costs())].clone()

    def our_loss(self):
        """V_R + V_P as the model file has it, in units of the scores."""
        return (self.ours.info["v_r"] + self.ours.info["v_p"]) * self.scale ** 2  # from [grey^2]

    def differences(self):
        """{name: relative difference of a loss from ours} at our parameters."""
        with torch.no_grad():
            differences = {"V_R + V_P": abs(float(self.loss()) / self.our_loss() - 1.0)}
            past, torques, goal = self.start_plan(0)
            u = 0.5 * torch.sin(torch.arange(float(self.horizon)))[:, None]
            cost = float(self.plan_costs(self.f, torch.atanh(u)[None], past, torques, goal, self.control_weight)[0])
            acted = torch.cat([torques.flip(0), u]) * self.max_torque
            ahead = self.ours.roll_out(past.flip(0).numpy(), acted.numpy())
            j = float(np.sum((ahead - self.ours.goal_feature) ** 2) + self.control_weight * np.sum(u.numpy() ** 2))
            differences["J"] = abs(cost / j - 1.0)
        return differences


class Saved(torch.nn.Module):
    """What torch_training needs of a Peer, in a form that C++ reads."""

    def __init__(self, peer):
        super().__init__()
        lists = {"encoder": peer.encoder, "decoder": peer.decoder, "f": peer.f, "start": peer.random_start()}
        tensors = {"%s_%d" % (name, i): each.detach() for name, found in lists.items() for i, each in enumerate(found)}
        tensors.update(images=peer.images, torques=peer.torques, targets=peer.targets, mean=peer.mean, basis=peer.basis,
                       scale=torch.tensor(peer.scale, dtype=torch.float64), order=torch.tensor(peer.order),
                       our_loss=torch.tensor(peer.our_loss(), dtype=torch.float64))
        for name, tensor in tensors.items():
            self.register_buffer(name, tensor)

    def forward(self):
        return 0


def minimise(parameters, function, iterations, rank):
    """So many iterations of PyTorch's L-BFGS, unless it cannot go on. Returns their number."""
    solver = torch.optim.LBFGS(parameters, max_iter=iterations, max_eval=10 * iterations, history_size=max(1, rank),
                               tolerance_grad=0.0, tolerance_change=0.0, line_search_fn="strong_wolfe")

    def closure():
        solver.zero_grad()
        value = function()
        value.backward()
        return value

    solver.step(closure)
    return solver.state[parameters[0]]["n_iter"]


def times_us(call, num_calls, warm_up=1):
    """(median, 99 % quantile) of single calls, after some that do not count, nor do those that return False [us]. Raises
    ValueError if most return False."""
    for _ in range(warm_up):
        call()
    times, num_early = [], 0
    while len(times) < num_calls:
        start = time.perf_counter()
        if call() is not False:
            times.append(1e6 * (time.perf_counter() - start))
            continue
        num_early += 1
        if num_early > num_calls:
            raise ValueError("L-BFGS of PyTorch ended early %d times in %d: its time means nothing" % (
                num_early, num_early + len(times)))
    return float(np.median(times)), float(np.quantile(times, 0.99))


def measure(run, compiled, iterations, plan_iterations):
    """{name: {median_us, p99_us}}. Raises ValueError where a loss is not ours."""
    peer = Peer(run, compiled)
    for name, difference in peer.differences().items():
        if not difference < MOST_DIFFERENCE:
            raise ValueError("%s of PyTorch is %.1e off ours, more than %.0e: nothing was timed" % (
                name, difference, MOST_DIFFERENCE))
    image = peer.images[0]
    results = {"objective_gradient": times_us(peer.objective_gradient, 100, WARM_UP)}
    with torch.no_grad():
        results["encode"] = times_us(lambda: peer.encode(image), 1000, WARM_UP)
    state = {"v": torch.zeros(peer.horizon, peer.torques.shape[1]), "number": 0}

    def plan():
        state["v"] = peer.plan(state["number"], state["v"], max(1, round(plan_iterations / 3.0)))
        state["number"] += 1

    results["plan"] = times_us(plan, 20, WARM_UP)
    results["pca"] = times_us(peer.fit_pca, 5)  # from here on the networks are for other scores
    results["retrain"] = times_us(lambda: peer.retrain(iterations, peer.config["training"]["lbfgs_rank"]), 5)
    return {name: {"median_us": median, "p99_us": p99} for name, (median, p99) in results.items()}


def blas():
    """File name of the BLAS library that PyTorch computes with."""
    with open("/proc/self/maps") as stream:
        names = {os.path.basename(line.split()[-1]) for line in stream if "blas" in line.lower() and "/" in line}
    return ", ".join(sorted(names)) or "PyTorch's own"


def main():
    parser = argparse.ArgumentParser(prog="torch_peers", description="Times training and planning in PyTorch, on the "
                                     "bags of a finished experiment of preset paper; prints JSON.")
    parser.add_argument("run", metavar="RUN_FOLDER")
    parser.add_argument("--eager", action="store_true", help="without TorchScript")
    parser.add_argument("--threads", type=int, default=1, help="default 1")
    parser.add_argument("--iterations", type=int, default=200, help="of a retraining, default 200")
    parser.add_argument("--plan-iterations", type=float, default=60.0, help="of a plan, over its three starts, default 60")
    parser.add_argument("--save", metavar="FILE", help="time nothing: save what torch_training times in C++, and print the "
                        "rank of its L-BFGS")
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    try:
        if options.save:
            peer = Peer(options.run, compiled=False)
            torch.jit.script(Saved(peer)).save(options.save)
            print(peer.config["training"]["lbfgs_rank"])
            return
        times = measure(options.run, not options.eager, options.iterations, options.plan_iterations)
    except ValueError as error:
        parser.exit(1, "torch_peers: %s\n" % error)
    print(json.dumps({"times": times, "torch": torch.__version__, "blas": blas()}))


if __name__ == "__main__":
    main()
