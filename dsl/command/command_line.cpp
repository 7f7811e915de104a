// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/command_line.hpp>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <utility>

#include <dsl/command/provenance.hpp>
#include <trellis/base/error.hpp>

namespace trellis::command {

namespace {

constexpr const char* more_help = "; 'trellis help' shows the usage";

/// Verbs of earlier versions, and what replaces each.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> replaced = {{
    {"plot", "'trellis report RESULTS --figures FOLDER' draws results"},
    {"compare", "'trellis report RESULTS RESULTS' compares results"},
    {"train", "'trellis experience --data FOLDER' trains a heuristic"},
}};

}  // namespace

CLI::Option& Subcommand::option(const std::string& name, const std::string& value, const std::string& doc,
                                std::function<void(const std::string&)> take) {
  const auto store = [name, take = std::move(take)](const std::string& typed) {
    if (typed.empty()) throw Error(fmt::format("{} is empty", name));
    take(typed);
  };
  return *app_.add_option_function<std::string>(name, store, doc)->type_name(value);
}

void Subcommand::argument(const std::string& name, const char* value, std::string& to, const std::string& doc) {
  text(name, value, to, doc, true);
}

void Subcommand::arguments(const std::string& name, const char* value, std::vector<std::string>& to,
                           const std::string& doc) {
  app_.add_option(name, to, doc)->required()->type_name(value)->each([name](const std::string& typed) {
    if (typed.empty()) throw Error(fmt::format("{} is empty", name));
  });
}

void Subcommand::optional_argument(const std::string& name, const std::string& value, std::string& to,
                                   const std::string& doc) {
  app_.add_option(name, to, doc)->type_name(value);
}

void Subcommand::flag(const std::string& name, bool& to, const std::string& doc) { app_.add_flag(name, to, doc); }

void Subcommand::text(const std::string& name, const char* value, std::string& to, const std::string& doc,
                      bool required) {
  option(name, value, doc, [&to](const std::string& typed) { to = typed; }).required(required);
}

void Subcommand::list(const std::string& name, const char* value, std::vector<std::string>& to,
                      const std::string& doc) {
  app_.add_option(name, to, doc)->delimiter(',')->type_name(value);
}

void Subcommand::integer(const std::string& name, const char* value, std::uint64_t least, std::uint64_t most,
                         std::optional<std::uint64_t>& to, const std::string& doc) {
  option(name, value, doc, [=, &to](const std::string& typed) {
    std::uint64_t number = 0;
    const char* end = typed.data() + typed.size();
    const auto [stop, error] = std::from_chars(typed.data(), end, number);
    const bool padded = typed.size() > 1 && typed.front() == '0';
    if (error != std::errc() || stop != end || padded || number < least || number > most) {
      throw Error(fmt::format("{} must be an integer in [{}, {}], got '{}'", name, least, most, typed));
    }
    to = number;
  });
}

void Subcommand::number(const std::string& name, const char* value, double least, std::optional<double>& to,
                        const std::string& doc) {
  option(name, value, doc, [=, &to](const std::string& typed) {
    double number = 0.0;
    const char* end = typed.data() + typed.size();
    const auto [stop, error] = std::from_chars(typed.data(), end, number);
    if (error != std::errc() || stop != end || !std::isfinite(number) || number < least) {
      throw Error(fmt::format("{} must be a number of at least {:g}, got '{}'", name, least, typed));
    }
    to = number;
  });
}

void Subcommand::choice(const std::string& name, const std::vector<std::string>& words, std::optional<std::size_t>& to,
                        const std::string& doc) {
  option(name, fmt::format("{}", fmt::join(words, "|")), doc, [=, &to](const std::string& typed) {
    const auto found = std::find(words.begin(), words.end(), typed);
    if (found == words.end()) {
      throw Error(fmt::format("{}: there are {}, got '{}'{}", name,
                              fmt::join(words, words.size() == 2 ? " and " : ", "), typed, did_you_mean(typed, words)));
    }
    to = static_cast<std::size_t>(found - words.begin());
  });
}

CommandLine::CommandLine()
    : app_(std::make_unique<CLI::App>(
          "Trellis runs scripts that declare hierarchies of guiding spaces for motion planning.", "trellis")) {
  app_->require_subcommand(1);
  app_->set_version_flag("--version", "trellis " + version_and_commit(), "Print the version and exit");
}

CommandLine::~CommandLine() = default;

Subcommand CommandLine::add(const std::string& name, const std::string& summary, std::function<int()> run) {
  CLI::App* verb = app_->add_subcommand(name, summary);
  verbs_.emplace_back(verb, std::move(run));
  return Subcommand(*verb);
}

std::vector<std::string> CommandLine::verbs() const {
  std::vector<std::string> names;
  names.reserve(verbs_.size());
  for (const auto& [app, run] : verbs_) names.push_back(app->get_name());
  return names;
}

std::string CommandLine::usage_of(const std::string& verb) const {
  for (const auto& [app, run] : verbs_) {
    if (app->get_name() == verb) return app->help(app_->get_name());
  }
  return "";
}

std::string CommandLine::unknown_option(const std::string& word) const {
  std::vector<std::string> known;
  for (const auto* parsed : app_->get_subcommands()) {
    for (const auto* option : parsed->get_options()) {
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    }
  }
  return fmt::format("no option {}{}", word, did_you_mean(word, known));
}

std::vector<std::string> CommandLine::with_verb(std::vector<std::string> words) const {
  const std::vector<std::string> known = verbs();
  if (words.empty()) throw Error(fmt::format("no command given; there are: {}", fmt::join(known, ", ")) + more_help);
  const std::string& first = words.front();
  if (first.starts_with('-') || std::find(known.begin(), known.end(), first) != known.end()) return words;
  if (first.ends_with(".lua")) {
    words.insert(words.begin(), "run");
    return words;
  }
  for (const auto& [verb, replacement] : replaced) {
    if (first == verb) throw Error(fmt::format("no command '{}': {}", first, replacement) + more_help);
  }
  const std::string offer = did_you_mean(first, known);
  throw Error(fmt::format("no command '{}'{}", first,
                          offer.empty() ? fmt::format("; there are: {}", fmt::join(known, ", ")) : offer) +
              more_help);
}

int CommandLine::run(int argc, char** argv) {
  usage_ = app_->help();  // after parsing, help() returns that of the verb
  try {
    std::vector<std::string> words = with_verb({argv + 1, argv + argc});
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    app_->parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app_->exit(error);
    std::string why = error.what();
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError)) {
      const auto words = app_->remaining(true);
      const auto word = std::find_if(words.begin(), words.end(), [](const auto& w) { return w.starts_with("--"); });
      if (word != words.end()) why = unknown_option(*word);
    }
    throw Error(why + more_help);
  }
  const auto typed = std::find_if(verbs_.begin(), verbs_.end(), [](const auto& verb) { return verb.first->parsed(); });
  return typed->second();
}

}  // namespace trellis::command
