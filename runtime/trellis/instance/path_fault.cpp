// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/path_fault.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

/// Says where a path is invalid.
std::string place_text(const Instance& instance, const InvalidPlace& place, double tolerance) {
  using Kind = InvalidPlace::Kind;
  const std::size_t number = place.point + 1;
  if (place.kind == Kind::outside) return fmt::format("leaves the space at point {}", number);
  const std::string where = place.kind == Kind::point
                                ? fmt::format("at point {}", number)
                                : fmt::format("between the points {} and {}", place.point, number);
  const std::string at = fmt::format("({:.4g})", fmt::join(place.invalid, ", "));
  if (const auto contact = instance.validity->contact(place.invalid)) {
    return fmt::format("is invalid {}: {} touches {}", where, at, describe(*contact, *instance.scene));
  }
  return fmt::format("is not certified {}: {} is too close to contact to decide with a tolerance of {:.2g} m", where,
                     at, tolerance);
}

/// Adds a motion to a certificate; returns whether it is certified. A proof by other intervals, as that of a search
/// that certified the motion alone and from its other end, is as good as the first.
bool add_proved(const Space& space, Validity& validity, View a, View b, Certificate& certificate) {
  const Certificate before = certificate;
  validity.certify(a, b, certificate);
  if (certificate.valid()) return true;
  Configuration middle(a.size());
  Configuration back(a.size());
  space.interpolate(a, b, 0.5, middle);
  space.interpolate(b, a, 0.5, back);
  for (const bool reversed : {false, true}) {
    // Of a half turn the motion back is another one.
    if (reversed && space.distance(middle, back) > certificate.tolerance) break;
    Certificate alone{certificate.tolerance};
    validity.certify(reversed ? b : a, reversed ? a : b, alone);
    certificate.checks += alone.checks;
    if (!alone.valid()) continue;
    certificate = {certificate.tolerance, std::min(before.nearest, alone.nearest),
                   std::min(before.clearance, alone.clearance), certificate.checks};
    return true;
  }
  return false;
}

}  // namespace

PathCertificate certify(const Space& space, Validity& validity, const Configurations& path, double tolerance) {
  using Kind = InvalidPlace::Kind;
  PathCertificate result;
  Certificate certificate{tolerance};
  const auto refute = [&](InvalidPlace place) {
    result.refuted = std::move(place);
    result.checks += certificate.checks;
    return result;
  };
  // The points first: the least of their distances decides most of the motions at once.
  for (std::size_t i = 0; i < path.size(); ++i) {
    const View point = path[i];
    const auto at_point = [&](Kind kind) { return InvalidPlace{kind, i, Configuration(point.begin(), point.end())}; };
    if (!space.contains(point)) return refute(at_point(Kind::outside));
    validity.certify(point, point, certificate);
    if (!certificate.valid()) return refute(at_point(Kind::point));
  }
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (add_proved(space, validity, path[i - 1], path[i], certificate)) continue;
    InvalidPlace place{Kind::motion, i, Configuration(path.dimension())};
    space.interpolate(path[i - 1], path[i], *certificate.refuted_at, place.invalid);
    return refute(std::move(place));
  }
  result.clearance = certificate.clearance;
  result.checks += certificate.checks;
  return result;
}

double certificate_tolerance(const Problem& problem) {
  return problem.contact_tolerance > 0.0 ? problem.contact_tolerance : certificate_share * problem.resolution;
}

std::string path_fault(const Problem& problem, const Configurations& path, double* clearance) {
  if (path.empty()) return "is empty";
  if (path.dimension() != problem.space.dimension()) {
    return fmt::format("has {} coordinates, and {} has {}", path.dimension(), problem.space.name(),
                       problem.space.dimension());
  }
  const auto instance = make_instance(problem);
  // A search normalises angles; a problem stores them as the user gave them.
  Configuration start = problem.start;
  Configuration first(path.front().begin(), path.front().end());
  problem.space.normalise(start);
  problem.space.normalise(first);
  if (start != first) {
    return "does not begin at the start";
  }
  if (instance->to_goal(path.back()) > problem.goal_tolerance) return "does not end at the goal";
  const PathCertificate certificate =
      certify(instance->space, *instance->validity, path, certificate_tolerance(problem));
  if (clearance != nullptr) *clearance = certificate.clearance;
  return certificate.refuted ? place_text(*instance, *certificate.refuted, certificate_tolerance(problem)) : "";
}

std::string checked_fault(const Problem& problem, const Configurations& path) {
  using Kind = InvalidPlace::Kind;
  const auto instance = make_instance(problem);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const View point = path[i];
    if (!instance->valid(point)) {
      return place_text(*instance, {Kind::point, i, Configuration(point.begin(), point.end())}, 0.0);
    }
    if (i == 0) continue;
    const MotionReport report = instance->motion(path[i - 1], point);
    if (report.valid) continue;
    InvalidPlace place{Kind::motion, i, Configuration(point.size())};
    instance->space.interpolate(path[i - 1], point, report.invalid_at, place.invalid);
    return place_text(*instance, place, 0.0);
  }
  return "";
}

std::string trajectory_fault(const Problem& problem, const Configurations& path, const Trajectory& trajectory) {
  // Documents store numbers with all their digits, so that states agree to within rounding.
  constexpr double tolerance = 1e-9;
  if (path.empty()) return "is empty";
  const std::uint64_t steps = std::accumulate(trajectory.steps.begin(), trajectory.steps.end(), std::uint64_t{0});
  if (steps + 1 != path.size()) {
    return fmt::format("has {} states, and its controls drive the robot through {}", path.size(), steps + 1);
  }
  Configurations states;
  try {
    states = replay(*problem.motion_model, problem.space, path.front(), trajectory);
  } catch (const Error& error) {
    return fmt::format("cannot be driven: {}", error.what());
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (problem.space.distance(std::as_const(states)[i], path[i]) > tolerance) {
      return fmt::format("is not where its controls drive the robot, at point {}", i + 1);
    }
  }
  return "";
}

}  // namespace trellis
