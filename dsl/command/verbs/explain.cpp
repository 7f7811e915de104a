// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dsl/command/choice.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/explanation.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/input_warnings.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

struct ExplainOptions {
  std::string script;
  std::string strategy;                ///< a name, "" for all
  std::string problem;                 ///< likewise
  std::string json;                    ///< a file, "-" for stdout, "" if not given
  std::optional<std::uint64_t> width;  ///< columns; none: the terminal's
  ScriptOptions scripts;
};

/// Problems in the same space, in which a strategy has the same hierarchy; the command explains the first one.
struct Similar {
  const Problem* first = nullptr;
  std::vector<std::string> others;  ///< names
};

bool are_similar(const Problem& a, const Problem& b) {
  const auto model = [](const Problem& p) { return p.motion_model ? p.motion_model->text() : std::string(); };
  return a.space == b.space && model(a) == model(b) && a.collision == b.collision && a.resolution == b.resolution;
}

std::vector<Similar> similar_problems(const std::vector<Problem>& problems) {
  std::vector<Similar> groups;
  for (const Problem& problem : problems) {
    const auto group = std::find_if(groups.begin(), groups.end(),
                                    [&](const Similar& other) { return are_similar(*other.first, problem); });
    if (group == groups.end()) {
      groups.push_back({&problem, {}});
    } else {
      group->others.push_back(problem.name);
    }
  }
  return groups;
}

int explain(const ExplainOptions& options) {
  constexpr int unbounded_width = 100;
  const std::size_t width = options.width ? *options.width : static_cast<std::size_t>(report_width(unbounded_width));
  const bool document_alone = options.json == "-";
  if (!options.json.empty() && !document_alone) require_writable_file(options.json);

  Experiment experiment = dsl::load_script(options.script, session_options(options.scripts)).experiment;
  choose_strategy(experiment, options.strategy);
  choose_problem(experiment, options.problem);

  for (const std::string& sentence : input_warnings(experiment)) {
    print_message(fmt::format("warning: {}", sentence));
  }
  int status = success;
  std::vector<ExplainedStrategy> explained;
  const std::vector<Similar> groups = similar_problems(experiment.problems);
  for (const auto& [name, strategy] : experiment.strategies) {
    for (const Similar& group : groups) {
      try {
        explained.push_back(
            {name, strategy.text(), group.first->name, group.others, trellis::explain(strategy, *group.first)});
      } catch (const Error& error) {
        // Continue with the other strategies.
        print_message(error.what());
        status = their_fault;
      }
    }
  }
  if (!options.json.empty()) {
    const std::string document = explanation_json(explained, options.script);
    if (document_alone) {
      print_all(document);
    } else {
      write_file(options.json, document);
    }
  }
  if (document_alone) return status;
  std::string text;
  for (const ExplainedStrategy& one : explained) {
    if (!text.empty()) text += '\n';
    text += explanation_text(one, width);
  }
  print_all(text);
  return status;
}

}  // namespace

void add_explain(CommandLine& line) {
  constexpr std::uint64_t narrowest = 60;
  constexpr std::uint64_t widest = 1000;
  const auto options = std::make_shared<ExplainOptions>();
  Subcommand verb = line.add("explain", "print what strategies will run, level by level, without planning",
                             [options] { return explain(*options); });
  verb.argument("SCRIPT", "FILE", options->script, "a Lua script");
  verb.text("--strategy", "NAME", options->strategy, "the strategy of this name alone");
  verb.text("--problem", "NAME", options->problem, "the problem of this name, instead of the first one in each space");
  verb.text("--json", "FILE", options->json, "write the same for programs to a file, - for the standard output");
  verb.integer("--width", "N", narrowest, widest, options->width,
               "columns of the text (default those of the terminal, else 100)");
  add_script_options(verb, options->scripts);
}

}  // namespace trellis::command
