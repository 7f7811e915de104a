// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/repl/console.hpp>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <set>

#include <dsl/command/interrupt.hpp>
#include <dsl/command/repl/source_text.hpp>
#include <dsl/command/repl/values.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/core/tokens.hpp>
#include <dsl/language/core/types.hpp>
#include <dsl/language/tools/completion.hpp>
#include <dsl/language/tools/vocabulary.hpp>
#include <dsl/language/tools/words.hpp>
#include <dsl/language/words/algebra.hpp>
#include <dsl/language/words/experiment.hpp>
#include <dsl/language/words/modules.hpp>
#include <dsl/lua/globals.hpp>
#include <trellis/base/error.hpp>
#include <trellis/memory/identity.hpp>
#include <trellis/report/report.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis::command {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

Screen screen(bool colour) {
  winsize size{};
  if (::isatty(STDOUT_FILENO) != 1 || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) {
    constexpr Screen paper = {.columns = 100, .rows = 45, .colour = false};
    return paper;
  }
  return {.columns = size.ws_col, .rows = size.ws_row, .colour = colour};
}

/// Whether a Lua text compiles; if so, pushes its function. `why`: the message if not.
bool loads(Stack& stack, const std::string& text, const std::string& name, std::string& why) {
  try {
    stack.load_within(typed_environment, text, name);
    return true;
  } catch (const lua::Located& error) {
    why = error.what();
    return false;
  }
}

bool ends_early(const std::string& message) { return message.ends_with("<eof>"); }

/// Removes a traceback that only shows the position in the message.
std::string without_traceback(const std::string& message) {
  constexpr std::string_view heading = "\nstack traceback:";
  const std::size_t at = message.find(heading);
  if (at == std::string::npos) return message;
  std::string text = message.substr(0, at + heading.size());
  std::size_t frames = 0;
  for (std::size_t line = at + heading.size(); line < message.size();) {
    const std::size_t end = std::min(message.find('\n', line + 1), message.size());
    const std::string_view frame(message.data() + line, end - line);
    line = end;
    // The input itself has no caller; a tail call ends it.
    if (frame.starts_with("\n\t[C]: in ?") || frame.find("(...tail calls...)") != std::string_view::npos) continue;
    text += frame;
    if (!frame.starts_with("\n\t[C]")) ++frames;
  }
  return frames > 1 ? text : message.substr(0, at);
}

void complain(const std::string& message) {
  std::fflush(stdout);
  print_stderr(broken_at_words(message + "\n", STDERR_FILENO));
}

/// Prints a value; for a session command without call parentheses, its usage.
std::string shown(Stack& stack, Value value) {
  if (value.type() != Type::function) return value_text(stack, value);
  for (const Verb& verb : verbs()) {
    if (push_verbs(stack).field(std::string(verb.name)).identity() != value.identity()) continue;
    return verb.name == "help" ? names_text() : verbs_text(verb.name);
  }
  return value_text(stack, value);
}

std::string commented(const std::string& text) {
  std::string out = "-- ";
  for (const char c : text) out += c == '\n' ? std::string("\n-- ") : std::string(1, c);
  return out;
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  return value != nullptr ? value : "";
}

/// Runs the user's editor on a file and waits for it.
void open_editor(const std::string& path) {
  std::string editor = environment("VISUAL");
  if (editor.empty()) editor = environment("EDITOR");
  if (editor.empty()) editor = "vi";
  // The variable may contain options, so a shell parses it.
  const std::string command = editor + " \"$1\"";
  const pid_t child = ::fork();
  if (child < 0) throw Error(fmt::format("edit: cannot start '{}': {}", editor, std::strerror(errno)));  // NOLINT
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", command.c_str(), "sh", path.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  InterruptibleSession::forget();
  if (status != 0) throw Error(fmt::format("edit: '{}' failed; VISUAL or EDITOR names another one", editor));
}

/// A name, or fields of names: scenes.cup.
bool is_path(std::string_view text) {
  bool begins = true;
  for (const char c : text) {
    if (c == '.' && !begins) {
      begins = true;
    } else if (std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_' ||
               (!begins && std::isdigit(static_cast<unsigned char>(c)) != 0)) {
      begins = false;
    } else {
      return false;
    }
  }
  return !begins;
}

