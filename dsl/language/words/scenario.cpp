// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/scenario.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/core/word.hpp>
#include <dsl/language/words/algebra.hpp>
#include <dsl/language/words/experiment.hpp>
#include <dsl/language/words/measure.hpp>
#include <trellis/report/words.hpp>

namespace trellis::dsl {

namespace {

/// The preconditions of a scenario: a problem, and strategies by name.
struct Setting {
  std::string script;  ///< as given on a command line, "" if it is in the scenario itself
  Problem problem;
  std::vector<std::pair<std::string, StrategySpec>> strategies;
  std::shared_ptr<const Measure> measure;
  std::int64_t shortcut = 0;
};
struct Tried {
  std::shared_ptr<const Setting> setting;
};
/// One of its strategies.
struct Candidate {
  std::shared_ptr<const Setting> setting;
  std::size_t index = 0;
};

}  // namespace

}  // namespace trellis::dsl

namespace trellis::lua {

template <>
struct Weight<dsl::Tried> {
  static std::size_t of(const dsl::Tried& given) {
    constexpr std::size_t strategy = 1024;
    return sizeof given + Weight<Problem>::of(given.setting->problem) + given.setting->strategies.size() * strategy;
  }
};
template <>
struct Weight<trial::Trial> {
  static std::size_t of(const trial::Trial& trial) {
    constexpr std::size_t setup = 2048;
    return setup + trial.setup().seeds.size() * sizeof(std::uint64_t);
  }
};

template <>
struct TypeName<dsl::Tried> {
  static constexpr const char* value = "setting";
};
template <>
struct TypeName<dsl::Candidate> {
  static constexpr const char* value = "strategy of a setting";
};
template <>
struct TypeName<trial::Trial> {
  static constexpr const char* value = "trial";
};
template <>
struct TypeName<trial::Criterion> {
  static constexpr const char* value = "criterion";
};
template <>
struct TypeName<trial::MatcherPointer> {
  static constexpr const char* value = "matcher";
};

}  // namespace trellis::lua

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;
using trial::Criterion;
using trial::MatcherPointer;
using trial::Trial;
using Book = std::shared_ptr<ScenarioBook>;

/// No manually written scenario has more: the script has an infinite loop.
constexpr std::size_t most_steps = 10'000;
constexpr std::size_t most_trials = 10'000;
constexpr std::size_t most_runs = 1'000'000;

struct GivenSettings {
  std::int64_t shortcut = 0;
};
const Settings<GivenSettings>& given_settings() {
  static const auto settings = Settings<GivenSettings>(Component::Kind::combinator, "given", "what is tried", "")
                                   .integer("shortcut", &GivenSettings::shortcut, "rounds", Range::non_negative(),
                                            "rounds of shortcutting on each found path; with 'script' its own");
  return settings;
}

struct WhenSettings {
  std::int64_t seed = 1;
};
const Settings<WhenSettings>& when_settings() {
  static const auto settings = Settings<WhenSettings>(Component::Kind::combinator, "when", "runs", "")
                                   .integer("seed", &WhenSettings::seed, "", Range::non_negative(),
                                            "the first of consecutive seeds, where 'seeds' is their number");
  return settings;
}

struct EfficiencySettings {
  bool expansion = false;
  bool root = false;
  bool mass = false;
};
const Settings<EfficiencySettings>& efficiency_settings() {
  static const auto settings =
      Settings<EfficiencySettings>(Component::Kind::combinator, "has_efficiency", "how well a level samples", "")
          .choice("role", &EfficiencySettings::expansion, {{"tree", false}, {"expansion", true}},
                  "the level's nodes, or what its h proposed")
          .choice("target", &EfficiencySettings::root, {{"own", false}, {"root", true}},
                  "in its own space on its own path, or lifted to the root on the root's")
          .choice("part", &EfficiencySettings::mass, {{"all", false}, {"mass", true}},
                  "the divergence by what the samples support, or its mass alone: how many more of them lie in the "
                  "target than uniform ones");
  return settings;
}

// What can stand behind a criterion -----------------------------------------------------------------------------------

struct Method {
  const char* name;
  const char* type;
  const char* doc;
  Criterion (*apply)(const Criterion&, Value argument);
};

