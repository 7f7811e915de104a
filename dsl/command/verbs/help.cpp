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
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

int help(const std::string& topic, const std::string& usage) {
  constexpr int widest = static_cast<int>(dsl::help_width);
  const auto width = static_cast<std::size_t>(std::min(widest, report_width(widest)));
  if (topic.empty()) {
    print_all(
        fmt::format("{}\n{}\n'trellis help WORD' explains a word, 'trellis run --help' about a "
                    "command.\n",
                    usage, dsl::vocabulary_text(width)));
  } else if (topic == "repl") {
    print_all("trellis repl [SCRIPT]: a session of the language with functions that scripts do not have:\n\n" +
              verbs_text("", width));
  } else {
    print_all(dsl::help_text(topic, width));
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
  Subcommand verb = line.add("help", "print what is known about a word of the language",
                             [topic, &line] { return help(*topic, line.usage()); });
  verb.optional_argument("TOPIC", "WORD", *topic, "a planner, guide, constructor or module");
}

}  // namespace trellis::command
