// The data that a model is trained on: images and torques of all trials so far.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/data_set.h"

namespace ddm {

DataSet::DataSet(int image_size, int torque_dim)
    : image_size_(image_size), torque_dim_(torque_dim) {
  eigen_assert(image_size >= 1 && torque_dim >= 1);
}

void DataSet::append(const Image& image, const Eigen::VectorXd& torque, bool new_segment) {
  eigen_assert(static_cast<Eigen::Index>(image.size()) == numPixels());
  eigen_assert(torque.size() == torque_dim_ && torque.allFinite());
  if (new_segment || segments_.empty()) segments_.push_back({num_frames_, 0});
  images_.push_back(std::make_shared<const Image>(image));
  torques_.insert(torques_.end(), torque.data(), torque.data() + torque.size());
  ++segments_.back().size;
  ++num_frames_;
}

void DataSet::append(const DataSet& other) {
  eigen_assert(other.image_size_ == image_size_ && other.torque_dim_ == torque_dim_);
  for (const Segment& segment : other.segments_) {
    segments_.push_back({segment.begin + num_frames_, segment.size});
  }
  images_.insert(images_.end(), other.images_.begin(), other.images_.end());
  torques_.insert(torques_.end(), other.torques_.begin(), other.torques_.end());
  num_frames_ += other.num_frames_;
  if (other.hasGoal()) goal_ = other.goal_;
}

void DataSet::setGoal(const Image& image) {
  eigen_assert(static_cast<Eigen::Index>(image.size()) == numPixels());
  goal_ = image;
}

ImageMatrix DataSet::pixels(Eigen::Index begin, Eigen::Index size) const {
  ImageMatrix out(numPixels(), size);
  for (Eigen::Index i = 0; i < size; ++i) {
    out.col(i) = Eigen::Map<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 1>>(
        image(begin + i).data(), numPixels());
  }
  return out;
}

Eigen::Map<const Eigen::MatrixXd> DataSet::torques() const {
  return {torques_.data(), torque_dim_, num_frames_};
}

}  // namespace ddm
