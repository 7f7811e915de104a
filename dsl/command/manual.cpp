// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/manual.hpp>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/version.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

/// An option or argument of a command, for the manual and the completions.
struct Switch {
  std::string name;  ///< "seeds", of an argument "SCRIPT"
  std::string type;  ///< "FILE", "safe|paper", "" of a flag
  std::string description;
  bool argument = false;  ///< positional
  bool required = false;
  bool many = false;

  [[nodiscard]] std::vector<std::string> choices() const {
    std::vector<std::string> all;
    if (type.find('|') == std::string::npos) return all;
    for (std::size_t at = 0; at <= type.size();) {
      const std::size_t end = std::min(type.find('|', at), type.size());
      all.push_back(type.substr(at, end - at));
      at = end + 1;
    }
    return all;
  }
};

std::vector<Switch> switches_of(const CLI::App& verb) {
  std::vector<Switch> all;
  for (const CLI::Option* option : verb.get_options()) {
    Switch one;
    one.argument = option->get_positional();
    if (!one.argument && option->get_lnames().empty()) continue;
    one.name = one.argument ? option->get_name(true) : option->get_lnames().front();
    one.type = option->get_expected_max() > 0 ? option->get_type_name() : "";
    one.description = option->get_description();
    one.required = option->get_required();
    one.many = option->get_expected_max() > 1;
    if (one.name != "help") all.push_back(std::move(one));
  }
  return all;
}

std::string joined(const std::vector<std::string>& words, std::string_view separator = " ") {
  return fmt::format("{}", fmt::join(words, separator));
}

// The page
// -------------------------------------------------------------------------------------------------------------

std::string roff(std::string_view text) {
  std::string all;
  for (const char c : text) {
    if (c == '\\' || c == '-') all += '\\';
    all += c == '\\' ? 'e' : c;
  }
  for (const char first : {'.', '\''}) {
    if (all.starts_with(first)) all.insert(0, R"(\&)");
  }
  return all;
}

std::string synopsis(const CLI::App& verb) {
  std::string text = fmt::format("\\fBtrellis {}\\fR", roff(verb.get_name()));
  bool options = false;
  for (const Switch& one : switches_of(verb)) {
    options = options || !one.argument;
    if (!one.argument) continue;
    text += fmt::format(" {}\\fI{}\\fR{}{}", one.required ? "" : "[", roff(one.name), one.many ? "..." : "",
                        one.required ? "" : "]");
  }
  return text + (options ? " [\\fIoptions\\fR]" : "");
}

/// Sections that do not come from the descriptions of the command line.
constexpr std::string_view closing = R"(.SH EXIT STATUS
.TP
.B 0
The command did what was asked; a run that finds no path is a result.
.TP
.B 1
A fault of trellis itself; of
.B trellis test
that something does not hold.
.TP
.B 2
What was given cannot be used: the message says what, where, and what was expected.
.TP
.B 130, 143, 129
SIGINT (Ctrl-C), SIGTERM or SIGHUP ended the command: 128 and the number of the signal. Each file that it writes has its
old content or its new one.
.TP
.B 141
The reader of the output closed it, as head does; what goes to files was written.
.SH ENVIRONMENT
.TP
.B TRELLIS_SCENES
The folder that scene files are looked for in, after the script's own.
.TP
.B TRELLIS_KERNEL
The instruction set that collision checks use, if not the fastest: baseline, avx2 or avx512. Results are the same bytes.
.TP
.B TRELLIS_STDLIB
A folder of modules that is read instead of the standard library, which is part of the program.
.SH EXAMPLES
.TP
.B trellis new mine
writes mine.lua, a small script to begin with, and mine_test.lua, its test.
.TP
.B trellis test mine_test.lua
runs the test's scenarios, and says what holds.
.TP
.B trellis run mine.lua \-\-html report.html
plans, prints the report, and writes a page that replays every run.
.TP
.B trellis help shrink
explains a word of the language.
)";

// Shells
// -------------------------------------------------------------------------------------------------------------

/// Returns the pattern of the files that an argument accepts, "" if it accepts none.
std::string pattern_of(const Switch& argument) {
  if (argument.name == "SCRIPT") return "*.lua";
  if (argument.name == "CASE") return "*.json";
  return "";
}

bool takes_word(const Switch& argument) { return argument.name == "TOPIC"; }

