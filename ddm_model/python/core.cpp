// The Python module ddm_model._core: training, and class Model.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/model_config.h>
#include <ddm_common/plain_file.h>
#include <ddm_common/python_values.h>
#include <ddm_model/minimise.h>
#include <ddm_model/model_file.h>
#include <ddm_model/trainer.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace ddm {
namespace {

/// Collects all episodes as one data set. Each episode is a segment of its own.
/// @param episodes  pairs (images, torques)
DataSet dataOf(const py::iterable& episodes, const py::object& goal, int image_size) {
  std::unique_ptr<DataSet> data;
  std::string size;
  for (const py::handle& one : episodes) {
    const std::string name = "episode " + std::to_string(data ? data->segments().size() : 0);
    if (!py::isinstance<py::sequence>(one) || py::len(one) != 2) {
      throw py::type_error(name + " must be a pair (images, torques), got " + describe(one));
    }
    const auto pair = py::reinterpret_borrow<py::sequence>(one);
    const Images images(pair[0], "images of " + name);
    const Eigen::MatrixXd torques =
        samplesOf(pair[1], "torques of " + name, data ? data->torqueDim() : -1);
    if (torques.cols() != images.count()) {
      throw py::value_error(name + " must have one torque for each image, got " +
                            std::to_string(images.count()) + " images and " +
                            std::to_string(torques.cols()) + " torques");
    }
    if (size.empty()) size = images.size();
    if (images.size() != size) {
      throw py::value_error("images of " + name + " must have the size of episode 0, " + size +
                            ", got " + images.size() + ": one camera takes all images");
    }
    if (!data) data = std::make_unique<DataSet>(image_size, static_cast<int>(torques.rows()));
    for (Eigen::Index t = 0; t < torques.cols(); ++t) {
      data->append(images.greyValues(t, image_size), torques.col(t), t == 0);
    }
  }
  if (!data) {
    throw py::value_error("episodes must have at least one episode, got none: record one first");
  }
  if (!goal.is_none()) {
    const Images image = Images::single(goal, "goal");
    if (image.size() != size) {
      throw py::value_error("goal must have the size of the images, " + size + ", got " +
                            image.size() + ": take it with the same camera");
    }
    data->setGoal(image.greyValues(0, image_size));
  }
  return *std::move(data);
}

/// Trains in a thread of its own. Meanwhile this thread handles signals and calls `progress`, so
/// that Ctrl-C works and threads of the training never run Python.
/// @throws py::error_already_set if a signal handler or `progress` raised an exception
TrainingResult trainInThread(const DataSet& data, const ModelConfig& config, const ModelInfo& info,
                             const py::object& progress) {
  std::atomic<bool> stop{false};
  std::mutex mutex;
  TrainingProgress latest;
  const auto observe = [&](const TrainingProgress& state) {
    const std::lock_guard<std::mutex> lock(mutex);
    latest = state;
    return !stop;
  };
  std::future<TrainingResult> result = std::async(std::launch::async, [&] {
    return train(data, config.model, config.training, info, observe);
  });
  const auto isDone = [&result] {
    const py::gil_scoped_release without_gil;
    return result.wait_for(std::chrono::milliseconds(20)) == std::future_status::ready;
  };
  try {
    while (!isDone()) {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (progress.is_none()) continue;
      std::unique_lock<std::mutex> lock(mutex);
      const TrainingProgress state = latest;
      lock.unlock();
      progress(state.fraction_done, state.v_r, state.v_p);
    }
  } catch (...) {
    stop = true;
    const py::gil_scoped_release without_gil;
    result.wait();
    throw;
  }
  return result.get();
}

std::shared_ptr<Ddm> trainModel(const py::iterable& episodes, const py::object& goal,
                                const py::iterable& layers, const py::dict& options,
                                const py::object& seed, const py::object& trial,
                                const py::object& progress) {
  if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0) {
    throw py::type_error("progress must be a function, got " + describe(progress));
  }
  YAML::Node blocks = mergedBlocks(layers, options, toYaml(ModelConfig()));
  const bool has_limits = takeOverLimits("model", &blocks) != "the default";
  ParamReader reader(blocks);
  const ModelConfig config = readModelConfig(&reader);
  reader.requireValid();
  const DataSet data = dataOf(episodes, goal, config.image.size);
  if (!has_limits) {
    throw py::value_error(
        "max_torque must be given where there is no plant: the limit of each motor [N m]");
  }
  ModelInfo info;
  info.seed = wholeOf<std::uint64_t>(seed, "seed");
  info.trial = trial.is_none() ? static_cast<std::uint32_t>(data.segments().size() - 1)
                               : wholeOf<std::uint32_t>(trial, "trial");
  info.config = toText(config);
  TrainingResult result = trainInThread(data, config, info, progress);
  if (!result.model) throw std::runtime_error("the training failed: " + result.message);
  return std::make_shared<Ddm>(*std::move(result.model));
}

std::shared_ptr<Ddm> load(const py::object& file) {
  const std::string path = pathOf(file);
  try {
    return std::make_shared<Ddm>(deserialiseModel(readFile(path), path));
  } catch (const std::runtime_error& error) {
    const py::object type = py::module::import("ddm_model.model").attr("ModelFileError");
    PyErr_SetString(type.ptr(), error.what());
    throw py::error_already_set();
  }
}

void save(const Ddm& model, const py::object& file) {
  const std::string path = pathOf(file);
  try {
    writeFileAtomically(path, serialiseModel(model));
  } catch (const std::runtime_error& error) {
    PyErr_SetString(PyExc_OSError, error.what());
    throw py::error_already_set();
  }
}

