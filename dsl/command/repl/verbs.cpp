// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/repl/verbs.hpp>

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <limits>
#include <utility>

#include <dsl/command/progress.hpp>
#include <dsl/command/repl/source_text.hpp>
#include <dsl/command/repl/values.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/command/tuning.hpp>
#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/core/tokens.hpp>
#include <dsl/language/core/types.hpp>
#include <dsl/language/tools/help_text.hpp>
#include <dsl/language/tools/vocabulary.hpp>
#include <dsl/language/tools/words.hpp>
#include <dsl/language/words/algebra.hpp>
#include <dsl/language/words/tuning.hpp>
#include <dsl/lua/globals.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/cell.hpp>
#include <trellis/experiment/partial.hpp>
#include <trellis/measure/censored_cost.hpp>
#include <trellis/memory/identity.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/views/table.hpp>

namespace trellis::command {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

constexpr std::array<Verb, 23> all_verbs = {{
    {"plan", "plan(strategy, problem, { seed = 1 })",
     "runs a strategy; without a problem, one of the script on the script's, others on the last one or "
     "scenes.simple_passage()"},
    {"start", "start(strategy, problem, { seed = 1 })", "begins a run and stops it before its first proposal"},
    {"step", "step(n)", "takes a run n proposals further, of whatever level; one without n"},
    {"continue", "continue()", "takes a run to its end"},
    {"where", "where()", "the last proposal: its level, from which part of h it came, what became of it"},
    {"levels", "levels()",
     "what each level of a run did, and what guided and unguided proposals spent, as in the report"},
    {"samples", "samples(level, role)", R"(the nodes ("tree") or proposals ("expansion") of a level; level 0's tree)"},
    {"efficiency", "efficiency(target)", "how well each level sampled, against the run's path; target: tube {}"},
    {"plot", "plot(level) or plot(\"run.svg\", level, { azimuth = 20 })",
     "the world, tree, failed proposals and path; or a picture. In space: options azimuth and elevation, in degrees"},
    {"compare", "compare(a, b, ..., { seeds = 5 })",
     "strategies side by side, paired by seed; options: problem, seeds, measure"},
    {"time", "time(strategy, 20, problem)",
     "runs a strategy with 20 seeds: CPU time and validity checks, medians with 95 % intervals; of a function, its "
     "CPU time; %time EXPRESSION does either"},
    {"ablate", "ablate(strategy, { seeds = 5 })",
     "a strategy with each of its guides taken out in turn; options likewise"},
    {"tune", "tune(function(p) ... end, problems, { over = { name = {...} }, budget = 200 })",
     "selects the best values of a strategy by successive halving over seeds, prints it and returns it"},
    {"replay", "replay(run) or replay(\"results.json\", n)", "runs a run again and says whether the same came out"},
    {"runs", "runs()", "the runs of this session, as a list"},
    {"edit", "edit() or edit(\"file.lua\")", "opens an editor on the last input, or a file, and runs what it leaves"},
    {"reload", "reload()",
     "reads the loaded script and its modules again, and says what has changed; the session's own values stay"},
    {"save", "save(\"file.lua\")",
     "writes the inputs that succeeded as a script that runs: it requires the loaded one, and returns what was planned "
     "last"},
    {"run", "run(n)", "run n of this session; without n the current one"},
    {"history", "history(n)",
     "the last n inputs with their numbers, 20 without n; _ is the last value that was printed"},
    {"help", "help(\"shrink\")",
     "what is known about a word, as shrink? and help shrink; without one, all names; help \"session\" is this"},
    {"source", "source(\"scenes.cup\")", "the lines that define a function, as scenes.cup??"},
    {"quit", "quit()", "ends the session, as exit and Ctrl-D do"},
}};

/// Prints the result of a run. Where a line of the terminal is too short, the costs follow on the next one: a break
/// that depended on the digits of the time would be another one each time.
void say_outcome(const Run& run) {
  std::string text = outcome_text(run) + "\n";
  const std::size_t colon = text.find(": ", text.find(", seed "));
  if (colon != std::string::npos && broken_at_words(text, STDOUT_FILENO) != text) text.replace(colon + 1, 1, "\n  ");
  print_all(broken_at_words(text, STDOUT_FILENO));
}

void say(const std::string& text) { print_all(text.empty() || text.back() == '\n' ? text : text + "\n"); }

/// Checks the names in a table of options; throws for unknown ones.
void check_options(const std::string& verb, Value table, const std::vector<std::string>& known) {
  const lua::Keys keys = table.keys();
  if (keys.length > 0 || !keys.odd.empty()) {
    throw Error(fmt::format("{}: options have names, as in {{ {} = ... }}", verb, known.front()));
  }
  for (const auto& name : keys.names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw Error(fmt::format("{}: no option '{}'{}; there are: {}", verb, name, did_you_mean(name, known),
                            fmt::join(known, ", ")));
  }
}

std::uint64_t natural(const std::string& what, Value value, std::int64_t least) {
  const auto number = value.integer();
  if (!number || *number < least) {
    throw Error(fmt::format("{} must be an integer of at least {}, got {}", what, least, dsl::describe(value)));
  }
  return static_cast<std::uint64_t>(*number);
}

StrategySpec strategy_argument(const std::string& verb, Value value) {
  if (auto strategy = dsl::as_strategy(value)) return std::move(*strategy);
  if (value.get<GuideSpec>() != nullptr) {
    throw Error(
        fmt::format("{}: {} only guides; end it with >> rrt {{}} or another planner", verb, dsl::describe(value)));
  }
  throw Error(fmt::format("{}: a strategy belongs here, as guide >> planner, got {}", verb, dsl::describe(value)));
}

Problem problem_argument(const std::string& verb, Value value) {
  if (const auto* problem = value.get<Problem>()) return *problem;
  throw Error(fmt::format("{}: a problem belongs here, as scenes.cup(), got {}{}", verb, dsl::describe(value),
                          value.type() == Type::function ? ": call it, with ()" : ""));
}

/// Returns the session's name of a strategy: the global that contains it, its name in the script, else its text.
std::string name_of(Stack& call, const SessionState& state, const StrategySpec& strategy) {
  std::string name;
  const int before = call.size();
  call.push_globals().each_pair([&](Value key, Value value) {
    const auto found = dsl::as_strategy(value);
    if (!found || !(*found == strategy)) return;
    const std::string global = key.string().value_or("");
    if (name.empty() || global < name) name = global;
  });
  call.resize(before);
  if (!name.empty()) return name;
  if (state.script) {
    for (const auto& [given, spec] : state.script->experiment.strategies) {
      if (spec == strategy) return given;
    }
  }
  return strategy.text();
}

/// The problem and the text of an expression that gives it, "" if none is known.
struct NamedProblem {
  Problem problem;
  std::string expression;
};

/// The path of a value in the session: a global, or a field of the script's strategies or problems; "" for none.
std::string expression_of(Stack& call, const Value& value) {
  const void* wanted = value.identity();
  if (wanted == nullptr) return "";
  std::string found;
  const auto search = [&](Value table, const std::string& prefix) {
    table.each_pair([&](Value key, Value element) {
      const auto name = key.string();
      if (!name || element.identity() != wanted) return;
      const std::string path = prefix.empty() ? *name : field_path(prefix, *name);
      if (found.empty() || path < found) found = path;
    });
  };
  const int before = call.size();
  const Value globals = call.push_globals();
  search(globals, "");
  if (found.empty()) {
    const Value script = globals.field("script");
    for (const char* part : {"strategies", "problems"}) {
      if (script.type() != Type::table) break;
      const Value table = script.field(part);
      if (table.type() == Type::table) search(table, std::string("script.") + part);
    }
  }
  call.resize(before);
  return found;
}

/// The lines that give a saved script what a loaded one gave the session.
/// \param file  the saved script, from whose folder its modules are loaded
std::string requiring_lines(const SessionState& state, const std::string& file) {
  if (state.path.empty()) return "";
  namespace fs = std::filesystem;
  const fs::path folder = fs::absolute(fs::path(file)).parent_path().lexically_normal();
  std::string name = fs::absolute(fs::path(state.path)).lexically_normal().lexically_relative(folder).string();
  const bool below = name.ends_with(".lua") && !name.starts_with("..");
  if (below) name.resize(name.size() - std::string_view(".lua").size());
  const bool plain = std::all_of(name.begin(), name.end(),
                                 [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '/'; });
  if (!below || !plain) {
    throw Error(
        fmt::format("save: '{0}' requires the loaded script, and only a file in its folder '{1}' or above it can "
                    "(with names of letters, digits and '_'); save into that folder",
                    file, fs::absolute(fs::path(state.path)).lexically_normal().parent_path().string()));
  }
  std::replace(name.begin(), name.end(), '/', '.');
  switch (state.returned) {
    case SessionState::Returned::nothing: return fmt::format("require \"{}\"\n", name);
    case SessionState::Returned::experiment: return fmt::format("local script = require \"{}\"\n", name);
    case SessionState::Returned::table:
      return fmt::format(
          "local returned = require \"{}\"\n"
          "local script = {{ strategies = {{ strategy = returned.strategy }}, problems = {{ returned.problem }}, seeds "
          "= "
          "{{ 1 }} }}\n",
          name);
    case SessionState::Returned::pair: break;
  }
  throw Error(
      fmt::format("save: '{}' returns two values, of which require gives one; let it return {{ strategy = ..., "
                  "problem = ... }}",
                  state.path));
}

/// Returns the lines of the standard library that define a field of a module, with their place; "" for none.
std::string module_lines(const std::string& path) {
  const std::size_t dot = path.find('.');
  const std::string module = path.substr(0, dot);
  const auto text = dot == std::string::npos ? std::nullopt : dsl::module_text(module);
  if (!text) return "";
  std::string found;
  int number = 0;
  for (std::size_t begin = 0; begin < text->size();) {
    const std::size_t end = std::min(text->find('\n', begin), text->size());
    const std::string line = text->substr(begin, end - begin);
    begin = end + 1;
    ++number;
    if (found.empty()) {
      if (!line.starts_with(path + " =") && !line.starts_with("function " + path + "(")) continue;
      found = fmt::format("stdlib/{}.lua:{}\n", module, number);
    }
    found += line + "\n";
    // A definition ends with the first line that closes it at the margin.
    if (line.starts_with("}") || line.starts_with(")") || line.starts_with("end")) return found;
  }
  return found;
}

/// Implements the session commands.
class Verbs {
 public:
  explicit Verbs(SessionState& state) : state_(state) {}

