// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/end_fault.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

std::string fault_of(const Problem& problem, View q, const Checker& checker) {
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::all_of(q.begin(), q.end(), finite)) return "a coordinate is no finite number";
  if (std::string outside = out_of_bounds(problem.space, q); !outside.empty()) return outside;
  if (problem.motion_model && !problem.motion_model->admits(q)) {
    return fmt::format("it is out of the limits of {}", problem.motion_model->text());
  }
  const auto contact = checker.contact(q);
  if (!contact) return "";
  const Scene& scene = *problem.scene;
  const std::string body = scene.body_name(contact->body);
  if (contact->other) return fmt::format("{} meets {}", body, scene.body_name(*contact->other));
  return fmt::format("{} is in collision with {}", scene.body_count() > 1 ? body : "the robot",
                     describe(*contact, scene));
}

}  // namespace trellis
