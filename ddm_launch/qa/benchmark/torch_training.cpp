// torch_training: times training in PyTorch's C++ interface, on data saved by torch_peers.py. Samples are rows.
// SPDX-License-Identifier: BSD-3-Clause
#include <torch/script.h>
#include <torch/torch.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "evaluation.h"

namespace {

constexpr double kMostDifference = 1e-5;  // of the loss from ours, relative
constexpr int kOversampling = 10;  // dimensions of the PCA's subspace beyond those wanted, as ours
constexpr int kSubspaceIterations = 2;
constexpr int kWarmUp = 10;

using Tensors = std::vector<torch::Tensor>;

/// A deep dynamical model in training. The names are those of torch_peers.py.
class Peer {
 public:
  explicit Peer(const torch::jit::Module& saved) {
    for (const auto& buffer : saved.named_buffers()) data_[buffer.name] = buffer.value;
    networks_ = {layersOf("encoder"), layersOf("decoder"), layersOf("f")};
    for (const Tensors& network : networks_) {
      parameters_.insert(parameters_.end(), network.begin(), network.end());
    }
    mean_ = data_.at("mean");
    basis_ = data_.at("basis");
    scale_ = data_.at("scale").item<double>();
    project();
  }

  /// V_R + V_P, eq. (5a).
  torch::Tensor loss() const {
    const torch::Tensor& targets = data_.at("targets");
    const torch::Tensor features = forward(networks_[0], /*linear_output=*/false, scores_);
    Tensors columns;
    for (int lag = 1; lag <= order(); ++lag) {
      columns.push_back(features.index_select(0, targets - lag));
      columns.push_back(data_.at("torques").index_select(0, targets - lag));
    }
    const torch::Tensor predicted = forward(networks_[2], true, torch::cat(columns, 1));
    const torch::Tensor decoded = forward(networks_[1], true, torch::cat({features, predicted}));
    return (decoded - wanted_).square().sum();
  }

  Tensors objectiveGradient() const {
    return torch::autograd::grad({weight_ * loss()}, parameters_);
  }

  /// @throws std::runtime_error if the loss is not the one that we computed
  void requireOurs() const {
    const double ours = data_.at("our_loss").item<double>();
    const double difference = std::abs(loss().item<double>() / ours - 1.0);
    if (difference < kMostDifference) return;
    std::ostringstream problem;
    problem << "V_R + V_P of PyTorch in C++ is " << difference << " off ours, more than "
            << kMostDifference << ": nothing was timed";
    throw std::runtime_error(problem.str());
  }

  void fitPca() {
    const torch::NoGradGuard no_grad;
    mean_ = data_.at("images").mean(0);
    const torch::Tensor centred = data_.at("images") - mean_;
    const int64_t num_components = data_.at("basis").size(1);
    torch::Tensor subspace = torch::randn({centred.size(1), num_components + kOversampling});
    subspace = std::get<0>(torch::linalg_qr(centred.mm(subspace)));
    for (int i = 0; i < kSubspaceIterations; ++i) {
      subspace = std::get<0>(torch::linalg_qr(centred.t().mm(subspace)));
      subspace = std::get<0>(torch::linalg_qr(centred.mm(subspace)));
    }
    const auto svd = torch::linalg_svd(subspace.t().mm(centred), /*full_matrices=*/false);
    basis_ = std::get<2>(svd).narrow(0, 0, num_components).t().contiguous();
    scale_ = 1.0;
    project();
    scale_ = 1.0 / scores_.select(1, 0).std().item<double>();
    project();
  }

  /// From the same random start each time; the components of PCA are drawn anew.
  /// @return whether it made all iterations: from some draws this L-BFGS is stuck after three
  bool retrain(int iterations, int rank) {
    {
      const torch::NoGradGuard no_grad;
      const Tensors starts = layers("start");
      for (size_t i = 0; i < parameters_.size(); ++i) parameters_[i].copy_(starts[i]);
    }
    fitPca();
    torch::optim::LBFGS solver(parameters_, torch::optim::LBFGSOptions(1.0)
                                                .max_iter(iterations)
                                                .max_eval(10 * iterations)
                                                .history_size(rank)
                                                .tolerance_grad(0.0)
                                                .tolerance_change(0.0)
                                                .line_search_fn("strong_wolfe"));
    solver.step([&] {
      solver.zero_grad();
      torch::Tensor value = weight_ * loss();
      value.backward();
      return value;
    });
    const auto& state = solver.state().begin()->second;
    return static_cast<const torch::optim::LBFGSParamState&>(*state).n_iter() >= iterations;
  }