  int plan(Stack& call) { return begin(call, "plan", std::numeric_limits<std::uint64_t>::max()); }
  int start(Stack& call) { return begin(call, "start", 0); }

  int step(Stack& call) {
    int next = 1;
    Run& run = *run_argument(call, "step", next);
    const std::uint64_t steps = call[next].given() ? natural("step: the number of proposals", call[next], 1) : 1;
    go_on(run, run.proposals + std::min(steps, std::numeric_limits<std::uint64_t>::max() - run.proposals));
    say(where_text(run));
    return 0;
  }

  int go_on(Stack& call) {
    Run& run = *only_run(call, "continue");
    go_on(run, std::numeric_limits<std::uint64_t>::max());
    say_outcome(run);
    return 0;
  }

  int where(Stack& call) {
    say(where_text(*only_run(call, "where")));
    return 0;
  }

  int levels(Stack& call) {
    say(levels_text(summarise(facts_of(only_run(call, "levels")->result())), width()));
    return 0;
  }

  int samples(Stack& call) {
    int next = 1;
    const Run& run = *run_argument(call, "samples", next);
    const std::size_t level = level_argument("samples", run, call[next]);
    const std::string role = call[next + 1].given() ? call[next + 1].string().value_or("") : "tree";
    if (role != "tree" && role != "expansion") {
      const std::vector<std::string> known = {"tree", "expansion"};
      throw Error(fmt::format(R"(samples: the role is "tree" or "expansion", got {}{})", dsl::describe(call[next + 1]),
                              did_you_mean(role, known)));
    }
    const Search& search = run.result().levels[level].record.search;
    const Configurations& rows = role == "tree" ? search.nodes : search.proposals;
    const Value list = call.push_table();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Value row = call.push_table();
      for (const double x : rows[i]) {
        call.push(x);
        call.append(row);
      }
      call.append(list);
    }
    return 1;
  }

