// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/tools/scenario_file.hpp>

#include <fmt/format.h>

#include <filesystem>
#include <map>

#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/words/modules.hpp>

namespace trellis::dsl {

ScenarioFile::ScenarioFile(const std::string& path, const Options& options)
    : book_(std::make_shared<ScenarioBook>()), session_(std::filesystem::path(path).parent_path().string(), [&] {
        SessionOptions session = options.session;
        session.scenarios = book_;
        return session;
      }()) {
  book_->seeds = options.seeds;
  book_->making = options.making;
  // Load each script once, even if a loop requests it again.
  const auto known = std::make_shared<std::map<std::string, Program>>();
  book_->load = [known, session = options.session](const std::string& script) {
    const auto found = known->find(script);
    return found != known->end() ? found->second : known->emplace(script, load_script(script, session)).first->second;
  };
  static_cast<void>(session_.evaluate(without_shebang(read_file(path)), path));
  if (book_->entries.empty()) {
    throw Error(fmt::format("{}: the script has no scenario; write scenario \"...\" (function() ... end)", path));
  }
  for (const auto& entry : book_->entries) {
    if (entry.body) continue;
    throw Error(fmt::format("{}scenario '{}' has no function; write scenario \"{}\" (function() ... end)",
                            entry.scenario.where.prefix(), entry.scenario.name, entry.scenario.name));
  }
}

ScenarioFile::~ScenarioFile() = default;

std::vector<std::string> ScenarioFile::names() const {
  std::vector<std::string> names;
  names.reserve(book_->entries.size());
  for (const auto& entry : book_->entries) names.push_back(entry.scenario.name);
  return names;
}

const Scenario& ScenarioFile::play(std::size_t index) {
  Scenario& scenario = book_->entries.at(index).scenario;
  scenario.steps.clear();
  for (const trial::Trial& trial : book_->trials) trial.forget();
  book_->trials.clear();
  struct Mark {
    explicit Mark(ScenarioBook& of, Scenario& scenario) : book(of) { book.current = &scenario; }
    ~Mark() { book.current = nullptr; }
    Mark(const Mark&) = delete;
    Mark& operator=(const Mark&) = delete;
    ScenarioBook& book;
  };
  session_.within_limits([&](lua::Stack& stack) {
    const Mark mark(*book_, scenario);
    book_->entries[index].body->push(stack);
    stack.call(0);
  });
  return scenario;
}

}  // namespace trellis::dsl