py::array_t<double> encode(const Ddm& model, const py::object& images) {
  const Images all(images, "images");
  Eigen::MatrixXd features(model.featureDim(), all.count());
  for (Eigen::Index i = 0; i < features.cols(); ++i) {
    features.col(i) = model.encode(all.greyValues(i, model.imageSize()));
  }
  return rowsOf(features);
}

py::array_t<std::uint8_t> decode(const Ddm& model, const py::object& features) {
  const Eigen::MatrixXd all = samplesOf(features, "features", model.featureDim());
  const Eigen::Index size = model.imageSize();
  py::array_t<std::uint8_t> images({all.cols(), size, size});
  for (Eigen::Index i = 0; i < all.cols(); ++i) {
    const Image image = model.decode(all.col(i));
    std::copy(image.begin(), image.end(), images.mutable_data() + i * size * size);
  }
  return images;
}

/// @return predicted features of the K steps after the given features  [feature_dim x K]
Eigen::MatrixXd rollOut(const Ddm& model, const py::object& features, const py::object& torques,
                        bool one_step) {
  const Eigen::Index order = model.options().order;
  const Eigen::MatrixXd z = samplesOf(features, "features", model.featureDim());
  const Eigen::MatrixXd u = samplesOf(torques, "torques", model.torqueDim());
  const auto num_steps = static_cast<int>(u.cols() - order + 1);
  if (z.cols() != order || num_steps < 1 || (one_step && num_steps != 1)) {
    throw py::value_error("features must have " + std::to_string(order) + " rows and torques " +
                          (one_step ? "" : "at least ") + std::to_string(order) +
                          ", the oldest first, got " + std::to_string(z.cols()) + " and " +
                          std::to_string(u.cols()));
  }
  Eigen::MatrixXd Z = Eigen::MatrixXd::Zero(z.rows(), u.cols());
  Z.leftCols(order) = z;
  return model.rollOut(Z, u, order - 1, num_steps).rightCols(num_steps);
}

py::dict infoOf(const Ddm& model) {
  const ModelInfo& info = model.info();
  py::dict out;
  out["id"] = modelId(serialiseModel(model));
  out["seed"] = info.seed;
  out["trial"] = info.trial;
  out["frames"] = info.frames;
  out["v_r"] = info.v_r;
  out["v_p"] = info.v_p;
  out["feature_spread"] = info.feature_spread;
  out["config"] = info.config;
  return out;
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  silenceSolverLog();
  using py::arg;
  module.def("train", trainModel, arg("episodes"), arg("goal"), arg("layers"), arg("options"),
             arg("seed"), arg("trial").none(true), arg("progress").none(true));
  py::class_<Ddm, std::shared_ptr<Ddm>> model(
      module, "Model",
      "A trained deep dynamical model: encoder g^-1, decoder g and prediction model f. Made by\n"
      "train() or Model.load(); it never changes. In all arrays, one sample is one row.");
  model.attr("__module__") = "ddm_model";
  model
      .def_static("load", load, arg("path"),
                  "Reads a model file (model.ddm). Raises ModelFileError, an OSError, if the file\n"
                  "cannot be read, is damaged or has another format version.")
      .def("save", save, arg("path"),
           "Writes the model file that all programs and nodes read. Raises OSError; the file is\n"
           "then unchanged.")
      .def("encode", encode, arg("images"),
           "Encoder: z = g^-1(y).\n\n"
           "images: uint8 [T, H, W] or [T, H, W, 3] (red, green, blue). Images of another size\n"
           "than image_size are cut to their central square and resized, as in training.\n"
           "Returns features [T, feature_dim]. Raises TypeError or ValueError.")
      .def("decode", decode, arg("features"),
           "Decoder: y = g(z). features: [T, feature_dim].\n"
           "Returns images, uint8 [T, image_size, image_size]. Raises TypeError or ValueError.")
      .def(
          "predict",
          [](const Ddm& self, const py::object& features, const py::object& torques) {
            return arrayOf(Eigen::VectorXd(rollOut(self, features, torques, true)));
          },
          arg("features"), arg("torques"),
          "Predicts one step: z_{t+1} = f(z_t, u_t, ..., z_{t-n+1}, u_{t-n+1}).\n\n"
          "features: the last n = options['order'] features, oldest first [n, feature_dim].\n"
          "torques: the last n torques with u_t at the end [n, torque_dim, N m].\n"
          "Returns z_{t+1} [feature_dim]. Raises TypeError or ValueError.")
      .def(
          "roll_out",
          [](const Ddm& self, const py::object& features, const py::object& torques) {
            return rowsOf(rollOut(self, features, torques, false));
          },
          arg("features"), arg("torques"),
          "Predicts K steps, each from the predictions before it.\n\n"
          "features: as for predict(). torques: as for predict(), then the K - 1 torques after\n"
          "u_t. Returns z_{t+1} ... z_{t+K} [K, feature_dim]. Raises TypeError or ValueError.")
      .def_property_readonly(
          "goal_feature",
          [](const Ddm& self) -> py::object {
            if (!self.hasGoal()) return py::none();
            return arrayOf(self.goalFeature());
          },
          "z_ref, the feature of the goal image [feature_dim]; None without a goal image")
      .def_property_readonly("image_size", &Ddm::imageSize, "Width and height of images [pixels]")
      .def_property_readonly("torque_dim", &Ddm::torqueDim, "Number of motors")
      .def_property_readonly(
          "options", [](const Ddm& self) { return dictOf(toYaml(self.options())); },
          "The block `model` of the configuration, as a dictionary")
      .def_property_readonly(
          "info", infoOf,
          "Dictionary: id (checksum of the file), seed, trial, frames (number of samples learned\n"
          "from), v_r and v_p [grey^2], feature_spread, and config, the configuration as YAML");
}

}  // namespace ddm