  int efficiency(Stack& call) {
    int next = 1;
    Run& run = *run_argument(call, "efficiency", next);
    Measure measure = this->measure();
    if (const auto* target = call[next].get<TargetSpec>()) {
      measure.target = *target;
    } else if (call[next].given()) {
      throw Error(fmt::format("efficiency: a target belongs here, as tube {{ delta = 0.5 }}, got {}",
                              dsl::describe(call[next])));
    }
    score(run, measure, state_.interrupted);
    say(efficiency_text(summarise(facts_of(run.result())), width()));
    return 0;
  }

  int plot(Stack& call) {
    int next = 1;
    const Run& run = *run_argument(call, "plot", next);
    const auto file = call[next].string();
    if (file) ++next;
    const bool numbered = call[next].given() && call[next].type() != Type::table;
    const std::size_t level = numbered ? level_argument("plot", run, call[next++]) : level_at_work(run);
    const PlotView view = call[next].given() ? view_argument(call[next]) : PlotView{};
    if (file) {
      write_own("plot", *file, plot_picture(run, level, *file, view));
      say(fmt::format("{} written", *file));
    } else {
      print_drawing(plot_text(run, level, state_.screen(), view));
    }
    return 0;
  }

  int compare(Stack& call) {
    Experiment experiment = comparison(call, "compare");
    if (experiment.strategies.size() < 2) throw Error("compare: it needs two strategies at least");
    return report(experiment);
  }

  int time(Stack& call) {
    constexpr std::uint64_t usual = 10;
    const std::uint64_t count = call[2].given() ? natural("time: the number of runs", call[2], 1) : usual;
    if (count > dsl::most_seeds) throw Error(fmt::format("time: at most {} runs, got {}", dsl::most_seeds, count));
    std::optional<Problem> given;
    if (call[3].given()) given = problem_argument("time", call[3]);
    Value value = call[1];
    if (value.type() == Type::function) {
      call.push(value);
      call.call(0);
      value = call.top();
      const auto* run = value.get<RunPointer>();
      if (run == nullptr && !dsl::as_strategy(value)) return time_calls(call, count);
      if (run != nullptr) {
        time_runs((*run)->strategy_name, (*run)->strategy, (*run)->problem, count);
        return 0;
      }
    }
    const StrategySpec strategy = strategy_argument("time", value);
    const Problem problem = given ? *given : usual_problem(call, of_script(strategy)).problem;
    time_runs(name_of(call, state_, strategy), strategy, problem, count);
    return 0;
  }

  int reload(Stack& call) {
    if (call.count() > 0) throw Error("reload: it takes nothing: reload()");
    if (state_.path.empty()) {
      throw Error("reload: this session was begun without a script; trellis repl SCRIPT begins with one");
    }
    state_.reloads = true;
    return 0;
  }

  int source(Stack& call) {
    std::string word = call[1].string().value_or("");
    if (!call[1].given()) throw Error("source: the name of a function belongs here, as source(\"scenes.cup\")");
    if (!word.empty()) {
      call.load_within(typed_environment, "return " + word, "=source");
      call.call(0);
    }
    const Value value = word.empty() ? call[1] : call.top();
    const auto definition = call.definition(value);
    if (!definition) {
      if (const std::string lines = module_lines(word); !lines.empty()) {
        say(lines);
      } else if (value.type() != Type::function) {
        say(value_text(call, value));
      } else if (!word.empty()) {
        say(fmt::format("{0} is part of the runtime; help(\"{0}\") describes it", word));
      } else {
        say("this function is part of the runtime; help(it) describes it");
      }
      return 0;
    }
    const std::string text = text_of(*definition);
    std::string lines;
    std::size_t begin = 0;
    for (int line = 1; line <= definition->last && begin < text.size(); ++line) {
      const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
      if (line >= definition->first) lines += text.substr(begin, end - begin);
      begin = end;
    }
    say(fmt::format("{}:{}\n{}", definition->chunk, definition->first, lines));
    return 0;
  }

  int ablate(Stack& call) {
    Experiment experiment = comparison(call, "ablate");
    if (experiment.strategies.size() != 1) throw Error("ablate: it takes one strategy");
    const auto& [name, strategy] = experiment.strategies.front();
    if (strategy.guide() == nullptr) {
      throw Error(fmt::format("ablate: the strategy '{}' has no guide that could be taken out", strategy.text()));
    }
    trellis::ablate(experiment, {name});
    experiment.ablation = dsl::default_ablation;
    return report(experiment);
  }