/// What users of other shells type, in the language: exit, help skeleton, skeleton?, skeleton??, = 1 + 1 and %time
/// nested.
std::string as_input(const std::string& input) {
  const std::size_t first = input.find_first_not_of(" \t");
  if (first == std::string::npos) return input;
  const std::string text = input.substr(first, input.find_last_not_of(" \t\n") - first + 1);
  if (text == "exit" || text == "quit" || text == "exit()") return "quit()";
  if (text.starts_with("=") && !text.starts_with("==")) return text.substr(1);
  constexpr std::string_view help = "help ";
  if (text.starts_with(help)) {
    const std::size_t word = text.find_first_not_of(' ', help.size());
    if (is_path(text.substr(word))) return fmt::format("help(\"{}\")", text.substr(word));
  }
  constexpr std::string_view time = "%time ";
  if (text.starts_with(time)) return fmt::format("time(function() return {} end)", text.substr(time.size()));
  for (const auto& [mark, verb] : {std::pair{"\?\?", "source"}, std::pair{"?", "help"}}) {
    if (!text.ends_with(mark)) continue;
    const std::string word = text.substr(0, text.size() - std::string_view(mark).size());
    if (is_path(word)) return fmt::format("{}(\"{}\")", verb, word);
  }
  return input;
}

/// Inside a string: the words that the language allows there, the session commands for help, files otherwise.
Completion completion_in_string(const std::string& text, const std::vector<dsl::Token>& all) {
  Completion found = {.words = dsl::completions(text).words};
  std::size_t before = all.size() - 1;
  if (before > 0 && all[before - 1].text == "(") --before;
  if (before == 0 || all[before - 1].text != "help") {
    found.files = found.words.empty();
    return found;
  }
  const std::string begun(all.back().text.substr(1));
  for (const Verb& verb : verbs()) {
    if (verb.name.starts_with(begun)) found.words.emplace_back(verb.name);
  }
  return found;
}

/// Returns the expression before a '.' or ':' at the end: names, fields and indices, as in script.problems[1]; "" for
/// anything else, such as a call.
std::string expression_before(const std::vector<dsl::Token>& all, const std::string& text) {
  using Kind = dsl::Token::Kind;
  if (all.empty() || (all.back().text != "." && all.back().text != ":")) return "";
  const std::size_t end = all.back().begin;
  for (std::size_t i = all.size() - 1; i > 0;) {
    if (all[i - 1].kind == Kind::name) {
      --i;
      if (i < 2 || all[i - 1].text != ".") return text.substr(all[i].begin, end - all[i].begin);
      --i;
    } else if (all[i - 1].text == "]" && i >= 4 && all[i - 3].text == "[" &&
               (all[i - 2].kind == Kind::number || all[i - 2].kind == Kind::string)) {
      i -= 3;
    } else {
      return "";
    }
  }
  return "";
}

/// Whether the text ends with `>>`, or with a name begun after it.
bool ends_in_composition(const std::vector<dsl::Token>& all, const std::string& text) {
  std::size_t end = all.size();
  const bool touches = end > 0 && all[end - 1].begin + all[end - 1].text.size() == text.size();
  if (touches && all[end - 1].kind == dsl::Token::Kind::name) --end;
  return end > 0 && all[end - 1].text == ">>";
}

/// The name of a value's type in descriptions of the language, "" for others.
std::string type_name(Value value) {
  if (value.get<Problem>() != nullptr) return "trellis.Problem";
  if (value.get<World>() != nullptr) return "trellis.World";
  if (value.get<Robot>() != nullptr) return "trellis.Robot";
  if (value.get<dsl::Program>() != nullptr) return "trellis.Experiment";
  return dsl::as_strategy(value) ? "trellis.Strategy" : "";
}

/// Returns the members of an expression's value: fields after '.', methods after ':'; none if it has no known type.
std::optional<std::vector<std::string>> members(Stack& stack, const std::string& expression, const std::string& sign) {
  stack.load_within(typed_environment, "return " + expression, "=completion");
  const int before = stack.size();
  stack.call(0);
  if (stack.size() < before) return {};
  const Value value = stack.top();
  std::vector<std::string> names;
  if (value.type() == Type::table) return sign == "." ? value.keys().names : names;
  if (value.get<RunPointer>() != nullptr) return sign == "." ? run_fields() : names;
  const std::string type = type_name(value);
  if (type.empty()) return {};
  for (const dsl::ObjectType& known : dsl::object_types()) {
    if (known.name != type) continue;
    for (const dsl::Field& member : known.members) {
      if (member.type.starts_with("fun(self") == (sign == ":")) names.push_back(member.name);
    }
  }
  return names;
}

