// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/store/resume.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/experiment/stored_runs.hpp>
#include <trellis/report/report.hpp>
#include <trellis/results/records.hpp>

namespace trellis::command {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* runs_file = "runs.jsonl";
constexpr const char* scores_file = "scores.jsonl";

template <class Run>
RunKey key_of(const Run& run) {
  return {utf8(run.problem), utf8(run.strategy), run.seed};
}
// No strategy has an empty name: these records are of a whole problem.
RunKey pooled_key(const std::string& problem) { return {utf8(problem), "", 0}; }

}  // namespace

Resume::Resume(std::string folder, const Manifest& manifest, bool restart, bool others)
    : folder_(std::move(folder)),
      runs_(folder_, runs_file, restart),
      scores_(folder_, scores_file, restart),
      others_(others) {
  if (restart || !Manifest::exists(folder_)) {
    attempt([&] { manifest.write(folder_); });
  }
}

void Resume::attempt(const std::function<void()>& write) {
  {
    const std::scoped_lock lock(failing_);
    if (failure_) return;
  }
  try {
    write();
  } catch (const Error& error) {
    if (!others_) throw;
    const std::scoped_lock lock(failing_);
    if (!failure_) failure_ = error;
  }
}

void Resume::planned(RunResult& run) {
  const RunKey key = key_of(run);
  const auto stored = runs_.find(key);
  if (!stored) {
    attempt([&] { runs_.append(key, run_line(facts_of(run))); });
    return;
  }
  restore_times(run, *stored);
  if (equal_but_for_scores(*stored, run_line(facts_of(run)))) return;
  throw Error(fmt::format(
      "{}: {} differs from its record when it is planned again; the program, the machine or a file that the script "
      "reads has changed: name another folder, or start again with --restart",
      (fs::path(folder_) / runs_file).string(), key.text()));
}

bool Resume::restore_scores(RunResult& run) {
  const auto stored = scores_.find(key_of(run));
  if (!stored) return false;
  trellis::restore_scores(run, *stored);
  restored_ = true;
  return true;
}

void Resume::scored(const RunResult& run) {
  attempt([&] { scores_.append(key_of(run), scores_line(run)); });
}

bool Resume::restore_pooled(const std::string& problem, std::vector<PooledScores>& pooled) {
  const auto stored = scores_.find(pooled_key(problem));
  if (!stored) return false;
  trellis::restore_pooled(pooled, *stored);
  return true;
}

void Resume::pooled(const std::string& problem, const std::vector<PooledScores>& pooled) {
  attempt([&] { scores_.append(pooled_key(problem), pooled_line(problem, pooled)); });
}

void Resume::finish(const ExperimentFacts& experiment) {
  std::string runs;
  std::string scores;
  const auto add_scores = [&](const RunKey& key) {
    const auto stored = scores_.find(key);
    if (stored) scores += *stored + '\n';
  };
  for (std::size_t i = 0; i < experiment.runs.size(); ++i) {
    const RunFacts& run = experiment.runs[i];
    runs += run_line(run) + '\n';
    add_scores(key_of(run));
    if (i + 1 < experiment.runs.size() && experiment.runs[i + 1].problem == run.problem) continue;
    add_scores(pooled_key(run.problem));
  }
  write_file((fs::path(folder_) / runs_file).string(), runs);
  write_file((fs::path(folder_) / scores_file).string(), scores);
}

}  // namespace trellis::command
