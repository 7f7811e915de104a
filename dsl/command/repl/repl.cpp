// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <dsl/command/commands.hpp>
#include <dsl/command/interrupt.hpp>
#include <dsl/command/repl/console.hpp>
#include <dsl/command/repl/line.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/command/store/outputs.hpp>
#include <trellis/base/printable.hpp>
#include <trellis/base/version.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

constexpr const char* prompt = "trellis> ";
constexpr const char* continued = "     ..> ";

bool coloured() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing here sets it
    return std::string_view(value != nullptr ? value : "");
  };
  return ::isatty(STDOUT_FILENO) == 1 && variable("NO_COLOR").empty() && variable("TERM") != "dumb" &&
         !variable("TERM").empty();
}

int repl(const std::string& script, const ScriptOptions& options) {
  dsl::SessionOptions session = session_options(options);
  // The user can stop a long input with Ctrl-C and keep the session.
  session.interrupted = InterruptibleSession::requested;
  session.stuck = nullptr;
  std::string input;  // its previous lines
  std::function<Completion(const std::string&)> complete;
  LineReader lines([&](const std::string& before) { return complete(input + before); });
  std::function<bool(const std::string&)> confirmed;
  if (lines.interactive()) {
    confirmed = [&](const std::string& question) {
      std::string answer;
      return lines.read(printable(question), answer) == LineReader::Got::line && (answer == "y" || answer == "yes");
    };
  }
  Console console(std::filesystem::path(script).parent_path().string(), coloured(), session, confirmed);
  complete = [&](const std::string& text) { return console.complete(text); };
  const std::string greeting = script.empty() ? "" : console.load(script);
  // Without a terminal, a Ctrl-C ends the program, as in other commands.
  std::optional<InterruptibleSession> patient;
  if (lines.interactive()) {
    patient.emplace();
    print_all(fmt::format("Trellis {}. help() lists all words, Ctrl-D ends.\n{}", trellis::version(), greeting));
    if (!lines.complaint().empty()) print_stderr(fmt::format("warning: {}\n", lines.complaint()));
  }

  int status = success;
  const auto run = [&](const std::string& text, bool more) {
    const auto verdict = console.run(text, more);
    if (verdict == Console::Verdict::failed && !lines.interactive()) status = their_fault;
    return verdict;
  };
  const auto take = [&](const std::string& line) {
    input += line;
    if (input.find_first_not_of(" \t\n") == std::string::npos) {
      input.clear();
      return;
    }
    if (run(input, true) == Console::Verdict::incomplete) {
      input += '\n';
      return;
    }
    lines.remember(input);
    input.clear();
    for (std::string text = console.edited(); !text.empty(); text = console.edited()) {
      print_all(text + "\n");
      run(text, false);
      lines.remember(text);
    }
  };
  std::string line;
  while (!console.over()) {
    const auto got = lines.read(input.empty() ? prompt : continued, line);
    if (got == LineReader::Got::interrupted) {
      input.clear();
      continue;
    }
    if (got == LineReader::Got::end) {
      if (input.empty()) break;
      // At a terminal, the end of input discards an incomplete input; for piped input it is an error.
      if (!lines.interactive()) run(input, false);
      input.clear();
      if (!lines.interactive()) break;
      continue;
    }
    // Pasted text, or an entry of the history, may have several lines: process each as if typed.
    if (input.empty() && console.together(line)) {
      take(line);
      continue;
    }
    for (std::size_t begin = 0; begin <= line.size() && !console.over();) {
      const std::size_t end = std::min(line.find('\n', begin), line.size());
      take(line.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  return status;
}

}  // namespace

void add_repl(CommandLine& line) {
  struct Options {
    std::string script;
    ScriptOptions session;
  };
  const auto options = std::make_shared<Options>();
  Subcommand verb = line.add("repl", "an interactive session: plan, step through runs, draw them",
                             [options] { return repl(options->script, options->session); });
  verb.optional_argument("SCRIPT", "FILE", options->script, "a Lua script to begin with");
  add_script_options(verb, options->session);
}

}  // namespace trellis::command
