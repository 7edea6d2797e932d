// Images that view_node draws: the feature space, and several images side by side.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace ddm {

/// Features drawn over the decoded grid, one per column. An empty matrix draws nothing.
struct FeatureOverlay {
  Eigen::MatrixXd experience;  ///< green dots: images seen so far  [feature_dim x N]
  Eigen::MatrixXd plan;        ///< yellow line with dots: z_0 ... z_K  [feature_dim x (K + 1)]
  Eigen::MatrixXd goal;        ///< red dot: z_ref  [feature_dim x 0 or 1]
  Eigen::MatrixXd current;     ///< cyan dot: z of the newest image  [feature_dim x 0 or 1]
};

/// The feature plane of one model (paper, Fig. 6): images decoded at 9 x 9 points over [-1, 1]^2.
/// The first feature points to the right and the second upwards. A grid point lies in the centre of
/// its image. The margin around the grid completes the range of arctan features, +-pi/2.
///
/// A model with one feature has a single row of images, in the middle. With three or more features,
/// the grid shows the plane where the others have the value of the goal feature (0 if the model has
/// no goal), and the overlay is projected onto it.
class FeaturePlane {
 public:
  static constexpr int kGrid = 9;       ///< decoded images per side
  static constexpr int kPitch = 48;     ///< size of an image and distance of two [pixels]
  static constexpr int kWidth = 605;    ///< size of the whole image, pi units of z [pixels]
  static constexpr double kUnit = 192;  ///< length of one unit of a feature [pixels]

  /// Decodes the grid, which takes longer than draw().
  explicit FeaturePlane(const Ddm& model);

  /// @return 8 bit red, green, blue  [kWidth x kWidth]
  cv::Mat draw(const FeatureOverlay& overlay) const;

  /// @param z  [feature_dim]
  /// @return   pixel of the feature. A feature far outside is moved closer, so that every finite
  ///           feature has a pixel
  static cv::Point pixelOf(const Eigen::Ref<const Eigen::VectorXd>& z);

 private:
  cv::Mat grid_;
};

/// One of several images side by side, with a caption.
struct Panel {
  Image image;  ///< empty: the panel stays black
  std::string caption;
};

constexpr int kPanelSeparator = 3;  ///< between two panels [pixels]
constexpr int kPanelCaption = 24;   ///< height of the captions, below the panels [pixels]

/// @return width and height of a panel: the smallest multiple of image_size that is >= 255 [pixels]
inline int panelSize(int image_size) { return (255 + image_size - 1) / image_size * image_size; }

/// Draws images side by side.
/// @param panels  at least one, each with an image of image_size x image_size or none
/// @return        8 bit grey
cv::Mat drawPanels(const std::vector<Panel>& panels, int image_size);

}  // namespace ddm
