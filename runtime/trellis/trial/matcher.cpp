// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/trial/matcher.hpp>

#include <fmt/format.h>

#include <algorithm>

#include <trellis/experiment/experiment.hpp>
#include <trellis/report/report.hpp>

namespace trellis::trial {

std::string sentence(const Trial& trial, const Matcher& matcher, const Verdict& verdict) {
  return fmt::format("{} {}: {}", trial.name(), matcher.text(), verdict.finding);
}

std::string evidence(const Trial& trial, const Matcher& matcher, const Verdict& verdict, int width) {
  if (!verdict.worst) return "";
  const auto& runs = trial.runs();
  const auto run = std::find_if(runs.begin(), runs.end(), [&](const RunResult& r) { return r.seed == *verdict.worst; });
  if (run == runs.end()) return "";
  return fmt::format(
      "seed {}: {}\n{}{}replay: {}\n", *verdict.worst, verdict.why_worst, levels_text(summarise(facts_of(*run)), width),
      matcher.of_efficiency() ? efficiency_text(summarise(facts_of(*run)), width) : "", trial.replay(*verdict.worst));
}

}  // namespace trellis::trial
