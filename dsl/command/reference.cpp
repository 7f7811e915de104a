// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include <dsl/command/commands.hpp>
#include <dsl/command/manual.hpp>
#include <dsl/command/outputs.hpp>
#include <dsl/language/catalogue.hpp>
#include <dsl/language/reference.hpp>
#include <dsl/language/words.hpp>
#include <trellis/base/error.hpp>

namespace trellis::command {

namespace {

std::string names_of_words() {
  std::string text;
  for (const dsl::Word& word : dsl::words()) text += word.name + '\n';
  return text;
}

}  // namespace

const std::vector<std::string>& reference_forms() {
  static const std::vector<std::string> forms = {"markdown", "catalogue", "stubs", "luacheck", "words",
                                                 "man",      "bash",      "fish",  "zsh"};
  return forms;
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
  } else if (form == "words") {
    print_all(names_of_words());
  } else if (form == "man") {
    print_all(manual(app));
  } else if (std::find(shells().begin(), shells().end(), form) != shells().end()) {
    print_all(shell_completion(form, app));
  } else {
    throw Error(fmt::format("reference: no form '{}'{}; there are: {}", form, did_you_mean(form, reference_forms()),
                            fmt::join(reference_forms(), ", ")));
  }
  return success;
}

}  // namespace trellis::command