double number_argument(const char* name, Value value, const char* expects = "a number") {
  const auto number = value.number();
  if (!number) throw Error(fmt::format("{}: takes {}, got {}", name, expects, describe(value)));
  return *number;
}

const std::vector<Method>& criterion_methods() {
  static const std::vector<Method> methods = {
      {"validity_checks", "fun(): trellis.Criterion", "of configurations whose validity was decided",
       [](const Criterion& c, Value) { return c.validity_checks(); }},
      {"motion_checks", "fun(): trellis.Criterion", "of motions that were checked",
       [](const Criterion& c, Value) { return c.motion_checks(); }},
      {"proposals", "fun(): trellis.Criterion", "of configurations that h proposed",
       [](const Criterion& c, Value) { return c.proposals(); }},
      {"nodes", "fun(): trellis.Criterion", "of nodes of trees and roadmaps",
       [](const Criterion& c, Value) { return c.nodes(); }},
      {"in_level", "fun(level: string|integer): trellis.Criterion", "of one level, instead of all of them together",
       [](const Criterion& c, Value level) {
         if (const auto number = level.integer()) return c.in_level(std::to_string(*number));
         const auto name = level.string();
         if (!name) throw Error(fmt::format("in_level: takes a level's name or number, got {}", describe(level)));
         return c.in_level(*name);
       }},
      {"by", "fun(margin: number): trellis.Criterion",
       "less or more than another trial by this much at the least: a share of its spending, or nats",
       [](const Criterion& c, Value margin) { return c.by(number_argument("by", margin)); }},
      {"with_confidence", "fun(confidence: number): trellis.Criterion",
       "how sure a statement about all seeds is to be, in (0.5, 1); 0.95 without it",
       [](const Criterion& c, Value confidence) {
         return c.with_confidence(number_argument("with_confidence", confidence));
       }}};
  return methods;
}

int criterion_method(Stack& call) {
  const auto* criterion = call[1].get<Criterion>();
  const auto asked = call[2].string();
  std::vector<std::string> known;
  for (const Method& method : criterion_methods()) {
    known.emplace_back(method.name);
    if (criterion == nullptr || !asked || *asked != method.name) continue;
    call.push_function([criterion = *criterion, &method](Stack& use) {
      // a.by(0.2) is the documented form; a:by(0.2) is equivalent.
      return use.result(method.apply(criterion, use[use[1].get<Criterion>() != nullptr ? 2 : 1]));
    });
    return 1;
  }
  throw Error(fmt::format("a criterion has no {}{}; it has: {}", asked.value_or(call[2].describe()),
                          asked ? did_you_mean(*asked, known) : "", fmt::join(known, ", ")));
}

int criterion_text(Stack& call) {
  const auto* criterion = call[1].get<Criterion>();
  return call.result(criterion == nullptr ? call[1].describe() : criterion->text());
}

Criterion criterion_argument(const std::string& word, const char* usage, Value value) {
  if (const auto* criterion = value.get<Criterion>()) return *criterion;
  throw Error(fmt::format("{}: a criterion belongs here, as {}, got {}{}", word, usage, describe(value),
                          value.type() == Type::function ? ": call it, with ()" : ""));
}

// Words ---------------------------------------------------------------------------------------------------------------

/// A word that is a plain function of its arguments.
struct Function {
  Construct construct;
  int (*call)(Stack&);
};

Construct function_construct(const char* name, const char* usage, const char* summary, std::vector<Field> arguments,
                             const char* returns) {
  Construct construct;
  construct.name = name;
  construct.usage = usage;
  construct.summary = summary;
  construct.returns = returns;
  construct.arguments = std::move(arguments);
  return construct;
}

constexpr const char* criterion_type = "trellis.Criterion";
constexpr const char* matcher_type = "trellis.Matcher";

