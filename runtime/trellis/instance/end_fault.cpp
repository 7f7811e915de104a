// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/end_fault.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace trellis {

std::string out_of_bounds(const Space& space, View q) {
  constexpr int least_digits = 6;
  constexpr int most_digits = 17;
  const std::vector<Axis> axes = space.coordinates();
  for (std::size_t j = 0; j < axes.size(); ++j) {
    const Axis& axis = axes[j];
    if (axis.periodic || (q[j] >= axis.lo && q[j] <= axis.hi)) continue;
    const double bound = q[j] < axis.lo ? axis.lo : axis.hi;
    int digits = least_digits;
    while (digits < most_digits && fmt::format("{:.{}g}", q[j], digits) == fmt::format("{:.{}g}", bound, digits)) {
      ++digits;
    }
    return fmt::format("{} = {:.{}g}, expected it in [{:.{}g}, {:.{}g}]", axis.name, q[j], digits, axis.lo, digits,
                       axis.hi, digits);
  }
  return "";
}

ShapeContact shape_contact(const std::shared_ptr<const Scene>& scene, View q, const Contact& contact,
                           std::optional<ShapeChecker>& shapes) {
  const ManipulatorScene* arm = scene->manipulator();
  if (arm == nullptr || arm->robot.exact()) return {contact, "", false};
  if (!shapes) shapes.emplace(scene);
  const ShapeReport report = shapes->at(q);
  if (report.contact) return {*report.contact, "", false};
  ShapeContact found{contact, "", shapes->fits(report)};
  const double least = *std::min_element(report.room.begin(), report.room.end());
  constexpr double in_cm = 100.0;
  found.hint = found.fits ? " by its covers alone: its shapes touch nothing"
                          : fmt::format(
                                " by its covers alone: its shapes come as near as {:.2g} cm, and touch nothing, but "
                                "no cover decides that",
                                in_cm * least);
  return found;
}

EndChecker::EndChecker(Problem problem)
    : problem_(std::move(problem)),
      checker_(make_checker(problem_.collision, problem_.scene, problem_.space, problem_.resolution)) {}

EndFault EndChecker::fault(View q) {
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::all_of(q.begin(), q.end(), finite)) return {"a coordinate is no finite number"};
  if (std::string outside = out_of_bounds(problem_.space, q); !outside.empty()) return {std::move(outside)};
  if (problem_.motion_model && !problem_.motion_model->admits(q)) {
    return {fmt::format("it is out of the limits of {}", problem_.motion_model->text())};
  }
  const auto contact = checker_->contact(q);
  if (!contact) return {};
  const Scene& scene = *problem_.scene;
  const ShapeContact found = shape_contact(problem_.scene, q, *contact, shapes_);
  const std::string body = scene.body_name(found.contact.body);
  if (const auto other = found.contact.other) {
    const auto named = [](const std::string& link, const std::string& own) { return link.empty() ? own : link; };
    return {fmt::format("{} meets {}{}", named(found.contact.link, body),
                        named(found.contact.other_link, scene.body_name(*other)), found.hint),
            found.fits};
  }
  return {fmt::format("{} is in collision with {}{}", scene.body_count() > 1 ? body : "the robot",
                      describe(found.contact, scene), found.hint),
          found.fits};
}

}  // namespace trellis