  int replay(Stack& call) {
    if (const auto file = call[1].string()) {
      const auto index = natural("replay: the number of the run", call[2], 1);
      Replayed replayed = replay_file(*file, static_cast<std::int64_t>(index), state_.interrupted);
      add(replayed.run);
      say(replayed.text + "\n" + outcome_text(*replayed.run));
      return announce(call, replayed.run);
    }
    const Run& run = *only_run(call, "replay");
    Run again = {.number = run.number,
                 .strategy_name = run.strategy_name,
                 .strategy = run.strategy,
                 .problem = run.problem,
                 .seed = run.seed};
    // Stops a run that was stopped before at the same position.
    advance(again, run.ended() ? std::numeric_limits<std::uint64_t>::max() : run.proposals, state_.interrupted);
    if (state_.interrupted()) {
      say("interrupted before there was anything to compare");
      return 0;
    }
    const std::string difference = difference_text(run.result(), again.result());
    say(difference.empty()
            ? fmt::format("run {} again: the same, in {:.1f} ms", run.number, 1000.0 * again.result().run.seconds)
            : fmt::format("run {} again: NOT the same: {}", run.number, difference));
    return 0;
  }

  int tune(Stack& call) {
    const dsl::Program program = dsl::read_tuning(call);
    TuneResult result;
    {
      Progress progress(true);
      result =
          trellis::tune(program.experiment, *program.tuning,
                        {.progress = [&](std::size_t done, std::size_t all) { progress.show("planning", done, all); },
                         .interrupted = state_.interrupted});
    }
    const StrategySpec& best = program.experiment.strategies[result.winner].second;
    Value problem = call[2];
    if (problem.type() == Type::table) {
      call.push(std::int64_t{1});
      problem = call.get(problem, call.top());
    }
    state_.problem = program.experiment.problems.front();
    state_.expression = expression_of(call, problem);
    state_.planned = SessionState::Planned{.strategy = best.text(),
                                           .text = best.text(),
                                           .spec = best,
                                           .problem = state_.expression,
                                           .instance = *state_.problem};
    say(tuning_text(program.experiment, *program.tuning, result, state_.screen().columns));
    call.push_object(best);
    state_.announced = call.top().identity();
    return 1;
  }

  int runs(Stack& call) {
    const Value list = call.push_table();
    for (const auto& run : state_.runs) {
      call.push_object(run);
      call.append(list);
    }
    return 1;
  }

  int run(Stack& call) {
    if (!call[1].given()) {
      call.push_object(only_run(call, "run"));
      return 1;
    }
    const auto number = natural("run: its number", call[1], 1);
    if (number > state_.runs.size()) {
      throw Error(fmt::format("run: there are {} runs, got {}", state_.runs.size(), number));
    }
    state_.current = state_.runs[static_cast<std::size_t>(number) - 1];
    call.push_object(state_.current);
    return 1;
  }

  int edit(Stack& call) {
    state_.to_edit = call[1].string().value_or("");
    if (call[1].given() && state_.to_edit.empty()) {
      throw Error(fmt::format("edit: the name of a file belongs here, got {}", dsl::describe(call[1])));
    }
    state_.edits = true;
    return 0;
  }

  int save(Stack& call) {
    const auto file = call[1].string();
    if (!file) {
      throw Error(fmt::format("save: the name of a file belongs here, as save \"session.lua\", got {}",
                              dsl::describe(call[1])));
    }
    std::string text = "-- The inputs of a session of trellis repl; those that print or plan are comments.\n";
    text += requiring_lines(state_, *file);
    for (const auto& input : state_.accepted) text += input + "\n";
    text += returning_line(call);
    write_own("save", *file, text);
    say(fmt::format("{} written: {} inputs", *file, state_.accepted_inputs));
    return 0;
  }

  int help(Stack& call) const {
    const std::size_t columns = std::min(state_.screen().columns, dsl::help_width);
    if (!call[1].given()) {
      say(names_text(columns, state_.screen().rows));
      return 0;
    }
    const std::string verb = call[1].type() == Type::object ? "" : verb_of(call, call[1]);
    if (verb == "words") {
      say(dsl::vocabulary_text(columns));
    } else if (verb == "session") {
      say(verbs_text("", columns));
    } else {
      const std::string known = verb.empty() ? "" : verbs_text(verb, columns);
      // A word of the language that is a session command too has more to read.
      const bool word = std::any_of(dsl::words().begin(), dsl::words().end(),
                                    [&](const dsl::Word& one) { return one.name == verb && verb != "help"; });
      if (known.empty() || word) {
        say(known + dsl::help_text_of(call, call[1], columns));
      } else {
        const std::string options = dsl::option_help(verb, columns);
        say(options.empty() ? known : known + '\n' + options);
      }
    }
    return 0;
  }

  int history(Stack& call) const {
    constexpr std::int64_t usual = 20;
    const auto count = static_cast<std::size_t>(call[1].given() ? natural("history: its number of inputs", call[1], 1)
                                                                : static_cast<std::uint64_t>(usual));
    const auto& inputs = state_.inputs;
    std::string text;
    for (std::size_t i = inputs.size() - std::min(count, inputs.size()); i < inputs.size(); ++i) {
      text += fmt::format("{:>4}  ", i + 1);
      for (const char c : inputs[i]) text += c == '\n' ? std::string("\n      ") : std::string(1, c);
      text += '\n';
    }
    say(text);
    return 0;
  }

  int quit(Stack&) {
    state_.over = true;
    return 0;
  }

