// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/team_parts.hpp>

#include <fmt/format.h>

#include <trellis/instance/path_fault.hpp>
#include <trellis/planner/planner.hpp>

namespace trellis {

double exact_tolerance_of(const Instance& instance) { return certificate_share * instance.resolution; }

double coarse_tolerance_of(const Instance& instance) {
  constexpr double share = 0.2;
  return share * instance.resolution;
}

bool certified(Instance& instance, const Configurations& path) {
  for (const double tolerance : {coarse_tolerance_of(instance), exact_tolerance_of(instance)}) {
    const PathCertificate certificate = certify(instance.space, *instance.validity, path, tolerance);
    instance.checks.validity += certificate.checks;
    if (certificate.certified()) return true;
  }
  return false;
}

std::string name_of(const std::vector<TeamMember>& members, const std::vector<std::size_t>& robots) {
  std::vector<std::size_t> numbers;
  numbers.reserve(robots.size());
  for (const std::size_t i : robots) numbers.push_back(members[i].number);
  return fmt::format("robot{} {}", robots.size() == 1 ? "" : "s", fmt::join(numbers, ", "));
}

Configurations shortened(const Run& run, Level& level) {
  constexpr std::int64_t rounds = 30;
  Stream stream(run.seed, level.record().key, "shortcut");
  return shortcut(level.instance(), level.solution().path, rounds, stream);
}

void count_checks(const Instance& part, Instance& team) {
  team.checks.validity += part.checks.validity;
  team.checks.motion += part.checks.motion;
  team.checks.alone += part.checks.alone;
}

}  // namespace trellis
