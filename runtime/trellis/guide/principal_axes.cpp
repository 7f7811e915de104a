// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/principal_axes.hpp>

#include <Eigen/Dense>

namespace trellis {

std::vector<std::vector<double>> principal_axes(const std::vector<double>& points,
                                                const std::vector<std::vector<double>>& first, std::size_t dimension) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto d = static_cast<Eigen::Index>(dimension);
  const Eigen::Map<const Rows> rows(points.data(), static_cast<Eigen::Index>(points.size()) / d, d);
  Eigen::MatrixXd moments = rows.transpose() * rows;
  std::vector<std::vector<double>> axes;
  axes.reserve(dimension);
  const auto add = [&](const Eigen::VectorXd& axis) { axes.emplace_back(axis.data(), axis.data() + d); };
  Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(d, d);
  Eigen::MatrixXd units(d, 0);
  for (const auto& direction : first) {
    const Eigen::Map<const Eigen::VectorXd> given(direction.data(), d);
    Eigen::VectorXd left = given;
    // Twice: once leaves errors where the direction is nearly in the span of those before.
    for (int i = 0; i < 2 && units.cols() > 0; ++i) left -= units * (units.transpose() * left).eval();
    constexpr double rounding = 1e-9;
    if (units.cols() == d || !(left.norm() > (units.cols() > 0 ? rounding * given.norm() : 0.0))) continue;
    const Eigen::VectorXd unit = left.normalized();
    add(unit);
    units.conservativeResize(Eigen::NoChange, units.cols() + 1);
    units.rightCols(1) = unit;
  }
  if (units.cols() > 0) {
    // An orthonormal basis of the orthogonal complement of `first`, which contains the other axes.
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr{units};
    const Eigen::MatrixXd all = qr.householderQ() * Eigen::MatrixXd::Identity(d, d);
    rest = all.rightCols(d - units.cols());
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