 private:
  /// The last line of a saved script: what was planned last.
  std::string returning_line(Stack& call) {
    if (!state_.planned) return "-- Nothing was planned: end this with 'return strategy, problem' to run it.\n";
    const auto& planned = *state_.planned;
    const auto there = [&](const std::string& expression) {
      return !expression.empty() && !state_.lost.contains(root_of(expression));
    };
    // What was typed has a value in the script if all its names have.
    const auto readable = [&](const std::string& typed) {
      if (typed.empty()) return false;
      try {
        const auto uses = lua::global_uses(call, "return " + typed, "=input");
        return std::none_of(uses.begin(), uses.end(), [&](const lua::GlobalUse& use) {
          return use.name == "_" || state_.lost.contains(use.name) || is_command(use.name);
        });
      } catch (const Error&) {
        return false;
      }
    };
    SourceWriter writer(call, state_.lost, nullptr, "");
    std::string strategy = there(planned.strategy) && planned.strategy != planned.text ? planned.strategy : "";
    if (strategy.empty()) {
      call.push_object(planned.spec);
      strategy = writer.text(call.top());
    }
    if (strategy.empty() && readable(planned.typed_strategy)) strategy = planned.typed_strategy;
    std::string problem = there(planned.problem) ? planned.problem : "";
    if (problem.empty()) {
      call.push_object(planned.instance);
      problem = writer.text(call.top());
    }
    if (problem.empty() && readable(planned.typed_problem)) problem = planned.typed_problem;
    if (strategy.empty()) {
      return "-- The last strategy has no text: end this with 'return strategy, problem' to run it.\n";
    }
    if (problem.empty()) {
      return fmt::format("-- The last problem has no name: end this with 'return {}, problem' to run it.\n", strategy);
    }
    if (planned.seed == 1) return fmt::format("return {}, {}\n", strategy, problem);
    return fmt::format(
        "return experiment {{ problems = {{ {} }}, strategies = {{ strategy = {} }}, seeds = {{ {} }} }}\n", problem,
        strategy, planned.seed);
  }

