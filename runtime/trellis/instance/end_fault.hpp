// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/instance/link_shapes.hpp>
#include <trellis/scene/scene.hpp>

// Why a start, a goal or any other configuration is not valid.

namespace trellis {

/// A start or a goal that is no valid configuration, or that no valid configuration reaches.
class InvalidEnd : public Error {
 public:
  using Error::Error;
};

/// Returns "lift = 2.5, expected it in [-2, 2]" for the first coordinate that is out of its bounds, with as many digits
/// as distinguish the numbers; "" where there is none.
std::string out_of_bounds(const Space& space, View q);

/// Why a configuration is not valid.
struct EndFault {
  std::string text;  ///< "link hand is in collision with obstacle 1 (board)"; "" where it is valid
  /// Whether it is valid as a start and as a goal all the same: only balls that cover a manipulator's shapes touch
  /// something, and `fit_covers` makes them smaller.
  bool fits = false;
};

/// What touches at a configuration of a manipulator, by its shapes.
struct ShapeContact {
  Contact contact;    ///< of the shapes; of the balls that cover them where the shapes touch nothing
  std::string hint;   ///< where only balls touch: how near the shapes are; else ""
  bool fits = false;  ///< as of EndFault
};
/// \param contact  what the checker of the problem found there; of other robots it is the result
/// \param shapes   of the scene; made where it is needed
ShapeContact shape_contact(const std::shared_ptr<const Scene>& scene, View q, const Contact& contact,
                           std::optional<ShapeChecker>& shapes);

/// Decides single configurations of a problem, of manipulators by the shapes of their links. Only one thread may use it
/// at a time.
class EndChecker {
 public:
  explicit EndChecker(Problem problem);

  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] EndFault fault(View q);

 private:
  Problem problem_;
  std::unique_ptr<Checker> checker_;
  std::optional<ShapeChecker> shapes_;  ///< of manipulators, once it is needed
};

}  // namespace trellis
