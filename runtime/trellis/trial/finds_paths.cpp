// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <limits>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/instance/path_fault.hpp>
#include <trellis/report/words.hpp>
#include <trellis/trial/matcher.hpp>
#include <trellis/trial/paired_runs.hpp>

namespace trellis::trial {

namespace {

double length_of(const RunResult& run) {
  return run.run.solved ? run.run.length : std::numeric_limits<double>::quiet_NaN();
}

class FindsPaths final : public Matcher {
 public:
  explicit FindsPaths(std::optional<Criterion> length) : length_(std::move(length)) {
    if (!length_) return;
    if (length_->quantity() != Quantity::none) {
      throw Error(fmt::format("finds_paths: takes a length, as finds_paths(at_most(20)), got a number of {}",
                              to_string(length_->quantity())));
    }
    if (length_->kind() == Criterion::Kind::exactly) {
      throw Error("finds_paths: no two paths are exactly as long; give a bound, as at_most(20)");
    }
    if (length_->from_above() && length_->margin() >= 1.0) {
      throw Error(
          fmt::format("finds_paths: by(x) is a share of the other's length, less than 1, got {:g}", length_->margin()));
    }
  }

  [[nodiscard]] std::string text() const override {
    if (!length_) return "finds valid paths";
    if (!length_->other()) return fmt::format("finds valid paths, {} m long", length_->text());
    return fmt::format("finds valid paths {}{} than those of {}",
                       length_->margin() > 0.0 ? fmt::format("{:g} % ", 100.0 * length_->margin()) : "",
                       length_->from_above() ? "shorter" : "longer", length_->other()->name());
  }

  [[nodiscard]] Verdict judge(const Trial& trial) const override {
    const auto& runs = trial.runs();
    Verdict verdict;
    std::size_t found = 0;
    for (const RunResult& run : runs) {
      if (!run.run.solved) continue;
      ++found;
      const std::string fault = path_fault(trial.setup().problem, run.run.path);
      if (fault.empty()) continue;
      verdict.finding = fmt::format("the path of seed {} {}", run.seed, fault);
      verdict.worst = run.seed;
      verdict.why_worst = "its path " + fault;
      return verdict;
    }
    verdict.holds = found > 0;
    verdict.finding = fmt::format("{} found, all valid", plural(found, "path"));
    if (found == 0) {
      verdict.finding = fmt::format("none found in {}", plural(runs.size(), "run"));
      verdict.worst = runs.front().seed;
      verdict.why_worst = fmt::format("found no path ({})", trellis::to_string(runs.front().run.status));
    }
    if (!length_ || !verdict.holds) return verdict;
    const MedianWords words{"found a path of", "m", 2};
    if (!length_->other()) return judge_median(*length_, runs, length_of, words);
    return judge_ratio(*length_, pairs_of(runs, trial, length_->other()->runs(), *length_->other()), length_of,
                       length_of, words);
  }

 private:
  std::optional<Criterion> length_;
};

}  // namespace

MatcherPointer finds_paths(std::optional<Criterion> length) { return std::make_shared<FindsPaths>(std::move(length)); }

}  // namespace trellis::trial