  static std::string absolute(const std::string& file) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file)).string();
  }

  /// The first name of an expression: script of script.strategies.nested.
  static std::string root_of(const std::string& expression) {
    return expression.substr(0, expression.find_first_of(".[( "));
  }

  /// Writes a file of the session.
  /// \param verb  the session command that writes it
  /// \throws Error for a file that is there, that this session did not write, and that the person does not give up
  void write_own(std::string_view verb, const std::string& file, const std::string& content) {
    require_writable_file(file);
    require_own(verb, file);
    write_file(file, content);
    state_.written[absolute(file)] = content;
  }

  void require_own(std::string_view verb, const std::string& file) const {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) return;
    const auto written = state_.written.find(absolute(file));
    if (written != state_.written.end() && dsl::read_file(file) == written->second) return;
    const char* why = written == state_.written.end() ? "is there, and this session did not write it"
                                                      : "has changed since this session wrote it";
    if (state_.confirmed(fmt::format("'{}' {}. Replace it? [y/N] ", file, why))) return;
    throw Error(fmt::format("{0}: '{1}' {2}; it is left as it is: {0} under another name", verb, file, why));
  }

  /// The text of the chunk that defines a function.
  [[nodiscard]] std::string text_of(const lua::Definition& definition) const {
    if (definition.file) {
      constexpr std::string_view input = "input ";
      if (!definition.chunk.starts_with(input)) return dsl::read_file(definition.chunk);
      const auto number = static_cast<std::size_t>(std::atoll(definition.chunk.c_str() + input.size()));
      return number >= 1 && number <= state_.inputs.size() ? state_.inputs[number - 1] : "";
    }
    const std::string name = std::filesystem::path(definition.chunk).stem().string();
    return dsl::module_text(name).value_or("");
  }

  static std::string time_row(const char* what, const Interval& interval) {
    // The lower bound of few runs is NaN or -inf; that of runs without a solution is inf.
    const bool bounded = interval.lo > -std::numeric_limits<double>::infinity();
    const std::string range = bounded ? fmt::format("{:.3g} to {:.3g}", interval.lo, interval.hi)
                                      : fmt::format("{} runs are too few for an interval", interval.n);
    return fmt::format("  {:<24} {:.3g}  ({})\n", what, interval.value, range);
  }

  void time_runs(const std::string& name, const StrategySpec& strategy, const Problem& problem,
                 std::uint64_t count) const {
    std::vector<CensoredCost> milliseconds;
    std::vector<CensoredCost> checks;
    for (std::uint64_t seed = 1; seed <= count && !state_.interrupted(); ++seed) {
      const RunRecord run =
          run_cell(name, strategy, problem, seed, {.interrupted = state_.interrupted, .measured = false}).run;
      if (run.status == Status::interrupted) break;
      milliseconds.push_back({1000.0 * run.cpu_seconds, run.solved});
      checks.push_back({static_cast<double>(run.validity_checks), run.solved});
    }
    if (milliseconds.empty()) {
      say("interrupted before a run ended");
      return;
    }
    const auto solved = std::count_if(checks.begin(), checks.end(), [](const CensoredCost& c) { return c.solved; });
    say(fmt::format("{} on {}, seeds 1 to {}: {} of {} solved; medians with 95 % intervals\n", name, problem.name,
                    checks.size(), solved, checks.size()) +
        time_row("CPU time, ms", median_cost(milliseconds)) + time_row("validity checks", median_cost(checks)));
  }

  /// Times calls of the function that is the first argument.
  static int time_calls(Stack& call, std::uint64_t count) {
    std::vector<CensoredCost> milliseconds;
    const int before = call.size();
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::clock_t begin = std::clock();
      call.push(call[1]);
      call.call(0);
      const auto ticks = static_cast<double>(std::clock() - begin);
      call.resize(before);
      milliseconds.push_back({1000.0 * ticks / CLOCKS_PER_SEC, true});
    }
    say(fmt::format("{} calls; median with 95 % interval\n", count) +
        time_row("CPU time, ms", median_cost(milliseconds)));
    return 0;
  }

  [[nodiscard]] int width() const { return static_cast<int>(state_.screen().columns); }

  [[nodiscard]] Measure measure() const {
    if (state_.script && state_.script->experiment.measure) return *state_.script->experiment.measure;
    return {};
  }

  void add(const RunPointer& run) {
    run->number = state_.runs.size() + 1;
    state_.runs.push_back(run);
    state_.current = run;
    state_.problem = run->problem;
  }

  /// Returns a run that was already printed.
  int announce(Stack& call, const RunPointer& run) {
    call.push_object(run);
    state_.announced = call.top().identity();
    return 1;
  }

  void go_on(Run& run, std::uint64_t proposals) const {
    if (!run.ended()) advance(run, proposals, state_.interrupted);
  }

  int begin(Stack& call, const std::string& verb, std::uint64_t proposals) {
    StrategySpec strategy = strategy_argument(verb, call[1]);
    int next = 2;
    std::optional<NamedProblem> problem;
    const auto given_problem = [&](Value value) {
      problem = {problem_argument(verb, value), expression_of(call, value)};
    };
    if (call[next].given() && call[next].type() != Type::table) given_problem(call[next++]);
    std::uint64_t seed = 1;
    if (call[next].type() == Type::table) {
      const Value options = call[next];
      check_options(verb, options, {"seed", "problem"});
      if (const Value given = options.field("seed"); given.given()) seed = natural(verb + ": option 'seed'", given, 0);
      if (const Value given = options.field("problem"); given.given()) given_problem(given);
    } else if (call[next].given()) {
      throw Error(fmt::format("{}: a table of options belongs here, as {{ seed = 2 }}, got {}", verb,
                              dsl::describe(call[next])));
    }
    if (!problem) problem = usual_problem(call, of_script(strategy));
    std::string name = name_of(call, state_, strategy);
    const std::string text = strategy.text();
    std::string expression = expression_of(call, call[1]);
    if (expression.empty()) expression = text;
    const StrategySpec run_spec = strategy;
    auto run = std::make_shared<Run>(Run{
        .strategy_name = std::move(name), .strategy = std::move(strategy), .problem = problem->problem, .seed = seed});
    advance(*run, proposals, state_.interrupted);
    add(run);
    state_.expression = problem->expression;
    const auto typed = [&](std::size_t i) {
      return i < state_.typed.size() && !state_.typed[i].starts_with('{') ? state_.typed[i] : "";
    };
    state_.planned = SessionState::Planned{.strategy = std::move(expression),
                                           .text = text,
                                           .spec = run_spec,
                                           .problem = problem->expression,
                                           .instance = problem->problem,
                                           .seed = seed,
                                           .typed_strategy = typed(0),
                                           .typed_problem = typed(1)};
    say_outcome(*run);
    return announce(call, run);
  }

  /// Whether the loaded script has this strategy.
  [[nodiscard]] bool of_script(const StrategySpec& strategy) const {
    if (!state_.script) return false;
    const auto& all = state_.script->experiment.strategies;
    return std::any_of(all.begin(), all.end(), [&](const auto& entry) { return entry.second == strategy; });
  }

  /// Returns the problem of a run that names none: the last one, but the script's for the script's own strategies.
  NamedProblem usual_problem(Stack& call, bool scripts) {
    const bool has_problems = state_.script && !state_.script->experiment.problems.empty();
    if (has_problems && (scripts || !state_.problem)) {
      const auto& problems = state_.script->experiment.problems;
      // The last problem may be one of several of the script.
      const auto last = std::find_if(problems.begin(), problems.end(), [&](const Problem& problem) {
        return state_.problem && problem.name == state_.problem->name && problem.scene == state_.problem->scene;
      });
      const Problem& chosen = last != problems.end() ? *last : problems.front();
      return {chosen, field_path("script.problems", chosen.name)};
    }
    if (state_.problem) return {*state_.problem, state_.expression};
    call.load("return require('scenes').simple_passage()", "=repl");
    call.call(0);
    return {problem_argument("plan", call.top()), "scenes.simple_passage()"};
  }

  /// Returns the run that an argument names, else the current one.
  RunPointer run_argument(Stack& call, const char* verb, int& next) {
    if (const auto* run = call[next].get<RunPointer>()) {
      ++next;
      return *run;
    }
    if (!state_.current) throw Error(fmt::format("{}: there is no run yet; plan(strategy) makes one", verb));
    return state_.current;
  }

  /// The same for a command without other arguments.
  RunPointer only_run(Stack& call, const char* verb) {
    int next = 1;
    RunPointer run = run_argument(call, verb, next);
    if (call[next].given()) {
      throw Error(fmt::format("{}: it takes a run and nothing else, got {}", verb, dsl::describe(call[next])));
    }
    return run;
  }

  /// { azimuth = 20, elevation = 60 }
  static PlotView view_argument(Value options) {
    if (options.type() != Type::table) {
      throw Error(fmt::format("plot: a view belongs here, as {{ azimuth = 20, elevation = 60 }}, got {}",
                              dsl::describe(options)));
    }
    check_options("plot", options, {"azimuth", "elevation"});
    const auto degrees = [&](const char* name, double most) -> std::optional<double> {
      const Value given = options.field(name);
      if (!given.given()) return std::nullopt;
      const auto number = given.number();
      if (number && std::abs(*number) <= most) return number;
      throw Error(fmt::format("plot: option '{}' must be a number of degrees in [-{:g}, {:g}], got {}", name, most,
                              most, dsl::describe(given)));
    };
    return {.azimuth = degrees("azimuth", 360.0), .elevation = degrees("elevation", 90.0)};
  }

  static std::size_t level_argument(const char* verb, const Run& run, Value value) {
    if (!value.given()) return 0;
    const std::size_t levels = run.result().levels.size();
    const auto level = value.integer();
    if (!level || *level < 0 || static_cast<std::size_t>(*level) >= levels) {
      const BoundedLoss& law = run.result().run.bounded;
      if (level && *level > 0 && law.bound > 0.0 && !law.guides_set_up) {
        throw Error(
            fmt::format("{}: the run has no level {}{}: its guides are set up when {} without guides has done as much "
                        "work as that costs, about {:.0f} checks; with bound = 0 it begins with them",
                        verb, *level, run.ended() ? "" : " yet", run.strategy.planner().name(), law.set_up));
      }
      throw Error(fmt::format("{}: the run has the levels 0 to {}, got {}", verb, levels - 1, dsl::describe(value)));
    }
    return static_cast<std::size_t>(*level);
  }

  /// Returns an experiment of the strategies and options in a call.
  Experiment comparison(Stack& call, const std::string& verb) {
    constexpr std::uint64_t usual_seeds = 5;
    Experiment experiment;
    experiment.measure = measure();
    experiment.seeds = dsl::consecutive_seeds(1, usual_seeds);
    std::optional<Problem> problem;
    const auto add = [&](std::string name, StrategySpec strategy) {
      const std::string base = name;
      const auto taken = [&] {
        return std::any_of(experiment.strategies.begin(), experiment.strategies.end(),
                           [&](const auto& entry) { return entry.first == name; });
      };
      for (int i = 2; taken(); ++i) name = fmt::format("{} ({})", base, i);
      experiment.strategies.emplace_back(std::move(name), std::move(strategy));
    };
    for (int i = 1; i <= call.count(); ++i) {
      const Value value = call[i];
      if (value.type() != Type::table) {
        StrategySpec strategy = strategy_argument(verb, value);
        std::string name = name_of(call, state_, strategy);
        add(std::move(name), std::move(strategy));
        continue;
      }
      // A table of strategies by name, such as script.strategies, or the options.
      const lua::Keys keys = value.keys();
      const bool strategies = !keys.names.empty() &&
                              std::all_of(keys.names.begin(), keys.names.end(),
                                          [&](const auto& n) { return dsl::as_strategy(value.field(n)).has_value(); });
      if (strategies) {
        for (const auto& name : keys.names) add(name, *dsl::as_strategy(value.field(name)));
        continue;
      }
      check_options(verb, value, {"problem", "seeds", "measure"});
      if (const Value given = value.field("problem"); given.given()) problem = problem_argument(verb, given);
      if (const Value given = value.field("seeds"); given.given()) {
        experiment.seeds = dsl::consecutive_seeds(1, natural(verb + ": option 'seeds'", given, 1));
      }
      if (const Value given = value.field("measure"); given.given()) {
        const auto* target = given.get<TargetSpec>();
        if (target == nullptr && given.boolean() != false) {
          throw Error(fmt::format("{}: option 'measure' must be a target, as tube {{}}, or false, got {}", verb,
                                  dsl::describe(given)));
        }
        if (target != nullptr) {
          if (!experiment.measure) experiment.measure.emplace();
          experiment.measure->target = *target;
        } else {
          experiment.measure.reset();
        }
      }
    }
    const auto& all = experiment.strategies;
    const bool scripts =
        std::all_of(all.begin(), all.end(), [&](const auto& entry) { return of_script(entry.second); });
    if (!problem) {
      NamedProblem usual = usual_problem(call, scripts);
      problem = std::move(usual.problem);
      state_.expression = std::move(usual.expression);
    } else {
      state_.expression.clear();
    }
    experiment.problems = {*problem};
    state_.problem = experiment.problems.front();
    return experiment;
  }

  int report(Experiment& experiment) {
    ExperimentResult result;
    std::string finished;
    {
      Progress progress(true);
      const std::size_t cells = experiment.strategies.size() * experiment.seeds.size();
      progress.show("planning", 0, cells);
      result = run_or_part(
          experiment,
          {.progress = [&](std::size_t done, std::size_t all) { progress.show_experiment(done, all, cells); },
           .interrupted = state_.interrupted},
          finished);
    }
    say(summary_text(summarise(facts_of(experiment, result)), width()).substr(1));
    if (!finished.empty()) {
      say(fmt::format("interrupted; this is what was finished: {}", finished));
      state_.forget_interruption();
    }
    return 0;
  }

  /// Returns the session command that a value names or is, "" for none.
  static std::string verb_of(Stack& call, Value value) {
    if (const auto word = value.string()) return *word;
    std::string name;
    const int before = call.size();
    const Value commands = push_verbs(call);
    for (const Verb& verb : all_verbs) {
      const int kept = call.size();
      if (commands.field(std::string(verb.name)).identity() == value.identity()) name = verb.name;
      call.resize(kept);
    }
    call.resize(before);
    return name;
  }

  SessionState& state_;
};

}  // namespace

