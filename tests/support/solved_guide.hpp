// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/guide.hpp>
#include <trellis/guide/path_steps.hpp>

#include "support/catch.hpp"
#include "support/density.hpp"

namespace trellis::test {

/// A guide with its space, solved as by the executor.
struct SolvedGuide {
  std::unique_ptr<Instance> parent;
  std::unique_ptr<Guide> guide;
  std::unique_ptr<Instance> sub;
  bool ends_valid = true;  ///< in S, before it was searched
  std::unique_ptr<UniformGuidance> uniform;
  Search search;
  std::unique_ptr<Planner> planner;
  Solution found;                     ///< the last path, if there is one
  std::vector<Configurations> paths;  ///< all that were found
  std::unique_ptr<Heuristic> h;
};

/// Solves the space of a guide by its default planner.
inline SolvedGuide solve_guide(const std::string& name, const std::vector<Options::Entry>& given,
                               const Problem& problem, std::uint64_t seed = 1, double proposals = Budget::unlimited) {
  SolvedGuide s;
  const GuideKind& kind = *find_guide(name);
  s.parent = make_instance(problem);
  s.guide = kind.make(Options::validate(*kind.component, given));
  s.sub = s.guide->project(*s.parent);
  if (!s.sub) {
    s.h = s.guide->heuristic(*s.parent, nullptr, nullptr);
    return s;
  }
  s.ends_valid = s.sub->validity->state(s.sub->start) && s.sub->validity->state(s.sub->goal());
  s.uniform = std::make_unique<UniformGuidance>(s.sub->space);
  s.search = Search(s.sub->space.dimension());
  const PlannerKind& planner = *find_planner(kind.default_planner);
  const Options options = Options::validate(*planner.component, {});
  s.guide->attach(*s.sub);
  s.planner = planner.make(options, {*s.sub, *s.uniform, Stream(seed, "0/0", "proposals"), s.search, false});
  Budget budget = planner.common(options).budget;
  budget.proposals = std::min({budget.proposals, proposals, s.guide->repairs().effort(false)});
  for (std::int64_t more = 1; more > 0;) {
    Solution found = s.planner->solve(*s.uniform, budget);
    const bool solved = found.solved();
    if (solved) s.paths.push_back(found.path);
    if (solved || s.paths.empty()) s.found = std::move(found);
    more = s.guide->repairs().another(solved ? &s.found : nullptr);
    budget.proposals = static_cast<double>(s.search.proposals.size()) + static_cast<double>(more);
  }
  s.h = s.guide->heuristic(*s.parent, s.sub.get(), &s.found);
  return s;
}

/// Checks that what h enters into a record is its density at every step.
/// \param count  of configurations where it is compared
inline void check_record(const SolvedGuide& solved, int count, int steps) {
  const Space& space = solved.parent->space;
  Stream stream(7, "0", "record");
  Configuration q(space.dimension());
  // Where h may have a density: its own first samples, and anywhere.
  Configurations probes(space.dimension());
  for (int i = 0; i < count; ++i) {
    if (i % 2 == 0) {
      space.sample_uniform(stream, q);
    } else {
      solved.h->sample(stream, q);
    }
    probes.push(q);
  }
  std::vector<double> sums(probes.size(), 0.0);
  double atoms = 0.0;
  DensityRecord record;
  const bool closed = !std::isnan(record_of(*solved.h).at(solved.parent->start));
  // However many steps there were: what follows a path by steps has balls of so many sizes.
  const std::size_t most_terms = dynamic_cast<const StepHeuristic*>(solved.h.get()) != nullptr ? 5 : 1;
  for (int t = 0; t < steps; ++t) {
    solved.h->sample(stream, q);
    record.served(*solved.h);
    const DensityRecord now = record_of(*solved.h);
    atoms += now.atoms() / steps;
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += now.at(std::as_const(probes)[i]) / steps;
    // Two of three proposals are reached, from wherever: stretches and regions move on.
    Outcome outcome;
    outcome.proposal = q;
    outcome.near = solved.parent->start;
    if (t % 3 != 0) {
      outcome.fate = Fate::reached;
      outcome.added = q;
    }
    solved.guide->learn(outcome);
    solved.h->observe(outcome, true);
  }
  REQUIRE(record.exact() == closed);
  if (!closed) return;
  CHECK(record.atoms() == Approx(atoms).margin(1e-12));
  for (int compacted = 0; compacted < 2; ++compacted) {
    for (std::size_t i = 0; i < sums.size(); ++i) {
      CHECK(record.at(std::as_const(probes)[i]) == Approx(sums[i]).epsilon(1e-9).margin(1e-300));
    }
    record.compact();
    CHECK(record.terms() <= most_terms);
  }
}

}  // namespace trellis::test
