// Pictures that view_node draws: the feature space, and images of the model side by side.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace ddm {

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

  /// Where a feature is drawn. Beyond the picture it is brought near, so that any finite feature
  /// will do.
  /// @param z  [feature_dim]
  static cv::Point pixelOf(const Eigen::Ref<const Eigen::VectorXd>& z);

 private:
  cv::Mat grid_;
};

/// One of several images side by side, with a caption.
struct Panel {
  Grey grey;  ///< empty: the panel stays black
  std::string caption;
};

constexpr int kPanelSeparator = 3;  ///< between two panels [pixels]
constexpr int kPanelCaption = 24;   ///< height of the captions, below the panels [pixels]

/// Width and height of a panel: as many whole times the image as make it 255 pixels or more.
inline int panelSize(int image_size) { return (255 + image_size - 1) / image_size * image_size; }

/// @param panels  at least one, with images of image_size x image_size
/// @return        8 bit grey
cv::Mat drawPanels(const std::vector<Panel>& panels, int image_size);

}  // namespace ddm