std::span<const Verb> verbs() { return all_verbs; }

bool is_command(std::string_view name) {
  return std::any_of(all_verbs.begin(), all_verbs.end(), [&](const Verb& verb) { return verb.name == name; });
}

std::string change_of(const Problem& before, const Problem& after) {
  std::vector<std::string> parts;
  const auto note = [&](bool same, const char* part) {
    if (!same) parts.emplace_back(part);
  };
  note(world_hash(*before.scene) == world_hash(*after.scene), "world");
  note(robot_hash(*before.scene) == robot_hash(*after.scene), "robot");
  note(identity(before.space) == identity(after.space), "space");
  note(before.start == after.start, "start");
  note(before.goals == after.goals && before.goal_tolerance == after.goal_tolerance, "goal");
  note(before.resolution == after.resolution && before.collision == after.collision, "collision checks");
  return parts.empty() ? "" : fmt::format("has another {}", fmt::join(parts, ", "));
}

std::string field_path(const std::string& table, const std::string& name) {
  const auto all = dsl::tokens(name);
  const bool plain = all.size() == 1 && all.front().kind == dsl::Token::Kind::name && all.front().text == name;
  return plain ? table + "." + name : table + "[\"" + name + "\"]";
}

std::string verbs_text(std::string_view name, std::size_t width) {
  constexpr std::size_t column = 30;
  std::string text;
  for (const Verb& verb : all_verbs) {
    if (name.empty()) {
      const bool fits = verb.usage.size() <= column;
      if (!fits) text += fmt::format("  {}\n", verb.usage);
      text += wrap(std::string(verb.summary), width, fmt::format("  {:<{}} ", fits ? verb.usage : "", column),
                   std::string(column + 3, ' '));
    } else if (name == verb.name) {
      text = wrap(fmt::format("{}: {}", verb.usage, verb.summary), width, "", "  ");
    }
  }
  return text;
}