template <Criterion::Kind kind>
int make_bound(Stack& call) {
  static const std::map<Criterion::Kind, const char*> names = {{Criterion::Kind::at_least, "at_least"},
                                                               {Criterion::Kind::at_most, "at_most"},
                                                               {Criterion::Kind::below, "below"},
                                                               {Criterion::Kind::above, "above"},
                                                               {Criterion::Kind::exactly, "exactly"}};
  if constexpr (kind == Criterion::Kind::below || kind == Criterion::Kind::above) {
    if (const auto* other = call[1].get<Trial>()) return call.result(Criterion(kind, *other));
    constexpr const char* expects = "a number, or a trial, as `when` makes it";
    return call.result(Criterion(kind, number_argument(names.at(kind), call[1], expects)));
  }
  return call.result(Criterion(kind, number_argument(names.at(kind), call[1])));
}

int make_solves(Stack& call) {
  return call.result(trial::solves(criterion_argument("solves", "solves(at_least(0.95))", call[1])));
}

int make_spends(Stack& call) {
  constexpr const char* usage = "spends(below(plain).validity_checks())";
  return call.result(trial::spends(criterion_argument("spends", usage, call[1])));
}

int make_finds_paths(Stack& call) {
  if (!call[1].given()) return call.result(trial::finds_paths());
  return call.result(trial::finds_paths(criterion_argument("finds_paths", "finds_paths(at_most(20))", call[1])));
}

int make_has_efficiency(Stack& call) {
  constexpr const char* usage = R"(has_efficiency("root", above(0.5)))";
  std::string name = call[1].string().value_or("");
  if (const auto number = call[1].integer()) name = std::to_string(*number);
  if (name.empty()) {
    throw Error(fmt::format("has_efficiency: a level belongs first, as in {}, got {}", usage, describe(call[1])));
  }
  const Criterion nats = criterion_argument("has_efficiency", usage, call[2]);
  const auto& component = efficiency_settings().component();
  const auto settings =
      efficiency_settings().read(validated(component, read_options(component, call, 3, false).options));
  trial::Level level(name);
  if (settings.expansion) level = level.expansion();
  if (settings.root) level = level.lifted();
  if (settings.mass) level = level.mass();
  return call.result(trial::has_efficiency(level, nats));
}

int make_is_deterministic(Stack& call) { return call.result(trial::is_deterministic()); }

const std::vector<Function>& plain_functions() {
  const auto bound = [](const char* name, const char* usage, const char* summary, bool trial, int (*call)(Stack&)) {
    const char* const expects = trial ? "a number, or a trial" : "a number";
    const char* const doc =
        trial ? "against another trial, on the same problem and seeds, it goes seed by seed; .by(0.2) asks for 20 % at "
                "the least"
              : "a share, nats, metres, or how many";
    return Function{
        function_construct(name, usage, summary, {{"x", trial ? "number|trellis.Trial" : "number", expects, doc, true}},
                           criterion_type),
        call};
  };
  using Kind = Criterion::Kind;
  static const std::vector<Function> functions = [&] {
    std::vector<Function> all = {
        bound("at_least", "at_least(0.95)", "a criterion: so much or more", false, make_bound<Kind::at_least>),
        bound("at_most", "at_most(5000).validity_checks()", "a criterion: so much or less", false,
              make_bound<Kind::at_most>),
        bound("below", "below(2.0)", "a criterion: less than a number, or than another trial", true,
              make_bound<Kind::below>),
        bound("above", "above(0.5)", "a criterion: more than a number, or than another trial", true,
              make_bound<Kind::above>),
        bound("exactly", "exactly(0).validity_checks()", "a criterion: just so much, in every run", false,
              make_bound<Kind::exactly>)};
    all.push_back({function_construct(
                       "solves", "solves(at_least(0.95))", "a matcher: the share of the seeds whose run finds a path",
                       {{"share", criterion_type, "a criterion",
                         "of a number in [0, 1]; with .with_confidence(0.95) it speaks of all seeds there are", true}},
                       matcher_type),
                   make_solves});
    all.push_back({function_construct("spends", "spends(below(plain).validity_checks())",
                                      "a matcher: what runs spend until they have a path, at the median over seeds",
                                      {{"criterion", criterion_type, "a criterion with a quantity",
                                        "as at_most(5000).validity_checks(); a run without a path counts as more than "
                                        "any other, with above as what it has spent",
                                        true}},
                                      matcher_type),
                   make_spends});
    all.push_back(
        {function_construct("finds_paths", "finds_paths(at_most(20))",
                            "a matcher: all paths found are valid and, at the median, as long as it says",
                            {{"length", criterion_type, "a criterion", "of metres in the metric; any without"}},
                            matcher_type),
         make_finds_paths});
    all.push_back(
        {function_construct(
             "has_efficiency", R"(has_efficiency("root", above(0.5)))",
             "a matcher: by how many nats a level samples above uniform sampling, as far as its samples show; more is "
             "better",
             {{"level", "string|integer", "a level's name or number",
               "\"root\", \"lazy\", \"shrink(0.5)\", the route to the root as \"skeleton >> lazy\", or 0, 1, ...",
               true},
              {"criterion", criterion_type, "a criterion", "of nats; above(plain) compares two trials", true}},
             matcher_type),
         make_has_efficiency});
    all.back().construct.options = efficiency_settings().component();
    all.push_back(
        {function_construct("is_deterministic", "is_deterministic()",
                            "a matcher: runs come out the same, to the last bit, on one thread and on several", {},
                            matcher_type),
         make_is_deterministic});
    return all;
  }();
  return functions;
}

