// The experience that a model is trained on: images and torques of all trials so far.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace ddm {

/// Grey values k of one image, row by row from the top left; the paper's y is k / 255.  [D]
using Grey = std::vector<std::uint8_t>;
/// The same of several images, one per column.  [D x N]
using GreyMatrix = Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic>;

/// Frames without a gap between them: frame i+1 follows frame i by one sampling time.
struct Segment {
  Eigen::Index begin = 0;  ///< first frame
  Eigen::Index size = 0;   ///< number of frames
};

/// Images and torques of any number of trials. A frame is a pair (y_t, u_t): the torque that was
/// applied after the image was seen. Pixels are kept once, as bytes: copies of a data set, and
/// others that it was appended to, share them.
class DataSet {
 public:
  /// @param image_size  images have image_size x image_size pixels
  /// @param torque_dim  number of motors
  /// @throws std::invalid_argument if one is < 1
  DataSet(int image_size, int torque_dim);

  /// Appends a frame.
  /// @param grey       image y_t                                                            [D]
  /// @param torque     u_t [N m]                                                    [torque_dim]
  /// @param new_segment  true where the previous frame is not the one of a sampling time before (the
  ///                   first of a trial, or after a gap): no training pair straddles this
  /// @throws std::invalid_argument for a wrong size or a torque that is not finite
  void append(const Grey& grey, const Eigen::VectorXd& torque, bool new_segment);

  /// Appends all frames of another data set; no pair straddles the seam. Takes over its goal image if
  /// it has one: the last one counts.
  /// @throws std::invalid_argument if image size or torque dimension differ
  void append(const DataSet& other);

  /// The paper's reference image; it is part of the auto-encoder's training data.
  /// @throws std::invalid_argument for a wrong size
  void setGoal(const Grey& grey);
  bool hasGoal() const { return !goal_.empty(); }
  const Grey& goal() const { return goal_; }

  int imageSize() const { return image_size_; }
  int torqueDim() const { return torque_dim_; }
  Eigen::Index numPixels() const { return static_cast<Eigen::Index>(image_size_) * image_size_; }
  Eigen::Index numFrames() const { return num_frames_; }
  const std::vector<Segment>& segments() const { return segments_; }

  /// Number of frames, and one for the goal if there is one.
  Eigen::Index numImages() const { return num_frames_ + (hasGoal() ? 1 : 0); }
  /// The image of a frame; numFrames() is the goal's number.
  const Grey& image(Eigen::Index number) const {
    return number < num_frames_ ? *images_[number] : goal_;
  }
  /// Images side by side, copied: for a block of them at a time.
  /// @return [D x size]
  GreyMatrix pixels(Eigen::Index begin, Eigen::Index size) const;
  /// @return torques of all frames [N m]  [torque_dim x numFrames()]
  Eigen::Map<const Eigen::MatrixXd> torques() const;

 private:
  int image_size_;
  int torque_dim_;
  Eigen::Index num_frames_ = 0;
  std::vector<std::shared_ptr<const Grey>> images_;
  std::vector<double> torques_;
  std::vector<Segment> segments_;
  Grey goal_;
};

}  // namespace ddm