/// Quotes a text with single quotes for a shell.
std::string in_quotes(std::string_view text) {
  std::string all = "'";
  for (const char c : text) all += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return all + "'";
}

std::string bash_verb(const CLI::App& verb) {
  std::string values;
  std::string rest;
  std::vector<std::string> options = {"--help"};
  for (const Switch& one : switches_of(verb)) {
    if (one.argument) {
      if (!pattern_of(one).empty()) rest = fmt::format("      pattern={}\n", in_quotes(pattern_of(one)));
      if (!one.choices().empty()) rest = fmt::format("      words={}\n", in_quotes(joined(one.choices())));
      if (takes_word(one)) rest = "      words=$(trellis reference words)\n";
      continue;
    }
    options.push_back("--" + one.name);
    if (one.type.empty()) continue;
    const std::string list = joined(one.choices());
    const std::string answer =
        one.type == "FILE"     ? "compopt -o default"
        : one.type == "FOLDER" ? "compopt -o dirnames"
        : !list.empty() ? fmt::format(R"(mapfile -t COMPREPLY < <(compgen -W {} -- "$current"))", in_quotes(list))
                        : ":";
    values += fmt::format("        --{}) {}; return ;;\n", one.name, answer);
  }
  std::string text = fmt::format("    {})\n", verb.get_name());
  if (!values.empty()) text += "      case $previous in\n" + values + "      esac\n";
  return text + fmt::format("      options={}\n{}      ;;\n", in_quotes(joined(options)), rest);
}

std::string bash(const CLI::App& app) {
  std::vector<std::string> verbs;
  std::string cases;
  for (const CLI::App* verb : app.get_subcommands({})) {
    verbs.push_back(verb->get_name());
    cases += bash_verb(*verb);
  }
  verbs.emplace_back("--help");
  return fmt::format(
      "# bash completion of trellis; printed by `trellis reference bash`\n"
      "_trellis() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}}\n"
      "  local options='' words='' pattern=''\n"
      "  COMPREPLY=()\n"
      "  if ((COMP_CWORD == 1)); then\n"
      "    mapfile -t COMPREPLY < <(compgen -W {} -- \"$current\")\n"
      "    return\n"
      "  fi\n"
      "  case ${{COMP_WORDS[1]}} in\n{}"
      "  esac\n"
      "  if [[ $current == -* ]]; then\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$current\")\n"
      "  elif [[ -n $words ]]; then\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
      "  elif [[ -n $pattern ]]; then\n"
      "    compopt -o filenames\n"
      "    mapfile -t COMPREPLY < <(compgen -d -- \"$current\"; compgen -f -X \"!$pattern\" -- \"$current\")\n"
      "  fi\n"
      "}}\n"
      "complete -F _trellis trellis\n",
      in_quotes(joined(verbs)), cases);
}

std::string fish(const CLI::App& app) {
  std::string text = "# fish completion of trellis; printed by `trellis reference fish`\ncomplete -c trellis -f\n";
  for (const CLI::App* verb : app.get_subcommands({})) {
    text += fmt::format("complete -c trellis -n __fish_use_subcommand -a {} -d {}\n", verb->get_name(),
                        in_quotes(verb->get_description()));
  }
  for (const CLI::App* verb : app.get_subcommands({})) {
    const std::string begin = fmt::format("complete -c trellis -n '__fish_seen_subcommand_from {}'", verb->get_name());
    for (const Switch& one : switches_of(*verb)) {
      std::string values;
      if (!pattern_of(one).empty()) {
        values = fmt::format(" -k -xa '(__fish_complete_suffix {})'", pattern_of(one).substr(1));
      } else if (takes_word(one)) {
        values = " -xa '(trellis reference words)'";
      } else if (!one.choices().empty()) {
        values = fmt::format(" -xa {}", in_quotes(joined(one.choices())));
      } else if (one.type == "FILE") {
        values = " -rF";
      } else if (one.type == "FOLDER") {
        values = " -xa '(__fish_complete_directories)'";
      } else if (!one.type.empty()) {
        values = " -x";
      }
      if (one.argument) {
        if (values != " -x") text += begin + values + '\n';
      } else {
        text += fmt::format("{} -l {}{} -d {}\n", begin, one.name, values, in_quotes(one.description));
      }
    }
  }
  return text;
}

