// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cstdio>
#include <string_view>

#include <dsl/command/commands.hpp>
#include <dsl/command/outputs.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/language/measure.hpp>
#include <dsl/language/session.hpp>
#include <trellis/base/error.hpp>

namespace trellis::command {

namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string indented(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    result += fmt::format("    {}\n", line);
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return result;
}

std::string summary(const std::string& script, const Experiment& experiment) {
  std::string text = fmt::format("{}: {}, {}, {}\n", script, counted(experiment.problems.size(), "problem", "problems"),
                                 counted(experiment.strategies.size(), "strategy", "strategies"),
                                 counted(experiment.seeds.size(), "seed", "seeds"));
  for (const auto& [name, strategy] : experiment.strategies) {
    text += fmt::format("\n  {}: {}\n{}", name, strategy.text(), indented(strategy.tree()));
  }
  if (!experiment.measure) return text + "\n  nothing is measured\n";
  const Measure& measure = *experiment.measure;
  return text + fmt::format("\n  measured against {}, by {}{}{}\n", dsl::text_of(measure.target),
                            dsl::text_of(measure.estimators),
                            measure.cross > 0
                                ? fmt::format(", on {} of other seeds too",
                                              counted(static_cast<std::size_t>(measure.cross), "path", "paths"))
                                : "",
                            measure.metrics ? ", with metrics of the search" : "");
}

}  // namespace

int check(const std::vector<std::string>& scripts, const ScriptOptions& options) {
  const dsl::SessionOptions session = session_options(options);
  int status = success;
  for (std::size_t i = 0; i < scripts.size(); ++i) {
    try {
      const std::string text = summary(scripts[i], dsl::load_script(scripts[i], session).experiment);
      print_all((i > 0 ? "\n" : "") + text);
    } catch (const Error& error) {
      // The other scripts are checked all the same.
      fmt::print(stderr, "trellis: {}\n", error.what());
      status = their_fault;
    }
  }
  return status;
}

}  // namespace trellis::command
