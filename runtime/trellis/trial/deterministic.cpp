// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include <trellis/experiment/cell.hpp>
#include <trellis/report/words.hpp>
#include <trellis/trial/matcher.hpp>

namespace trellis::trial {

namespace {

class IsDeterministic final : public Matcher {
 public:
  [[nodiscard]] std::string text() const override { return "is deterministic"; }

  [[nodiscard]] Verdict judge(const Trial& trial) const override {
    constexpr unsigned least_threads = 4;
    const unsigned several = std::max(least_threads, std::thread::hardware_concurrency());
    const auto& runs = trial.runs();
    Verdict verdict;
    for (const unsigned threads : {1U, several}) {
      const auto again = trial.runs_again(threads);
      for (std::size_t i = 0; i < runs.size(); ++i) {
        const std::string difference = difference_text(runs[i], again[i]);
        if (difference.empty()) continue;
        verdict.finding = fmt::format("made again on {}, seed {} came out otherwise: {}", plural(threads, "thread"),
                                      runs[i].seed, difference);
        verdict.worst = runs[i].seed;
        verdict.why_worst = difference;
        return verdict;
      }
    }
    verdict.holds = true;
    verdict.finding = fmt::format("{} came out the same on 1 and on {} threads", plural(runs.size(), "run"), several);
    return verdict;
  }
};

}  // namespace

MatcherPointer is_deterministic() { return std::make_shared<IsDeterministic>(); }

}  // namespace trellis::trial
