// What a model makes of bags: the files that `inspect` draws from.
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_measurements.h"

#include <ddm_bag_io/bag_reader.h>
#include <ddm_files/plain_file.h>
#include <ddm_model/image_errors.h>
#include <ddm_model/long_term_prediction.h>
#include <ddm_params/param_value.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <utility>

#include "npy_file.h"

namespace ddm {
namespace {

constexpr Eigen::Index kMaxStarts = 1000;  // predictions of each length: seconds, not minutes
constexpr Eigen::Index kReconstructions = 8;

/// Says what is done, and on a terminal how far.
std::function<void(double)> progress(const std::string& what) {
  const bool live = ::isatty(STDERR_FILENO) != 0;
  std::cerr << what << (live ? "" : "\n") << std::flush;
  return [what, live, shown = -1](double fraction) mutable {
    const int percent = static_cast<int>(100.0 * fraction);
    if (!live || percent == shown) return;
    shown = percent;
    std::cerr << "\r" << what << "  " << percent << " %" << (percent == 100 ? "\n" : "")
              << std::flush;
  };
}

std::string number(double value) { return "," + formatDouble(value); }

std::string numbers(const Eigen::VectorXd& values) {
  std::string text;
  for (Eigen::Index i = 0; i < values.size(); ++i) text += number(values[i]);
  return text;
}

/// ",z_1,z_2..."
std::string columns(const std::string& name, Eigen::Index count) {
  std::string text;
  for (Eigen::Index i = 1; i <= count; ++i) text += "," + name + "_" + std::to_string(i);
  return text;
}

/// A comma or a quote in a file's name must not tear its row.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

struct Bags {
  DataSet data;
  std::vector<BagContent> contents;
};

Bags readBags(const Ddm& model, const std::vector<std::string>& paths, const BagOptions& topics,
              const std::string& folder) {
  Bags bags{DataSet(model.imageSize(), model.torqueDim()), {}};
  const auto show = progress("reading " + std::to_string(paths.size()) + " bag(s)");
  std::string rows =
      "bag,camera,frames,pieces,images_without_torque,torques_without_image,interval_s,goal\n";
  for (size_t i = 0; i < paths.size(); ++i) {
    BagContent content = readBag(paths[i], model.imageSize(), topics);
    if (content.data.torqueDim() != model.torqueDim()) {
      throw std::runtime_error("bag " + paths[i] + ": has " +
                               std::to_string(content.data.torqueDim()) +
                               " torque(s) a frame, the model has " +
                               std::to_string(model.torqueDim()) + ": it is of another robot");
    }
    rows += quoted(paths[i]) + "," + quoted(content.camera) + "," +
            std::to_string(content.data.numFrames()) + "," +
            std::to_string(content.data.pieces().size()) + "," +
            std::to_string(content.num_images_without_torque) + "," +
            std::to_string(content.num_torques_without_image) + number(content.interval) + "," +
            (content.data.hasGoal() ? "1" : "0") + "\n";
    bags.data.append(content.data);
    bags.contents.push_back(std::move(content));
    show(static_cast<double>(i + 1) / static_cast<double>(paths.size()));
  }
  writeFileAtomically(folder + "/bags.csv", rows);
  return bags;
}

void writeFeatures(const Bags& bags, const Eigen::MatrixXd& Z, const ImageErrors& errors,
                   const std::string& path) {
  std::string text = "bag,piece,time_s" + columns("u", bags.data.torqueDim()) +
                     columns("z", Z.rows()) + ",mean_rms,pca_rms,reconstruction_rms\n";
  Eigen::Index frame = 0;
  size_t piece = 0;  // of all bags together
  for (size_t b = 0; b < bags.contents.size(); ++b) {
    for (const double time : bags.contents[b].times) {
      const std::vector<Piece>& pieces = bags.data.pieces();
      while (frame >= pieces[piece].begin + pieces[piece].size) ++piece;
      text += std::to_string(b) + "," + std::to_string(piece) + number(time) +
              numbers(bags.data.torques().col(frame)) + numbers(Z.col(frame)) +
              number(errors.mean[frame]) + number(errors.pca[frame]) +
              number(errors.reconstruction[frame]) + "\n";
      ++frame;
    }
  }
  writeFileAtomically(path, text);
}

/// Images one after the other, each row by row: an array [number x size x size].
class Pictures {
 public:
  explicit Pictures(int size) : size_(size) {}
  void add(const Grey& grey) { pixels_.insert(pixels_.end(), grey.begin(), grey.end()); }
  void write(const std::string& path) const {
    const Eigen::Index number = static_cast<Eigen::Index>(pixels_.size()) / (size_ * size_);
    writeFileAtomically(
        path, npyBytes("|u1", {number, size_, size_}, false, pixels_.data(), pixels_.size()));
  }

