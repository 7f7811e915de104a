// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/manual.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/language/tools/catalogue.hpp>
#include <dsl/language/tools/reference.hpp>
#include <dsl/language/tools/words.hpp>
#include <trellis/base/error.hpp>

namespace trellis::command {

namespace {

std::string names_of_words() {
  std::string text;
  for (const dsl::Word& word : dsl::words()) text += word.name + '\n';
  return text;
}

/// The formats of the printed words; the first is the default.
const std::vector<std::string>& forms() {
  static const std::vector<std::string> all = {"markdown", "catalogue", "stubs", "luacheck", "python",
                                               "words",    "man",       "bash",  "fish",     "zsh"};
  return all;
}

int reference(const std::string& form, const CLI::App& app) {
  if (form.empty() || form == "markdown") {
    print_all(dsl::reference_markdown());
  } else if (form == "catalogue") {
    print_all(dsl::catalogue_markdown());
  } else if (form == "stubs") {
    print_all(dsl::reference_stubs());
  } else if (form == "luacheck") {
    print_all(dsl::reference_luacheck());
  } else if (form == "python") {
    print_all(dsl::reference_python());
  } else if (form == "words") {
    print_all(names_of_words());
  } else if (form == "man") {
    print_all(manual(app));
  } else if (std::find(shells().begin(), shells().end(), form) != shells().end()) {
    print_all(shell_completion(form, app));
  } else {
    throw Error(fmt::format("reference: no form '{}'{}; there are: {}", form, did_you_mean(form, forms()),
                            fmt::join(forms(), ", ")));
  }
  return success;
}

}  // namespace

void add_reference(CommandLine& line) {
  const auto form = std::make_shared<std::string>();
  Subcommand verb = line.add("reference", "print all words of the language, for reading or for other programs",
                             [form, &line] { return reference(*form, line.app()); });
  verb.optional_argument(
      "FORM", fmt::format("{}", fmt::join(forms(), "|")), *form,
      "markdown (the default), stubs for lua-language-server, luacheck's configuration, stubs for Python, words, "
      "one a line; "
      "of the command line: man, the manual page, or the completion for bash, fish or zsh");
}

}  // namespace trellis::command
