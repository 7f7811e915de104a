// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <dsl/command/store/records.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/store.hpp>

namespace trellis::command {

/// The records of `trellis run --out`, from which the same command continues.
class Resume : public RunStore {
 public:
  /// Opens the records of a folder. \throws Error if they are of other runs
  /// \param restart  deletes them
  /// \param others   whether the command has other outputs: then it continues without the folder where that cannot be
  ///                 written, and `failure` has the reason
  Resume(std::string folder, const Manifest& manifest, bool restart, bool others);

  // RunStore
  void planned(RunResult& run) override;
  bool restore_scores(RunResult& run) override;
  void scored(const RunResult& run) override;
  bool restore_pooled(const std::string& problem, std::vector<PooledScores>& pooled) override;
  void pooled(const std::string& problem, const std::vector<PooledScores>& pooled) override;

  /// Calls `write`, which writes to the folder. After a failure it calls nothing. Thread-safe.
  /// \throws Error where that fails and the command has no other output
  void attempt(const std::function<void()>& write);
  [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }

  /// The runs with a record, and whether this process restored the scores of one.
  [[nodiscard]] std::size_t runs() const { return runs_.size(); }
  [[nodiscard]] bool restored() const { return restored_; }

  /// Replaces the records by those of the results, in their order.
  void finish(const ExperimentFacts& experiment);

 private:
  std::string folder_;
  RecordFile runs_;
  RecordFile scores_;
  std::atomic<bool> restored_{false};
  bool others_;
  std::mutex failing_;  // guards the failure
  std::optional<Error> failure_;
};

}  // namespace trellis::command
