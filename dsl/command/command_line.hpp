// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace trellis::command {

/// A verb of the command line. Its options store what is typed while the command line is parsed. They throw an Error
/// that names the option for an empty value, one of another type, and one out of range. `value` describes a value in
/// help, manual and completions: FILE, FOLDER, NAME, ...
class Subcommand {
 public:
  explicit Subcommand(CLI::App& app) : app_(app) {}

  void argument(const std::string& name, const char* value, std::string& to, const std::string& doc);
  void arguments(const std::string& name, const char* value, std::vector<std::string>& to, const std::string& doc);
  /// An argument that may be missing or empty.
  void optional_argument(const std::string& name, const std::string& value, std::string& to, const std::string& doc);

  void flag(const std::string& name, bool& to, const std::string& doc);
  void text(const std::string& name, const char* value, std::string& to, const std::string& doc, bool required = false);
  /// Several names, separated by commas.
  void list(const std::string& name, const char* value, std::vector<std::string>& to, const std::string& doc);
  /// Decimal digits only: no sign, fraction, exponent, or leading zero, which other programs read as octal.
  void integer(const std::string& name, const char* value, std::uint64_t least, std::uint64_t most,
               std::optional<std::uint64_t>& to, const std::string& doc);
  void number(const std::string& name, const char* value, double least, std::optional<double>& to,
              const std::string& doc);
  /// One of a few words; stores its index.
  void choice(const std::string& name, const std::vector<std::string>& words, std::optional<std::size_t>& to,
              const std::string& doc);

 private:
  CLI::Option& option(const std::string& name, const std::string& value, const std::string& doc,
                      std::function<void(const std::string&)> take);

  CLI::App& app_;
};

/// The command line: `trellis VERB OPTIONS`.
class CommandLine {
 public:
  CommandLine();
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// \param run  returns the exit status; called for the verb that is typed
  Subcommand add(const std::string& name, const std::string& summary, std::function<int()> run);

  [[nodiscard]] const CLI::App& app() const { return *app_; }
  /// The list of verbs.
  [[nodiscard]] const std::string& usage() const { return usage_; }
  [[nodiscard]] std::vector<std::string> verbs() const;
  /// What `trellis VERB --help` prints; "" for a word that is no verb.
  [[nodiscard]] std::string usage_of(const std::string& verb) const;

  /// Parses the command line and runs its verb. \throws Error
  int run(int argc, char** argv);

 private:
  [[nodiscard]] std::string unknown_option(const std::string& word) const;
  /// The words of the command line with a verb first: run for a script alone. \throws Error for an unknown verb
  [[nodiscard]] std::vector<std::string> with_verb(std::vector<std::string> words) const;

  std::unique_ptr<CLI::App> app_;
  std::vector<std::pair<CLI::App*, std::function<int()>>> verbs_;
  std::string usage_;
};

}  // namespace trellis::command
