// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/checker.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/collision/common.hpp>
#include <trellis/collision/narrow_phase.hpp>
#include <trellis/collision/orders.hpp>

namespace trellis {

namespace {

/// Whether the first `dimension` coordinates, which move the robot, are finite. A configuration with another coordinate
/// is invalid.
bool is_finite(View q, std::size_t dimension) {
  // 0 times infinity or NaN is NaN, 0 times a finite number is 0.
  double sum = 0.0;
  for (std::size_t j = 0; j < dimension; ++j) sum += 0.0 * q[j];
  return sum == 0.0;
}

/// The largest number of configurations at which a checker validates a motion.
constexpr double most_configurations = 1U << 26U;

[[noreturn]] void refuse_motion(double displacement, double resolution) {
  throw Error(fmt::format("a motion of {} m at resolution {} m would take checks of more than {} configurations",
                          displacement, resolution, most_configurations));
}

/// Returns the number of configurations at which a checker validates a motion with this bound on its displacement:
/// max(1, ceil of their ratio).
/// \throws Error where the number exceeds most_configurations
std::uint32_t configurations_of(double displacement, double resolution) {
  const double count = displacement / resolution;
  if (!(count <= most_configurations)) refuse_motion(displacement, resolution);
  // Without SSE 4.1, std::ceil is a function call.
  const auto whole = static_cast<std::uint32_t>(count);
  const std::uint32_t up = whole + (static_cast<double>(whole) < count ? 1 : 0);
  return up == 0 ? 1 : up;
}

}  // namespace

Checker::Checker(const Scene& scene, std::unique_ptr<NarrowPhase> phase, double resolution)
    : phase_(std::move(phase)),
      dimension_(scene.robot_dimension()),
      resolution_(resolution),
      cost_(check_cost(scene)) {}

Checker::~Checker() = default;

bool Checker::valid(View q) const { return is_finite(q, dimension_) && !phase_->touches(q); }

std::uint32_t Checker::most_checks(View a, View b) const {
  if (!is_finite(a, dimension_) || !is_finite(b, dimension_)) return 1;
  return configurations_of(phase_->displacement(a, b), resolution_);
}

MotionReport Checker::validate(View a, View b, std::uint32_t n) const {
  if (!is_finite(a, dimension_) || !is_finite(b, dimension_)) return {false, 1, 1.0};
  if (n == 0) n = configurations_of(phase_->displacement(a, b), resolution_);
  const MotionReport valid{true, n, std::numeric_limits<double>::quiet_NaN()};
  switch (phase_->begin(a, b, n)) {
    case NarrowPhase::Decision::valid: return valid;
    case NarrowPhase::Decision::end_touches: return {false, 1, 1.0};
    case NarrowPhase::Decision::undecided: break;
  }
  const Order& order = order_of(n);
  for (std::uint32_t rank = 0; rank < n;) {
    const NarrowPhase::Batch batch = phase_->check(order, rank);
    if (batch.touches != 0) {
      const std::uint32_t first = rank + static_cast<std::uint32_t>(std::countr_zero(batch.touches));
      static_cast<void>(phase_->end(first));
      return {false, first + 1, order.share(first)};
    }
    rank += batch.count;
  }
  if (const auto between = phase_->end(n)) return {false, n, *between};
  return valid;
}

void Checker::certify(View a, View b, Certificate& certificate) const {
  if (!is_finite(a, dimension_) || !is_finite(b, dimension_)) {
    certificate.refuted_at = is_finite(a, dimension_) ? 1.0 : 0.0;
    return;
  }
  if (phase_->sweep(a, b, certificate)) return;
  const double longest =
      std::isfinite(certificate.nearest) ? std::max(resolution_, 2.0 * certificate.nearest) : resolution_;
  const NarrowPhase::Distances distances = phase_->on(a, b, longest);
  add_motion(certificate, distances.clearance, distances.displacement, distances.first, distances.breaks);
  if (distances.sure && std::exchange(certificate.refuted_at, std::nullopt)) {
    certificate.clearance = std::min(certificate.clearance, *distances.sure);
  }
}

double Checker::clearance(View q) const { return is_finite(q, dimension_) ? phase_->clearance(q) : 0.0; }

std::optional<Proximity> Checker::nearest_obstacle(View q) const { return phase_->nearest_obstacle(q); }

double Checker::invalid_radius(View q) const { return is_finite(q, dimension_) ? phase_->invalid_radius(q) : 0.0; }

std::optional<Contact> Checker::contact(View q) const {
  return is_finite(q, dimension_) ? phase_->contact(q) : Contact{0, std::nullopt};
}

std::unique_ptr<Checker> make_checker(const std::string& backend, std::shared_ptr<const Scene> scene,
                                      const Space& space, double resolution) {
  const std::vector<std::string> known = collision_backends(*scene);
  if (std::find(known.begin(), known.end(), backend) == known.end()) {
    throw Error(fmt::format("no collision backend '{}'; there are '{}' and '{}'{}", backend, known.front(),
                            known.back(), did_you_mean(backend, known)));
  }
  if (scene->manipulator() != nullptr) return make_sphere_checker(std::move(scene), space, resolution);
  if (scene->spatial() != nullptr) {
    return make_spatial_checker(std::move(scene), space, resolution, backend == "fcl");
  }
  if (backend == "planar") return make_planar_checker(std::move(scene), space, resolution);
  return make_fcl_checker(std::move(scene), space, resolution);
}

std::vector<std::string> collision_backends(const Scene& scene) {
  if (scene.manipulator() != nullptr) return {"spheres"};
  if (scene.spatial() != nullptr) return {"fcl", "fcl_plain"};
  return {"planar", "fcl"};
}

std::string describe(const Contact& contact, const Scene& scene) {
  if (contact.other) {
    return fmt::format("itself ({} meets {})", contact.link.empty() ? scene.body_name(contact.body) : contact.link,
                       contact.other_link.empty() ? scene.body_name(*contact.other) : contact.other_link);
  }
  if (!contact.obstacle) return "the world's boundary";
  return scene.obstacle_name(*contact.obstacle);
}

std::vector<std::uint32_t> bisection_order(std::uint32_t n) {
  std::vector<std::uint32_t> order;
  if (n == 0) return order;
  order.reserve(n);
  order.push_back(n);
  // Intervals whose midpoints come next; each level contains the halves of the intervals before, from the left.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> level = {{0, n}};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> next;
  while (!level.empty()) {
    next.clear();
    for (const auto& [lo, hi] : level) {
      if (hi - lo < 2) continue;
      const std::uint32_t middle = lo + (hi - lo) / 2;
      order.push_back(middle);
      next.emplace_back(lo, middle);
      next.emplace_back(middle, hi);
    }
    std::swap(level, next);
  }
  return order;
}

}  // namespace trellis
