// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/measure/statistics.hpp>
#include <trellis/report/words.hpp>
#include <trellis/trial/matcher.hpp>

namespace trellis::trial {

namespace {

class Solves final : public Matcher {
 public:
  explicit Solves(Criterion share) : share_(std::move(share)) {
    if (share_.other() || share_.quantity() != Quantity::none) {
      throw Error("solves: takes a share of the seeds, as solves(at_least(0.95))");
    }
    if (!(share_.value() >= 0.0 && share_.value() <= 1.0)) {
      throw Error(fmt::format("solves: a share is in [0, 1], got {:g}", share_.value()));
    }
    if (share_.asked_confidence() && share_.kind() == Criterion::Kind::exactly) {
      throw Error("solves: there is no confidence in an exact share");
    }
  }

  [[nodiscard]] std::string text() const override {
    const std::string sure = share_.asked_confidence()
                                 ? fmt::format(", with {:g} % confidence", 100.0 * share_.confidence())
                                 : std::string();
    return fmt::format("solves {} {:g} % of the seeds{}", to_string(share_.kind()), 100.0 * share_.value(), sure);
  }

  [[nodiscard]] Verdict judge(const Trial& trial) const override {
    const auto& runs = trial.runs();
    const auto count = [](const auto& all, bool solved) {
      return static_cast<std::size_t>(
          std::count_if(all.begin(), all.end(), [=](const RunResult& run) { return run.run.solved == solved; }));
    };
    const std::size_t solved = count(runs, true);
    // A one-sided claim assigns the whole error probability to that side.
    const Interval share = wilson_interval(solved, runs.size(), 2.0 * share_.confidence() - 1.0);
    Verdict verdict;
    verdict.finding = fmt::format("{} of {} ({} %)", solved, runs.size(), percent(share.value));
    if (share_.asked_confidence()) {
      const double end = share_.from_above() ? share.hi : share.lo;
      verdict.finding +=
          fmt::format(", {} {:.1f} % with {:g} % confidence", share_.from_above() ? "at most" : "at least", 100.0 * end,
                      100.0 * share_.confidence());
      verdict.holds = share_.met_by(end);
    } else {
      verdict.holds = share_.met_by(share.value);
    }
    if (verdict.holds) return verdict;
    // The first run that exceeds the claim.
    const bool too_few = share.value < share_.value() || (!share_.from_above() && solved < runs.size());
    for (const RunResult& run : runs) {
      if (run.run.solved == too_few || verdict.worst) continue;
      verdict.worst = run.seed;
      verdict.why_worst =
          run.run.solved ? "found a path" : fmt::format("found no path ({})", trellis::to_string(run.run.status));
    }
    return verdict;
  }

 private:
  Criterion share_;
};

}  // namespace

MatcherPointer solves(Criterion share) { return std::make_shared<Solves>(std::move(share)); }

}  // namespace trellis::trial
