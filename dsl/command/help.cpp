// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <string>
#include <vector>

#include <dsl/command/commands.hpp>
#include <dsl/command/outputs.hpp>
#include <dsl/language/reference.hpp>
#include <dsl/language/vocabulary.hpp>
#include <trellis/base/error.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

int help(const std::string& topic, const std::string& usage) {
  if (topic.empty()) {
    print_all(
        fmt::format("{}\n{}\n'trellis help WORD' tells what is known about a word, 'trellis run --help' about a "
                    "command.\n",
                    usage, dsl::vocabulary_text()));
  } else {
    print_all(dsl::help_text(topic));
  }
  return success;
}

int reference(const std::string& form) {
  static const std::vector<std::string> forms = {"markdown", "stubs", "luacheck"};
  if (form.empty() || form == "markdown") {
    print_all(dsl::reference_markdown());
  } else if (form == "stubs") {
    print_all(dsl::reference_stubs());
  } else if (form == "luacheck") {
    print_all(dsl::reference_luacheck());
  } else {
    throw Error(fmt::format("reference: no form '{}'{}; there are: {}", form, did_you_mean(form, forms),
                            fmt::join(forms, ", ")));
  }
  return success;
}

int version() {
  print_all(fmt::format("trellis {}\n", trellis::version()));
  return success;
}

}  // namespace trellis::command
