// The data that a model is trained on: images and torques of all trials so far.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace ddm {

/// Grey values k of one image, row by row from the top left. The paper's y is k / 255.  [D]
using Image = std::vector<std::uint8_t>;
/// Grey values of several images, one image per column.  [D x N]
using ImageMatrix = Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic>;

/// Samples without a gap between them: sample i+1 follows sample i by one sampling time.
struct Segment {
  Eigen::Index begin = 0;  ///< index of the first sample
  Eigen::Index size = 0;   ///< number of samples
};

/// Images and torques of any number of trials. A sample is a pair (y_t, u_t) of an image and the
/// torque that is applied after the image is seen. Pixels are stored once, as bytes: copies of a
/// data set, and data sets that it is appended to, share the stored images.
class DataSet {
 public:
  /// @param image_size  width and height of the images [pixels]
  /// @param torque_dim  number of motors
  DataSet(int image_size, int torque_dim);

  /// Appends a sample. Images and torques come from code that has checked them: wrong sizes are
  /// errors of the programmer, which eigen_assert reports in debug builds only.
  /// @param image       image y_t                                                            [D]
  /// @param torque     u_t [N m]                                                    [torque_dim]
  /// @param new_segment  true if the previous sample is not one sampling time earlier: at the first
  ///                   sample of a trial and after a gap. No training pair spans such a boundary
  void append(const Image& image, const Eigen::VectorXd& torque, bool new_segment);

  /// Appends all samples of another data set. No training pair spans the boundary between the two
  /// data sets. If the other data set has a goal image, it replaces the goal image of this one.
  void append(const DataSet& other);

  /// Sets the goal image y_ref (paper, Sec. 3.1), which is also training data of the auto-encoder.
  void setGoal(const Image& image);
  bool hasGoal() const { return !goal_.empty(); }
  const Image& goal() const { return goal_; }

  int imageSize() const { return image_size_; }
  int torqueDim() const { return torque_dim_; }
  Eigen::Index numPixels() const { return static_cast<Eigen::Index>(image_size_) * image_size_; }
  Eigen::Index numFrames() const { return num_frames_; }
  const std::vector<Segment>& segments() const { return segments_; }

  /// @return number of samples, plus one if there is a goal image
  Eigen::Index numImages() const { return num_frames_ + (hasGoal() ? 1 : 0); }
  /// @return the image of sample `number`, or the goal image if number = numFrames()
  const Image& image(Eigen::Index number) const {
    return number < num_frames_ ? *images_[number] : goal_;
  }
  /// Copies the images begin ... begin + size - 1 into columns. Meant for blocks of a few images.
  /// @return [D x size]
  ImageMatrix pixels(Eigen::Index begin, Eigen::Index size) const;
  /// @return torques of all samples [N m]  [torque_dim x numFrames()]
  Eigen::Map<const Eigen::MatrixXd> torques() const;

 private:
  int image_size_;
  int torque_dim_;
  Eigen::Index num_frames_ = 0;
  std::vector<std::shared_ptr<const Image>> images_;
  std::vector<double> torques_;
  std::vector<Segment> segments_;
  Image goal_;
};

}  // namespace ddm
