// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <dsl/command/commands.hpp>
#include <dsl/command/interrupt.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/command/store/junit.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/language/tools/scenario_file.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/words.hpp>

namespace trellis::command {

namespace {

constexpr int table_width = 120;
constexpr std::uint64_t most_jobs = 1024;
constexpr std::string_view margin = "        ";

std::string indented(std::string_view text) {
  std::string all;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (!line.empty()) all += margin;
    all += line;
    all += '\n';
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return all;
}

struct TestOptions {
  std::vector<std::string> files;
  std::string filter;  ///< a part of the names of the scenarios to run
  std::optional<std::uint64_t> seeds;
  std::optional<std::uint64_t> jobs;
  std::string junit;  ///< a file, "" if not given
  ScriptOptions scripts;
};

struct Tally {
  std::size_t scenarios = 0;
  std::size_t failed_scenarios = 0;
  std::size_t expectations = 0;
  std::size_t failed_expectations = 0;
  bool script_wrong = false;
};

/// Prints the results of a scenario as they arrive.
class ScenarioPrinter {
 public:
  explicit ScenarioPrinter(JunitCase& into) : into_(into) {}

  void say(const std::string& text) {
    print_all(text);
    into_.text += text;
  }
  void fail(const std::string& sentence) {
    if (into_.failure.empty()) into_.failure = sentence;
  }

 private:
  JunitCase& into_;
};

void judge(const dsl::Step& step, ScenarioPrinter& printer, Tally& tally) {
  const auto& [trial, matcher] = *step.expectation;
  ++tally.expectations;
  trial::Verdict verdict;
  try {
    verdict = matcher->judge(trial);
  } catch (const Error& error) {
    throw Error(step.where.prefix() + error.what());
  }
  const std::string sentence = trial::sentence(trial, *matcher, verdict);
  if (verdict.holds) {
    printer.say(fmt::format("  ok    {}\n", sentence));
    return;
  }
  ++tally.failed_expectations;
  printer.say(fmt::format("  FAIL  {}\n{}", sentence,
                          indented(fmt::format("at {}:{}\n{}", step.where.script, step.where.line,
                                               trial::evidence(trial, *matcher, verdict, table_width)))));
  printer.fail(sentence);
}

/// Runs a scenario and prints its result.
JunitCase try_scenario(dsl::ScenarioFile& file, std::size_t index, Tally& tally) {
  JunitCase result;
  result.name = file.names()[index];
  ScenarioPrinter printer(result);
  const auto begin = std::chrono::steady_clock::now();
  ++tally.scenarios;
  print_all(fmt::format("\nscenario: {}\n", result.name));
  try {
    const dsl::Scenario& scenario = file.play(index);
    bool expected = false;
    for (const dsl::Step& step : scenario.steps) {
      if (step.kind == dsl::Step::Kind::given) printer.say(fmt::format("  given {}\n", step.text));
      if (step.kind == dsl::Step::Kind::when) printer.say(fmt::format("  when  {}\n", step.text));
      if (step.kind != dsl::Step::Kind::expect) continue;
      expected = true;
      judge(step, printer, tally);
    }
    if (!expected) throw Error(scenario.where.prefix() + "the scenario expects nothing; write expect(trial, matcher)");
  } catch (const Error& error) {
    result.error = error.what();
    printer.say(fmt::format("  ERROR {}\n", error.what()));
  }
  if (!result.failure.empty() || !result.error.empty()) ++tally.failed_scenarios;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

JunitSuite try_file(const std::string& path, const dsl::ScenarioFile::Options& options, const std::string& filter,
                    Tally& tally) {
  JunitSuite suite{path, {}};
  std::optional<dsl::ScenarioFile> file;
  try {
    file.emplace(path, options);
  } catch (const Error& error) {
    // Continue with the other files.
    print_message(error.what());
    tally.script_wrong = true;
    suite.cases.push_back({path, 0.0, "", error.what(), ""});
    return suite;
  }
  const auto names = file->names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].find(filter) == std::string::npos) continue;
    suite.cases.push_back(try_scenario(*file, i, tally));
  }
  return suite;
}

std::string summary(const Tally& tally) {
  const auto part = [](std::size_t all, std::size_t failed, const char* noun) {
    return plural(all, noun) + (failed > 0 ? fmt::format(" ({} failed)", failed) : "");
  };
  return fmt::format("\n{}: {}, {}\n", tally.failed_scenarios > 0 || tally.script_wrong ? "FAILED" : "passed",
                     part(tally.scenarios, tally.failed_scenarios, "scenario"),
                     part(tally.expectations, tally.failed_expectations, "expectation"));
}

int test(const TestOptions& options) {
  dsl::ScenarioFile::Options playing;
  playing.session = session_options(options.scripts);
  playing.seeds = options.seeds;
  playing.making.jobs = static_cast<unsigned>(options.jobs.value_or(0));
  playing.making.interrupted = InterruptibleRun::requested;
  if (!options.junit.empty()) require_writable_file(options.junit);

  const InterruptibleRun interruptible;
  Tally tally;
  std::vector<JunitSuite> suites;
  suites.reserve(options.files.size());
  for (const std::string& path : options.files) suites.push_back(try_file(path, playing, options.filter, tally));
  if (!options.junit.empty()) write_file(options.junit, junit_text(suites));
  if (tally.scenarios == 0 && !tally.script_wrong) {
    throw Error(fmt::format("test: no scenario's name contains '{}'", options.filter));
  }
  print_all(summary(tally));
  if (tally.script_wrong) return their_fault;
  return tally.failed_scenarios > 0 ? tests_failed : success;
}

}  // namespace

void add_test(CommandLine& line) {
  const auto options = std::make_shared<TestOptions>();
  Subcommand verb =
      line.add("test", "run the scenarios of scripts and say what holds", [options] { return test(*options); });
  verb.arguments("SCRIPT", "FILE", options->files, "Lua scripts of scenarios");
  verb.text("--filter", "NAME", options->filter, "only the scenarios whose names contain this");
  verb.integer("--seeds", "N", 1, dsl::most_seeds, options->seeds,
               "the number of seeds of every trial, instead of the script's");
  verb.integer("--jobs", "N", 1, most_jobs, options->jobs, "runs at the same time (default all cores)");
  verb.text("--junit", "FILE", options->junit, "write what came out as JUnit's XML");
  add_script_options(verb, options->scripts);
}

}  // namespace trellis::command