/// Removes characters that have a meaning in zsh's descriptions.
std::string zsh_text(std::string_view text) {
  std::string all;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') all += '\\';
    all += c;
  }
  return all;
}

std::string zsh_verb(const CLI::App& verb) {
  std::string text = fmt::format("    {})\n      _arguments", verb.get_name());
  for (const Switch& one : switches_of(verb)) {
    std::string action;
    if (!pattern_of(one).empty()) {
      action = fmt::format("_files -g \"{}\"", pattern_of(one));
    } else if (takes_word(one)) {
      action = "($(trellis reference words))";
    } else if (!one.choices().empty()) {
      action = fmt::format("({})", joined(one.choices()));
    } else if (one.type == "FILE") {
      action = "_files";
    } else if (one.type == "FOLDER") {
      action = "_directories";
    }
    std::string entry;
    if (one.argument) {
      entry = fmt::format("{}:{}:{}", one.many ? "*" : "1", one.name, action);
    } else {
      entry = fmt::format("--{}[{}]", one.name, zsh_text(one.description));
      if (!one.type.empty()) entry += fmt::format(":{}:{}", one.choices().empty() ? one.type : "choice", action);
    }
    text += fmt::format(" \\\n        {}", in_quotes(entry));
  }
  return text + "\n      ;;\n";
}

std::string zsh(const CLI::App& app) {
  std::string verbs;
  std::string cases;
  for (const CLI::App* verb : app.get_subcommands({})) {
    verbs += fmt::format("    {}\n", in_quotes(fmt::format("{}:{}", verb->get_name(), verb->get_description())));
    cases += zsh_verb(*verb);
  }
  return fmt::format(
      "#compdef trellis\n# zsh completion of trellis; printed by `trellis reference zsh`\n"
      "_trellis() {{\n"
      "  local -a verbs=(\n{}  )\n"
      "  if ((CURRENT == 2)); then\n"
      "    _describe command verbs\n"
      "    return\n"
      "  fi\n"
      "  shift words\n"
      "  ((CURRENT--))\n"
      "  case $words[1] in\n{}"
      "  esac\n"
      "}}\n"
      "_trellis \"$@\"\n",
      verbs, cases);
}

}  // namespace

std::string manual(const CLI::App& app) {
  std::string text = fmt::format(
      ".\\\" SPDX-License-Identifier: GPL-3.0-or-later\n.\\\" Printed by `trellis reference man`.\n"
      ".TH TRELLIS 1 \"\" \"Trellis {}\" \"User Commands\"\n"
      ".SH NAME\ntrellis \\- guiding spaces for motion planning\n.SH SYNOPSIS\n",
      trellis::version());
  for (const CLI::App* verb : app.get_subcommands({})) text += fmt::format("{}\n.br\n", synopsis(*verb));
  text += fmt::format(".SH DESCRIPTION\n{}\n", roff(app.get_description()));
  text +=
      "A script in Lua declares a hierarchy of simpler spaces, each guiding the search in the one above it. Trellis\n"
      "builds the projections and heuristics, executes the hierarchy, and reports for every level what it cost and "
      "what\n"
      "it was worth: its sampling efficiency, in nats. The same seed gives the same result.\n.SH COMMANDS\n";
  for (const CLI::App* verb : app.get_subcommands({})) {
    text += fmt::format(".SS {}\n{}.\n", synopsis(*verb), roff(verb->get_description()));
    for (const Switch& one : switches_of(*verb)) {
      const std::string value = one.argument || one.type.empty() ? "" : fmt::format(" \\fI{}\\fR", roff(one.type));
      const std::string name =
          one.argument ? fmt::format("\\fI{}\\fR", roff(one.name)) : fmt::format(R"(\fB\-\-{}\fR)", roff(one.name));
      text += fmt::format(".TP\n{}{}\n{}\n", name, value, roff(one.description));
    }
  }
  return text + std::string(closing);
}

const std::vector<std::string>& shells() {
  static const std::vector<std::string> all = {"bash", "fish", "zsh"};
  return all;
}

std::string shell_completion(const std::string& shell, const CLI::App& app) {
  if (shell == "bash") return bash(app);
  if (shell == "fish") return fish(app);
  if (shell == "zsh") return zsh(app);
  throw Fault("no completion for the shell " + shell);
}

}  // namespace trellis::command
