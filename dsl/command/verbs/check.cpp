// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <string_view>

#include <dsl/command/commands.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/core/tokens.hpp>
#include <dsl/language/tools/session.hpp>
#include <dsl/language/tools/words.hpp>
#include <dsl/language/words/measure.hpp>
#include <dsl/language/words/modules.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/cell.hpp>
#include <trellis/experiment/input_warnings.hpp>

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
                                ? fmt::format(", on {} of other seeds too{}",
                                              counted(static_cast<std::size_t>(measure.cross), "path", "paths"),
                                              measure.cross_levels ? ", at every level" : "")
                                : "",
                            measure.metrics ? ", with metrics of the search" : "");
}

bool has_functions(const GuideSpec& guide) {
  if (guide.kind() != GuideSpec::Kind::component) {
    return std::any_of(guide.terms().begin(), guide.terms().end(),
                       [](const GuideSpec::Term& term) { return has_functions(term.guide); });
  }
  return guide.custom() != nullptr || (guide.below() != nullptr && has_functions(*guide.below()));
}

/// Takes a strategy a few proposals far if the script's functions guide it, so that what they return is checked.
/// \throws Error of such a function
void try_functions(const std::string& name, const StrategySpec& strategy, const Problem& problem) {
  if (strategy.guide() == nullptr || !has_functions(*strategy.guide())) return;
  constexpr int few = 200;  // steps, of all levels
  constexpr auto patience = std::chrono::seconds(2);
  const auto begin = std::chrono::steady_clock::now();
  int steps = 0;
  const auto enough = [&] { return ++steps > few || std::chrono::steady_clock::now() - begin > patience; };
  static_cast<void>(
      run_cell(name, strategy, problem, 1, {.interrupted = enough, .measured = false, .companion = false}));
}

/// Warns of local variables that hide a word of the language and that nothing uses, as in `local world = world { ...
/// }`.
void find_hidden_words(const std::string& source, const std::string& script, std::vector<std::string>& warnings) {
  const std::vector<dsl::Token> all = dsl::tokens(source);
  using Kind = dsl::Token::Kind;
  for (const std::string& name : dsl::locals_outside(source)) {
    const auto& words = dsl::words();
    if (std::none_of(words.begin(), words.end(), [&](const dsl::Word& word) { return word.name == name; })) continue;
    std::size_t declared = all.size();
    std::size_t last = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].kind != Kind::name || all[i].text != name) continue;
      if (i > 0 && all[i - 1].text == "local") declared = std::min(declared, i);
      // { world = world }: a field is no use, its value is.
      const bool field =
          (i > 0 && (all[i - 1].text == "." || all[i - 1].text == ":")) ||
          (i > 0 && i + 1 < all.size() && all[i + 1].text == "=" && (all[i - 1].text == "{" || all[i - 1].text == ","));
      if (!field) last = i;
    }
    // The word itself stands behind the declaration: local world = world { ... }.
    if (declared + 2 >= all.size() || all[declared + 1].text != "=" || all[declared + 2].text != name ||
        last > declared + 2) {
      continue;
    }
    const auto line =
        std::count(source.begin(), source.begin() + static_cast<std::ptrdiff_t>(all[declared].begin), '\n');
    warnings.push_back(fmt::format("{}:{}: nothing uses the local '{}', which hides the word of the language", script,
                                   line + 1, name));
  }
}

/// Checks one script without planning, except for a few proposals that its functions guide; returns whether it has no
/// fault.
bool check_script(const std::string& script, const dsl::SessionOptions& options, std::string& text) {
  const std::string source = dsl::without_shebang(dsl::read_file(script));
  dsl::Session session(std::filesystem::path(script).parent_path().string(), options);
  const dsl::Program program = session.load(source, script);
  const Experiment& experiment = program.experiment;
  std::vector<std::string> faults = session.unknown_names(source, script);
  std::vector<std::string> warnings = program.warnings;
  find_hidden_words(source, script, warnings);
  for (std::string& warning : input_warnings(experiment)) warnings.push_back(std::move(warning));
  for (const Problem& problem : experiment.problems) {
    if (std::string warning = narrow_warning(problem); !warning.empty()) warnings.push_back(std::move(warning));
  }
  for (const auto& [name, strategy] : experiment.strategies) {
    std::set<std::string> spaces;  // check one problem per space
    for (const Problem& problem : experiment.problems) {
      if (!spaces.insert(problem.space.name()).second) continue;
      try {
        trellis::check(strategy, problem);
        try_functions(name, strategy, problem);
      } catch (const Error& error) {
        faults.emplace_back(error.what());
      }
    }
    for (const std::string& sentence : unreachable_guides(strategy)) {
      warnings.push_back(fmt::format("{} (strategy '{}')", sentence, name));
    }
  }
  for (const std::string& fault : faults) print_message(fault);
  if (faults.size() > 1) print_message(fmt::format("{} mistakes", faults.size()));
  for (const std::string& warning : warnings) print_message(fmt::format("warning: {}", warning));
  text = summary(script, experiment);
  return faults.empty();
}

int check(const std::vector<std::string>& scripts, const ScriptOptions& options) {
  const dsl::SessionOptions session = session_options(options);
  int status = success;
  for (std::size_t i = 0; i < scripts.size(); ++i) {
    try {
      std::string text;
      if (!check_script(scripts[i], session, text)) status = their_fault;
      print_all((i > 0 ? "\n" : "") + text);
    } catch (const Error& error) {
      // Continue with the other scripts.
      print_error(error);
      status = their_fault;
    }
  }
  return status;
}

}  // namespace

void add_check(CommandLine& line) {
  struct Options {
    std::vector<std::string> scripts;
    ScriptOptions session;
  };
  const auto options = std::make_shared<Options>();
  Subcommand verb = line.add("check", "validate scripts without planning and print their strategies",
                             [options] { return check(options->scripts, options->session); });
  verb.arguments("SCRIPT", "FILE", options->scripts, "Lua scripts");
  add_script_options(verb, options->session);
}

}  // namespace trellis::command