// Scenarios -----------------------------------------------------------------------------------------------------------

const Construct& given_construct();
const Construct& when_construct();

/// Returns the scenario whose function runs. \throws Error if there is none.
Scenario& current(const Book& book, const char* word) {
  if (!book) {
    throw Error(fmt::format("{}: scenarios are run by `trellis test FILE`, and by nothing else", word));
  }
  if (book->current == nullptr) {
    throw Error(fmt::format("{}: it belongs inside a scenario: scenario \"...\" (function() ... end)", word));
  }
  return *book->current;
}

void add_step(Stack& call, Scenario& scenario, Step::Kind kind, std::string text,
              std::optional<Step::Expectation> expectation = {}) {
  if (scenario.steps.size() >= most_steps) {
    throw Error(fmt::format("a scenario has {} lines at most; is there an infinite loop?", most_steps));
  }
  Step& step = scenario.steps.emplace_back();
  step.kind = kind;
  step.text = std::move(text);
  step.expectation = std::move(expectation);
  if (auto position = call.where()) step.where = std::move(*position);
}

int begin_scenario(const Book& book, Stack& call) {
  if (!book) throw Error("scenario: scenarios are run by `trellis test FILE`, and by nothing else");
  if (book->current != nullptr) throw Error("scenario: a scenario cannot stand inside another one");
  const auto name = call[1].string();
  if (!name || name->empty()) {
    throw Error(
        fmt::format("scenario: its name comes first, as in scenario \"regions help\" (function() ... end), got {}",
                    describe(call[1])));
  }
  for (const auto& entry : book->entries) {
    if (entry.scenario.name == *name) throw Error(fmt::format("scenario: two are called '{}'", *name));
  }
  if (book->entries.size() >= most_steps) throw Error(fmt::format("a file has {} scenarios at most", most_steps));
  const std::size_t index = book->entries.size();
  book->entries.push_back({{*name, call.where().value_or(lua::Position{}), {}}, nullptr});
  call.push_function([book, index](Stack& use) {
    if (use[1].type() != Type::function || use.count() != 1) {
      throw Error(fmt::format("scenario '{}': a function belongs behind the name, got {}",
                              book->entries[index].scenario.name, describe(use[1])));
    }
    if (book->entries[index].body) {
      throw Error(fmt::format("scenario '{}': it has its function already", book->entries[index].scenario.name));
    }
    book->entries[index].body = std::make_shared<lua::Reference>(use, use[1]);
    return 0;
  });
  return 1;
}

std::string names_of(const std::vector<Problem>& problems) {
  std::string all;
  for (const Problem& problem : problems) all += fmt::format("{}'{}'", all.empty() ? "" : ", ", problem.name);
  return all;
}

/// Returns the path of a script that a test names, within the test's folder.
std::string script_path(const std::string& name, const ScriptPlace& place) {
  namespace fs = std::filesystem;
  const fs::path given = fs::path(name).lexically_normal();
  const bool within = !given.is_absolute() && !given.empty() && *given.begin() != "..";
  if (!within && !place.trust) {
    throw Error(
        fmt::format("given: the script '{}' does not lie in the test's folder; --trust lets a test that you "
                    "trust read it",
                    name));
  }
  return (given.is_absolute() ? given : fs::path(place.folder) / given).lexically_normal().string();
}

