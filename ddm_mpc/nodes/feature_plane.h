// Picture of the feature space: a grid of decoded images and what has been, is and shall be in it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace ddm {

/// Colours of what is drawn over the grid: red, green, blue.
namespace feature_colours {
inline const cv::Scalar kExperience(0, 200, 0);
inline const cv::Scalar kPlan(255, 255, 0);
inline const cv::Scalar kGoal(255, 0, 0);
inline const cv::Scalar kCurrent(0, 255, 255);
}  // namespace feature_colours

/// What is drawn over the decoded grid; features are columns, and an empty matrix draws nothing.
struct FeatureOverlay {
  Eigen::MatrixXd experience;  ///< green dots: images seen so far          [feature_dim x N]
  Eigen::MatrixXd plan;        ///< yellow line with dots: z_0 ... z_K      [feature_dim x (K + 1)]
  Eigen::MatrixXd goal;        ///< red dot: z_ref                          [feature_dim x 0 or 1]
  Eigen::MatrixXd current;     ///< cyan dot: z of the image just seen      [feature_dim x 0 or 1]
};

/// The feature plane of one model (paper, Fig. 6): images decoded at 9 x 9 points over
/// [-1, 1]^2, the first feature to the right and the second upwards. A grid point lies in the
/// middle of its image. The margin around the grid shows the rest of what arctan features can be,
/// +-pi/2.
///
/// With one feature there is one row of images, in the middle. With three or more, those from the
/// third on have the goal's value in the grid (0 where the model has no goal); the overlay is seen
/// along them.
class FeaturePlane {
 public:
  static constexpr int kGrid = 9;       ///< decoded images per side
  static constexpr int kPitch = 48;     ///< from one image to the next, and their size [pixels]
  static constexpr int kWidth = 605;    ///< width and height of the picture [pixels]: pi units of z
  static constexpr double kUnit = 192;  ///< a difference of 1 in a feature [pixels]

  /// Decodes the grid; this is the slow part.
  explicit FeaturePlane(const Ddm& model);

  /// @return picture, 8 bit red, green, blue  [kWidth x kWidth]
  cv::Mat draw(const FeatureOverlay& overlay) const;

  /// The decoded images alone, one to each kPitch pixels.
  cv::Mat images() const { return grid_(images_); }

  /// What all images have in common from the third feature on.  [feature_dim]
  const Eigen::VectorXd& slice() const { return slice_; }

  /// Where a feature is drawn. Beyond the picture it is brought near, so that any finite feature
  /// will do.
  /// @param z  [feature_dim]
  static cv::Point pixelOf(const Eigen::Ref<const Eigen::VectorXd>& z);

 private:
  Eigen::VectorXd slice_;
  cv::Mat grid_;
  cv::Rect images_;  // where they are in the grid's picture
};

}  // namespace ddm
