// model_test_numbers: what C++ computes with a model, for tests of what Python does.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_reader.h>
#include <ddm_common/plain_file.h>
#include <ddm_model/ddm.h>
#include <ddm_model/model_file.h>
#include <ros/time.h>

#include <iostream>
#include <string>

/// usage: model_test_numbers MODEL BAG FRAME STEPS. A line for the feature of each frame, then one for each of those predicted
/// 0, 1, ... steps ahead of a frame, then one for the decoded image of each of these.
int main(int, char** argv) {
  ros::Time::init();
  const ddm::Ddm model = ddm::deserialiseModel(ddm::readFile(argv[1]), argv[1]);
  const ddm::DataSet data = ddm::readBag(argv[2], model.imageSize(), {}).data;
  const Eigen::MatrixXd Z = ddm::encodeAll(model, data);
  const Eigen::IOFormat exact(Eigen::FullPrecision, Eigen::DontAlignCols);
  const Eigen::MatrixXd path =
      model.rollOut(Z, data.torques(), std::stoi(argv[3]), std::stoi(argv[4]));
  std::cout << Z.transpose().format(exact) << "\n" << path.transpose().format(exact) << "\n";
  for (Eigen::Index k = 0; k < path.cols(); ++k) {
    for (const int grey : model.decode(path.col(k))) std::cout << grey << " ";
    std::cout << "\n";
  }
  return 0;
}