 private:
  int order() const { return data_.at("order").item<int>(); }

  /// Weights and biases in turn.
  Tensors layers(const std::string& name) const {
    Tensors found;
    for (size_t i = 0; data_.count(name + "_" + std::to_string(i)) > 0; ++i) {
      found.push_back(data_.at(name + "_" + std::to_string(i)));
    }
    return found;
  }

  Tensors layersOf(const std::string& name) const {
    Tensors found = layers(name);
    for (torch::Tensor& layer : found) layer = layer.detach().clone().requires_grad_();
    return found;
  }

  static torch::Tensor forward(const Tensors& network, bool linear_output, torch::Tensor samples) {
    for (size_t i = 0; i < network.size(); i += 2) {
      samples = torch::addmm(network[i + 1], samples, network[i].t());
      if (i + 2 < network.size() || !linear_output) samples = torch::atan(samples);
    }
    return samples;
  }

  void project() {
    scores_ = (data_.at("images") - mean_).mm(basis_) * scale_;
    wanted_ = torch::cat({scores_, scores_.index_select(0, data_.at("targets"))});
    weight_ = 1.0 / scores_.square().sum().item<double>();
  }

  std::map<std::string, torch::Tensor> data_;
  std::vector<Tensors> networks_;  ///< encoder, decoder, f
  Tensors parameters_;
  torch::Tensor mean_, basis_, scores_, wanted_;
  double scale_ = 1.0;
  double weight_ = 1.0;
};

/// `"name": {"median_us": ..., "p99_us": ...}` of single calls, after some that do not count.
/// @param call  returns whether its time counts
/// @throws std::runtime_error if most of them do not
std::string timesOf(const std::string& name, int num_calls, int warm_up,
                    const std::function<bool()>& call) {
  for (int i = 0; i < warm_up; ++i) call();
  std::vector<double> times;
  for (int i = 0; i < 2 * num_calls && static_cast<int>(times.size()) < num_calls; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const bool counts = call();
    const auto end = std::chrono::steady_clock::now();
    if (counts) times.push_back(std::chrono::duration<double, std::micro>(end - start).count());
  }
  if (static_cast<int>(times.size()) < num_calls) {
    throw std::runtime_error(name + " of PyTorch in C++ ended early, most of " +
                             std::to_string(2 * num_calls) + " times: its time means nothing");
  }
  std::ostringstream text;
  text << '"' << name << "\": {\"median_us\": " << ddm::quantile(times, 0.5)
       << ", \"p99_us\": " << ddm::quantile(times, 0.99) << '}';
  return text.str();
}

void run(const std::string& file, int iterations, int rank) {
  torch::set_num_threads(1);
  torch::manual_seed(0);
  Peer peer(torch::jit::load(file));
  peer.requireOurs();
  const auto always = [](const auto& call) {
    return [&call] {
      call();
      return true;
    };
  };
  const auto gradient = [&] { peer.objectiveGradient(); };
  const auto pca = [&] { peer.fitPca(); };
  std::cout << "{" << timesOf("objective_gradient", 100, kWarmUp, always(gradient));
  std::cout << ", " << timesOf("pca", 5, 1, always(pca));
  std::cout << ", " << timesOf("retrain", 5, 1, [&] { return peer.retrain(iterations, rank); });
  std::cout << "}\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr
        << "usage: torch_training FILE ITERATIONS RANK\n"
           "Times training on one core on what `torch_peers.py --save FILE` has saved; prints "
           "JSON.\n";
    return 2;
  }
  try {
    run(argv[1], std::stoi(argv[2]), std::stoi(argv[3]));
  } catch (const std::exception& error) {
    std::cerr << "torch_training: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