Setting setting_of_script(const Book& book, const ScriptPlace& place, const Arguments& arguments) {
  for (const char* field : {"strategies", "measure", "shortcut"}) {
    if (arguments[field].given()) {
      throw Error(
          fmt::format("given: field '{}' is the script's own affair; leave it out, or leave out 'script'", field));
    }
  }
  const auto name = arguments.string("script");
  if (name->empty()) arguments.reject("script");
  Setting setting;
  setting.script = script_path(*name, place);
  const Program program = book->load(setting.script);
  const Experiment& experiment = program.experiment;
  const auto wanted = arguments.string("problem");
  if (!wanted && experiment.problems.size() > 1) {
    throw Error(fmt::format("given: '{}' has several problems; say which: problem = one of {}", *name,
                            names_of(experiment.problems)));
  }
  std::vector<std::string> known;
  for (const Problem& problem : experiment.problems) {
    if (!wanted || problem.name == *wanted) setting.problem = problem;
    known.push_back(problem.name);
  }
  if (wanted && setting.problem.name != *wanted) {
    throw Error(fmt::format("given: '{}' has no problem '{}'{}; it has {}", *name, *wanted,
                            did_you_mean(*wanted, known), names_of(experiment.problems)));
  }
  setting.strategies = experiment.strategies;
  if (experiment.measure) setting.measure = std::make_shared<const Measure>(*experiment.measure);
  setting.shortcut = experiment.shortcut;
  return setting;
}

Setting setting_of_values(const Arguments& arguments) {
  Setting setting;
  const auto* problem = arguments["problem"].get<Problem>();
  if (problem == nullptr) {
    if (arguments["problem"].given()) arguments.reject("problem");
    throw Error("given: what is tried is missing: script = \"...\", or problem = p, strategies = { name = strategy }");
  }
  setting.problem = *problem;
  if (!arguments["strategies"].given()) {
    throw Error("given: field 'strategies' is missing: a table { name = strategy }");
  }
  setting.strategies = read_strategies(arguments, "given");
  setting.shortcut = given_settings().read(arguments.options()).shortcut;
  const Value measure = arguments["measure"];
  if (measure.given()) {
    const auto* target = measure.get<TargetSpec>();
    if (target == nullptr) arguments.reject("measure");
    Measure made;
    made.target = *target;
    setting.measure = std::make_shared<const Measure>(std::move(made));
  }
  return setting;
}

int make_given(const Book& book, const ScriptPlace& place, Stack& call) {
  Scenario& scenario = current(book, "given");
  const Arguments arguments(given_construct(), call);
  const Setting setting =
      arguments["script"].given() ? setting_of_script(book, place, arguments) : setting_of_values(arguments);
  add_step(call, scenario, Step::Kind::given,
           setting.script.empty() ? fmt::format("the problem '{}'", setting.problem.name)
                                  : fmt::format("the problem '{}' of {}", setting.problem.name, setting.script));
  return call.result(Tried{std::make_shared<const Setting>(setting)});
}

int strategy_of_given(Stack& call) {
  const auto* given = call[1].get<Tried>();
  const auto name = call[2].string();
  std::vector<std::string> known;
  if (given != nullptr) {
    const auto& strategies = given->setting->strategies;
    for (std::size_t i = 0; i < strategies.size(); ++i) {
      if (name && strategies[i].first == *name) return call.result(Candidate{given->setting, i});
      known.push_back(strategies[i].first);
    }
  }
  throw Error(fmt::format("what is given has no strategy {}{}; it has: {}",
                          name ? fmt::format("'{}'", *name) : call[2].describe(),
                          name ? did_you_mean(*name, known) : "", fmt::join(known, ", ")));
}

