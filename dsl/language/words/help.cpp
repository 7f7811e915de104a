// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/help.hpp>

#include <cstdio>
#include <utility>

#include <trellis/base/printable.hpp>

namespace trellis::dsl {

const Construct& help_construct() {
  static const Construct construct = {
      .name = "help",
      .usage = "help \"shrink\"  help(scenes.trap)  help(strategy)",
      .summary = "prints what is known about a word, a function, or a value; all words without one",
      .list = "",
      .element = "",
      .fields = {},
      .options = {},
      .returns = "",
      .arguments = {
          {"subject", "any", "a word, or a value", "a strategy shows its tree; \"guide.shrink\" is the guide shrink"}}};
  return construct;
}

void open_help(lua::Stack& stack, std::function<std::string(lua::Stack&)> text_of,
               std::function<void(const std::string&)> print) {
  stack.push_function([text_of = std::move(text_of), print = std::move(print)](lua::Stack& call) {
    const std::string text = text_of(call);
    if (print) {
      print(text);
    } else {
      const std::string shown = printable(text);
      std::fwrite(shown.data(), 1, shown.size(), stdout);
      std::fflush(stdout);
    }
    return 0;
  });
  stack.set_global(help_construct().name);
}

}  // namespace trellis::dsl