 private:
  Eigen::Index size_;
  std::vector<std::uint8_t> pixels_;
};

/// Some frames: as they are, as the principal components keep them, as the auto-encoder does.
void writeReconstructions(const Ddm& model, const DataSet& data, const std::string& path) {
  std::vector<Eigen::Index> all(static_cast<size_t>(data.numFrames()));
  for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Eigen::Index>(i);
  Pictures pictures(model.imageSize());
  for (const Eigen::Index frame : thinnedOut(all, kReconstructions)) {
    const Eigen::MatrixXf kept = model.pca().reconstruct(model.pca().project(data.image(frame)));
    Grey by_pca(data.image(frame).size());
    for (size_t i = 0; i < by_pca.size(); ++i) {
      const float grey = kept(static_cast<Eigen::Index>(i), 0);
      by_pca[i] = static_cast<std::uint8_t>(255.0F * std::min(1.0F, std::max(0.0F, grey)) + 0.5F);
    }
    pictures.add(data.image(frame));
    pictures.add(by_pca);
    pictures.add(model.decode(model.encode(data.image(frame))));
  }
  pictures.write(path);
}

void writeErrors(const std::vector<PredictionError>& errors, const std::string& path) {
  std::string text = "steps,num_predictions,rmse,rmse_repeat,rmse_mean_torque\n";
  for (const PredictionError& error : errors) {
    text += std::to_string(error.steps) + "," + std::to_string(error.num_predictions) +
            number(error.rmse) + number(error.rmse_repeat) + number(error.rmse_mean_torque) + "\n";
  }
  writeFileAtomically(path, text);
}

/// The frames whose longest predictions are in the middle, and worst, of all by the distance of the
/// feature predicted last to that of the image that came.
std::vector<std::pair<std::string, Eigen::Index>> notableStarts(
    const Ddm& model, const DataSet& data, const Eigen::MatrixXd& Z,
    const std::vector<Eigen::Index>& starts, int num_steps) {
  std::vector<std::pair<double, Eigen::Index>> ranked;
  for (const Eigen::Index frame : starts) {
    const Eigen::MatrixXd path = model.rollOut(Z, data.torques(), frame, num_steps);
    ranked.emplace_back((path.rightCols(1) - Z.col(frame + num_steps)).norm(), frame);
  }
  std::sort(ranked.begin(), ranked.end());
  return {{"typical", ranked[ranked.size() / 2].second}, {"worst", ranked.back().second}};
}

void writePredictions(const Ddm& model, const DataSet& data, const Eigen::MatrixXd& Z,
                      const std::vector<Eigen::Index>& starts, int num_steps,
                      const std::string& folder) {
  std::string text = "kind,frame,steps" + columns("z", Z.rows()) + "\n";
  for (const auto& notable : notableStarts(model, data, Z, starts, num_steps)) {
    const Eigen::Index frame = notable.second;
    const Eigen::MatrixXd path = model.rollOut(Z, data.torques(), frame, num_steps);
    Pictures pictures(model.imageSize());
    for (int k = 0; k <= num_steps; ++k) {
      text += notable.first + "," + std::to_string(frame) + "," + std::to_string(k) +
              numbers(path.col(k)) + "\n";
      pictures.add(data.image(frame + k));
      pictures.add(model.decode(path.col(k)));
    }
    pictures.write(folder + "/arrays/" + notable.first + "_prediction.npy");
  }
  writeFileAtomically(folder + "/predicted_features.csv", text);
}

/// The longest prediction, up to max_steps, that any piece has room for; 0: none.
int possibleSteps(const Ddm& model, const DataSet& data, int max_steps) {
  int steps = max_steps;
  while (steps > 0 && predictionStarts(model, data, steps).empty()) --steps;
  return steps;
}

}  // namespace

Eigen::MatrixXd measureBags(const Ddm& model, const std::vector<std::string>& paths,
                            const BagOptions& topics, int max_steps, const std::string& folder) {
  const Bags bags = readBags(model, paths, topics, folder);
  const DataSet& data = bags.data;
  const std::string frames = std::to_string(data.numFrames()) + " frames";
  const ImageErrors errors = imageErrors(model, data, progress("reconstructing " + frames));
  const Eigen::MatrixXd Z = encodeAll(model, data);
  writeFeatures(bags, Z, errors, folder + "/features.csv");
  std::string spectrum = "component,variance,share\n";
  for (Eigen::Index i = 0; i < errors.component_share.size(); ++i) {
    spectrum += std::to_string(i + 1) + number(model.pca().variance[i]) +
                number(errors.component_share[i]) + "\n";
  }
  writeFileAtomically(folder + "/spectrum.csv", spectrum);
  writeFileAtomically(folder + "/images.yaml",
                      "variation: " + formatDouble(errors.variation) + "\n");
  writeReconstructions(model, data, folder + "/arrays/reconstructions.npy");
  const int num_steps = possibleSteps(model, data, max_steps);
  if (num_steps < 1) {
    writeErrors({}, folder + "/prediction_errors.csv");
    return Z;
  }
  const std::vector<Eigen::Index> starts =
      thinnedOut(predictionStarts(model, data, num_steps), kMaxStarts);
  const auto show = progress("predicting " + std::to_string(num_steps) + " step(s) from " +
                             std::to_string(starts.size()) + " frames");
  writeErrors(predictionErrors(model, data, starts, num_steps, show),
              folder + "/prediction_errors.csv");
  writePredictions(model, data, Z, starts, num_steps, folder);
  return Z;
}

}  // namespace ddm
