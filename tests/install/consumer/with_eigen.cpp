// SPDX-License-Identifier: GPL-3.0-or-later
// Reads and writes configurations and poses by Eigen.
#include <iostream>

#include <trellis/eigen.hpp>

int main() {
  using namespace trellis;
  Configurations path(2);
  path.push(Configuration{0.0, 1.0});
  path.push(Configuration{2.0, 3.0});
  const Eigen::RowVectorXd mean = as_eigen(path).colwise().mean();
  as_eigen(path[1]) *= 2.0;
  const Pose3 turned = pose_of(Eigen::Translation3d(0, 0, 1) * isometry_of({{1, 0, 0}, {0, 0, 1, 0}}));
  std::cout << "mean " << mean << ", end " << as_eigen(path[1]).transpose() << ", at "
            << as_eigen(turned.position).transpose() << '\n';
}
