// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/command/provenance.hpp>
#include <dsl/command/repl/verbs.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/language/tools/vocabulary.hpp>
#include <dsl/language/tools/words.hpp>
#include <trellis/base/error.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

/// \throws Error with the nearest command or word, for a topic that is none.
std::string help_on(const std::string& topic, const CommandLine& line, std::size_t width) {
  try {
    return dsl::help_text(topic, width);
  } catch (const Error&) {
    const std::string offer = did_you_mean(topic, line.verbs());
    if (offer.empty()) throw;
    throw Error(fmt::format("no help on '{}'{}; 'trellis help' lists all words", topic, offer));
  }
}

int help(const std::string& topic, const CommandLine& line) {
  constexpr int widest = static_cast<int>(dsl::help_width);
  const auto width = static_cast<std::size_t>(std::min(widest, report_width(widest)));
  if (topic.empty()) {
    print_all(fmt::format("{}\n{}\n'trellis help WORD' explains a word, 'trellis help run' a command.\n", line.usage(),
                          dsl::vocabulary_text(width)));
  } else if (topic == "repl") {
    print_all("trellis repl [SCRIPT]: a session of the language with functions that scripts do not have:\n\n" +
              verbs_text("", width));
  } else {
    const std::string of_verb = line.usage_of(topic);
    // A word of the language, or the terms of reports.
    const bool word = topic == "report" || std::any_of(dsl::words().begin(), dsl::words().end(),
                                                       [&](const dsl::Word& one) { return one.name == topic; });
    if (of_verb.empty() || word) print_all(help_on(topic, line, width));
    if (!of_verb.empty()) print_all(word ? "\n" + of_verb : of_verb);
  }
  return success;
}

}  // namespace

void add_version(CommandLine& line) {
  line.add("version", "print the version", [] {
    print_all(fmt::format("trellis {}\n", version_and_commit()));
    return success;
  });
}

void add_help(CommandLine& line) {
  const auto topic = std::make_shared<std::string>();
  Subcommand verb = line.add("help", "print what is known about a word of the language or a command",
                             [topic, &line] { return help(*topic, line); });
  verb.optional_argument("TOPIC", "WORD", *topic, "a planner, guide, constructor or module, or a command");
}

}  // namespace trellis::command