/// A text for each difference of two sets of named things: "strategies.nested is new".
template <class T, class Same>
void add_differences(const std::string& of, const std::vector<std::pair<std::string, T>>& before,
                     const std::vector<std::pair<std::string, T>>& after, const Same& same, std::string& text) {
  const auto find = [](const auto& all, const std::string& name) {
    return std::find_if(all.begin(), all.end(), [&](const auto& entry) { return entry.first == name; });
  };
  for (const auto& [name, value] : after) {
    const auto old = find(before, name);
    if (old == before.end()) {
      text += fmt::format("  {} is new\n", field_path(of, name));
    } else if (const std::string how = same(old->second, value); !how.empty()) {
      text += fmt::format("  {} {}\n", field_path(of, name), how);
    }
  }
  for (const auto& [name, value] : before) {
    if (find(after, name) == after.end()) text += fmt::format("  {} is gone\n", field_path(of, name));
  }
}

/// Returns a line for each difference of two results of a script, "" for none.
std::string differences(const Experiment& before, const Experiment& after) {
  std::string text;
  add_differences(
      "script.strategies", before.strategies, after.strategies,
      [](const StrategySpec& a, const StrategySpec& b) {
        return a == b ? "" : fmt::format("is {}, and was {}", b.text(), a.text());
      },
      text);
  const auto problems = [](const Experiment& experiment) {
    std::vector<std::pair<std::string, Problem>> all;
    for (const Problem& problem : experiment.problems) all.emplace_back(problem.name, problem);
    return all;
  };
  add_differences("script.problems", problems(before), problems(after), change_of, text);
  if (before.seeds != after.seeds) {
    text += fmt::format("  script.seeds: {}, and were {}\n", after.seeds.size(), before.seeds.size());
  }
  return text;
}

}  // namespace

Console::Console(const std::string& folder, bool colour, const dsl::SessionOptions& options,
                 std::function<bool(const std::string& question)> confirmed)
    : session_(folder, options) {
  if (confirmed) state_.confirmed = std::move(confirmed);
  state_.screen = [colour] { return screen(colour); };
  state_.interrupted = InterruptibleSession::requested;
  state_.forget_interruption = InterruptibleSession::forget;
  session_.with([this](Stack& stack) {
    open_runs(stack);
    open_verbs(stack, state_);
  });
}

std::string Console::load(const std::string& path) {
  const std::string text = dsl::without_shebang(dsl::read_file(path));
  std::string bound;
  session_.run(text, path, [&](Stack& stack) {
    if (stack.size() == 0) return;  // the script may only define globals
    state_.returned = stack[1].get<dsl::Program>() != nullptr ? SessionState::Returned::experiment
                      : stack[1].type() == Type::table        ? SessionState::Returned::table
                                                              : SessionState::Returned::pair;
    state_.script = dsl::read_program(stack, 1);
    const Experiment& experiment = state_.script->experiment;
    stack.resize(0);
    const auto note = [&](const std::string& field, const std::string& what) {
      bound += fmt::format("  {:<32} {}\n", field, what);
    };
    for (const auto& [name, strategy] : experiment.strategies) {
      note(field_path("script.strategies", name), strategy.text());
    }
    for (std::size_t i = 0; i < experiment.problems.size(); ++i) {
      constexpr std::size_t most = 4;
      if (i < most) {
        const Problem& problem = experiment.problems[i];
        note(field_path("script.problems", problem.name), fmt::format("problem in {}", problem.space.name()));
      }
      if (i == most) note("...", fmt::format("{} problems in all", experiment.problems.size()));
    }
    dsl::push_experiment(stack, experiment);
    stack.set_global("script");
  });
  session_.with([&](Stack& stack) {
    const Value globals = stack.push_globals();
    for (const Verb& verb : verbs()) {
      const std::string name(verb.name);
      const bool word =
          std::any_of(dsl::words().begin(), dsl::words().end(), [&](const dsl::Word& one) { return one.name == name; });
      if (word || !globals.field(name).given()) continue;
      bound += fmt::format("  {:<32} is the script's; {} is the session's word here\n", "_G." + name, name);
    }
  });
  state_.path = path;
  return bound.empty() ? fmt::format("{} returns nothing; its globals are there\n", path)
                       : fmt::format("{} is bound to script:\n{}", path, bound);
}

