// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/principal_axes.hpp>

#include <Eigen/Dense>

namespace trellis {

std::vector<std::vector<double>> principal_axes(const std::vector<double>& points, const std::vector<double>& first,
                                                std::size_t dimension) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto d = static_cast<Eigen::Index>(dimension);
  const Eigen::Map<const Rows> rows(points.data(), static_cast<Eigen::Index>(points.size()) / d, d);
  Eigen::MatrixXd moments = rows.transpose() * rows;
  std::vector<std::vector<double>> axes;
  axes.reserve(dimension);
  const auto add = [&](const Eigen::VectorXd& axis) { axes.emplace_back(axis.data(), axis.data() + d); };
  Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(d, d);
  if (!first.empty()) {
    const Eigen::Map<const Eigen::VectorXd> given(first.data(), d);
    if (given.norm() > 0.0) {
      const Eigen::VectorXd unit = given.normalized();
      add(unit);
      // An orthonormal basis of the orthogonal complement of `first`, which contains the other axes.
      const Eigen::HouseholderQR<Eigen::MatrixXd> qr{Eigen::MatrixXd(unit)};
      const Eigen::MatrixXd all = qr.householderQ() * Eigen::MatrixXd::Identity(d, d);
      rest = all.rightCols(d - 1);
    }
  }
  if (rest.cols() == 0) return axes;
  moments = (rest.transpose() * moments * rest).eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(moments);
  for (Eigen::Index j = rest.cols(); j-- > 0;) {
    Eigen::VectorXd axis = rest * solver.eigenvectors().col(j);
    // The library does not define the sign: makes the largest coordinate positive.
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis[largest] < 0.0) axis = -axis;
    add(axis);
  }
  return axes;
}

}  // namespace trellis
