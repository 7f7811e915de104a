// SPDX-License-Identifier: GPL-3.0-or-later
// <trellis/eigen.hpp>: views of the same memory, and poses as isometries.
#include <type_traits>
#include <utility>

#include <trellis/base/random.hpp>
#include <trellis/eigen.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

/// Whether as_eigen takes an argument of this type.
template <class T>
concept Viewable = requires(T&& value) {
  as_eigen(std::forward<T>(value));
};

Pose3 random_pose(Stream& stream) {
  const double first = stream.uniform();
  const double second = stream.uniform();
  return {{10.0 * first - 5.0, second, -3.0}, rotation_from_unit({first, second, stream.uniform()})};
}

double largest_difference(const Vec3& a, const Eigen::Vector3d& b) { return (as_eigen(a) - b).cwiseAbs().maxCoeff(); }

}  // namespace

SCENARIO("vectors, rotations and configurations are objects of Eigen without a copy", "[scene][eigen]") {
  GIVEN("vectors") {
    Vec2 flat{1.0, 2.0};
    Vec3 v{1.0, 2.0, 3.0};
    THEN("a view sees their memory, and writes to it") {
      CHECK(as_eigen(flat).data() == &flat.x);
      CHECK(as_eigen(v).data() == &v.x);
      as_eigen(flat) *= 2.0;
      CHECK(flat == Vec2{2.0, 4.0});
      as_eigen(v) += Eigen::Vector3d(10.0, 20.0, 30.0);
      CHECK(v == Vec3{11.0, 22.0, 33.0});
      as_eigen(v).y() = 5.0;
      CHECK(v == Vec3{11.0, 5.0, 33.0});
    }
    THEN("scalar and vector products are the same numbers") {
      const Vec3 w{-0.3, 0.7, 1e3};
      CHECK(as_eigen(v).dot(as_eigen(w)) == dot(v, w));
      const Vec3 product = cross(v, w);
      CHECK(as_eigen(v).cross(as_eigen(w)) == as_eigen(product));
    }
  }
  GIVEN("a rotation") {
    Quaternion q{0.1, 0.2, 0.3, 0.9};
    THEN("each coefficient is the one of the same name") {
      CHECK(as_eigen(q).x() == 0.1);
      CHECK(as_eigen(q).y() == 0.2);
      CHECK(as_eigen(q).z() == 0.3);
      CHECK(as_eigen(q).w() == 0.9);
      as_eigen(q) = Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5);  // w, x, y, z
      CHECK(q == Quaternion{-0.5, 0.5, -0.5, 0.5});
    }
    THEN("products and rotated vectors agree") {
      Stream stream(1, "0", "rotations");
      for (int i = 0; i < 100; ++i) {
        const Quaternion a = random_pose(stream).orientation;
        const Quaternion b = random_pose(stream).orientation;
        const Quaternion product = a * b;
        CHECK((as_eigen(a) * as_eigen(b)).coeffs().isApprox(as_eigen(product).coeffs(), 1e-14));
        const Vec3 v{0.3, -2.0, 1.0};
        CHECK(largest_difference(a(v), as_eigen(a) * as_eigen(v)) < 1e-14);
      }
    }
  }
  GIVEN("configurations") {
    Configurations rows(3);
    rows.push(Configuration{1.0, 2.0, 3.0});
    rows.push(Configuration{4.0, 5.0, 6.0});
    THEN("they are the rows of a matrix") {
      const auto matrix = as_eigen(rows);
      CHECK(matrix.rows() == 2);
      CHECK(matrix.cols() == 3);
      CHECK(matrix.data() == rows.values().data());
      CHECK(matrix(1, 0) == 4.0);
      CHECK(matrix.colwise().sum() == Eigen::RowVector3d(5.0, 7.0, 9.0));
    }
    THEN("a row is a column vector, which the matrix shows after it was written to") {
      const auto matrix = as_eigen(rows);
      as_eigen(rows[1]).setConstant(-1.0);
      CHECK(matrix.row(1) == Eigen::RowVector3d(-1.0, -1.0, -1.0));
      const View row = rows.front();
      CHECK(as_eigen(row).data() == row.data());
      CHECK(as_eigen(row).size() == 3);
    }
    THEN("no configurations are a matrix without rows") {
      const Configurations none(3);
      const Configurations moved;
      CHECK(as_eigen(none).rows() == 0);
      CHECK(as_eigen(none).cols() == 3);
      CHECK(as_eigen(moved).size() == 0);
    }
  }
  GIVEN("a configuration that owns its numbers") {
    Configuration q{1.0, 2.0};
    const Configuration& read = q;
    THEN("it is viewed, too") {
      as_eigen(q).reverseInPlace();
      CHECK(q == Configuration{2.0, 1.0});
      CHECK(as_eigen(read).data() == q.data());
    }
  }
  GIVEN("what does not live on, and what is constant") {
    THEN("there is no view of a temporary object, and none to write to of a constant one") {
      STATIC_REQUIRE(Viewable<Vec3&>);
      STATIC_REQUIRE(Viewable<View>);
      STATIC_REQUIRE_FALSE(Viewable<Vec2>);
      STATIC_REQUIRE_FALSE(Viewable<Vec3>);
      STATIC_REQUIRE_FALSE(Viewable<Quaternion>);
      STATIC_REQUIRE_FALSE(Viewable<Configuration>);
      STATIC_REQUIRE_FALSE(Viewable<Configurations>);
      STATIC_REQUIRE(
          std::is_same_v<decltype(as_eigen(std::declval<const Vec3&>())), Eigen::Map<const Eigen::Vector3d>>);
      STATIC_REQUIRE(std::is_same_v<decltype(as_eigen(std::declval<View>())), Eigen::Map<const Eigen::VectorXd>>);
    }
  }
}

SCENARIO("poses are isometries of Eigen", "[scene][eigen]") {
  Stream stream(2, "0", "poses");
  GIVEN("random poses and points") {
    THEN("both move points alike, compose alike and have the same inverse") {
      for (int i = 0; i < 100; ++i) {
        const Pose3 a = random_pose(stream);
        const Pose3 b = random_pose(stream);
        const Vec3 p{1.0, -2.0, 0.5};
        CHECK(largest_difference(a(p), isometry_of(a) * as_eigen(p)) < 1e-14);
        CHECK(largest_difference((a * b)(p), isometry_of(a) * isometry_of(b) * as_eigen(p)) < 1e-13);
        CHECK(largest_difference(a.inverse()(p), isometry_of(a).inverse() * as_eigen(p)) < 1e-14);
      }
    }
    THEN("there and back is the same pose") {
      for (int i = 0; i < 100; ++i) {
        const Pose3 pose = random_pose(stream);
        const Pose3 back = pose_of(isometry_of(pose));
        CHECK(back.position == pose.position);
        CHECK(angle_between(back.orientation, pose.orientation) < 1e-14);
        CHECK(back.orientation.w >= 0.0);
      }
    }
  }
  GIVEN("half turns, about each axis") {
    THEN("they return as well") {
      for (const Quaternion& turn : {Quaternion{1, 0, 0, 0}, Quaternion{0, 1, 0, 0}, Quaternion{0, 0, 1, 0}}) {
        CHECK(pose_of(isometry_of({{1, 2, 3}, turn})) == Pose3{{1, 2, 3}, turn});
      }
    }
  }
  GIVEN("the identity") {
    THEN("it is that of Eigen") {
      CHECK(isometry_of({}).matrix() == Eigen::Isometry3d::Identity().matrix());
      CHECK(pose_of(Eigen::Isometry3d::Identity()) == Pose3());
    }
  }
}