std::string names_text(std::size_t width, std::size_t rows) {
  std::string text;
  const auto list = [&](const std::string& title, const std::vector<std::string>& names) {
    text += wrap(fmt::format("{}", fmt::join(names, " ")), width, title + ": ", "  ");
  };
  std::vector<std::string> names;
  names.reserve(std::size(all_verbs));
  for (const Verb& verb : all_verbs) names.emplace_back(verb.name);
  list("session", names);
  using Kind = dsl::Word::Kind;
  for (const auto& [kind, title] : {std::pair{Kind::planner, "planners"},
                                    {Kind::guide, "guides"},
                                    {Kind::target, "targets"},
                                    {Kind::estimator, "estimators"},
                                    {Kind::constructor, "values"},
                                    {Kind::function, "functions"}}) {
    names.clear();
    for (const dsl::Word& word : dsl::words()) {
      if (word.kind == kind && (kind != Kind::function || word.module().empty())) names.push_back(word.name);
    }
    list(title, names);
  }
  std::string modules;
  std::swap(text, modules);
  for (const dsl::Word& module : dsl::words()) {
    if (module.kind != Kind::module) continue;
    names.clear();
    for (const dsl::Word& word : dsl::words()) {
      if (word.module() == module.name) names.push_back(word.name.substr(module.name.size() + 1));
    }
    list(module.name, names);
  }
  std::swap(text, modules);
  constexpr const char* more =
      R"(help "shrink" explains a word, help "session" the functions of a session, help "words" lists all with a line each)";
  const std::string end = '\n' + wrap(more, width, "", "");
  const auto lines = [](const std::string& part) {
    return static_cast<std::size_t>(std::count(part.begin(), part.end(), '\n'));
  };
  // The prompt has a line, too.
  if (lines(text) + lines(modules) + lines(end) < rows) return text + modules + end;
  names.clear();
  for (const dsl::Word& module : dsl::words()) {
    if (module.kind == Kind::module) names.push_back(module.name);
  }
  list("modules", names);
  return text + end;
}

Value push_verbs(Stack& stack) { return stack.push_hidden("session commands"); }

namespace {

/// Pushes what a name means in an input: a session command, or a global.
int read_name(Stack& call) {
  const Value commands = push_verbs(call);
  const auto name = call[2].string();
  if (name && commands.field(*name).given()) return 1;
  const Value globals = call.push_globals();
  if (name && !globals.field(*name).given()) {
    std::vector<std::string> known = dsl::module_names();
    if (std::find(known.begin(), known.end(), *name) == known.end()) {
      const auto add = [&](const std::vector<std::string>& names) {
        known.insert(known.end(), names.begin(), names.end());
      };
      add(globals.keys().names);
      add(commands.keys().names);
      // The globals report every other unknown name.
      const std::string nearest = nearest_name(*name, known);
      if (commands.field(nearest).given()) {
        throw Error(fmt::format("unknown name '{}'{}", *name, did_you_mean(*name, known)));
      }
    }
  }
  call.get(globals, call[2]);
  return 1;
}

/// Assigns a name in an input: a global, but for the names of session commands, so that a script does not hide them.
int assign_name(Stack& call) {
  const auto name = call[2].string();
  const bool command = name && push_verbs(call).field(*name).given();
  if (command) {
    call.push(call[3]);
    call.set_field(call[1], *name);
  } else {
    call.set(call.push_globals(), call[2], call[3]);
  }
  return 0;
}

}  // namespace

void open_verbs(Stack& stack, SessionState& state) {
  const auto verbs = std::make_shared<Verbs>(state);
  stack.on_missing(stack.push_hidden(typed_environment), read_name, assign_name);
  const Value commands = push_verbs(stack);
  const auto add = [&](const char* name, auto method) {
    stack.push_function([verbs, &state, method](Stack& call) {
      state.used = true;
      return ((*verbs).*method)(call);
    });
    stack.set_field(commands, name);
  };
  add("plan", &Verbs::plan);
  add("start", &Verbs::start);
  add("step", &Verbs::step);
  add("continue", static_cast<int (Verbs::*)(Stack&)>(&Verbs::go_on));
  add("where", &Verbs::where);
  add("levels", &Verbs::levels);
  add("samples", &Verbs::samples);
  add("efficiency", &Verbs::efficiency);
  add("plot", &Verbs::plot);
  add("compare", &Verbs::compare);
  add("ablate", &Verbs::ablate);
  add("time", &Verbs::time);
  add("source", &Verbs::source);
  add("tune", &Verbs::tune);
  add("replay", &Verbs::replay);
  add("runs", &Verbs::runs);
  add("run", &Verbs::run);
  add("edit", &Verbs::edit);
  add("reload", &Verbs::reload);
  add("save", &Verbs::save);
  add("quit", &Verbs::quit);
  add("history", &Verbs::history);
  add("help", &Verbs::help);
}

}  // namespace trellis::command