void Console::reload() {
  const std::optional<dsl::Program> before = state_.script;
  session_.with([](Stack& stack) {
    // Modules run again where the script requires them; those of the standard library do not change.
    const auto standard = dsl::module_names();
    const Value modules = stack.push_hidden("modules");
    for (const std::string& name : modules.keys().names) {
      if (std::find(standard.begin(), standard.end(), name) != standard.end()) continue;
      stack.push_nil();
      stack.set_field(modules, name);
    }
  });
  static_cast<void>(load(state_.path));
  std::string changes;
  if (before && state_.script) {
    changes = differences(before->experiment, state_.script->experiment);
    for (const Problem& problem : state_.script->experiment.problems) {
      // The session's last problem was the script's: take the new one.
      const auto& old = before->experiment.problems;
      const bool scripts = std::any_of(old.begin(), old.end(), [&](const Problem& p) {
        return state_.problem && p.name == state_.problem->name && p.scene == state_.problem->scene;
      });
      if (scripts && problem.name == state_.problem->name) state_.problem = problem;
    }
  }
  print_all(changes.empty()
                ? fmt::format("{} read again: its strategies, problems and seeds are the same\n", state_.path)
                : fmt::format("{} read again:\n{}", state_.path, changes));
}

void Console::print_warnings() {
  for (const std::string& warning : session_.take_warnings()) complain("warning: " + warning);
}

Console::Verdict Console::run(const std::string& typed, bool more) {
  const std::string input = as_input(typed);
  const std::string name = fmt::format("@input {}", inputs_ + 1);
  state_.used = false;
  state_.announced = nullptr;
  state_.typed = arguments_of_call(input, {"plan", "start"});
  bool incomplete = false;
  const std::string last_input = std::exchange(state_.last_input, input);
  state_.inputs.resize(inputs_);
  state_.inputs.push_back(input);
  try {
    session_.with([&](Stack& stack) {
      std::string no_expression;
      if (!loads(stack, "return " + input, name, no_expression)) {
        std::string no_chunk;
        if (!loads(stack, input, name, no_chunk)) {
          // `guide >>` begins an expression, `x = {` a statement.
          incomplete = more && (ends_early(no_chunk) || ends_early(no_expression));
          if (incomplete) return;
          throw lua::Located(no_chunk);
        }
      }
      // edit() offers the input before the one that calls it.
      const std::string own = std::exchange(state_.last_input, last_input);
      stack.call(0);
      if (!state_.edits) state_.last_input = own;
      std::fflush(stdout);
      const int values = stack.size();
      for (int i = 1; i <= values; ++i) {
        if (state_.announced == nullptr || stack[i].identity() != state_.announced) {
          print_all(shown(stack, stack[i]));
        }
        stack.resize(values);
      }
      // The last value is _ for the next inputs.
      if (values > 0 && stack[1].given()) {
        const Value commands = push_verbs(stack);
        stack.push(stack[1]);
        stack.set_field(commands, "_");
      }
    });
    if (incomplete) {
      state_.last_input = last_input;
      return Verdict::incomplete;
    }
    ++inputs_;
    print_warnings();
    accept(input);
    warn_of_locals(input);
    if (std::exchange(state_.reloads, false)) reload();
    std::fflush(stdout);
    InterruptibleSession::forget();
    return Verdict::done;
  } catch (const Interrupted&) {
    complain("interrupted");
  } catch (const Error& error) {
    if (output_closed()) throw;
    const bool stopped = InterruptibleSession::requested();
    complain(stopped ? "interrupted" : without_traceback(error.what()));
  } catch (const std::exception& error) {
    complain(fmt::format("a fault of trellis itself, please report it: {}", error.what()));
  }
  ++inputs_;
  InterruptibleSession::forget();
  return Verdict::failed;
}

bool Console::together(const std::string& text) {
  if (dsl::locals_outside(text).empty()) return false;
  bool chunk = false;
  session_.with([&](Stack& stack) {
    std::string why;
    chunk = loads(stack, text, "=input", why);
  });
  return chunk;
}

void Console::accept(const std::string& input) {
  if (dsl::tokens(input).empty()) return;
  ++state_.accepted_inputs;
  std::vector<std::string> parts;
  std::vector<bool> used;
  session_.with([&](Stack& stack) {
    parts = statements(stack, input);
    used.assign(parts.size(), state_.used);
    if (!state_.used || parts.size() == 1) return;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const auto uses = lua::global_uses(stack, parts[i], "=input");
      used[i] = std::any_of(uses.begin(), uses.end(), [](const lua::GlobalUse& use) { return is_command(use.name); });
    }
    // A function of the session called the command.
    if (std::find(used.begin(), used.end(), true) != used.end()) return;
    parts = {input};
    used = {true};
  });
  for (std::size_t i = 0; i < parts.size(); ++i) accept_statement(parts[i], used[i]);
}