int make_when(const Book& book, Stack& call) {
  Scenario& scenario = current(book, "when");
  const Arguments arguments(when_construct(), call);
  const auto first = static_cast<std::uint64_t>(when_settings().read(arguments.options()).seed);
  std::vector<std::uint64_t> seeds = read_seeds(arguments, "when", first, trial::default_seeds);
  if (book->seeds) seeds = trial::seeds(*book->seeds, seeds.front());
  std::vector<Trial> trials;
  std::string names;
  // The recorded steps are not part of the script's memory, so they have their own limits.
  const std::size_t all = arguments.count() + book->trials.size();
  std::size_t runs = arguments.count() * seeds.size();
  for (const Trial& trial : book->trials) runs += trial.setup().seeds.size();
  if (all > most_trials || runs > most_runs) {
    throw Error(fmt::format("when: a scenario has at most {} trials with {} runs in all, got {} with {}", most_trials,
                            most_runs, all, runs));
  }
  arguments.each([&](std::size_t i, Value element) {
    const auto* candidate = element.get<Candidate>();
    if (candidate == nullptr) {
      throw Error(
          fmt::format("when: element {} must be a strategy of what was given, as in `local it = given {{ ... }}` "
                      "and it.guided, got {}",
                      i, describe(element)));
    }
    const Setting& setting = *candidate->setting;
    const auto& [name, strategy] = setting.strategies[candidate->index];
    trials.emplace_back(trial::Setup{.name = name,
                                     .strategy = strategy,
                                     .problem = setting.problem,
                                     .seeds = seeds,
                                     .measure = setting.measure,
                                     .shortcut = setting.shortcut,
                                     .script = setting.script},
                        book->making);
    names += (names.empty() ? "" : ", ") + name;
  });
  if (trials.empty()) throw Error("when: nothing is tried; name strategies of what was given, as when { it.guided }");
  add_step(call, scenario, Step::Kind::when, fmt::format("{} on {}", names, seeds_text(seeds)));
  const auto count = static_cast<int>(trials.size());
  for (Trial& trial : trials) {
    book->trials.push_back(trial);
    call.push_object(std::move(trial));
  }
  return count;
}

int make_expect(const Book& book, Stack& call) {
  Scenario& scenario = current(book, "expect");
  const auto* trial = call[1].get<Trial>();
  if (trial == nullptr) {
    throw Error(fmt::format("expect: a trial comes first, as `when` makes it, got {}", describe(call[1])));
  }
  const auto* matcher = call[2].get<MatcherPointer>();
  if (matcher == nullptr) {
    const bool called = call[2].type() != Type::function;
    throw Error(fmt::format("expect: what is expected comes second, as solves(at_least(0.95)), got {}{}",
                            describe(call[2]), called ? "" : ": call it, with ()"));
  }
  add_step(call, scenario, Step::Kind::expect, "", Step::Expectation{*trial, *matcher});
  return call.result(Trial(*trial));
}

int setting_text(Stack& call) {
  const auto* tried = call[1].get<Tried>();
  if (tried == nullptr) return call.result(call[1].describe());
  const Setting& setting = *tried->setting;
  return call.result(fmt::format("setting of the problem '{}' and {}", setting.problem.name,
                                 plural_y(setting.strategies.size(), "strateg")));
}

int candidate_text(Stack& call) {
  const auto* candidate = call[1].get<Candidate>();
  if (candidate == nullptr) return call.result(call[1].describe());
  const auto& [name, strategy] = candidate->setting->strategies[candidate->index];
  return call.result(fmt::format("{} on {}: {}", name, candidate->setting->problem.name, strategy.text()));
}

int trial_text(Stack& call) {
  const auto* trial = call[1].get<Trial>();
  return call.result(trial == nullptr ? call[1].describe() : trial->text());
}

int matcher_text(Stack& call) {
  const auto* matcher = call[1].get<MatcherPointer>();
  return call.result(matcher == nullptr ? call[1].describe() : (*matcher)->text());
}

const Construct& scenario_construct() {
  static const Construct construct = function_construct(
      "scenario", "scenario \"regions find the doorway\" (function() ... end)",
      "what is to hold, under a name, for `trellis test`: what is given, when it runs, what is expected",
      {{"name", "string", "a string", "a function without arguments follows, in parentheses", true}},
      "fun(body: fun())");
  return construct;
}

