// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"

namespace trellis::test {

/// All guides but those that need a team of robots.
inline const std::vector<GuideKind>& guides_of_one_robot() {
  static const std::vector<GuideKind> kinds = [] {
    std::vector<GuideKind> some;
    for (const GuideKind& kind : guide_kinds()) {
      if (kind.claims.needs != GuideClaims::Needs::team) some.push_back(kind);
    }
    return some;
  }();
  return kinds;
}

/// A guide with its options by default; one that needs a file has the name of none.
inline GuideSpec guide_of(const GuideKind& kind) {
  const std::string& name = kind.component->name;
  std::vector<Options::Entry> options;
  if (name == "learned") options.emplace_back("model", std::string("none.model"));
  if (name == "experience" || name == "path_database") options.emplace_back("db", std::string("none.db"));
  return GuideSpec::make(name, options);
}

/// A guide alone, and above each of these.
inline std::vector<GuideSpec> above(const GuideSpec& guide, const std::vector<std::string>& divisions) {
  std::vector<GuideSpec> all = {guide};
  for (const std::string& division : divisions) all.push_back(guide >> GuideSpec::make(division, {}));
  return all;
}

/// Plans with every guide, or checks that it says in a sentence why not.
/// \param specs  gives those to plan with, of a guide
/// \param check  is called with each run that found a path
/// \return how many planned
template <class Specs, class Check>
int plan_with_every_guide(const Problem& problem, const PlannerSpec& planner, const Specs& specs, const Check& check) {
  int planned = 0;
  for (const GuideKind& kind : guide_kinds()) {
    for (const GuideSpec& spec : specs(guide_of(kind))) {
      CAPTURE(spec.text());
      try {
        const RunRecord run = execute(spec >> planner, problem, 1);
        if (run.solved) check(run);
        ++planned;
      } catch (const Error& error) {
        CHECK(std::string(error.what()).size() > 20);
      }
    }
  }
  return planned;
}

}  // namespace trellis::test
