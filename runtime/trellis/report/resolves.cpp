// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/resolves.hpp>

#include <fmt/format.h>

#include <trellis/report/summary.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

std::string resolves_text(const LevelSummary& level) {
  const ResolvesSummary& of = level.resolved_for;
  std::uint64_t all = 0;
  std::string reasons;
  for (const ResolveReason& reason : resolve_reasons) {
    const std::uint64_t count = of.total.*reason.count;
    if (count == 0) continue;
    all += count;
    reasons += fmt::format("{}{} ({})", reasons.empty() ? "" : ", ", reason.text, count);
  }
  std::string text;
  if (all > 0) text = fmt::format("solved again {}: {}", plural(all, "time"), reasons);
  const auto add = [&](std::size_t runs, const char* what) {
    if (runs > 0) text += fmt::format("{}{} in {}", text.empty() ? "" : "; ", what, plural(runs, "run"));
  };
  add(of.exhausted, "the search found no other path");
  add(of.limited, "its path was refuted and its limit of re-solves was reached");
  return text;
}

}  // namespace trellis