const Construct& given_construct() {
  static const Construct construct = {
      .name = "given",
      .usage = "local it = given { script = \"doorway.lua\" }",
      .summary = "what a scenario tries: a problem, and strategies that are fields of what it returns",
      .list = "",
      .element = "",
      .fields = {{"script", "string", "the name of a file", "a script in the test's folder; its experiment is tried"},
                 {"problem", "string|trellis.Problem", "a problem; with 'script' the name of one of its problems",
                  "may be left out where the script has one only"},
                 {"strategies", "table<string, trellis.Strategy>", "a table of strategies",
                  "{ name = strategy }; with 'script' its own"},
                 {"measure", "trellis.Target", "a target, as tube { delta = 0.5 }",
                  "what samples are measured against; with 'script' its own", false, "tube {}"}},
      .options = given_settings().component(),
      .returns = "trellis.Setting"};
  return construct;
}

const Construct& when_construct() {
  static const Construct construct = {
      .name = "when",
      .usage = "local guided, plain = when { it.guided, it.plain, seeds = 30 }",
      .summary = "trials of strategies, each on the same seeds; one value for each",
      .list = "strategies of what was given",
      .element = "trellis.Candidate",
      .fields = {{"seeds", "integer|integer[]", fmt::format("an integer in [1, {}], or a list of seeds", most_seeds),
                  "how many consecutive seeds, or which ones", false, std::to_string(trial::default_seeds)}},
      .options = when_settings().component(),
      .returns = "trellis.Trial ..."};
  return construct;
}

const Construct& expect_construct() {
  static const Construct construct =
      function_construct("expect", "expect(guided, solves(at_least(0.95)))", "what a trial is expected to do",
                         {{"trial", "trellis.Trial", "a trial", "as `when` makes it", true},
                          {"matcher", matcher_type, "a matcher", "as solves(at_least(0.95)) makes it", true}},
                         "trellis.Trial");
  return construct;
}

}  // namespace

void open_scenario(Stack& stack, const ScriptPlace& place, const std::shared_ptr<ScenarioBook>& book) {
  const auto text = [](lua::Callback print) { return lua::Metamethods{{"__tostring", std::move(print)}}; };
  stack.declare<Tried>({{"__index", strategy_of_given}, {"__tostring", setting_text}});
  stack.declare<Candidate>(text(candidate_text));
  stack.declare<Trial>(text(trial_text));
  stack.declare<MatcherPointer>(text(matcher_text));
  stack.declare<Criterion>({{"__index", criterion_method}, {"__tostring", criterion_text}});
  for (const Function& function : plain_functions()) {
    stack.push_function(function.call);
    stack.set_global(function.construct.name);
  }
  stack.push_function([book](Stack& call) { return begin_scenario(book, call); });
  stack.set_global(scenario_construct().name);
  stack.push_function([book, place](Stack& call) { return make_given(book, place, call); });
  stack.set_global(given_construct().name);
  stack.push_function([book](Stack& call) { return make_when(book, call); });
  stack.set_global(when_construct().name);
  stack.push_function([book](Stack& call) { return make_expect(book, call); });
  stack.set_global(expect_construct().name);
}

std::vector<const Construct*> scenario_constructs() {
  std::vector<const Construct*> all = {&scenario_construct(), &given_construct(), &when_construct(),
                                       &expect_construct()};
  for (const Function& function : plain_functions()) all.push_back(&function.construct);
  return all;
}

std::vector<ObjectType> scenario_types() {
  std::vector<ObjectType> types;
  types.push_back({"trellis.Setting", "what a scenario tries", "", {}, {}});
  types.back().members = {{"[string]", "trellis.Candidate", "", "its strategies, by their names: setting.guided"}};
  types.push_back({"trellis.Candidate", "a strategy of a setting", "", {}, {}});
  types.push_back({"trellis.Trial", "a strategy on a problem over a range of seeds", "", {}, {}});
  types.push_back({"trellis.Matcher", "what a trial is expected to do", "", {}, {}});
  types.push_back({"trellis.Criterion", "the criterion for a figure", "", {}, {}});
  for (const Method& method : criterion_methods()) {
    types.back().members.push_back({method.name, method.type, "", method.doc});
  }
  return types;
}

}  // namespace trellis::dsl