void Console::accept_statement(const std::string& text, bool used) {
  const auto all = dsl::tokens(text);
  if (all.empty()) return;
  // Inputs that only print are no statements, `return` would end the script, and scripts have no session commands.
  bool statement = !used && all.front().text != "return";
  std::set<std::string> assigned;
  session_.with([&](Stack& stack) {
    std::string why;
    const bool chunk = loads(stack, text, "=input", why);
    statement = statement && chunk;
    for (const lua::GlobalUse& use : lua::global_uses(stack, chunk ? text : "return " + text, "=input")) {
      if (use.set) assigned.insert(use.name);
      // What a comment has made is not there when the script runs; nor is the value printed last.
      if (!use.set && (use.name == "_" || state_.lost.contains(use.name))) statement = false;
    }
  });
  state_.accepted.push_back(statement ? text : commented(text));
  for (const std::string& name : assigned) {
    state_.lost.insert(name);  // it does not give itself
    const std::string source = statement ? "" : literal(name);
    if (!source.empty()) state_.accepted.push_back(fmt::format("{} = {}", name, source));
    if (statement || !source.empty()) state_.lost.erase(name);
  }
}

std::string Console::literal(const std::string& name) {
  std::string text;
  session_.with([&](Stack& stack) {
    const auto& planned = state_.planned;
    const bool known = planned && !planned->problem.empty() &&
                       !state_.lost.contains(planned->problem.substr(0, planned->problem.find_first_of(".[( ")));
    SourceWriter writer(stack, state_.lost, known ? &planned->instance : nullptr, known ? planned->problem : "");
    text = writer.text(stack.push_global(name));
  });
  return text;
}

void Console::warn_of_locals(const std::string& input) {
  if (warned_) return;
  const auto names = dsl::locals_outside(input);
  if (names.empty()) return;
  warned_ = true;
  complain(
      fmt::format("note: each input is a chunk of its own, so 'local {0}' has ended with it; without 'local', {0} "
                  "would stay",
                  names.front()));
}

Completion Console::complete(const std::string& text) {
  auto all = dsl::tokens(text);
  if (!all.empty() && all.back().unfinished) {
    return all.back().kind == dsl::Token::Kind::string ? completion_in_string(text, all) : Completion{};
  }
  std::vector<std::string> names;
  const bool composes = ends_in_composition(all, text);
  session_.with([&](Stack& stack) {
    const int before = stack.size();
    stack.push_globals().each_pair([&](Value key, Value value) {
      const auto name = key.string();
      const bool fits = !composes || value.get<GuideSpec>() != nullptr || value.get<PlannerSpec>() != nullptr ||
                        value.get<StrategySpec>() != nullptr;
      if (name && fits && !name->starts_with("_")) names.push_back(*name);
    });
    if (!composes) {
      for (const Verb& verb : verbs()) names.emplace_back(verb.name);
    }
    stack.resize(before);
  });
  const dsl::Completions known = dsl::completions(text, names);
  Completion found = {.words = known.words};
  if (known.options) {
    for (auto& option : found.words) option += " = ";
    return found;
  }
  std::string word;
  if (!all.empty() && all.back().begin + all.back().text.size() == text.size() &&
      (all.back().kind == dsl::Token::Kind::name || all.back().kind == dsl::Token::Kind::keyword)) {
    word = all.back().text;
    all.pop_back();
  }
  const std::string expression = expression_before(all, text);
  if (expression.empty()) return found;
  const std::string sign(all.back().text);
  try {
    session_.with([&](Stack& stack) {
      const auto known_members = members(stack, expression, sign);
      if (!known_members) return;
      if (sign == ":") found.words.clear();  // of all types
      for (const std::string& name : *known_members) {
        if (!name.starts_with("_") && name.starts_with(word)) found.words.push_back(name);
      }
    });
  } catch (const Error&) {  // NOLINT(bugprone-empty-catch): a module that cannot be loaded says so when it is used
  }
  std::sort(found.words.begin(), found.words.end());
  found.words.erase(std::unique(found.words.begin(), found.words.end()), found.words.end());
  return found;
}

std::string Console::edited() {
  if (!std::exchange(state_.edits, false)) return "";
  namespace fs = std::filesystem;
  try {
    std::string path = state_.to_edit;
    if (!path.empty()) {
      open_editor(path);
      return dsl::without_shebang(dsl::read_file(path));
    }
    path = (fs::temp_directory_path() / fmt::format("trellis-{}.lua", ::getpid())).string();
    write_file(path, state_.last_input + "\n");
    std::string text;
    try {
      open_editor(path);
      text = dsl::read_file(path);
    } catch (const Error&) {
      fs::remove(path);
      throw;
    }
    fs::remove(path);
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text;
  } catch (const Error& error) {
    complain(error.what());
    return "";
  }
}

}  // namespace trellis::command
